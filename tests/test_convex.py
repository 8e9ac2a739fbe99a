"""Polygons divided into convex pieces."""

import math

import numpy as np
import pytest
import shapely
from shapely.geometry import Polygon, box

from satAOI_geo.convex import convex_pieces
from tests import plans


def polygons() -> list[Polygon]:
    shapes = [o.shape for seed in range(40) for o in plans.random_plan(seed).obstacles]
    floors = [plans.random_plan(seed).outside(2000.0) for seed in range(10)]
    return [s for s in shapes if isinstance(s, Polygon)] + [
        part for floor in floors for part in getattr(floor, "geoms", [floor])
    ]


def regular(n: int, radius_mm: float) -> Polygon:
    angles_rad = 2 * math.pi * np.arange(n) / n
    return Polygon(radius_mm * np.column_stack((np.cos(angles_rad), np.sin(angles_rad))))


def test_pieces_cover_the_polygon_and_nothing_else() -> None:
    for polygon in polygons():
        pieces = [Polygon(corners) for corners in convex_pieces(polygon)]
        assert sum(piece.area for piece in pieces) == pytest.approx(polygon.area, rel=1e-12)
        together = shapely.union_all(pieces)
        assert together.symmetric_difference(polygon).area < 1e-6


def test_pieces_are_convex_and_run_counter_clockwise() -> None:
    for polygon in polygons():
        for corners in convex_pieces(polygon):
            piece = Polygon(corners)
            assert piece.exterior.is_ccw
            # rounding may bend a side by 1e-12 of its length
            assert piece.convex_hull.area - piece.area <= 1e-9 * piece.area


@pytest.mark.parametrize("n", [3, 4, 12, 360])
def test_convex_polygon_is_one_piece(n: int) -> None:
    assert len(convex_pieces(regular(n, 400.0))) == 1


def test_l_is_two_pieces() -> None:
    corner = Polygon([(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)])
    assert len(convex_pieces(corner)) == 2


def test_frame_around_a_room_is_at_most_four_times_the_best_division() -> None:
    frame = box(0, 0, 5000, 5000).difference(box(200, 200, 4800, 4800))
    assert 3 <= len(convex_pieces(frame)) <= 16


def test_polygon_that_cannot_be_triangulated_whole_is_cut(monkeypatch: pytest.MonkeyPatch) -> None:
    frame = box(0, 0, 5000, 4000).difference(box(200, 200, 4800, 3800))
    triangulate = shapely.constrained_delaunay_triangles

    def fails_on_holes(polygon: Polygon) -> object:
        if polygon.interiors:
            raise shapely.GEOSException("Unable to find shell join index")
        return triangulate(polygon)

    monkeypatch.setattr(shapely, "constrained_delaunay_triangles", fails_on_holes)
    pieces = [Polygon(corners) for corners in convex_pieces(frame)]
    assert shapely.union_all(pieces).symmetric_difference(frame).area < 1e-6
