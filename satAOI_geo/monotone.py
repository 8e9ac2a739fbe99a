"""Polygons as few monotone pieces: shapes that every row meets in one stretch, if at all.

Triangles are joined across their common sides where in no row that leaves two stretches. A thin
band along an arc, as a curved wall is, becomes a few pieces instead of one for each chord.
"""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import shapely
from shapely.geometry import Polygon, box

from satAOI_geo.plan import FloatArray, polygons_in

Point: TypeAlias = tuple[float, float]


@dataclass(frozen=True, slots=True)
class _Piece:
    """A monotone polygon.

    Attributes:
        ring: Its corners, counter-clockwise.
        bottom_mm: The least of their heights.
        top_mm: The greatest.
    """

    ring: list[Point]
    bottom_mm: float
    top_mm: float

    @classmethod
    def of(cls, ring: list[Point]) -> "_Piece":
        """The piece with these corners."""
        heights_mm = [y_mm for _, y_mm in ring]
        return cls(ring, min(heights_mm), max(heights_mm))

    def joined(self, other: "_Piece", begin: Point, end: Point) -> "_Piece | None":
        """Both without the side that runs begin-end here and end-begin there.

        None if some row met that twice. In the rows of the side both are one; above and below there
        may be one of them only.
        """
        low_mm, high_mm = sorted((begin[1], end[1]))
        bottoms_mm, tops_mm = (self.bottom_mm, other.bottom_mm), (self.top_mm, other.top_mm)
        if low_mm not in bottoms_mm or high_mm not in tops_mm:
            return None
        here, there = self.ring.index(end), other.ring.index(begin)
        # this one from the side's end round to its begin, then the other one from there round
        around_here = self.ring[here:] + self.ring[:here]
        around_there = other.ring[there:] + other.ring[:there]
        return _Piece(around_here + around_there[1:-1], min(bottoms_mm), max(tops_mm))


def monotone_pieces(polygon: Polygon) -> list[FloatArray]:
    """Monotone polygons whose union is the polygon, its holes left out.

    Returns:
        The corners of each piece, shape (n, 2), counter-clockwise, the first not repeated.
    """
    ring_mm = np.asarray(shapely.orient_polygons(polygon).exterior.coords)[:-1, :2]
    if not polygon.interiors and _is_monotone(ring_mm):
        return [ring_mm]
    triangles = shapely.orient_polygons(_triangles(polygon))
    rings = [
        [(x, y) for x, y in ring[:3]]
        for ring in shapely.get_coordinates(triangles).reshape(-1, 4, 2).tolist()
    ]
    # a piece lives at the number of one of its triangles; the others lead to it
    pieces = [_Piece.of(ring) for ring in rings]
    joined_to = list(range(len(pieces)))
    owner = {
        (begin, end): number
        for number, ring in enumerate(rings)
        for begin, end in zip(ring, ring[1:] + ring[:1], strict=True)
    }
    for (begin, end), number in sorted(owner.items()):
        across = owner.get((end, begin))
        if across is None or begin > end:
            continue
        a, b = _found(joined_to, number), _found(joined_to, across)
        # around a hole two triangles may be of one piece already
        joined = pieces[a].joined(pieces[b], begin, end) if a != b else None
        if joined is not None:
            pieces[a] = joined
            joined_to[b] = a
    return [np.array(pieces[k].ring) for k, to in enumerate(joined_to) if k == to]


def _is_monotone(ring_mm: FloatArray) -> bool:
    """Whether a ring rises once and falls once."""
    rises = np.sign(np.diff(ring_mm[:, 1], append=ring_mm[0, 1]))
    rises = rises[rises != 0]
    return int((rises != np.roll(rises, 1)).sum()) <= 2


def _triangles(polygon: Polygon) -> list[Polygon]:
    """The triangles of a polygon.

    Where GEOS cannot join a hole to the outside ("unable to find shell join index"), the polygon
    is cut across its longer side and each half tried by itself.
    """
    try:
        return polygons_in([shapely.constrained_delaunay_triangles(polygon)])
    except shapely.GEOSException:
        left, bottom, right, top = polygon.bounds
        x_mm, y_mm = (left + right) / 2, (bottom + top) / 2
        boxes = (
            [(left, bottom, x_mm, top), (x_mm, bottom, right, top)]
            if right - left > top - bottom
            else [(left, bottom, right, y_mm), (left, y_mm, right, top)]
        )
        halves = polygons_in([polygon.intersection(box(*bounds)) for bounds in boxes])
        return [triangle for half in halves for triangle in _triangles(half)]


def _found(joined_to: list[int], number: int) -> int:
    """The piece that a triangle belongs to by now."""
    while joined_to[number] != number:
        number = joined_to[number]
    return number
