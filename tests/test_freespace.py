"""Free space by row intervals is the free space of the reference, state by state."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeAlias

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from satAOI_adapters import read_plan
from satAOI_adapters.dxf_read import ReadOptions
from satAOI_geo.collision import Collider, Reference
from satAOI_geo.freespace import FreeSpace, Sweeps, free_space
from satAOI_geo.intervals import Intervals
from satAOI_geo.lattice import Lattice
from satAOI_geo.nodes import Nodes
from satAOI_geo.plan import BoolArray, FloorPlan
from satAOI_geo.robot import ROBOTS, Robot
from tests import drawn, plans
from tests.oracle import Oracle

PROTOTYPE = ROBOTS["magicbim"]

SAMPLES = sorted((Path(__file__).parents[1] / "samples").glob("*.dxf"))

Numbers: TypeAlias = tuple[int, int, int, int]
"""Row, column, direction number and swing number of a state."""


@dataclass(frozen=True)
class Setting:
    """All that a free space depends on besides the plan."""

    robot: Robot = PROTOTYPE
    step_mm: float = 10.0
    n_directions: int = 24
    clearance_mm: float = 0.0

    def lattice(self, plan: FloorPlan) -> Lattice:
        return Lattice.over(
            plan.floor.bounds, self.robot, step_mm=self.step_mm, n_directions=self.n_directions
        )

    def engine(self, plan: FloorPlan) -> Intervals:
        return Intervals.of(plan, self.robot, self.lattice(plan), self.clearance_mm)

    def space(self, plan: FloorPlan) -> FreeSpace:
        return free_space(self.engine(plan), self.robot, self.lattice(plan))

    def collider(self, plan: FloorPlan) -> Collider:
        return Collider(plan, self.robot, self.clearance_mm)


SETTINGS = {
    "prototype": Setting(),
    "with_clearance": Setting(step_mm=33.0, n_directions=12, clearance_mm=35.0),
    "pivot_behind_the_vehicle": Setting(
        Robot(
            name="drawbar",
            vehicle_length_mm=611.7,
            vehicle_width_mm=433.1,
            pivot_offset_mm=702.9,
            arm_length_mm=533.3,
            disc_radius_mm=217.3,
        ),
        step_mm=7.3,
        n_directions=8,
    ),
    "pivot_ahead_of_a_wide_vehicle": Setting(
        Robot(
            name="bulldozer",
            vehicle_length_mm=260.0,
            vehicle_width_mm=1111.0,
            pivot_offset_mm=-333.3,
            arm_length_mm=480.0,
            disc_radius_mm=480.0 - 1 / 3,
            swing_min_rad=math.radians(-20),
            swing_max_rad=math.radians(100),
        ),
        step_mm=33.0,
        n_directions=36,
        clearance_mm=0.5,
    ),
    "full_turn_of_swing": Setting(
        Robot(
            name="carousel",
            vehicle_length_mm=430.0,
            vehicle_width_mm=290.0,
            pivot_offset_mm=40.0,
            arm_length_mm=750.0,
            disc_radius_mm=150.0,
            swing_min_rad=-math.pi,
            swing_max_rad=math.pi,
        ),
        step_mm=100.0,
        n_directions=4,
    ),
}


def at_boundary(free: BoolArray) -> BoolArray:
    """Nodes with a neighbour in row or column of which the opposite is true."""
    changed = np.zeros_like(free)
    up, right = free[1:] != free[:-1], free[:, 1:] != free[:, :-1]
    changed[1:] |= up
    changed[:-1] |= up
    changed[:, 1:] |= right
    changed[:, :-1] |= right
    return changed


def drawn_nodes(free: BoolArray, draw: np.random.Generator) -> Iterator[tuple[int, int]]:
    """Twenty nodes beside the boundary of the free nodes, if there are any, and ten anywhere."""
    beside = np.argwhere(at_boundary(free))
    if len(beside):
        yield from draw.choice(beside, size=min(20, len(beside)), replace=False)
    yield from draw.integers(free.shape, size=(10, 2))


def sampled(space: FreeSpace, n_states: int) -> tuple[list[Numbers], int]:
    """States drawn at random, the same on every run, and how many lie beside the boundary."""
    draw = np.random.default_rng(n_states)
    lattice = space.lattice
    states: list[Numbers] = []
    n_beside = 0
    while len(states) < n_states:
        a1, swing = draw.integers((lattice.n_directions, len(lattice.swings)))
        free = Nodes(space.words[a1, swing], lattice.n_columns).as_array()
        beside = at_boundary(free)
        for iy, ix in drawn_nodes(free, draw):
            states.append((int(iy), int(ix), int(a1), int(swing)))
            n_beside += bool(beside[iy, ix])
    return states, n_beside


def mismatches(space: FreeSpace, collider: Collider, states: list[Numbers]) -> list[Numbers]:
    """The states about which the two disagree."""
    pose = space.lattice.pose
    return [s for s in states if space.is_free(*s) != collider.is_free(pose(*s))]


# 25 plans of 1200 states: 30 000, on the lattice that is used by default


@pytest.mark.parametrize("path", SAMPLES, ids=[path.stem for path in SAMPLES])
def test_every_state_tried_on_a_sample_is_as_the_reference_says(path: Path) -> None:
    plan, setting = read_plan(path, ReadOptions()), Setting()
    space = setting.space(plan)
    states, n_beside = sampled(space, 1200)
    assert n_beside >= len(states) / 2
    assert mismatches(space, setting.collider(plan), states) == []


@pytest.mark.parametrize("name", sorted(plans.CASES))
def test_every_state_tried_on_a_named_plan_is_as_the_reference_says(name: str) -> None:
    plan, setting = plans.CASES[name]().plan, Setting()
    space = setting.space(plan)
    states, n_beside = sampled(space, 1200)
    assert n_beside >= len(states) / 2
    assert mismatches(space, setting.collider(plan), states) == []


@pytest.mark.parametrize("seed", range(100, 110))
def test_every_state_tried_on_a_random_plan_is_as_the_reference_says(seed: int) -> None:
    plan, setting = plans.random_plan(seed), Setting()
    space = setting.space(plan)
    states, n_beside = sampled(space, 1200)
    assert n_beside >= len(states) / 2
    assert mismatches(space, setting.collider(plan), states) == []


@pytest.mark.parametrize("setting", SETTINGS.values(), ids=SETTINGS)
@pytest.mark.parametrize("name", drawn.HARD)
def test_every_state_tried_on_a_hard_plan_is_as_the_reference_says(
    name: str, setting: Setting
) -> None:
    plan = drawn.HARD[name]
    space = setting.space(plan)
    states, _ = sampled(space, 300)
    assert mismatches(space, setting.collider(plan), states) == []


@settings(max_examples=60)
@given(
    drawn.robots(),
    st.integers(0, 10**6),
    st.sampled_from([7.3, 10.0, 33.0, 100.0]),
    st.sampled_from([4, 8, 12, 24, 36]),
    st.sampled_from([0.0, 35.0]),
)
def test_every_state_tried_with_a_random_robot_is_as_the_reference_says(
    robot: Robot, seed: int, step_mm: float, n_directions: int, clearance_mm: float
) -> None:
    plan = plans.random_plan(seed, n_obstacles=5, side_mm=(1500, 3500))
    setting = Setting(robot, step_mm, n_directions, clearance_mm)
    space = setting.space(plan)
    states, _ = sampled(space, 100)
    assert mismatches(space, setting.collider(plan), states) == []


@pytest.mark.parametrize("name", drawn.HARD)
def test_every_state_of_a_coarse_lattice_is_as_the_definitions_say(name: str) -> None:
    plan = drawn.HARD[name]
    setting = Setting(step_mm=187.0, n_directions=8, clearance_mm=3.0)
    space, lattice = setting.space(plan), setting.lattice(plan)
    oracle = Oracle(plan, PROTOTYPE, lattice, clearance_mm=3.0)
    for a1 in range(lattice.n_directions):
        for swing, a2 in enumerate(lattice.swings):
            expected = np.reshape(oracle.free((a1, a2), oracle.nodes), lattice.shape)
            assert np.array_equal(
                Nodes(space.words[a1, swing], lattice.n_columns).as_array(), expected
            )


def test_slow_engine_finds_the_same_free_space() -> None:
    plan = drawn.HARD["comb_with_holes"]
    setting = Setting(step_mm=250.0, n_directions=8)
    lattice = setting.lattice(plan)
    reference = Reference(setting.collider(plan), lattice)
    slow = free_space(reference, PROTOTYPE, lattice)
    assert np.array_equal(slow.words, setting.space(plan).words)


@pytest.mark.parametrize("name", ["specks_smaller_than_a_cell", "slivers", "thin_bands_along_arcs"])
def test_steps_that_something_small_bars_are_those_of_the_slow_engine(name: str) -> None:
    # a robot of parts narrower than a cell, among things smaller than a cell
    robot = replace(
        PROTOTYPE,
        vehicle_length_mm=70.0,
        vehicle_width_mm=20.0,
        pivot_offset_mm=10.0,
        arm_length_mm=130.0,
        disc_radius_mm=30.0,
    )
    plan = drawn.HARD[name]
    setting = Setting(robot, step_mm=170.0, n_directions=8)
    space, lattice = setting.space(plan), setting.lattice(plan)
    slow = free_space(Reference(setting.collider(plan), lattice), robot, lattice)
    n_barred = 0
    for a1, rows_up in np.ndindex(lattice.n_directions, 2):
        free = np.stack([Nodes(words, lattice.n_columns).as_array() for words in space.words[a1]])
        ahead = np.zeros_like(free)
        if rows_up:
            ahead[:, :-1] = free[:, 1:]
        else:
            ahead[..., :-1] = free[..., 1:]
        bits = (*free.shape[:2], space.words.shape[-1] * 64)
        found, expected = free & ahead, free & ahead
        for steps, some in ((found, space), (expected, slow)):
            steps[np.unravel_index(some.barred_steps(a1, rows_up=rows_up), bits)] = False
        assert np.array_equal(found, expected)
        if rows_up:
            for steps, up in zip(found, space.steps_up(a1), strict=True):
                assert np.array_equal(Nodes(up, lattice.n_columns).as_array(), steps)
        n_barred += np.count_nonzero(free & ahead & ~found)
    assert n_barred > 0


def test_arm_without_length_leaves_the_disc_to_be_tested() -> None:
    # an arm as long as the disc's radius: the spine is a single point, 300 mm from the wall
    robot = replace(PROTOTYPE, vehicle_length_mm=50.0, vehicle_width_mm=50.0, arm_length_mm=350.0)
    plan = drawn.plan_of(drawn.ROOM)
    setting = Setting(robot, step_mm=100.0, n_directions=4)
    space = setting.space(plan)
    states, n_beside = sampled(space, 300)
    assert n_beside > 0
    assert mismatches(space, setting.collider(plan), states) == []


def test_free_nodes_are_those_with_some_free_pose() -> None:
    space = Setting(step_mm=50.0, n_directions=8).space(drawn.HARD["spiral"])
    every = np.array(
        [[Nodes(words, space.lattice.n_columns).as_array() for words in row] for row in space.words]
    )
    assert np.array_equal(space.free_nodes().as_array(), every.any(axis=(0, 1)))
    assert np.bitwise_count(space.words).sum() == every.sum()


def test_free_space_of_an_empty_room_is_what_walls_leave() -> None:
    # straight to the east in a room of 4000 × 3600: the disc's rim 350 behind, the vehicle's front
    # 1574.5 ahead, its sides 415 off, and contact is collision
    setting = Setting()
    plan = drawn.plan_of(drawn.ROOM)
    space, lattice = setting.space(plan), setting.lattice(plan)
    columns = [ix for ix in range(400) if 350 < lattice.x_mm(ix) < 4000 - 1574.5]
    rows = [iy for iy in range(360) if 415 < lattice.y_mm(iy) < 3600 - 415]
    expected = np.zeros((360, 400), dtype=bool)
    expected[np.ix_(rows, columns)] = True
    straight = lattice.swings.index(0)
    assert np.array_equal(Nodes(space.words[0, straight], lattice.n_columns).as_array(), expected)


@given(drawn.robots(), st.sampled_from([4, 8, 12, 24]))
def test_the_disc_about_the_vehicle_holds_all_that_it_sweeps(
    robot: Robot, n_directions: int
) -> None:
    lattice = Lattice.over((0.0, 0.0, 100.0, 100.0), robot, n_directions=n_directions)
    sweeps, n_swings = Sweeps.of(robot, lattice), len(lattice.swings)
    for a1, disc in enumerate(sweeps.rounds):
        here = slice(a1 * n_swings, (a1 + 1) * n_swings)
        swept = [*sweeps.turns[here], *sweeps.orbits[here], *sweeps.swings[here]]
        corners = shapely.points(np.concatenate([part.corners_mm for part in swept]))
        core = shapely.MultiPoint(disc.corners_mm).convex_hull
        # the parts are convex and have no radius of their own
        assert {part.radius_mm for part in swept} == {0.0}
        assert shapely.distance(corners, core).max() < disc.radius_mm
