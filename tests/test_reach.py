"""Connected sets against the slow search, and the doors the robot does and does not fit through."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from shapely.geometry import LineString, box

from satAOI_geo.cells import covered_cells
from satAOI_geo.collision import Collider, Reference
from satAOI_geo.freespace import FreeSpace, Sweeps, free_space, moves
from satAOI_geo.intervals import Intervals
from satAOI_geo.lattice import Lattice
from satAOI_geo.nodes import Nodes
from satAOI_geo.plan import Circle, FloorPlan
from satAOI_geo.reach import Band, DiscComponents, PoseComponents
from satAOI_geo.robot import ROBOTS, Robot, unit
from satAOI_geo.units import MM2_PER_M2
from tests import drawn, plans
from tests.oracle import Node, Oracle, State, flooded

PROTOTYPE = ROBOTS["magicbim"]


def searched(
    plan: FloorPlan, robot: Robot, lattice: Lattice, clearance_mm: float = 0.0
) -> tuple[FreeSpace, PoseComponents]:
    engine = Intervals.of(plan, robot, lattice, clearance_mm)
    space = free_space(engine, robot, lattice)
    return space, PoseComponents.of(lattice, [Band.of(engine, robot, space)])


def numbered(lattice: Lattice, state: State) -> tuple[int, int, int, int]:
    """The same state with the number of its swing for a2."""
    iy, ix, a1, a2 = state
    return iy, ix, a1, lattice.swings.index(a2)


def assert_same_sets(
    plan: FloorPlan, robot: Robot, lattice: Lattice, *, clearance_mm: float = 0.0
) -> int:
    """Every state is free in both or neither, and the sets are the same; how many sets."""
    space, fast = searched(plan, robot, lattice, clearance_mm)
    slow = Oracle(plan, robot, lattice, clearance_mm).partition()
    assert np.bitwise_count(space.words).sum() == len(slow)
    fast_label = {state: fast.at(*numbered(lattice, state)) for state in slow}
    assert None not in fast_label.values()
    # one to one: no set of either meets two sets of the other
    pairs = set(zip(slow.values(), fast_label.values(), strict=True))
    assert len(pairs) == len(set(slow.values())) == len(fast.boxes)
    return len(pairs)


SMALL = [
    # seed of the plan, step, directions, clearance
    (11, 140.0, 8, 0.0),
    (12, 100.0, 8, 0.0),
    (13, 160.0, 12, 0.0),
    (14, 90.0, 8, 35.0),
    (15, 130.0, 12, 0.0),
    (16, 60.0, 4, 0.0),
    (17, 110.0, 8, 10.0),
    (18, 150.0, 12, 0.0),
    (19, 120.0, 8, 0.0),
    (20, 100.0, 4, 0.0),
    (21, 160.0, 12, 0.0),
    (22, 120.0, 8, 0.0),
    (23, 200.0, 16, 0.0),
    (24, 130.0, 8, 0.0),
    (25, 70.0, 4, 35.0),
    (26, 150.0, 12, 0.0),
]


@pytest.mark.parametrize(("seed", "step_mm", "n_directions", "clearance_mm"), SMALL)
def test_pose_connected_sets_are_those_of_the_slow_search(
    seed: int, step_mm: float, n_directions: int, clearance_mm: float
) -> None:
    plan = plans.random_plan(seed, n_obstacles=5, side_mm=(2500, 3500))
    lattice = Lattice.over(plan.floor.bounds, PROTOTYPE, step_mm=step_mm, n_directions=n_directions)
    assert_same_sets(plan, PROTOTYPE, lattice, clearance_mm=clearance_mm)


ODD_ROBOTS = {
    "pivot_outside": replace(PROTOTYPE, vehicle_length_mm=400.0, pivot_offset_mm=-333.0),
    "asymmetric_swing": replace(
        PROTOTYPE, swing_min_rad=math.radians(-100), swing_max_rad=math.radians(31)
    ),
    "full_turn_of_swing": replace(
        PROTOTYPE,
        vehicle_length_mm=500.0,
        vehicle_width_mm=300.0,
        swing_min_rad=-math.pi,
        swing_max_rad=math.pi,
    ),
    # as many swings as a full turn has, and an end between the last and the first
    "all_but_one_degree_of_swing": replace(
        PROTOTYPE,
        vehicle_length_mm=500.0,
        vehicle_width_mm=300.0,
        swing_min_rad=-math.pi,
        swing_max_rad=math.radians(179),
    ),
    # between two directions its arm sweeps floor that it covers in neither
    "thin_arm": replace(
        PROTOTYPE,
        vehicle_length_mm=150.0,
        vehicle_width_mm=120.0,
        pivot_offset_mm=30.0,
        arm_length_mm=600.0,
        disc_radius_mm=25.0,
    ),
    "stiff_arm": replace(PROTOTYPE, swing_min_rad=0.0, swing_max_rad=0.0),
    "arm_all_disc": replace(PROTOTYPE, arm_length_mm=350.0, vehicle_length_mm=300.0),
}


@pytest.mark.parametrize("robot", ODD_ROBOTS.values(), ids=ODD_ROBOTS)
@pytest.mark.parametrize("seed", [31, 32])
def test_pose_connected_sets_of_odd_robots_are_those_of_the_slow_search(
    robot: Robot, seed: int
) -> None:
    plan = plans.random_plan(seed, n_obstacles=4, side_mm=(2300, 3000))
    lattice = Lattice.over(plan.floor.bounds, robot, step_mm=150.0, n_directions=8)
    assert_same_sets(plan, robot, lattice)


@pytest.mark.parametrize("name", ["triangles_that_touch", "floor_in_two_parts", "spiral"])
def test_pose_connected_sets_of_hard_plans_are_those_of_the_slow_search(name: str) -> None:
    plan = drawn.HARD[name]
    lattice = Lattice.over(plan.floor.bounds, PROTOTYPE, step_mm=150.0, n_directions=8)
    assert assert_same_sets(plan, PROTOTYPE, lattice) > 1


def test_slow_engine_finds_the_same_sets() -> None:
    plan = drawn.HARD["triangles_that_touch"]
    lattice = Lattice.over(plan.floor.bounds, PROTOTYPE, step_mm=250.0, n_directions=4)
    space, fast = searched(plan, PROTOTYPE, lattice)
    reference = Reference(Collider(plan, PROTOTYPE), lattice)
    slow = Band.of(reference, PROTOTYPE, space)
    assert np.array_equal(slow.labels, fast.bands[0].labels)


@pytest.mark.parametrize("seed", [41, 42])
def test_disc_connected_set_is_what_algorithm_2_reaches(seed: int) -> None:
    plan = plans.random_plan(seed, n_obstacles=6, side_mm=(3000, 4500))
    lattice = Lattice.over(plan.floor.bounds, PROTOTYPE, step_mm=200.0, n_directions=8)
    collider = Collider(plan, PROTOTYPE)

    def is_free(node: Node) -> bool:
        poses = np.ndindex(lattice.n_directions, len(lattice.swings))
        return any(collider.is_free(lattice.pose(*node, a1, swing)) for a1, swing in poses)

    space = free_space(Intervals.of(plan, PROTOTYPE, lattice), PROTOTYPE, lattice)
    discs = DiscComponents.of(space.free_nodes())
    covered: set[Node] = set()
    for label in range(len(discs.boxes)):
        nodes = {(int(iy), int(ix)) for iy, ix in np.argwhere(discs.nodes(label).as_array())}
        assert nodes == flooded(min(nodes), lattice.shape, is_free)
        assert all(discs.labels_at(*node) == label for node in nodes)
        covered |= nodes
    blocked = [node for node in np.ndindex(lattice.shape) if node not in covered]
    assert not any(is_free(node) for node in blocked)
    assert all(discs.labels_at(*node) == -1 for node in blocked)


def test_disc_connected_nodes_touch_at_corners_too() -> None:
    free = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 0], [1, 0, 1]], dtype=bool)
    discs = DiscComponents.of(Nodes.of(free))
    labels = discs.labels_at(*np.mgrid[:4, :3]).tolist()
    assert labels == [[0, -1, -1], [-1, 0, -1], [-1, -1, -1], [1, -1, 2]]
    assert discs.boxes.tolist() == [[0, 0, 1, 1], [3, 0, 3, 0], [3, 2, 3, 2]]


def two_rooms_searched(opening_mm: float) -> tuple[Lattice, DiscComponents, PoseComponents]:
    plan = plans.two_rooms(opening_mm).plan
    lattice = Lattice.over(plan.floor.bounds, PROTOTYPE)
    space, poses = searched(plan, PROTOTYPE, lattice)
    return lattice, DiscComponents.of(space.free_nodes()), poses


@pytest.mark.parametrize(
    ("opening_mm", "disc_passes", "pose_passes"),
    [
        # Rows of nodes lie 5 mm off the middle of the opening, and contact is collision: the disc
        # passes where 350 + 5 < opening / 2, the vehicle where 415 + 5 < opening / 2.
        (690, False, False),
        (710, False, False),
        (720, True, False),
        (760, True, False),
        (800, True, False),
        (840, True, False),
        (850, True, True),
        (900, True, True),
    ],
)
def test_opening_lets_through_what_fits(
    opening_mm: float, *, disc_passes: bool, pose_passes: bool
) -> None:
    lattice, discs, poses = two_rooms_searched(opening_mm)
    start, beyond = lattice.nearest_node(1000.0, 2000.0), lattice.nearest_node(7200.0, 2000.0)
    assert start is not None
    assert beyond is not None
    assert (discs.labels_at(*start) == discs.labels_at(*beyond)).item() is disc_passes

    largest = max(poses.at_node(*start), key=lambda label: poses.nodes(label).count())
    assert (largest in poses.at_node(*beyond)) is pose_passes
    # one room has 16 m²; through the opening the disc gets as far as the vehicle's nose lets it
    covered = covered_cells(poses.nodes(largest), PROTOTYPE.disc_radius_mm / lattice.step_mm)
    area_m2 = covered.count() * lattice.step_mm**2 / MM2_PER_M2
    low_m2, high_m2 = (31.5, 32.0) if pose_passes else (15.5, 17.2)
    assert low_m2 < area_m2 < high_m2


def test_robot_turned_in_a_narrow_room_stays_the_way_it_was_set_down() -> None:
    # 1100 mm wide, 2600 mm long: the straight robot, 1924.5 mm from rim to front, stands either
    # way along it, and the vehicle, 1206 mm from corner to corner, turns in it in neither
    plan = FloorPlan(box(0, 0, 2600, 1100))
    lattice = Lattice.over(plan.floor.bounds, PROTOTYPE)
    _, poses = searched(plan, PROTOTYPE, lattice)
    middle = lattice.n_rows // 2
    straight = lattice.swings.index(0)
    east = poses.at(middle, lattice.n_columns // 4, 0, straight)
    west = poses.at(middle, lattice.n_columns * 3 // 4, 12, straight)
    assert east is not None
    assert west is not None
    assert east != west


def test_wall_of_no_width_between_two_nodes_parts_them() -> None:
    # the robot of a wall-thin slot: both sides free for a small robot, the step across is not
    robot = replace(
        PROTOTYPE,
        vehicle_length_mm=20.0,
        vehicle_width_mm=20.0,
        pivot_offset_mm=0.0,
        arm_length_mm=60.0,
        disc_radius_mm=20.0,
    )
    plan = drawn.plan_of(box(0, 0, 1000, 1000), LineString([(500, -10), (500, 1010)]))
    lattice = Lattice.over(plan.floor.bounds, robot, step_mm=100.0, n_directions=4)
    _, poses = searched(plan, robot, lattice)
    north, straight = 1, lattice.swings.index(0)
    left, right = poses.at(3, 4, north, straight), poses.at(3, 5, north, straight)
    assert left is not None
    assert right is not None
    assert left != right


@pytest.mark.parametrize("other", [(0, 1), (1, 0)], ids=["to_the_right", "up"])
def test_pole_thinner_than_the_step_parts_the_nodes_on_its_sides(other: Node) -> None:
    # the disc of 20 mm steps 100 mm across a pole of 1 mm
    robot = replace(
        PROTOTYPE,
        vehicle_length_mm=20.0,
        vehicle_width_mm=20.0,
        pivot_offset_mm=0.0,
        arm_length_mm=60.0,
        disc_radius_mm=20.0,
        swing_min_rad=0.0,
        swing_max_rad=0.0,
    )
    floor = box(0, 0, 200, 200)
    lattice = Lattice.over(floor.bounds, robot, step_mm=100.0, n_directions=4)
    pole = Circle(50 + 50.0 * other[1], 50 + 50.0 * other[0], 1.0)
    a1 = 1 if other == (0, 1) else 0  # the arm across the step, clear of the pole
    for plan, parted in ((drawn.plan_of(floor, pole), True), (drawn.plan_of(floor), False)):
        _, poses = searched(plan, robot, lattice)
        here, there = poses.at(0, 0, a1, 0), poses.at(*other, a1, 0)
        assert here is not None
        assert there is not None
        assert (here != there) is parted


@pytest.mark.parametrize(
    ("distance_mm", "bearing_deg", "stopped"),
    [
        # The arm is 40 mm wide, its pivot 500 mm off; from there the vehicle, as wide, reaches
        # another 600 mm. Each pole stands between two directions 15° apart, touching neither.
        (300, 7.5, {"turn", "orbit"}),
        # beyond what the vehicle sweeps about its pivot (605) and what it shifts along (149 up)
        (1098, 9.0, {"turn"}),
        (898, 3.33, {"turn", "orbit", "swing"}),
        (1200, 7.5, set()),
    ],
)
def test_pole_stops_the_moves_that_sweep_over_it(
    distance_mm: float, bearing_deg: float, stopped: set[str]
) -> None:
    robot = Robot(
        name="thin",
        vehicle_length_mm=600.0,
        vehicle_width_mm=40.0,
        pivot_offset_mm=300.0,
        arm_length_mm=500.0,
        disc_radius_mm=20.0,
    )
    x_mm, y_mm = (distance_mm * part for part in unit(math.radians(bearing_deg)))
    plan = drawn.plan_of(box(-2000, -2000, 2000, 2000), Circle(x_mm, y_mm, 1.0))
    # one cell, its centre the origin
    lattice = Lattice.over(plan.floor.bounds, robot, step_mm=4000.0)
    engine = Intervals.of(plan, robot, lattice)
    space = free_space(engine, robot, lattice)
    straight = lattice.swings.index(0)
    names = {(1, straight): "turn", (0, straight + 1): "swing", (1, straight - 1): "orbit"}
    allowed = {
        names[move.to_a1, move.to_swing]: bool(
            Nodes(move.allowed(engine), lattice.n_columns).as_array()[0, 0]
        )
        for move in moves(engine, Sweeps.of(robot, lattice), space, 0)
        if move.swing == straight
    }
    assert all(space.is_free(0, 0, *pose) for pose in [(0, straight), *names])
    assert {name for name, is_allowed in allowed.items() if not is_allowed} == stopped
    assert set(allowed) == set(names.values())


def test_floor_on_which_nothing_is_free_has_no_sets() -> None:
    plan = FloorPlan(box(0, 0, 800, 800))
    lattice = Lattice.over(plan.floor.bounds, PROTOTYPE)
    space, poses = searched(plan, PROTOTYPE, lattice)
    assert not space.words.any()
    assert poses.boxes.shape == (0, 4)
    assert poses.at_node(40, 40) == []
    assert DiscComponents.of(space.free_nodes()).boxes.shape == (0, 4)


@pytest.mark.parametrize("seed", [51, 52])
def test_every_set_lies_in_its_box_and_touches_its_sides(seed: int) -> None:
    plan = plans.random_plan(seed, n_obstacles=6, side_mm=(3000, 4500))
    lattice = Lattice.over(plan.floor.bounds, PROTOTYPE, step_mm=50.0, n_directions=12)
    space, poses = searched(plan, PROTOTYPE, lattice)
    discs = DiscComponents.of(space.free_nodes())
    for sets in (discs, poses):
        for label, box_of in enumerate(sets.boxes):
            nodes = sets.nodes(label).as_array()
            iy, ix = np.nonzero(nodes)
            assert box_of.tolist() == [iy.min(), ix.min(), iy.max(), ix.max()]
            window = slice(iy.min(), iy.max() + 1), slice(ix.min(), ix.max() + 1)
            assert np.array_equal(sets.nodes(label, *window).as_array(), nodes[window])


@pytest.mark.parametrize("seed", [51, 52])
def test_sets_together_hold_every_free_state_once(seed: int) -> None:
    plan = plans.random_plan(seed, n_obstacles=6, side_mm=(3000, 4500))
    lattice = Lattice.over(plan.floor.bounds, PROTOTYPE, step_mm=50.0, n_directions=12)
    space, poses = searched(plan, PROTOTYPE, lattice)
    runs = poses.bands[0].runs
    assert runs.n_states(lattice.n_rows) == np.bitwise_count(space.words).sum()
    nodes = [poses.nodes(label).as_array() for label in range(len(poses.boxes))]
    assert np.array_equal(np.any(nodes, axis=0), space.free_nodes().as_array())


@pytest.mark.parametrize("seed", range(71, 77))
def test_floor_cut_into_bands_has_the_same_sets(seed: int) -> None:
    plan = plans.random_plan(seed, n_obstacles=6, side_mm=(3000, 4500))
    lattice = Lattice.over(plan.floor.bounds, PROTOTYPE, step_mm=50.0, n_directions=12)
    engine = Intervals.of(plan, PROTOTYPE, lattice)
    noise = np.random.default_rng(seed)
    inner = noise.choice(
        np.arange(1, lattice.n_rows), size=int(noise.integers(1, 9)), replace=False
    )
    cuts = [0, *np.sort(inner).tolist(), lattice.n_rows]
    bands = []
    for begin, end in pairwise(cuts):
        # each has the first row of the next
        rows = slice(begin, min(end + 1, lattice.n_rows))
        here = engine.band(rows)
        bands.append(Band.of(here, PROTOTYPE, free_space(here, PROTOTYPE, lattice.band(rows))))
    cut = PoseComponents.of(lattice, bands)
    _, whole = searched(plan, PROTOTYPE, lattice)
    for name in ("first", "row", "begin", "end"):
        assert np.array_equal(getattr(cut.stretches, name), getattr(whole.stretches, name))
    for iy, ix in noise.integers(0, lattice.shape, size=(60, 2)).tolist():
        assert cut.at_node(iy, ix) == whole.at_node(iy, ix)
        for label in whole.at_node(iy, ix):
            state = whole.straightest(iy, ix, label)
            assert cut.straightest(iy, ix, label) == state
            assert cut.at(*state) == label


@pytest.mark.parametrize("name", ["full_turn_of_swing", "all_but_one_degree_of_swing"])
def test_the_arm_swings_through_180_degrees_where_its_range_has_them(name: str) -> None:
    robot = ODD_ROBOTS[name]
    plan = FloorPlan(box(0, 0, 4000, 4000))
    lattice = Lattice.over(plan.floor.bounds, robot, step_mm=500.0, n_directions=8)
    engine = Intervals.of(plan, robot, lattice)
    space = free_space(engine, robot, lattice)
    swung = {
        abs(move.to_swing - move.swing)
        for move in moves(engine, Sweeps.of(robot, lattice), space, 0)
    }
    # from the last of 8 swings to the first
    assert swung == ({0, 1, 7} if name == "full_turn_of_swing" else {0, 1})
