"""Sides of pieces are what rows meet first, cut where they bend the other way."""

import numpy as np
import pytest
import shapely
from hypothesis import assume, given
from shapely.geometry import LineString, Polygon, box

from satAOI_geo.lattice import Lattice
from satAOI_geo.pieces import Pieces
from satAOI_geo.plan import Circle, FloatArray, Shape
from tests.drawn import plan_of
from tests.test_intervals import stars

UNIT = Lattice((-0.5, -0.5), 1.0, 1, 1, 4, (0,))
"""Lattice units are millimetres."""

WIDE_FLOOR = box(-5000, -5000, 5000, 5000)


Curves = list[tuple[FloatArray, bool]]


def pieces_of(*shapes: Shape) -> Pieces:
    """Those of shapes, and after these of what is off the floor."""
    return Pieces.of(plan_of(WIDE_FLOOR, *shapes), UNIT, 100.0)


N_OFF_THE_FLOOR = pieces_of().radius.size


def sides_of(shape: Shape) -> list[Curves]:
    """Corners of each curve of each side of a shape, and whether it is a hollow."""
    pieces = pieces_of(shape)
    corners = np.column_stack((pieces.x, pieces.y))
    return [
        [
            (corners[pieces.first[curve] : pieces.first[curve + 1]], bool(pieces.is_hollow[curve]))
            for curve in range(pieces.of_side[side], pieces.of_side[side + 1])
        ]
        for side in range(2 * (pieces.radius.size - N_OFF_THE_FLOOR))
    ]


def left_end(curves: Curves, y: float) -> float:
    """The least x that curves have at a height, inf where none is as high."""
    ends = [
        float(np.interp(y, corners[:, 1], corners[:, 0]))
        for corners, _ in curves
        if corners[0, 1] <= y <= corners[-1, 1]
    ]
    return min(ends, default=np.inf)


@given(stars())
def test_left_and_right_ends_of_an_outline_are_those_of_its_pieces(outline: Polygon) -> None:
    assume(outline.is_valid and outline.area > 0)
    sides = sides_of(outline)
    _, bottom, _, top = outline.bounds
    for y in np.linspace(bottom, top, 23)[1:-1] + 0.0312:
        row = outline.intersection(LineString([(-1000, y), (1000, y)]))
        met = [k for k in range(0, len(sides), 2) if left_end(sides[k], y) < np.inf]
        assert bool(met) == (not row.is_empty)
        if met:
            left = min(left_end(sides[k], y) for k in met)
            right = -min(left_end(sides[k + 1], y) for k in met)
            assert (left, right) == pytest.approx((row.bounds[0], row.bounds[2]), abs=1e-9)


@given(stars())
def test_bulges_bend_outwards_and_hollows_inwards(outline: Polygon) -> None:
    assume(outline.is_valid and outline.area > 0)
    for side in sides_of(outline):
        for corners, is_hollow in side:
            dx, dy = np.diff(corners, axis=0).T
            assert (dy > 0).all()
            slopes = dx / dy
            assert (np.diff(slopes) < 0).all() if is_hollow else (np.diff(slopes) > -1e-9).all()


def test_half_ring_has_a_hollow_inside_and_nothing_but_bulges_outside() -> None:
    ring = shapely.Point(0, 0).buffer(1000, 40).difference(shapely.Point(0, 0).buffer(990, 40))
    left, right = sides_of(ring.intersection(box(0, -2000, 2000, 2000)))
    # 80 chords, of which the first and the last end at the straight cuts
    assert sorted(len(corners) for corners, is_hollow in left if is_hollow) == [79]
    assert [(len(corners), is_hollow) for corners, is_hollow in right] == [(81, False)]


def test_rectangle_has_its_upright_sides_and_a_circle_its_centre() -> None:
    (left,), (right,) = sides_of(box(10, 20, 30, 60))
    assert left[0].tolist() == [[10, 20], [10, 60]]
    assert right[0].tolist() == [[-30, 20], [-30, 60]]
    (left,), (right,) = sides_of(Circle(7.0, 8.0, 3.0))
    assert (left[0].tolist(), right[0].tolist()) == ([[7, 8]], [[-7, 8]])


def test_line_is_cut_where_it_begins_to_fall() -> None:
    pieces = pieces_of(LineString([(0, 0), (50, 100), (90, 100), (120, 30), (200, 40)]))
    assert pieces.bottom[:-N_OFF_THE_FLOOR].tolist() == [0, 30, 30]
    assert pieces.top[:-N_OFF_THE_FLOOR].tolist() == [100, 100, 40]
