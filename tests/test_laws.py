"""Laws that hold whatever the plan: symmetry bit for bit, and less room is never more reach."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from shapely.geometry import Polygon, box

from satAOI_geo.freespace import free_space
from satAOI_geo.intervals import Intervals
from satAOI_geo.lattice import Lattice
from satAOI_geo.nodes import Nodes
from satAOI_geo.plan import BoolArray, Circle, FloorPlan, Obstacle
from satAOI_geo.reach import Band, DiscComponents, PoseComponents
from satAOI_geo.robot import ROBOTS, Robot
from tests import plans
from tests.drawn import ROOM, plan_of

PROTOTYPE = ROBOTS["magicbim"]
LOPSIDED = replace(
    PROTOTYPE,
    vehicle_length_mm=431.0,
    pivot_offset_mm=-307.0,
    swing_min_rad=math.radians(-30),
    swing_max_rad=math.radians(105),
)
"""Swings farther to one side; its pivot lies outside the vehicle."""

ROBOTS_TRIED = pytest.mark.parametrize(
    "robot", [PROTOTYPE, LOPSIDED], ids=["prototype", "lopsided"]
)

STEP_MM = 20.0
"""Nodes at odd multiples of 10 mm: a distance of exactly 350 mm from a wall is the rule."""

FINE = 24
"""Directions where all that is found is compared bit for bit; half as many serve elsewhere."""

Labels = npt.NDArray[np.int32]


def is_of_whole_cells(plan: FloorPlan) -> bool:
    return all(bound % STEP_MM == 0 for bound in plan.floor.bounds)


DRAWN = [
    plan
    for plan in (plans.random_plan(seed, side_mm=(2400, 3400)) for seed in range(1000, 1040))
    if is_of_whole_cells(plan)
][:3]

on_drawn_plans = pytest.mark.parametrize("plan", DRAWN, ids=range(len(DRAWN)))


@dataclass(frozen=True)
class Found:
    """What a plan comes to."""

    lattice: Lattice
    words: npt.NDArray[np.uint64]
    poses: PoseComponents
    discs: DiscComponents

    @property
    def free(self) -> BoolArray:
        """Whether each state is free, shape (a1, swing, row, column)."""
        return Nodes(self.words, self.lattice.n_columns).as_array()

    def labels(self) -> Labels:
        """The number of each state's set, shaped as `free`, -1 where it is not."""
        free, (band,) = self.free, self.poses.bands
        widths = band.runs.end - band.runs.begin + 1
        labels = np.full(free.shape, -1, dtype=np.int32)
        # runs are ordered as the states are, and hold them all
        labels[free] = np.repeat(numbers_of(self.poses), widths)
        return labels


def disc_labels(at: Found) -> Labels:
    """The number of each node's disc-connected set, -1 where no pose is free."""
    labels = np.full(at.lattice.shape, -1, dtype=np.int32)
    for label in range(len(at.discs.boxes)):
        labels[at.discs.nodes(label).as_array()] = label
    return labels


def numbers_of(poses: PoseComponents) -> Labels:
    """The number of each run's set."""
    return poses.numbers[0][poses.bands[0].labels]


@lru_cache(maxsize=20)
def found(
    plan: FloorPlan,
    robot: Robot = PROTOTYPE,
    *,
    clearance_mm: float = 0.0,
    n_directions: int = FINE // 2,
) -> Found:
    lattice = Lattice.over(plan.floor.bounds, robot, step_mm=STEP_MM, n_directions=n_directions)
    engine = Intervals.of(plan, robot, lattice, clearance_mm)
    space = free_space(engine, robot, lattice)
    return Found(
        lattice,
        space.words,
        PoseComponents.of(lattice, [Band.of(engine, robot, space)]),
        DiscComponents.of(space.free_nodes()),
    )


def canonical(labels: Labels) -> npt.NDArray[np.int64]:
    """The same sets numbered by the first of their states: equal sets have equal numbers."""
    flat = labels.ravel()
    first = np.full(flat.max(initial=-1) + 2, -1)
    # of several states of one set the last one written stays; number -1 is no set
    first[flat[::-1]] = np.arange(flat.size)[::-1]
    first[-1] = -1
    return first[labels]


