"""Polygons as few convex pieces: triangles, joined across the diagonals that are not needed.

A convex polygon is one piece. Of others Hertel and Mehlhorn (1983) take the triangles and drop each
diagonal whose removal leaves the angles at both its ends convex. At most four times as many pieces
remain as the best division has.
"""

import math
from typing import Final, TypeAlias

import numpy as np
import shapely
from shapely.geometry import Polygon, box

from satAOI_geo.plan import FloatArray, polygons_in

Point: TypeAlias = tuple[float, float]

STRAIGHT: Final = 1e-12
"""Sine of the angle by which a piece may bend inwards and still count as convex. Rounding bends
straight edges by 1e-16 of their coordinates; over 100 m this is a ten thousandth of the contact
tolerance."""


def convex_pieces(polygon: Polygon) -> list[FloatArray]:
    """Convex polygons whose union is the polygon, its holes left out.

    Returns:
        The corners of each piece, shape (n, 2), counter-clockwise, the first not repeated.
    """
    ring_mm = np.asarray(shapely.orient_polygons(polygon).exterior.coords)[:-1, :2]
    if not polygon.interiors and _is_convex(ring_mm):
        return [ring_mm]
    triangles = shapely.orient_polygons(_triangles(polygon))
    rings = [
        [(x, y) for x, y in ring[:3]]
        for ring in shapely.get_coordinates(triangles).reshape(-1, 4, 2).tolist()
    ]
    # a piece lives at the number of one of its triangles; the others lead to it
    pieces: list[list[Point]] = rings
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
        merged = _merged(pieces[a], pieces[b], begin, end)
        if merged is not None:
            pieces[a] = merged
            joined_to[b] = a
    return [np.array(pieces[k]) for k, to in enumerate(joined_to) if k == to]


def _is_convex(ring_mm: FloatArray) -> bool:
    """Whether a ring that does not cross itself, counter-clockwise, nowhere bends right."""
    ahead_mm = np.roll(ring_mm, -1, axis=0) - ring_mm
    (ax, ay), (bx, by) = ahead_mm.T, np.roll(ahead_mm, -1, axis=0).T
    bends = ax * by - ay * bx >= -STRAIGHT * np.hypot(ax, ay) * np.hypot(bx, by)
    return bool(bends.all())


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


def _merged(a: list[Point], b: list[Point], begin: Point, end: Point) -> list[Point] | None:
    """Two pieces without the diagonal that runs begin-end in a, or None if not convex."""
    at_a, at_b = a.index(end), b.index(begin)
    # a from the diagonal's end round to its begin, then b from there round to its end
    around_a = a[at_a:] + a[:at_a]
    around_b = b[at_b:] + b[:at_b]
    convex_at_begin = _bends_left(around_a[-2], begin, around_b[1])
    convex_at_end = _bends_left(around_b[-2], end, around_a[1])
    return around_a + around_b[1:-1] if convex_at_begin and convex_at_end else None


def _bends_left(before: Point, at: Point, after: Point) -> bool:
    """Whether a chain of three points bends left or runs straight on."""
    ax, ay = at[0] - before[0], at[1] - before[1]
    bx, by = after[0] - at[0], after[1] - at[1]
    return ax * by - ay * bx >= -STRAIGHT * math.hypot(ax, ay) * math.hypot(bx, by)
