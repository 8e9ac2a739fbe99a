"""Walls and windows on layers whose names say nothing, told by how they go on from known walls.

A partition runs in two lines, with a room on either side of these, from one wall to another or to
its own end. Joints of tiles and treads have lines on both their sides, furniture does not end at
walls on two lines. A window fills an opening with three lines or more, from jamb to jamb; two may
be those of a threshold.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np
import shapely
from shapely.geometry import LineString

from satAOI_adapters.dxf_read.curves import Line
from satAOI_adapters.dxf_read.doors import FACES_MM, as_lines, directions, loose_pieces
from satAOI_adapters.dxf_read.enclosure import OPENING_MM
from satAOI_adapters.dxf_read.estimate import WALLS
from satAOI_adapters.dxf_read.features import Feature
from satAOI_adapters.dxf_read.groups import linked
from satAOI_adapters.dxf_read.linework import PARALLEL
from satAOI_adapters.dxf_read.plans import Drawn
from satAOI_adapters.dxf_read.shapes import TIE_MM
from satAOI_adapters.dxf_read.terms import Terms
from satAOI_adapters.dxf_read.unclassified import SAY_WHAT
from satAOI_adapters.dxf_read.windows import windows
from satAOI_adapters.meanings import Meaning
from satAOI_adapters.wording import are, counted
from satAOI_geo.plan import BoolArray, Finding, FloatArray, IntArray

ENOUGH_MM: Final = 2000.0
"""So long the lines of a partition must be together."""

AT_WALLS: Final = 2
"""So many of them must end at walls that are known: both faces of one end, or one of each."""

MAX_LINES: Final = 5000
"""Lines that are compared with each other, the longest first: more are no partitions' but drawn
patterns, furniture and plants."""

TWICE_MM: Final = 5.0
"""Lines closer to each other are drawn twice."""

AS_WALLS: Final = ("walls-by-look", "that run in pairs and end at walls {are} taken for walls")
AS_WINDOWS: Final = (
    "window-by-look",
    "that run abreast from jamb to jamb {are} taken for windows, which stop the robot",
)
"""What findings are called, and what they say of lines."""


def with_nameless_walls(
    drawn: Drawn, dashed: frozenset[int], terms: Terms
) -> tuple[Drawn, tuple[Finding, ...]]:
    """What is drawn, with such walls and windows among the walls.

    Args:
        drawn: What is drawn, by meaning.
        dashed: Identities of what is placed and dashed.
        terms: The terms of the reading.
    """
    known = _straight(drawn[Meaning.WALL])
    lines = [
        feature
        for feature in drawn[None]
        if not (feature.is_area or feature.width_mm or id(feature.placed) in dashed)
    ]
    if not known or not lines:
        return drawn, ()
    panes = _panes(lines, drawn[Meaning.DOOR], known)
    glazed = {id(pane.placed) for pane in panes}
    pieces = loose_pieces([f for f in lines if id(f.placed) not in glazed], frozenset())
    faces = _faces(pieces, known, terms.gap_mm + TIE_MM)
    told = glazed | {id(face.placed) for face in faces}
    found = [feature for feature in drawn[None] if id(feature.placed) in told]
    rest = [feature for feature in drawn[None] if id(feature.placed) not in told]
    findings = (*_said(panes, AS_WINDOWS, terms), *_said(faces, AS_WALLS, terms))
    return {**drawn, None: rest, Meaning.WALL: [*drawn[Meaning.WALL], *found]}, findings


def _straight(features: Sequence[Feature]) -> list[LineString]:
    """All straight pieces of what is drawn."""
    return [
        LineString((piece.start, piece.end))
        for feature in features
        for path in feature.paths
        for piece in path.pieces
        if isinstance(piece, Line)
    ]


def _panes(
    lines: Sequence[Feature], doors: Sequence[Feature], known: Sequence[LineString]
) -> list[Feature]:
    """The lines of windows: longer than a wall is thick, and not farther apart.

    Shorter ones are the pattern of a wall, from face to face.
    """
    # the glass ends half-way between the faces of the wall
    boxes = shapely.box(*np.array([feature.box() for feature in lines]).T)
    near, _ = shapely.STRtree(known).query(boxes, predicate="dwithin", distance=FACES_MM / 2)
    at_walls = [lines[k] for k in np.unique(near).tolist()]
    nameless = {id(feature.placed) for feature in at_walls}
    found = []
    for window in windows([*at_walls, *doors], known, frozenset()):
        panes = as_lines(window)
        middles = shapely.multipoints([pane.centroid for pane in panes])
        fits = shapely.minimum_bounding_radius(middles) <= FACES_MM / 2 < panes[0].length / 2
        if fits and all(id(pane.placed) in nameless for pane in window):
            found += window
    return found


def _faces(
    pieces: Sequence[Feature], known: Sequence[LineString], within_mm: float
) -> list[Feature]:
    """The faces and ends of partitions among straight pieces of lines."""
    lines = as_lines(pieces)
    if not lines:
        return []
    longest = np.sort(np.argsort(-shapely.length(lines), kind="stable")[:MAX_LINES]).tolist()
    pieces, lines = [pieces[k] for k in longest], [lines[k] for k in longest]
    along = directions(lines)
    pairs = _facing(lines, along)
    is_face = np.bincount(pairs[:, 0], minlength=len(lines)) > 0
    at_walls = _at_walls(lines, along, known, within_mm)
    group = linked(_joined(lines, is_face, pairs, within_mm), len(lines))
    n_at_walls = np.bincount(group, is_face & at_walls)
    lengths_mm = np.bincount(group, np.where(is_face, shapely.length(lines), 0.0))
    is_wall = is_face & ((n_at_walls >= AT_WALLS) & (lengths_mm >= ENOUGH_MM))[group]
    walls = [line for line, wall in zip(lines, is_wall, strict=True) if wall]
    is_wall |= _are_ends(lines, walls, within_mm)
    return [piece for piece, wall in zip(pieces, is_wall, strict=True) if wall]


def _facing(lines: Sequence[LineString], along: FloatArray) -> IntArray:
    """Pairs of lines that face each other across a wall and nothing across a room.

    Each has others as far away as walls are thick on one of its sides only.

    Args:
        lines: Straight lines, shape (n,).
        along: Unit vectors along them.

    Returns:
        Shape (pairs, 2), in both orders.
    """
    one, other = shapely.STRtree(lines).query(lines, predicate="dwithin", distance=FACES_MM)
    x, y = along[one].T
    starts_mm, ends_mm = (shapely.get_coordinates(shapely.get_point(lines, k)) for k in (0, -1))
    middles_mm = (starts_mm + ends_mm) / 2
    shift_x_mm, shift_y_mm = (middles_mm[other] - middles_mm[one]).T
    offsets_mm = shift_y_mm * x - shift_x_mm * y
    ahead_mm = np.abs(shift_x_mm * x + shift_y_mm * y)
    lengths_mm = shapely.length(lines)
    shorter_mm = np.minimum(lengths_mm[one], lengths_mm[other])
    # so far apart along their direction they still share half of the shorter one
    runs_along = ahead_mm <= (lengths_mm[one] + lengths_mm[other] - shorter_mm) / 2
    is_parallel = np.abs(x * along[other, 1] - y * along[other, 0]) <= PARALLEL
    distances_mm = np.abs(offsets_mm)
    beside = is_parallel & runs_along & (distances_mm > TWICE_MM) & (distances_mm <= FACES_MM)
    on_left, on_right = (
        np.bincount(one[beside & (side * offsets_mm > 0)], minlength=len(lines)) > 0
        for side in (1, -1)
    )
    has_room = on_left ^ on_right
    is_wall = beside & (distances_mm >= WALLS.least_mm) & has_room[one] & has_room[other]
    return np.asarray(np.column_stack((one, other))[is_wall])


def _at_walls(
    lines: Sequence[LineString], along: FloatArray, known: Sequence[LineString], within_mm: float
) -> BoolArray:
    """Which lines end at walls or have walls end at them.

    Those that span an opening from jamb to jamb, as the lines of a threshold do, are left out.
    """
    tree, known_along = shapely.STRtree(known), directions(known)
    meets, goes_on = np.zeros(len(lines), dtype=bool), np.zeros((2, len(lines)), dtype=bool)
    for number, end in enumerate((0, -1)):
        one, wall = tree.query(
            shapely.get_point(lines, end), predicate="dwithin", distance=within_mm
        )
        sines = along[one, 0] * known_along[wall, 1] - along[one, 1] * known_along[wall, 0]
        goes_on[number, one[np.abs(sines) <= PARALLEL]] = True
        meets[one] = True
        _, met = shapely.STRtree(lines).query(
            shapely.get_point(known, end), predicate="dwithin", distance=within_mm
        )
        meets[met] = True
    return np.asarray(meets & ~(goes_on.all(axis=0) & (shapely.length(lines) <= OPENING_MM)))


def _joined(
    lines: Sequence[LineString], is_face: BoolArray, pairs: IntArray, within_mm: float
) -> IntArray:
    """Pairs of faces that belong to one wall, face each other or end at each other."""
    tree = shapely.STRtree(lines)
    meeting = [pairs]
    for end in (0, -1):
        one, other = tree.query(
            shapely.get_point(lines, end), predicate="dwithin", distance=within_mm
        )
        meeting.append(np.column_stack((one, other))[is_face[one] & is_face[other]])
    return np.concatenate(meeting)


def _are_ends(
    lines: Sequence[LineString], faces: Sequence[LineString], within_mm: float
) -> BoolArray:
    """Which lines, no longer than a wall is thick, run from face to face."""
    tree = shapely.STRtree(faces)
    is_end = shapely.length(lines) <= FACES_MM
    for end in (0, -1):
        near, _ = tree.query(shapely.get_point(lines, end), predicate="dwithin", distance=within_mm)
        is_end &= np.isin(np.arange(len(lines)), near)
    return np.asarray(is_end)


def _said(found: Sequence[Feature], what: tuple[str, str], terms: Terms) -> list[Finding]:
    """What is to be said about lines, layer by layer."""
    code, said = what
    findings = []
    for layer in sorted({feature.placed.layer for feature in found}):
        first, *more = (feature for feature in found if feature.placed.layer == layer)
        x_mm, y_mm = terms.place(first.paths[0].start)
        count = 1 + len(more)
        findings.append(
            Finding(
                code,
                f"{counted(count, 'line')} on layer '{layer}' {said.format(are=are(count))}, the "
                f"first at ({x_mm:.1f}, {y_mm:.1f}) mm: the layer's name says nothing",
                SAY_WHAT,
                layer=layer,
                handle=first.placed.handle,
                at_mm=(x_mm, y_mm),
            )
        )
    return findings
