"""Nodes are where they are said to be, directions are exact, bits come back as they went in."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from satAOI_geo.errors import InputError, LimitError
from satAOI_geo.lattice import MAX_NODES, Lattice
from satAOI_geo.nodes import Nodes
from satAOI_geo.robot import ROBOTS, Robot, unit

PROTOTYPE = ROBOTS["magicbim"]
HALL_MM = (0.0, 0.0, 10450.0, 19190.0)

multiples_of_four = pytest.mark.parametrize("n_directions", [4, 8, 12, 16, 20, 24, 36, 40, 72])


def lattice_of(n_rows: int, n_columns: int, n_directions: int = 24) -> Lattice:
    return Lattice((0.0, 0.0), 10.0, n_rows, n_columns, n_directions, (0,))


def with_swing(least_deg: float, most_deg: float) -> Robot:
    return replace(
        PROTOTYPE, swing_min_rad=math.radians(least_deg), swing_max_rad=math.radians(most_deg)
    )


def test_hall_of_the_paper_has_1045_by_1919_nodes_and_312_poses() -> None:
    lattice = Lattice.over(HALL_MM, PROTOTYPE)
    assert lattice.shape == (1919, 1045)
    assert lattice.n_directions * len(lattice.swings) == 312
    assert lattice.swings == tuple(range(-6, 7))


def test_nodes_are_the_centres_of_the_cells() -> None:
    lattice = Lattice.over((-20.0, 1000.0, 20.0, 1030.0), PROTOTYPE)
    assert lattice.shape == (3, 4)
    assert [lattice.x_mm(ix) for ix in range(4)] == [-15, -5, 5, 15]
    assert [lattice.y_mm(iy) for iy in range(3)] == [1005, 1015, 1025]


def test_last_cell_may_reach_beyond_the_floor() -> None:
    assert Lattice.over((0.0, 0.0, 101.0, 99.0), PROTOTYPE).shape == (10, 11)


def test_rounding_of_large_coordinates_makes_no_further_cell() -> None:
    # 0.1 and 1e6 + 0.1 are not whole in binary: the extents come out a hair above 50 cells
    bounds_mm = (1e6 + 0.1, 0.1, 1e6 + 500.1, 0.1 + 500 + 1e-10)
    assert Lattice.over(bounds_mm, PROTOTYPE).shape == (50, 50)


@given(st.integers(-(10**6), 10**6), st.integers(1, 10**4), st.sampled_from([10.0, 7.3, 33.0, 0.1]))
def test_extent_of_whole_cells_has_as_many_nodes(left: int, n_cells: int, step_mm: float) -> None:
    bounds_mm = (left * step_mm, 0.0, (left + n_cells) * step_mm, step_mm)
    assert Lattice.over(bounds_mm, PROTOTYPE, step_mm=step_mm).shape == (1, n_cells)


# a number next to 0, divided by the step, is 0 itself
@given(st.floats(-5, 405, allow_subnormal=False), st.floats(-5, 305, allow_subnormal=False))
def test_nearest_node_is_the_one_whose_cell_holds_the_point(x_mm: float, y_mm: float) -> None:
    lattice = lattice_of(n_rows=30, n_columns=40)
    node = lattice.nearest_node(x_mm, y_mm)
    assert (node is None) == (not (0 <= x_mm < 400 and 0 <= y_mm < 300))
    if node is not None:
        iy, ix = node
        assert abs(lattice.x_mm(ix) - x_mm) <= 5
        assert abs(lattice.y_mm(iy) - y_mm) <= 5


@multiples_of_four
def test_directions_are_the_multiples_of_a_share_of_the_full_turn(n_directions: int) -> None:
    directions = lattice_of(1, 1, n_directions).directions()
    angles_rad = 2 * np.pi * np.arange(n_directions) / n_directions
    expected = np.column_stack((np.cos(angles_rad), np.sin(angles_rad)))
    # 2π rounded to double precision is off by 1e-15
    assert np.abs(directions - expected).max() < 1e-15


@multiples_of_four
def test_directions_turned_by_a_quarter_agree_to_the_last_bit(n_directions: int) -> None:
    directions = lattice_of(1, 1, n_directions).directions()
    turned = np.column_stack((-directions[:, 1], directions[:, 0]))
    assert np.array_equal(np.roll(directions, -n_directions // 4, axis=0), turned)


@multiples_of_four
def test_directions_mirrored_in_the_y_axis_agree_to_the_last_bit(n_directions: int) -> None:
    directions = lattice_of(1, 1, n_directions).directions()
    mirrored = directions * (-1, 1)
    half_turn_less = (n_directions // 2 - np.arange(n_directions)) % n_directions
    assert np.array_equal(directions[half_turn_less], mirrored)


@multiples_of_four
def test_poses_are_the_directions_the_lattice_names(n_directions: int) -> None:
    lattice = Lattice.over(HALL_MM, PROTOTYPE, n_directions=n_directions)
    directions = lattice.directions()
    for a1 in range(n_directions):
        for swing, turn in enumerate(lattice.swings):
            pose = lattice.pose(0, 0, a1, swing)
            assert unit(pose.a1_rad) == pytest.approx(directions[a1], abs=2e-15)
            heading = directions[(a1 + turn) % n_directions]
            assert unit(pose.a1_rad + pose.a2_rad) == pytest.approx(heading, abs=4e-15)


@pytest.mark.parametrize(
    ("least_deg", "most_deg", "turns"),
    [
        # a2 is the negative of the swing
        (-90, 90, range(-6, 7)),
        (-30, 75, range(-5, 3)),
        (15, 45, range(-3, 0)),
        (-29.9, 29.9, range(-1, 2)),
        (0, 0, range(1)),
        (-180, 165, range(-11, 13)),
    ],
)
def test_swings_are_all_the_multiples_within_the_range(
    least_deg: float, most_deg: float, turns: range
) -> None:
    lattice = Lattice.over(HALL_MM, with_swing(least_deg, most_deg))
    assert lattice.swings == tuple(turns)


@pytest.mark.parametrize("least_deg", range(-360, 1, 15))
def test_full_turn_of_swing_has_every_heading_once(least_deg: int) -> None:
    swings = Lattice.over(HALL_MM, with_swing(least_deg, least_deg + 360)).swings
    assert len(swings) == 24
    assert {turn % 24 for turn in swings} == set(range(24))


def test_swing_is_all_round_where_nothing_is_missing_of_a_full_turn() -> None:
    # both have 24 swings of 15°; 180° itself and -165° are no neighbours where 5° lie between
    for most_deg, all_round in ((180, True), (175, False)):
        lattice = Lattice.over(HALL_MM, with_swing(-180, most_deg))
        assert (len(lattice.swings), lattice.swings_all_round) == (24, all_round)


def test_swing_range_between_two_directions_is_refused() -> None:
    with pytest.raises(InputError, match="15°"):
        Lattice.over(HALL_MM, with_swing(1, 14))


@pytest.mark.parametrize("step_mm", [0.0, -10.0, math.nan, math.inf])
def test_step_that_is_no_length_is_refused(step_mm: float) -> None:
    with pytest.raises(InputError, match="step"):
        Lattice.over(HALL_MM, PROTOTYPE, step_mm=step_mm)


@pytest.mark.parametrize("n_directions", [-4, 0, 2, 6, 25])
def test_directions_that_are_no_multiple_of_four_are_refused(n_directions: int) -> None:
    with pytest.raises(InputError, match="multiple of 4"):
        Lattice.over(HALL_MM, PROTOTYPE, n_directions=n_directions)


def test_floor_of_too_many_nodes_is_refused_with_both_figures() -> None:
    with pytest.raises(LimitError) as refusal:
        Lattice.over((0.0, 0.0, 1e5, 1e6 + 10), PROTOTYPE)
    assert (refusal.value.value, refusal.value.allowed) == (10_000 * 100_001, MAX_NODES)
    assert Lattice.over((0.0, 0.0, 1e5, 1e6), PROTOTYPE).shape == (100_000, 10_000)


@pytest.mark.parametrize("n_columns", [1, 63, 64, 65, 128])
def test_complement_of_no_nodes_is_all_nodes(n_columns: int) -> None:
    lattice = lattice_of(3, n_columns)
    assert not Nodes(lattice.no_nodes(), n_columns).as_array().any()
    assert np.bitwise_count(~lattice.no_nodes()).sum() == 3 * n_columns
