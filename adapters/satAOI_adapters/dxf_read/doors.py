"""What is drawn on door layers: no obstacle, but some of it says where walls or the floor end.

Lines that span an opening close the floor there. And some offices draw whole partitions on the
layer of their doors; these are walls.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np
import shapely
from shapely.geometry import LineString
from shapely.geometry.base import BaseGeometry

from satAOI_adapters.dxf_read.curves import Arc, Line, Path, Point
from satAOI_adapters.dxf_read.enclosure import OPENING_MM
from satAOI_adapters.dxf_read.features import Feature
from satAOI_adapters.dxf_read.groups import Spots, linked
from satAOI_adapters.dxf_read.linework import PARALLEL
from satAOI_adapters.dxf_read.options import CLOSE_GAPS_MM
from satAOI_adapters.dxf_read.swings import (
    LEAF_MM,
    LEAF_SLACK_MM,
    LEAST_LEAF_MM,
    WIDEST_RAD,
)
from satAOI_geo.plan import BoolArray, Finding, FloatArray, IntArray

JAMB_MM: Final = 300.0
"""A line that ends this close to walls on both sides spans the opening between them."""

ABREAST_MM: Final = 20.0
"""Lines of a window end this close to abreast of each other."""

PARTITION_MM: Final = 2500.0
"""A single straight line longer than this, with another beside it, is the face of a wall."""

CORNER: Final = 0.5
"""Least sine of the angle between the two sides of a wall's corner: 30°."""

GATE_LEAF_MM: Final = 4000.0
"""No leaf of a gate is longer."""

FACES_MM: Final = 400.0
"""The two faces of a partition are no farther apart."""


def partitions(
    doors: Sequence[Feature], walls: Sequence[BaseGeometry], door_blocks: frozenset[str]
) -> list[Feature]:
    """The lines on door layers that are faces of walls.

    They are open, straight, in no door's block and longer than a leaf. Joined at their ends they
    turn a corner with another such line; or one alone is longer than any opening, has a parallel
    one beside it, and does not span an opening from wall to wall as a garage door's line does.
    Lines shorter than any leaf that go on from these, and those abreast of them, are the faces of
    the stubs between a door and the next corner.

    Args:
        doors: What is drawn on door layers.
        walls: Walls that are known already.
        door_blocks: Names of blocks that are doors.
    """
    pieces = loose_pieces(doors, door_blocks)
    if not pieces:
        return []
    lines = as_lines(pieces)
    lengths_mm = shapely.length(lines)
    is_long = lengths_mm > LEAF_MM
    faces = (lengths_mm > PARTITION_MM) & ~spanning(lines, walls, JAMB_MM) & _in_pairs(lines)
    is_wall = is_long & (_in_corners(lines, is_long) | faces)
    is_wall |= _stubs(lines, is_wall)
    return [piece for piece, wall in zip(pieces, is_wall, strict=True) if wall]


def loose_pieces(
    doors: Sequence[Feature], door_blocks: frozenset[str], *, with_outlines: bool = False
) -> list[Feature]:
    """The straight pieces of lines, each as a feature, that are in no door's block.

    Args:
        doors: What is drawn on door layers.
        door_blocks: Names of blocks that are doors.
        with_outlines: Whether the sides of closed outlines count, too.
    """
    return [
        replace(feature, paths=(Path((piece,), closed=False),))
        for feature in doors
        if door_blocks.isdisjoint(feature.placed.blocks)
        for path in feature.paths
        if path.is_straight and (with_outlines or not path.closed)
        for piece in path.pieces
    ]


def as_lines(pieces: Sequence[Feature]) -> list[LineString]:
    """Features of one straight piece each as lines."""
    return [LineString((path.start, path.end)) for piece in pieces for path in piece.paths]


def partition_findings(found: Sequence[Feature]) -> list[Finding]:
    """What is to be said about walls on door layers."""
    layers = sorted({feature.placed.layer for feature in found})
    return [
        Finding(
            "wall-on-door-layer",
            f"{sum(feature.placed.layer == layer for feature in found)} lines on door layer "
            f"'{layer}' are too long for doors, or go on from such, and taken as walls",
            "say what the layer is in a file for --layers",
            layer=layer,
        )
        for layer in layers
    ]


def spans(doors: Sequence[Feature], walls: Sequence[BaseGeometry]) -> list[LineString]:
    """The lines that doors close openings with, from wall to wall.

    They are drawn as lines, or told by the swings of gates that are wider than what is closed
    anyhow: from the hinge to where the leaf's tip is when it is shut, and from hinge to hinge where
    two leaves meet. A leaf that stands open has a free end and does not count.
    """
    pieces = [piece for feature in doors for path in feature.paths for piece in path.pieces]
    ends = [(piece.start, piece.end) for piece in pieces if isinstance(piece, Line)]
    ends += _by_swings([p for p in pieces if isinstance(p, Arc) and _swings(p)])
    lines = [LineString(pair) for pair in ends if math.dist(*pair) > JAMB_MM]
    return [line for line, does in zip(lines, spanning(lines, walls, JAMB_MM), strict=True) if does]


