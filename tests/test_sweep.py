"""A swept part holds all that the part sweeps, and little more."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from shapely.geometry import MultiPoint, Polygon
from shapely.geometry.base import BaseGeometry

from satAOI_geo.plan import FloatArray
from satAOI_geo.robot import ROBOTS, Part, Robot, unit
from satAOI_geo.sweep import carried, stepped, turned
from tests.drawn import robots

PROTOTYPE = ROBOTS["magicbim"]
DISC_MM = np.zeros(2)

INSTANTS = np.linspace(0, 1, 61)
"""Shares of the true motion that are looked at, both ends and half-way among them."""

ROUNDING_MM = 1e-9
"""Of coordinates of a few metres, times a few operations."""

directions = st.integers(0, 359).map(math.radians)
turns_rad = st.sampled_from([4, 8, 12, 24, 36]).map(lambda n: 2 * math.pi / n)


def rotated(points_mm: FloatArray, about_mm: FloatArray, turn_rad: float) -> FloatArray:
    cos, sin = math.cos(turn_rad), math.sin(turn_rad)
    turned_mm: FloatArray = (points_mm - about_mm) @ np.array(((cos, sin), (-sin, cos)))
    return turned_mm + about_mm


def core(part: Part) -> BaseGeometry:
    return MultiPoint(part.corners_mm).convex_hull


def excess_mm(on_the_way: list[FloatArray], swept: Part) -> float:
    """How far a part's corners, shape (n, 2) at each instant, get out of the swept core."""
    corners_mm = shapely.points(np.concatenate(on_the_way))
    return float(shapely.distance(corners_mm, core(swept)).max())


@given(robots(), directions, directions, st.floats(-200, 200), st.floats(-200, 200))
def test_step_sweeps_all_between_its_ends(
    robot: Robot, a1_rad: float, yaw_rad: float, dx_mm: float, dy_mm: float
) -> None:
    step_mm = np.array((dx_mm, dy_mm))
    for part in (robot.capsule(unit(a1_rad)), robot.vehicle(unit(a1_rad), unit(yaw_rad))):
        (swept,) = stepped([part], step_mm)
        on_the_way = [part.corners_mm + share * step_mm for share in INSTANTS]
        assert excess_mm(on_the_way, swept) < ROUNDING_MM


@given(robots(), directions, directions, turns_rad)
def test_turn_about_the_disc_sweeps_all_between_its_ends(
    robot: Robot, a1_rad: float, yaw_rad: float, turn_rad: float
) -> None:
    for part in (robot.capsule(unit(a1_rad)), robot.vehicle(unit(a1_rad), unit(yaw_rad))):
        (swept,) = turned([part], DISC_MM, turn_rad)
        on_the_way = [rotated(part.corners_mm, DISC_MM, share * turn_rad) for share in INSTANTS]
        assert excess_mm(on_the_way, swept) < ROUNDING_MM


@given(robots(), directions, directions, turns_rad)
def test_swing_about_the_pivot_sweeps_all_between_its_ends(
    robot: Robot, a1_rad: float, yaw_rad: float, turn_rad: float
) -> None:
    arm = unit(a1_rad)
    pivot_mm = robot.arm_length_mm * arm
    # the poses themselves: the arm stays, the heading turns
    on_the_way = [
        robot.vehicle(arm, unit(yaw_rad + share * turn_rad)).corners_mm for share in INSTANTS
    ]
    (swept,) = turned([robot.vehicle(arm, unit(yaw_rad))], pivot_mm, turn_rad)
    assert excess_mm(on_the_way, swept) < ROUNDING_MM


@given(robots(), directions, directions, turns_rad)
def test_orbit_sweeps_all_between_its_ends(
    robot: Robot, a1_rad: float, yaw_rad: float, turn_rad: float
) -> None:
    heading = unit(yaw_rad)
    # the poses themselves: the arm turns, the heading stays
    on_the_way = [
        robot.vehicle(unit(a1_rad + share * turn_rad), heading).corners_mm for share in INSTANTS
    ]
    pivot_mm = robot.arm_length_mm * unit(a1_rad)
    (swept,) = carried([robot.vehicle(unit(a1_rad), heading)], pivot_mm, turn_rad)
    assert excess_mm(on_the_way, swept) < ROUNDING_MM


@given(robots(), directions, directions, turns_rad)
def test_turn_ends_at_the_next_pose(
    robot: Robot, a1_rad: float, yaw_rad: float, turn_rad: float
) -> None:
    (swept,) = turned([robot.vehicle(unit(a1_rad), unit(yaw_rad))], DISC_MM, turn_rad)
    end = robot.vehicle(unit(a1_rad + turn_rad), unit(yaw_rad + turn_rad))
    assert excess_mm([end.corners_mm], swept) < ROUNDING_MM


