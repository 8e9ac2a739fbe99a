"""Convex pieces are convex, do not overlap, and make up the polygon."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from shapely.affinity import rotate
from shapely.geometry import Point, Polygon, box

from satAOI_geo.convex import convex_pieces
from satAOI_geo.plan import FloatArray
from tests.drawn import HARD


def turning_rad(corners_mm: FloatArray) -> FloatArray:
    """By how much each corner turns left."""
    sides_mm = np.roll(corners_mm, -1, axis=0) - corners_mm
    headings_rad = np.arctan2(sides_mm[:, 1], sides_mm[:, 0])
    turns_rad = np.roll(headings_rad, -1) - headings_rad
    # between -π and π
    return turns_rad - 2 * np.pi * np.round(turns_rad / (2 * np.pi))


def assert_pieces_make_up(polygon: Polygon) -> int:
    """How many pieces there are, once they are found to be what they should be."""
    pieces = convex_pieces(polygon)
    for corners_mm in pieces:
        turns_rad = turning_rad(corners_mm)
        # no corner bends inwards, and the sides go round once
        assert turns_rad.min() > -1e-9
        assert turns_rad.sum() == pytest.approx(2 * math.pi)
    made_of = [Polygon(corners_mm) for corners_mm in pieces]
    # together as large as the polygon and nowhere off it: so they do not overlap
    assert sum(piece.area for piece in made_of) == pytest.approx(polygon.area, rel=1e-9)
    off = shapely.union_all(made_of).symmetric_difference(polygon)
    assert off.area < 1e-9 * polygon.area
    # a corner that bends inwards needs two diagonals at most, and no other diagonal is left
    assert len(pieces) <= 1 + 2 * n_inward_corners(polygon)
    return len(pieces)


def n_inward_corners(polygon: Polygon) -> int:
    """How many corners of the outline and the holes bend inwards."""
    oriented = shapely.orient_polygons(polygon)
    rings = [oriented.exterior, *oriented.interiors]
    # the polygon is on the left of all its rings
    return sum(int((turning_rad(np.asarray(ring.coords)[:-1]) < -1e-9).sum()) for ring in rings)


def outlines() -> dict[str, Polygon]:
    """Every polygon of the hard plans, obstacles and what is off the floor."""
    found = {}
    for name, plan in HARD.items():
        regions = [plan.outside(100.0), *(obstacle.region() for obstacle in plan.obstacles)]
        for number, part in enumerate(shapely.get_parts(regions)):
            if isinstance(part, Polygon):
                found[f"{name}-{number}"] = part
    return found


OUTLINES = outlines()


@pytest.mark.parametrize("polygon", OUTLINES.values(), ids=OUTLINES)
def test_pieces_of_a_hard_outline_make_it_up(polygon: Polygon) -> None:
    assert_pieces_make_up(polygon)


@given(
    st.lists(st.floats(50, 600), min_size=3, max_size=24), st.sampled_from([0.125, 10.0]), st.data()
)
def test_pieces_of_a_star_make_it_up(
    reaches_mm: list[float], grain_mm: float, data: st.DataObject
) -> None:
    angles_rad = 2 * np.pi * np.arange(len(reaches_mm)) / len(reaches_mm)
    corners_mm = np.column_stack((np.cos(angles_rad), np.sin(angles_rad)))
    corners_mm *= np.array(reaches_mm)[:, np.newaxis]
    star = Polygon(grain_mm * np.round(corners_mm / grain_mm))
    hole_mm = data.draw(st.sampled_from([0.0, 10.0, 30.0]))
    polygon = star.difference(Point(0, 0).buffer(hole_mm, quad_segs=3)) if hole_mm else star
    if isinstance(polygon, Polygon) and polygon.is_valid and polygon.area > 0:
        assert_pieces_make_up(polygon)


@given(st.integers(0, 2**36 - 1), st.floats(0, 90), st.sampled_from([100.0, 50.0, 37.0]))
def test_pieces_of_blocks_side_by_side_make_them_up(
    pattern: int, turn_deg: float, longest_mm: float
) -> None:
    # corners in the middle of sides, holes that touch the outline in a corner
    blocks = [
        box(100 * x, 100 * y, 100 * x + 100, 100 * y + 100)
        for x in range(6)
        for y in range(6)
        if pattern >> 6 * y + x & 1
    ]
    together = shapely.segmentize(rotate(shapely.union_all(blocks), turn_deg), longest_mm)
    for part in shapely.get_parts(together):
        assert_pieces_make_up(part)


@pytest.mark.parametrize("n_corners", [3, 4, 5, 12, 100])
def test_convex_polygon_is_one_piece(n_corners: int) -> None:
    angles_rad = 0.1 + 2 * np.pi * np.arange(n_corners) / n_corners
    corners_mm = 700 * np.column_stack((np.cos(angles_rad), np.sin(angles_rad)))
    assert assert_pieces_make_up(Polygon(corners_mm)) == 1
    assert assert_pieces_make_up(Polygon(corners_mm[::-1])) == 1


def test_l_is_two_pieces() -> None:
    ell = Polygon([(0, 0), (600, 0), (600, 200), (200, 200), (200, 500), (0, 500)])
    assert assert_pieces_make_up(ell) == 2


def test_polygon_that_cannot_be_triangulated_whole_is_cut(monkeypatch: pytest.MonkeyPatch) -> None:
    frame = box(0, 0, 5000, 4000).difference(box(200, 200, 4800, 3800))
    triangulate = shapely.constrained_delaunay_triangles

    def fails_on_holes(polygon: Polygon) -> object:
        if polygon.interiors:
            raise shapely.GEOSException("Unable to find shell join index")
        return triangulate(polygon)

    monkeypatch.setattr(shapely, "constrained_delaunay_triangles", fails_on_holes)
    assert_pieces_make_up(frame)