def _swings(arc: Arc) -> bool:
    """Whether an arc is that of a door or, larger, of a gate."""
    radius_mm = math.hypot(*arc.u)
    return (
        arc.is_round and LEAST_LEAF_MM <= radius_mm <= GATE_LEAF_MM and arc.sweep_rad <= WIDEST_RAD
    )


def _by_swings(arcs: Sequence[Arc]) -> list[tuple[Point, Point]]:
    """Where leaves are shut, or open, one by one; and hinge to hinge of two whose tips meet."""
    if not arcs:
        return []
    tips = [(arc.centre, tip) for arc in arcs for tip in (arc.start, arc.end)]
    meeting = Spots([tip for _, tip in tips]).pairs(LEAF_SLACK_MM)
    shut = [*tips, *((tips[i][0], tips[j][0]) for i, j in meeting.tolist())]
    return [ends for ends in shut if math.dist(*ends) > OPENING_MM]


def spanning(
    lines: Sequence[LineString], walls: Sequence[BaseGeometry], within_mm: float
) -> BoolArray:
    """Which lines end at walls on both sides, or as close to them."""
    known = shapely.STRtree(walls)
    at_walls = np.ones(len(lines), dtype=bool)
    for end in (0, -1):
        near, _ = known.query(
            shapely.get_point(lines, end), predicate="dwithin", distance=within_mm
        )
        at_walls &= np.isin(np.arange(len(lines)), near)
    return at_walls


def _in_corners(lines: Sequence[LineString], is_long: BoolArray) -> BoolArray:
    """Which lines are in a chain, joined end to end, with long lines in two directions."""
    chain = _chains(lines)
    along = directions(lines)
    turns = np.zeros(len(lines), dtype=bool)
    for k in np.unique(chain[is_long]):
        (first, *_), members = along[is_long & (chain == k)], chain == k
        sines = along[is_long & members] @ np.array((-first[1], first[0]))
        turns[members] = np.abs(sines).max() > CORNER
    return turns


def _chains(lines: Sequence[LineString]) -> IntArray:
    """The number of the chain, joined end to end, that each line is in."""
    ends = [line.coords[k] for line in lines for k in (0, -1)]
    pairs = Spots(ends).pairs(CLOSE_GAPS_MM)
    return linked(pairs // 2, len(lines))


def _stubs(lines: Sequence[LineString], is_wall: BoolArray) -> BoolArray:
    """Which lines, shorter than any leaf, go on from walls or from what is abreast of these."""
    chain = _chains(lines)
    is_short = shapely.length(lines) < LEAST_LEAF_MM
    joined = is_short & np.isin(chain, chain[is_wall])
    one, other = abreast(lines).T
    across = other[joined[one] & is_short[other]]
    return np.asarray(joined | is_short & np.isin(chain, chain[across]))


def directions(lines: Sequence[LineString]) -> FloatArray:
    """Unit vectors along lines, shape (n, 2)."""
    ends = np.array([(line.coords[0], line.coords[-1]) for line in lines])
    along = ends[:, 1] - ends[:, 0]
    return np.asarray(along / np.maximum(np.hypot(*along.T), CLOSE_GAPS_MM)[:, np.newaxis])


def _in_pairs(lines: Sequence[LineString]) -> BoolArray:
    """Which lines have a parallel one beside them, as the faces of a wall do."""
    along = directions(lines)
    near, other = shapely.STRtree(lines).query(lines, predicate="dwithin", distance=FACES_MM)
    sines = np.abs(along[near, 0] * along[other, 1] - along[near, 1] * along[other, 0])
    long_enough = shapely.length(lines)[other] > PARTITION_MM
    beside = (near != other) & (sines <= PARALLEL) & long_enough
    return np.bincount(near, beside, len(lines)) > 0


def abreast(lines: Sequence[LineString]) -> IntArray:
    """Numbers of lines that run side by side and end side by side, shape (pairs, 2)."""
    along = directions(lines)
    one, other = shapely.STRtree(lines).query(lines, predicate="dwithin", distance=FACES_MM)
    sines = np.abs(along[one, 0] * along[other, 1] - along[one, 1] * along[other, 0])
    low, high = _reach(lines, along, one, one), _reach(lines, along, other, one)
    is_even = (np.abs(low - high) <= ABREAST_MM).all(axis=1)
    return np.asarray(np.column_stack((one, other))[(sines <= PARALLEL) & is_even])


def _reach(
    lines: Sequence[LineString], along: FloatArray, which: IntArray, of: IntArray
) -> FloatArray:
    """From where to where lines reach in the direction of others, shape (n, 2)."""
    ends = np.array([(line.coords[0], line.coords[-1]) for line in lines])
    shares = (ends[which] * along[of][:, np.newaxis]).sum(axis=-1)
    return np.sort(shares, axis=1)
