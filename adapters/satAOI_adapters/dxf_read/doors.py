"""What is drawn on door layers: no obstacle, but some of it says where walls or the floor end.

Leaves and swings never stop the robot. Lines that span an opening close the floor there. And
some offices draw whole partitions on the layer of their doors; these are walls.
"""

import math
from collections.abc import Sequence
from typing import Final

import numpy as np
import numpy.typing as npt
import shapely
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree
from shapely.geometry import LineString
from shapely.geometry.base import BaseGeometry

from satAOI_adapters.dxf_read.curves import Line
from satAOI_adapters.dxf_read.entities import Feature
from satAOI_adapters.dxf_read.linework import GAP_MM, PARALLEL
from satAOI_geo.plan import Finding

JAMB_MM: Final = 300.0
"""A line that ends this close to walls on both sides spans the opening between them."""

LEAF_MM: Final = 1300.0
"""No door leaf is longer."""

PARTITION_MM: Final = 2500.0
"""A single straight line longer than this, with another beside it, is the face of a wall."""

FACES_MM: Final = 400.0
"""The two faces of a partition are no farther apart."""


def partitions(doors: Sequence[Feature], walls: Sequence[BaseGeometry]) -> list[Feature]:
    """The lines on door layers that are faces of walls.

    They are open, straight and outside any block. Joined at their ends they turn a corner between
    two sides longer than a leaf; or one alone is longer than any opening, has a parallel one
    beside it, and does not span an opening from wall to wall as the line of a garage door does.
    """
    loose = [
        (feature, LineString((piece.start, piece.end)))
        for feature in doors
        for path in feature.paths
        if path.is_straight and not (feature.placed.blocks or path.closed)
        for piece in path.pieces
    ]
    if not loose:
        return []
    lines = [line for _, line in loose]
    lengths_mm = shapely.length(lines)
    chain = _chains(lines)
    long_sides = np.bincount(chain, lengths_mm > LEAF_MM)
    faces = (lengths_mm > PARTITION_MM) & ~_spanning(lines, walls) & _in_pairs(lines)
    is_wall = (long_sides >= 2) | (np.bincount(chain, faces) > 0)
    found = {id(f): f for (f, _), own in zip(loose, chain, strict=True) if is_wall[own]}
    return list(found.values())


def partition_findings(found: Sequence[Feature]) -> list[Finding]:
    """What is to be said about walls on door layers."""
    layers = sorted({feature.placed.layer for feature in found})
    return [
        Finding(
            "wall-on-door-layer",
            f"{sum(feature.placed.layer == layer for feature in found)} lines on door layer "
            f"'{layer}' are too long for doors and taken as walls",
            "say what the layer is in a file for --layers",
            layer=layer,
        )
        for layer in layers
    ]


def spans(doors: Sequence[Feature], walls: Sequence[BaseGeometry]) -> list[LineString]:
    """The straight lines of doors that reach from wall to wall across an opening.

    A leaf that stands open has a free end and does not count.
    """
    lines = [
        LineString((piece.start, piece.end))
        for feature in doors
        for path in feature.paths
        for piece in path.pieces
        if isinstance(piece, Line) and math.dist(piece.start, piece.end) > JAMB_MM
    ]
    spanning = _spanning(lines, walls)
    return [line for line, does in zip(lines, spanning, strict=True) if does]


def _spanning(lines: Sequence[LineString], walls: Sequence[BaseGeometry]) -> npt.NDArray[np.bool_]:
    """Which lines end at walls on both sides."""
    known = shapely.union_all(walls)
    shapely.prepare(known)
    starts, ends = shapely.get_point(lines, 0), shapely.get_point(lines, -1)
    return np.asarray(
        shapely.dwithin(starts, known, JAMB_MM) & shapely.dwithin(ends, known, JAMB_MM)
    )


def _chains(lines: Sequence[LineString]) -> npt.NDArray[np.int32]:
    """The number of the chain, of lines that meet at their ends, that each line is in."""
    n = len(lines)
    ends = [line.coords[k] for line in lines for k in (0, -1)]
    pairs = cKDTree(ends).query_pairs(GAP_MM, output_type="ndarray") // 2
    links = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(n, n))
    return np.asarray(connected_components(links, directed=False)[1])


def _in_pairs(lines: Sequence[LineString]) -> npt.NDArray[np.bool_]:
    """Which lines have a parallel one beside them, as the faces of a wall do."""
    ends = np.array([(line.coords[0], line.coords[-1]) for line in lines])
    along = ends[:, 1] - ends[:, 0]
    along /= np.maximum(np.hypot(*along.T), GAP_MM)[:, np.newaxis]
    near, other = shapely.STRtree(lines).query(lines, predicate="dwithin", distance=FACES_MM)
    sines = np.abs(along[near, 0] * along[other, 1] - along[near, 1] * along[other, 0])
    long_enough = shapely.length(lines)[other] > PARTITION_MM
    beside = (near != other) & (sines <= PARALLEL) & long_enough
    return np.bincount(near, beside, len(lines)) > 0
