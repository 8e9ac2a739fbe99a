"""Which closed outlines on layers without a meaning are those of rooms.

A room's outline runs along walls all around but for its doorways. A pit or a machine in a corner
runs along two walls and has its other two sides out on the floor. Where a layer shows rooms, a
niche with an open side is one, too.
"""

import math
from collections import Counter
from collections.abc import Sequence
from typing import Final

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from satAOI_adapters.dxf_read.shapes import GeometryArray, is_thin
from satAOI_geo.plan import Kind, Obstacle, polygons_in

ROOM_MM: Final = 1000.0
"""An outline at least this wide may be that of a room."""

ALONG_MM: Final = 100.0
"""An outline this close to a wall or to another outline runs along it."""

SAMPLE_MM: Final = 20.0
"""Distance of the points that stand for an outline: a fiftieth of the narrowest room."""

NEARLY: Final = 0.8
"""Share of an outline with something along it that leaves nothing but doorways.

A door of 0.9 m in a closet of 1.1 × 1.5 m leaves 0.83; what fills a niche as deep as wide has 0.75.
"""


OF_ROOMS: Final = 0.75
"""A layer of which at least this share of the wide outlines are rooms shows rooms."""

SEVERAL: Final = 3
"""And so many of them are."""

HALF: Final = 0.5
"""On such a layer a niche is a room that has this share of its outline along walls."""


def rooms_among(things: Sequence[Obstacle], known: Sequence[Obstacle]) -> set[int]:
    """The indices of those outlines that run along walls, or along those of other rooms.

    Outlines side by side hold each other up only as long as walls hold up the whole group: one
    that falls takes its neighbours with it, in whatever order they are looked at.
    """
    wide = [i for i, thing in enumerate(things) if _is_wide(thing)]
    if not wide:
        return set()
    walls = [obstacle.region() for obstacle in known if obstacle.kind is Kind.WALL]
    rims = [things[i].region().boundary for i in wide]
    lines: GeometryArray = np.array([*walls, *rims], dtype=object)
    near = _near([things[i].region() for i in wide], walls)
    fallen: set[int] = set()
    pending = set(range(len(wide)))
    while pending:
        held_by = {i: [k for k in near[i] if k - len(walls) not in fallen] for i in pending}
        falls = {i for i in pending if share_along(rims[i], lines[held_by[i]]) < NEARLY}
        fallen |= falls
        pending = {k - len(walls) for i in falls for k in near[i] if k >= len(walls)} - fallen
    layers = [things[i].layer for i in wide]
    of_rooms = _layers_of_rooms(layers, fallen)
    niches = {
        i
        for i in fallen
        if layers[i] in of_rooms
        and share_along(rims[i], lines[[k for k in near[i] if k - len(walls) not in fallen]])
        >= HALF
    }
    return {wide[i] for i in range(len(wide)) if i not in fallen - niches}


def _layers_of_rooms(layers: Sequence[str], fallen: set[int]) -> set[str]:
    """The layers on which most outlines, all but the fallen ones, are those of rooms."""
    drawn = Counter(layers)
    found = Counter(layer for i, layer in enumerate(layers) if i not in fallen)
    return {layer for layer, n in found.items() if n >= max(SEVERAL, OF_ROOMS * drawn[layer])}


def share_along(rim: BaseGeometry, lines: Sequence[BaseGeometry] | GeometryArray) -> float:
    """Which share of an outline has lines or walls along it, judged by points on it."""
    n_points = math.ceil(rim.length / SAMPLE_MM)
    points = shapely.line_interpolate_point(
        rim, (np.arange(n_points) + 0.5) / n_points, normalized=True
    )
    near, _ = shapely.STRtree(lines).query_nearest(points, max_distance=ALONG_MM, all_matches=False)
    return float(len(near) / n_points)


def _is_wide(thing: Obstacle) -> bool:
    return any(not is_thin(part, ROOM_MM) for part in polygons_in([thing.region()]))


def _near(regions: Sequence[BaseGeometry], walls: Sequence[BaseGeometry]) -> list[list[int]]:
    """The indices of the walls, then of the outlines, that each outline may run along.

    These lie beside it: a copy, a fill of it or a frame around it does not hold it up.
    """
    beside = np.array([*walls, *regions], dtype=object)
    one, other = shapely.STRtree(beside).query(regions, predicate="dwithin", distance=ALONG_MM)
    shared_mm2 = shapely.area(shapely.intersection(np.array(regions)[one], beside[other]))
    smaller_mm2 = np.minimum(shapely.area(regions)[one], shapely.area(beside)[other])
    is_beside = (other < len(walls)) | (shared_mm2 < HALF * smaller_mm2)
    found: list[list[int]] = [[] for _ in regions]
    for i, k in zip(one[is_beside].tolist(), other[is_beside].tolist(), strict=True):
        found[i].append(k)
    return found