@given(robots(), directions, directions, turns_rad)
def test_turn_sweeps_no_farther_than_the_push_beyond_the_arc(
    robot: Robot, a1_rad: float, yaw_rad: float, turn_rad: float
) -> None:
    vehicle = robot.vehicle(unit(a1_rad), unit(yaw_rad))
    farthest_mm = np.hypot(*vehicle.corners_mm.T).max()
    (swept,) = turned([vehicle], DISC_MM, turn_rad)
    swept_mm = np.hypot(*swept.corners_mm.T).max()
    assert swept_mm <= farthest_mm / math.cos(turn_rad / 2) * (1 + 1e-12)


def test_turn_of_15_degrees_adds_less_than_one_percent_to_the_hull_of_what_it_sweeps() -> None:
    vehicle = PROTOTYPE.vehicle(unit(0), unit(0))
    (swept,) = turned([vehicle], DISC_MM, math.radians(15))
    turns_rad = np.linspace(0, math.radians(15), 200)
    passed = np.concatenate([rotated(vehicle.corners_mm, DISC_MM, turn) for turn in turns_rad])
    radius_mm = math.hypot(1574.5, 415)
    # 1 / cos(7.5°) - 1 is 0.86 %
    assert core(swept).hausdorff_distance(MultiPoint(passed).convex_hull) < 0.01 * radius_mm


@given(directions, turns_rad)
def test_capsule_turned_about_the_disc_is_a_sector(a1_rad: float, turn_rad: float) -> None:
    spine_mm = PROTOTYPE.arm_length_mm - PROTOTYPE.disc_radius_mm
    (swept,) = turned([PROTOTYPE.capsule(unit(a1_rad))], DISC_MM, turn_rad)
    # a kite: two spines and, half-way, the meeting point of the tangents at their ends
    assert core(swept).area == pytest.approx(spine_mm**2 * math.tan(turn_rad / 2), rel=1e-9)
    assert swept.radius_mm == PROTOTYPE.disc_radius_mm


def test_capsule_stepped_along_itself_is_a_longer_capsule() -> None:
    (swept,) = stepped([PROTOTYPE.capsule(unit(0))], np.array((10.0, 0.0)))
    assert sorted(swept.corners_mm.tolist()) == [[0, 0], [655, 0]]


def test_vehicle_stepped_along_itself_is_a_longer_vehicle() -> None:
    (swept,) = stepped([PROTOTYPE.vehicle(unit(0), unit(0))], np.array((10.0, 0.0)))
    assert core(swept).area == 885 * 830


@given(robots(), directions, turns_rad)
def test_corners_of_a_swept_part_run_counter_clockwise(
    robot: Robot, a1_rad: float, turn_rad: float
) -> None:
    vehicle = robot.vehicle(unit(a1_rad), unit(0.3))
    for swept in (
        *stepped([vehicle], np.array((0.0, 10.0))),
        *turned([vehicle], DISC_MM, turn_rad),
        *carried([vehicle], robot.arm_length_mm * unit(a1_rad), turn_rad),
    ):
        assert shapely.is_ccw(Polygon(swept.corners_mm).exterior)
        assert Polygon(swept.corners_mm).area == pytest.approx(core(swept).area, rel=1e-12)


def test_disc_without_an_arm_turns_on_the_spot() -> None:
    # an arm as long as the disc's radius: the spine is a single point
    robot = Robot(
        name="disc",
        vehicle_length_mm=300.0,
        vehicle_width_mm=300.0,
        pivot_offset_mm=0.0,
        arm_length_mm=200.0,
        disc_radius_mm=200.0,
    )
    (swept,) = turned([robot.capsule(unit(0))], DISC_MM, math.radians(15))
    assert np.all(swept.corners_mm == 0)
    assert swept.radius_mm == 200


@given(robots(), st.lists(directions, min_size=2, max_size=5), turns_rad)
def test_parts_swept_together_are_those_swept_one_by_one(
    robot: Robot, a1s_rad: list[float], turn_rad: float
) -> None:
    vehicles = [robot.vehicle(unit(a1_rad), unit(0.3)) for a1_rad in a1s_rad]
    pivot_mm = robot.arm_length_mm * unit(1.0)
    for sweep in (turned, carried):
        together = sweep(vehicles, pivot_mm, turn_rad)
        alone = [part for vehicle in vehicles for part in sweep([vehicle], pivot_mm, turn_rad)]
        for one, other in zip(together, alone, strict=True):
            assert np.array_equal(one.corners_mm, other.corners_mm)
