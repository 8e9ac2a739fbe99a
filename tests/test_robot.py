"""The robot's parts stand where its drawing says, and measures that contradict are refused."""

import math
from dataclasses import asdict, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from satAOI_geo.errors import RobotError
from satAOI_geo.robot import ROBOTS, Part, Robot, unit

PROTOTYPE = ROBOTS["magicbim"]
EAST, NORTH, WEST = np.array((1.0, 0.0)), np.array((0.0, 1.0)), np.array((-1.0, 0.0))

angles = st.floats(-4 * math.pi, 4 * math.pi)


def signed_area_mm2(part: Part) -> float:
    x_mm, y_mm = part.corners_mm.T
    return float((x_mm * np.roll(y_mm, -1) - np.roll(x_mm, -1) * y_mm).sum() / 2)


def test_capsule_reaches_from_the_far_rim_of_the_disc_to_the_pivot() -> None:
    capsule = PROTOTYPE.capsule(EAST)
    assert capsule.corners_mm.tolist() == [[0, 0], [645, 0]]
    assert capsule.radius_mm == 350
    # 645 + 350 is the arm's length of 995
    assert capsule.corners_mm[1, 0] + capsule.radius_mm == PROTOTYPE.arm_length_mm


def test_straight_robot_has_its_vehicle_ahead_of_the_pivot() -> None:
    corners_mm = PROTOTYPE.vehicle(EAST, EAST).corners_mm
    # the centre at 995 + 142, half of 875 along and half of 830 across
    assert sorted(corners_mm.tolist()) == [
        [699.5, -415],
        [699.5, 415],
        [1574.5, -415],
        [1574.5, 415],
    ]


def test_vehicle_turned_right_of_the_arm_lies_to_the_east_of_a_pivot_in_the_north() -> None:
    # a1 = 90°, a2 = -90°: the pivot at (0, 995), the vehicle heading along x
    corners_mm = PROTOTYPE.vehicle(NORTH, EAST).corners_mm
    assert sorted(corners_mm.tolist()) == [
        [-295.5, 580],
        [-295.5, 1410],
        [579.5, 580],
        [579.5, 1410],
    ]


def test_pivot_in_front_of_the_centre_puts_the_vehicle_back() -> None:
    robot = replace(PROTOTYPE, pivot_offset_mm=-600.0)
    assert robot.vehicle(WEST, NORTH).corners_mm.mean(axis=0).tolist() == [-995, -600]


@given(angles, angles)
def test_vehicle_runs_counter_clockwise_and_keeps_its_area(a1_rad: float, yaw_rad: float) -> None:
    vehicle = PROTOTYPE.vehicle(unit(a1_rad), unit(yaw_rad))
    # the cross product of numbers up to 2000 is good to 1e-9
    assert signed_area_mm2(vehicle) == pytest.approx(875 * 830, rel=1e-12)


@given(angles, angles, st.floats(-2000, 2000))
def test_no_corner_of_the_robot_is_beyond_its_reach(
    a1_rad: float, yaw_rad: float, pivot_offset_mm: float
) -> None:
    robot = replace(PROTOTYPE, pivot_offset_mm=pivot_offset_mm)
    arm = unit(a1_rad)
    for part in (robot.capsule(arm), robot.vehicle(arm, unit(yaw_rad))):
        farthest_mm = np.hypot(*part.corners_mm.T).max() + part.radius_mm
        assert farthest_mm <= robot.reach_mm * (1 + 1e-15)


@pytest.mark.parametrize("turns", range(-9, 10))
def test_unit_vectors_at_quarter_turns_are_whole_numbers(turns: int) -> None:
    # a product, not a table: what a pose made of multiples of 90° really holds
    expected = [(1, 0), (0, 1), (-1, 0), (0, -1)][turns % 4]
    assert tuple(unit(turns * (math.pi / 2))) == expected


@given(angles)
def test_unit_vector_is_cosine_and_sine(angle_rad: float) -> None:
    # 4π rounded to double precision is off by 1e-15, and so is what is left of it
    assert unit(angle_rad) == pytest.approx((math.cos(angle_rad), math.sin(angle_rad)), abs=4e-15)


def test_moved_part_has_its_reference_point_at_the_node() -> None:
    moved = PROTOTYPE.capsule(NORTH).moved(10.0, -20.0)
    assert moved.corners_mm.tolist() == [[10, -20], [10, 625]]
    assert moved.radius_mm == 350


@pytest.mark.parametrize(
    "measure",
    ["vehicle_length_mm", "vehicle_width_mm", "arm_length_mm", "disc_radius_mm"],
)
@pytest.mark.parametrize("value_mm", [0.0, -1.0, math.nan, math.inf])
def test_length_that_is_no_length_is_refused_by_name(measure: str, value_mm: float) -> None:
    with pytest.raises(RobotError, match=measure) as refusal:
        Robot(**asdict(PROTOTYPE) | {measure: value_mm})
    assert refusal.value.measure == measure


@pytest.mark.parametrize("value_mm", [math.nan, math.inf, -math.inf])
def test_pivot_offset_that_is_no_number_is_refused(value_mm: float) -> None:
    with pytest.raises(RobotError) as refusal:
        replace(PROTOTYPE, pivot_offset_mm=value_mm)
    assert refusal.value.measure == "pivot_offset_mm"


def test_arm_shorter_than_the_disc_s_radius_is_refused() -> None:
    with pytest.raises(RobotError, match="349") as refusal:
        replace(PROTOTYPE, arm_length_mm=349.0)
    assert refusal.value.measure == "arm_length_mm"


def test_arm_as_long_as_the_disc_s_radius_makes_the_capsule_a_disc() -> None:
    capsule = replace(PROTOTYPE, arm_length_mm=350.0).capsule(EAST)
    assert np.all(capsule.corners_mm == 0)


@pytest.mark.parametrize(("least_deg", "most_deg"), [(10, 5), (-180, 181), (math.nan, 90)])
def test_swing_range_that_is_empty_or_beyond_a_full_turn_is_refused(
    least_deg: float, most_deg: float
) -> None:
    with pytest.raises(RobotError) as refusal:
        replace(
            PROTOTYPE,
            swing_min_rad=math.radians(least_deg),
            swing_max_rad=math.radians(most_deg),
        )
    assert refusal.value.measure == "swing_max_rad"


@pytest.mark.parametrize("least_deg", [-353, -180, -90, -52, -7, 0])
def test_full_turn_of_swing_may_begin_anywhere(least_deg: int) -> None:
    robot = replace(
        PROTOTYPE,
        swing_min_rad=math.radians(least_deg),
        swing_max_rad=math.radians(least_deg + 360),
    )
    assert robot.swing_max_rad - robot.swing_min_rad == pytest.approx(2 * math.pi, rel=1e-15)
