"""Windows on the layers of doors and openings: a sill is in the way of the robot, a door is not.

A door leaves its opening free and shows at most a threshold, one line on either face of the wall.
A window fills its opening: the faces of the wall go on across it, and between them runs the glass.

      │       │
    ──┤───────├──   face
      │───────│     glass
    ──┤───────├──   face
"""

from collections.abc import Iterable, Sequence
from typing import Final

import numpy as np
import shapely
from shapely.geometry import LineString
from shapely.geometry.base import BaseGeometry

from satAOI_adapters.dxf_read.curves import Arc
from satAOI_adapters.dxf_read.doors import (
    FACES_MM,
    abreast,
    as_lines,
    directions,
    loose_pieces,
    spanning,
)
from satAOI_adapters.dxf_read.features import Feature
from satAOI_adapters.dxf_read.groups import linked
from satAOI_adapters.dxf_read.swings import LEAF_SLACK_MM, may_be_swing
from satAOI_geo.plan import BoolArray, Finding, IntArray

APART_MM: Final = 5.0
"""Lines closer to each other are drawn twice."""

LINES: Final = 3
"""Fewest lines of a window: two faces and the glass."""


def windows(
    doors: Sequence[Feature], walls: Sequence[BaseGeometry], door_blocks: frozenset[str]
) -> list[Feature]:
    """The lines of windows on door layers.

    Three or more stand abreast, each from wall to wall, and no door swings from where they end.

    Args:
        doors: What is drawn on door layers.
        walls: Walls that are known already.
        door_blocks: Names of blocks that are doors.
    """
    pieces = loose_pieces(doors, door_blocks, with_outlines=True)
    lines = as_lines(pieces)
    # the glass ends half-way between the wall's faces
    reach = spanning(lines, walls, FACES_MM / 2)
    pieces = [piece for piece, does in zip(pieces, reach, strict=True) if does]
    lines = as_lines(pieces)
    if len(lines) < LINES:
        return []
    group = linked(abreast(lines), len(lines))
    is_window = _are_many(lines, group) & ~np.isin(group, group[_at_swings(lines, doors)])
    return [feature for feature, does in zip(pieces, is_window, strict=True) if does]


def window_findings(found: Iterable[Feature]) -> list[Finding]:
    """What is to be said about windows on door layers."""
    return [
        Finding(
            "window-on-door-layer",
            f"lines abreast from jamb to jamb on door layer '{layer}' are taken as windows, which "
            "stop the robot",
            "draw windows on a layer of their own, or say what the layer is in a file for --layers",
            layer=layer,
        )
        for layer in sorted({feature.placed.layer for feature in found})
    ]


def _are_many(lines: Sequence[LineString], group: IntArray) -> BoolArray:
    """Which lines are in a group of `LINES` or more that do not lie on each other."""
    along = directions(lines)
    middles = np.array([line.centroid.coords[0] for line in lines])
    many = np.zeros(len(lines), dtype=bool)
    for number in np.unique(group):
        members = np.flatnonzero(group == number)
        x, y = along[members[0]]
        across = np.sort(middles[members] @ np.array((-y, x)))
        many[members] = 1 + (np.diff(across) > APART_MM).sum() >= LINES
    return many


def _at_swings(lines: Sequence[LineString], doors: Sequence[Feature]) -> BoolArray:
    """Which lines end at the hinge of a door."""
    hinges = [
        piece.centre
        for feature in doors
        for path in feature.paths
        for piece in path.pieces
        if isinstance(piece, Arc) and may_be_swing(piece)
    ]
    if not hinges:
        return np.zeros(len(lines), dtype=bool)
    tree = shapely.STRtree(shapely.points(hinges))
    ends = shapely.multipoints([(line.coords[0], line.coords[-1]) for line in lines])
    near, _ = tree.query(ends, predicate="dwithin", distance=LEAF_SLACK_MM)
    return np.isin(np.arange(len(lines)), near)
