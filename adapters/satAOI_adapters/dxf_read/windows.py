"""Windows on the layers of doors and openings: a sill is in the way of the robot, a door is not.

A door leaves its opening free and shows at most a threshold, one line on either face of the wall,
and its leaf. A window fills its opening: the faces of the wall go on across it, and between them
runs the glass.

      │       │              │       │
    ──┤───────├──   face   ──┤───────├──   threshold
      │───────│     glass    │▭▭▭▭▭▭▭│     leaf
    ──┤───────├──   face   ──┤───────├──   threshold
"""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Final

import numpy as np
import shapely
from shapely.geometry import LineString
from shapely.geometry.base import BaseGeometry

from satAOI_adapters.dxf_read.curves import Arc, Path
from satAOI_adapters.dxf_read.dashed import is_dashed
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
from satAOI_adapters.dxf_read.shapes import by_chords, is_wide, middle_line
from satAOI_adapters.dxf_read.swings import LEAF_SLACK_MM, may_be_swing, swings
from satAOI_adapters.dxf_read.terms import Terms
from satAOI_geo.plan import BoolArray, Finding, IntArray

APART_MM: Final = 5.0
"""Lines closer to each other are drawn twice."""

LINES: Final = 3
"""Fewest lines of a window: two faces and the glass."""


def windows(
    doors: Sequence[Feature], walls: Sequence[BaseGeometry], door_blocks: frozenset[str]
) -> list[list[Feature]]:
    """The windows on door layers, each by its lines.

    Three or more stand abreast, each from wall to wall, and no door swings from where they end.
    Dashed lines and the outlines of leaves do not count.

    Args:
        doors: What is drawn on door layers.
        walls: Walls that are known already.
        door_blocks: Names of blocks that are doors.
    """
    solid = [feature for feature in doors if not is_dashed(feature.placed)]
    pieces = loose_pieces(_without_leaves(solid), door_blocks, with_outlines=True)
    lines = as_lines(pieces)
    # the glass ends half-way between the wall's faces
    reach = spanning(lines, walls, FACES_MM / 2)
    pieces = [piece for piece, does in zip(pieces, reach, strict=True) if does]
    lines = as_lines(pieces)
    if len(lines) < LINES:
        return []
    group = linked(abreast(lines), len(lines))
    is_window = _are_many(lines, group) & ~np.isin(group, group[_at_swings(lines, doors)])
    found: defaultdict[int, list[Feature]] = defaultdict(list)
    for k in np.flatnonzero(is_window):
        found[int(group[k])].append(pieces[k])
    return list(found.values())


def window_findings(
    found: Iterable[Sequence[Feature]], terms: Terms, *, are_doors: bool
) -> list[Finding]:
    """What is to be said about windows on door layers.

    Args:
        found: The windows, each by its lines.
        terms: The terms of the reading.
        are_doors: Whether they are taken as doors, as windows have layers of their own.
    """
    of_layer: defaultdict[str, list[Feature]] = defaultdict(list)
    for first, *_ in found:
        of_layer[first.placed.layer].append(first)
    say = _like_windows if are_doors else _windows
    return [say(of_layer[layer], terms) for layer in sorted(of_layer)]


def _windows(firsts: Sequence[Feature], terms: Terms) -> Finding:
    """What is to be said about the windows of one layer, of each of which a line is given."""
    return _finding(
        firsts,
        terms,
        "are taken as a window, which stops the robot",
        "draw windows on a layer of their own, or say what the layer is in a file for --layers",
    )


def _like_windows(firsts: Sequence[Feature], terms: Terms) -> Finding:
    """What is to be said about doors of one layer that are drawn as windows are."""
    return _finding(
        firsts,
        terms,
        "are taken as a door, which lets the robot pass, as windows have layers of their own",
        "draw windows on their layer, or say what this one is in a file for --layers",
    )


def _finding(firsts: Sequence[Feature], terms: Terms, are_taken: str, remedy: str) -> Finding:
    placed = firsts[0].placed
    x_mm, y_mm = terms.place(firsts[0].paths[0].start)
    return Finding(
        "window-on-door-layer",
        f"{LINES} or more lines abreast from jamb to jamb on door layer '{placed.layer}' "
        f"{are_taken}, in {len(firsts)} openings, the first at ({x_mm:.1f}, {y_mm:.1f}) mm",
        remedy,
        layer=placed.layer,
        handle=placed.handle,
        at_mm=(x_mm, y_mm),
    )


def _without_leaves(doors: Sequence[Feature]) -> list[Feature]:
    """Features less the outlines of leaves."""
    drawn = shapely.STRtree([middle_line(path) for feature in doors for path in feature.paths])
    kept = (tuple(p for p in feature.paths if not _is_leaf(p, drawn)) for feature in doors)
    return [
        replace(feature, paths=paths) for feature, paths in zip(doors, kept, strict=True) if paths
    ]


def _is_leaf(path: Path, drawn: shapely.STRtree) -> bool:
    """Whether an outline is as thin as a leaf, with no glass in it and no pane beside it."""
    if not path.closed or is_wide(path, LEAF_SLACK_MM):
        return False
    outline = by_chords(path)
    within = outline.buffer(-APART_MM)
    if within.is_empty or drawn.query(within, predicate="intersects").size:
        return False
    around = drawn.geometries[drawn.query(outline, predicate="dwithin", distance=APART_MM)]
    panes = around[shapely.is_closed(around)]
    # one that is drawn twice is beside itself
    return bool(shapely.covered_by(panes, outline.buffer(2 * APART_MM)).all())


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
    hinges = [door.hinge for door in swings(doors)]
    # an arc tells of a door where its leaf is not drawn, too
    hinges += [
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
