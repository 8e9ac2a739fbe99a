"""Monotone pieces are monotone, do not overlap, and make up the polygon."""

from itertools import pairwise

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from shapely.affinity import rotate
from shapely.geometry import Point, Polygon, box

from satAOI_geo.monotone import monotone_pieces
from satAOI_geo.plan import FloatArray
from tests.drawn import HARD


def n_turns(corners_mm: FloatArray) -> int:
    """How often a ring of corners begins to rise or to fall; level sides do neither."""
    rises = [b - a > 0 for a, b in pairwise([*corners_mm[:, 1], corners_mm[0, 1]]) if b != a]
    return sum(one != other for one, other in pairwise([*rises, rises[0]]))


def assert_pieces_make_up(polygon: Polygon) -> int:
    """How many pieces there are, once they are found to be what they should be."""
    pieces = monotone_pieces(polygon)
    assert [n_turns(corners_mm) for corners_mm in pieces] == [2] * len(pieces)
    made_of = [Polygon(corners_mm) for corners_mm in pieces]
    assert all(piece.exterior.is_ccw for piece in made_of)
    # together as large as the polygon and nowhere off it: so they do not overlap
    assert sum(piece.area for piece in made_of) == pytest.approx(polygon.area, rel=1e-9)
    off = shapely.union_all(made_of).symmetric_difference(polygon)
    assert off.area < 1e-9 * polygon.area
    # one cut at each turn inside the polygon is enough to leave none
    assert len(pieces) <= max(1, n_turns_of(polygon) - 1)
    return len(pieces)


def n_turns_of(polygon: Polygon) -> int:
    """How often the outline and the holes begin to rise or to fall."""
    return sum(
        n_turns(np.asarray(ring.coords)[:-1]) for ring in (polygon.exterior, *polygon.interiors)
    )


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


@pytest.mark.parametrize("quarters", [0, 1])
def test_half_a_ring_is_one_piece_where_it_bends_sideways_and_two_where_it_is_an_arch(
    quarters: int,
) -> None:
    ring = Point(0, 0).buffer(1000, quad_segs=40).difference(Point(0, 0).buffer(990, quad_segs=40))
    half = ring.intersection(box(0, -2000, 2000, 2000))
    assert assert_pieces_make_up(rotate(half, 90 * quarters, origin=(0, 0))) == 1 + quarters


def test_comb_has_a_piece_a_tooth() -> None:
    teeth = [box(300 * k, 0, 300 * k + 100, 500) for k in range(5)]
    comb = shapely.union_all([box(0, -100, 1300, 0), *teeth])
    assert assert_pieces_make_up(comb) == 5
    assert assert_pieces_make_up(rotate(comb, 90)) == 1


def test_polygon_that_cannot_be_triangulated_whole_is_cut(monkeypatch: pytest.MonkeyPatch) -> None:
    frame = box(0, 0, 5000, 4000).difference(box(200, 200, 4800, 3800))
    triangulate = shapely.constrained_delaunay_triangles

    def fails_on_holes(polygon: Polygon) -> object:
        if polygon.interiors:
            raise shapely.GEOSException("Unable to find shell join index")
        return triangulate(polygon)

    monkeypatch.setattr(shapely, "constrained_delaunay_triangles", fails_on_holes)
    assert_pieces_make_up(frame)