def turned_states(states: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """(a1, swing, iy, ix) becomes (a1 + 90°, swing, ix, n_rows - 1 - iy)."""
    return np.roll(states, FINE // 4, axis=0).swapaxes(-1, -2)[..., ::-1]


def mirrored_states(states: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """(a1, swing, iy, ix) becomes (180° - a1, -swing, iy, n_columns - 1 - ix)."""
    half_turn_less = (FINE // 2 - np.arange(FINE)) % FINE
    return states[half_turn_less][:, ::-1, :, ::-1]


def assert_same_after(
    before: Found,
    after: Found,
    mapped: Callable[[npt.NDArray[Any]], npt.NDArray[Any]],
) -> None:
    """States, disc-connected sets and pose-connected sets are the same after a motion."""
    assert np.array_equal(after.free, mapped(before.free))
    assert np.array_equal(canonical(after.labels()), canonical(mapped(before.labels())))
    discs = mapped(np.broadcast_to(disc_labels(before), before.free.shape))[0, 0]
    assert np.array_equal(canonical(disc_labels(after)), canonical(discs))


found_finely = partial(found, n_directions=FINE)


@on_drawn_plans
@ROBOTS_TRIED
def test_plan_turned_by_a_quarter_turns_all_that_is_found(plan: FloorPlan, robot: Robot) -> None:
    before, after = found_finely(plan, robot), found_finely(plans.quarter_turned(plan), robot)
    assert_same_after(before, after, turned_states)


@pytest.mark.parametrize("turns", [2, 3, 4])
def test_plan_turned_by_several_quarters_turns_all_that_is_found(turns: int) -> None:
    def turned_often(states: npt.NDArray[Any]) -> npt.NDArray[Any]:
        for _ in range(turns):
            states = turned_states(states)
        return states

    plan = DRAWN[0]
    for _ in range(turns):
        plan = plans.quarter_turned(plan)
    assert_same_after(found_finely(DRAWN[0]), found_finely(plan), turned_often)


@on_drawn_plans
@ROBOTS_TRIED
def test_plan_in_a_mirror_mirrors_all_that_is_found(plan: FloorPlan, robot: Robot) -> None:
    in_the_mirror = replace(
        robot, swing_min_rad=-robot.swing_max_rad, swing_max_rad=-robot.swing_min_rad
    )
    before, after = found_finely(plan, robot), found_finely(plans.mirrored(plan), in_the_mirror)
    assert_same_after(before, after, mirrored_states)


@on_drawn_plans
@pytest.mark.parametrize("cells", [(1, 0), (-4000, 123_456)], ids=repr)
def test_plan_shifted_by_whole_cells_shifts_all_that_is_found(
    plan: FloorPlan, cells: tuple[int, int]
) -> None:
    before, after = found(plan), found(plans.shifted(plan, cells[0] * STEP_MM, cells[1] * STEP_MM))
    assert np.array_equal(before.words, after.words)
    assert np.array_equal(numbers_of(before.poses), numbers_of(after.poses))
    assert np.array_equal(disc_labels(before), disc_labels(after))


@on_drawn_plans
def test_order_of_the_obstacles_does_not_matter(plan: FloorPlan) -> None:
    before = found(plan)
    after = found(replace(plan, obstacles=plan.obstacles[::-1]))
    assert np.array_equal(before.words, after.words)
    assert np.array_equal(numbers_of(before.poses), numbers_of(after.poses))


def test_threads_find_the_same_numbers_every_time() -> None:
    first = found(DRAWN[0]).poses
    for _ in range(4):
        found.cache_clear()
        again = found(DRAWN[0]).poses
        for name in ("first", "begin", "end"):
            one, other = first.bands[0].runs, again.bands[0].runs
            assert np.array_equal(getattr(one, name), getattr(other, name))
        assert np.array_equal(numbers_of(first), numbers_of(again))
        assert np.array_equal(first.boxes, again.boxes)


@on_drawn_plans
@ROBOTS_TRIED
def test_pose_connected_sets_lie_within_disc_connected_ones(plan: FloorPlan, robot: Robot) -> None:
    at = found(plan, robot)
    for label in range(len(at.poses.boxes)):
        assert len(np.unique(disc_labels(at)[at.poses.nodes(label).as_array()])) == 1
    assert disc_labels(at)[~at.free.any(axis=(0, 1))].max(initial=-1) == -1


def assert_never_more(before: Found, after: Found) -> None:
    """No state, no node and no connection is found that was not there before."""
    assert not (after.free & ~before.free).any()
    assert_split(before.labels()[after.free], after.labels()[after.free])
    reached = disc_labels(after) >= 0
    assert_split(disc_labels(before)[reached], disc_labels(after)[reached])


def assert_split(whole: Labels, parts: Labels) -> None:
    """Each part lies in one whole."""
    whole_of = np.full(parts.max(initial=-1) + 1, -1)
    whole_of[parts] = whole
    assert np.array_equal(whole_of[parts], whole)
    assert (whole >= 0).all()


@on_drawn_plans
def test_one_more_obstacle_never_adds(plan: FloorPlan) -> None:
    for n_obstacles in (0, 2, 5):
        fewer = found(replace(plan, obstacles=plan.obstacles[:n_obstacles]))
        more = found(replace(plan, obstacles=plan.obstacles[: n_obstacles + 1]))
        assert_never_more(fewer, more)


def test_smaller_floor_never_adds() -> None:
    cut = box(0, 0, 4000, 3600).difference(box(2000, 2200, 4000, 3600))
    assert_never_more(found(plan_of(ROOM)), found(plan_of(cut)))


@on_drawn_plans
@pytest.mark.parametrize(
    "grown",
    [
        replace(PROTOTYPE, vehicle_length_mm=943.0),
        replace(PROTOTYPE, vehicle_width_mm=851.7),
        # the arm is as wide as the disc and still ends at the pivot
        replace(PROTOTYPE, disc_radius_mm=388.8),
        replace(PROTOTYPE, vehicle_length_mm=875.125, vehicle_width_mm=830.125),
    ],
    ids=["longer", "wider", "larger_disc", "hardly"],
)
def test_larger_robot_never_adds(plan: FloorPlan, grown: Robot) -> None:
    assert_never_more(found(plan), found(plan, grown))


@on_drawn_plans
def test_more_clearance_never_adds(plan: FloorPlan) -> None:
    assert_never_more(found(plan), found(plan, clearance_mm=0.5))
    assert_never_more(found(plan, clearance_mm=20.0), found(plan, clearance_mm=35.0))


@on_drawn_plans
def test_arm_that_swings_less_never_adds(plan: FloorPlan) -> None:
    stiffer = replace(PROTOTYPE, swing_min_rad=math.radians(-45), swing_max_rad=math.radians(60))
    before, after = found(plan), found(plan, stiffer)
    # a2 from -60° to 30° out of -90° to 90°
    same = slice(1, 5)
    assert np.array_equal(after.free, before.free[:, same])
    assert_split(before.labels()[:, same][after.free], after.labels()[after.free])


def test_block_cut_in_two_blocks_as_much_as_the_whole() -> None:
    whole = found(plan_of(ROOM, box(1310, 900, 2210, 1700)))
    halves = found(plan_of(ROOM, box(1310, 900, 1777, 1700), box(1777, 900, 2210, 1700)))
    assert np.array_equal(whole.words, halves.words)
    assert np.array_equal(numbers_of(whole.poses), numbers_of(halves.poses))


def test_obstacle_within_another_changes_nothing() -> None:
    block = box(1310, 900, 2210, 1700)
    alone = found(plan_of(ROOM, block))
    both = found(plan_of(ROOM, block, Circle(1700.0, 1300.0, 390.0)))
    assert np.array_equal(alone.words, both.words)


def test_circle_blocks_more_than_a_polygon_in_it_and_less_than_one_around_it() -> None:
    circle = Circle(1833.3, 1677.7, 412.5)
    inside, around = polygon_about(circle, 1.0), polygon_about(circle, 1 / math.cos(math.pi / 16))
    assert_never_more(found(plan_of(ROOM, inside)), found(plan_of(ROOM, circle)))
    assert_never_more(found(plan_of(ROOM, circle)), found(plan_of(ROOM, around)))


def polygon_about(circle: Circle, share: float) -> Polygon:
    """Sixteen corners at a share of the circle's radius."""
    angles_rad = np.arange(16) * math.pi / 8
    corner_mm = share * circle.radius_mm
    return Polygon(
        np.column_stack(
            (
                circle.x_mm + corner_mm * np.cos(angles_rad),
                circle.y_mm + corner_mm * np.sin(angles_rad),
            )
        )
    )


def test_obstacle_off_the_floor_changes_nothing() -> None:
    plan = DRAWN[0]
    right_mm = plan.floor.bounds[2]
    outside = Obstacle(box(right_mm, -5000, right_mm + 9000, 9000), plan.obstacles[0].kind)
    before, after = found(plan), found(replace(plan, obstacles=(*plan.obstacles, outside)))
    assert np.array_equal(before.words, after.words)
    assert np.array_equal(numbers_of(before.poses), numbers_of(after.poses))
