"""The frame of a sheet drawn among the walls: a rectangle around all else that no wall touches.

It would be a wall without thickness, a door or an opening, around a building whose walls have all
three. With the frame goes what is joined to it, the title block.

    ┌──────────────────────┐
    │  ┌──────────┐        │
    │  │ building │ ┌──────┤
    │  └───/ ─────┘ │ title│
    └───────────────┴──────┘

Where doors swing in it, the building is told by them. Where none does, the rectangle may be the
wall of a hall with a core in it: that is told by how much of it the building fills and by what
stands between the two, and either reading is said with both areas.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

import numpy as np
import shapely
from shapely.geometry import box
from shapely.geometry.base import BaseGeometry

from satAOI_adapters.dxf_read.doors import FACES_MM
from satAOI_adapters.dxf_read.enclosure import enclosed
from satAOI_adapters.dxf_read.estimate import beside
from satAOI_adapters.dxf_read.features import Feature
from satAOI_adapters.dxf_read.groups import linked
from satAOI_adapters.dxf_read.linework import WALL_MM
from satAOI_adapters.dxf_read.lookalikes import look_like_walls
from satAOI_adapters.dxf_read.meaning import Seen
from satAOI_adapters.dxf_read.options import CLOSE_GAPS_MM
from satAOI_adapters.dxf_read.plans import n_swings, rough_lines
from satAOI_adapters.dxf_read.shapes import GeometryArray, is_thin
from satAOI_adapters.meanings import KINDS, Certainty, Meaning, Verdict
from satAOI_adapters.wording import counted
from satAOI_geo.plan import BoolArray, Finding, FloatArray, IntArray, polygons_in

IN_A_PLAN: Final = frozenset({*KINDS, Meaning.FLOOR, Meaning.DOOR})
"""Meanings of what a plan consists of; its frame is taken for one of these."""

MOST_FRAMES: Final = 4
"""Rectangles inside each other that are looked at: edge of the paper, margins, borders."""

WHOLE: Final = 0.99
"""Share of a rectangle's rim that must be drawn."""

EVEN_MM: Final = 10.0
"""Rectangles a usual wall's thickness apart, on all sides alike to this, are its faces."""

FILLED: Final = 0.4
"""A plan spans this share of its sheet: one that spans less would be drawn at the next scale."""

FRAME: Final = "frame"
"""What findings call a frame that is left out."""

MARKS: Final = 2
"""So many closed things beside a plan may be marks, as a north arrow; columns are more."""


@dataclass(frozen=True, slots=True)
class Sheet:
    """What is drawn of plans, with rectangles around it.

    Attributes:
        drawn: Entities, with what they draw in drawing units.
        mm_per_unit: Millimetres in one.
        lines: The same roughly, in millimetres, turned so that the outermost rectangle is upright.
        frames: Left, bottom, right, top of the rectangles, the outermost first.
        is_frame: Which lines draw them.
        group: The group of lines, joined to each other, that each line is in.
    """

    drawn: Sequence[tuple[Seen, Feature]]
    mm_per_unit: float
    lines: GeometryArray
    frames: Sequence[tuple[float, ...]]
    is_frame: BoolArray
    group: IntArray

    @property
    def is_out(self) -> BoolArray:
        """Which lines go with the frames: what is joined to one, directly or through others."""
        return np.isin(self.group, self.group[self.is_frame])

    @property
    def is_apart(self) -> bool:
        """Whether there is something in the frames, and no wall near one."""
        rest = self.lines[~self.is_out]
        frames = shapely.union_all(self.lines[self.is_frame])
        return bool(rest.size and (shapely.distance(frames, rest) > WALL_MM).all())

    @property
    def rest(self) -> list[Feature]:
        """What is not joined to a frame, in drawing units."""
        return [self.drawn[k][1] for k in np.flatnonzero(~self.is_out).tolist()]

    @property
    def left_out(self) -> list[Seen]:
        """The entities that are, or are joined to, a frame."""
        left_out = {
            id(self.drawn[k][0]): self.drawn[k][0] for k in np.flatnonzero(self.is_out).tolist()
        }
        return list(left_out.values())

    @property
    def outermost(self) -> tuple[Seen, Feature]:
        """The first of what draws the frames."""
        return self.drawn[int(np.flatnonzero(self.is_frame)[0])]


def without_frames(
    near: Sequence[tuple[Seen, Feature]], mm_per_unit: float
) -> tuple[list[tuple[Seen, Feature]], tuple[Finding, ...]]:
    """What is drawn, with frames and title blocks left out.

    Args:
        near: Entities, with what they draw in drawing units.
        mm_per_unit: Millimetres in a drawing unit.
    """
    drawn = [pair for pair in near if pair[0].verdict.meaning in IN_A_PLAN]
    judge = _by_doors if any(n_swings(feature) for _, feature in drawn) else _by_rooms
    doubt: tuple[Finding, ...] = ()
    for sheet in _sheets(drawn, mm_per_unit) if drawn else ():
        if not sheet.is_apart:
            continue
        finding = judge(sheet)
        if finding is not None and finding.code == FRAME:
            left_out = {id(entity) for entity in sheet.left_out}
            ignored = Verdict(Meaning.IGNORE)
            rest = [(replace(e, verdict=ignored) if id(e) in left_out else e, f) for e, f in near]
            return rest, (finding,)
        doubt = doubt or (() if finding is None else (finding,))
        if not _faces_mm(sheet.frames[-2:], WALL_MM):
            break
    return list(near), doubt


def _sheets(drawn: Sequence[tuple[Seen, Feature]], mm_per_unit: float) -> Iterator[Sheet]:
    """What is drawn of plans with all the rectangles around it, then with fewer of them.

    The inner ones may be the faces of the building's walls.
    """
    lines = _upright(rough_lines([feature for _, feature in drawn]), mm_per_unit)
    frames, depth = _frames(lines)
    if not frames:
        return
    tree = shapely.STRtree(lines)
    pairs = tree.query(lines, predicate="dwithin", distance=CLOSE_GAPS_MM).T
    group = linked(pairs, len(lines))
    for count in range(len(frames), 0, -1):
        yield Sheet(drawn, mm_per_unit, lines, frames[:count], depth < count, group)


def is_sheet(lines: GeometryArray) -> bool:
    """Whether lines, in millimetres, are a sheet's frame with something joined, as a title block.

    Rectangles as far apart as the faces of walls are none.
    """
    lines = _upright(lines, 1.0)
    frames, depth = _frames(lines)
    is_frame = depth < MOST_FRAMES
    if not frames or _faces_mm(frames, WALL_MM):
        return False
    rims = shapely.union_all(lines[is_frame])
    return bool(shapely.dwithin(rims, lines[~is_frame], CLOSE_GAPS_MM).any())


def _by_doors(sheet: Sheet) -> Finding | None:
    """What is to be said where doors swing: a frame, if they are those of the building in it."""
    rest = sheet.rest
    is_building = any(map(n_swings, rest)) and look_like_walls(rest, sheet.mm_per_unit)
    return _as_frame(sheet, "") if is_building and not _faces_mm(sheet.frames, FACES_MM) else None


def _by_rooms(sheet: Sheet) -> Finding | None:
    """What is to be said where no door swings, if walls in the rectangle enclose rooms."""
    if not _may_be_guessed(sheet):
        return None
    is_wall = np.array([entity.verdict.meaning is Meaning.WALL for entity, _ in sheet.drawn])
    rooms = enclosed(list(sheet.lines[is_wall & ~sheet.is_out])).region
    if rooms.is_empty:
        return None
    areas = (
        f"; no door tells what it is: it encloses {box(*sheet.frames[0]).area / 1e6:.2f} m², the "
        f"walls in it {rooms.area / 1e6:.2f} m²"
    )
    signs = list(_signs_of_a_wall(sheet, rooms))
    return _as_wall(sheet, areas, signs) if signs else _as_frame(sheet, areas)


def _upright(drawn: GeometryArray, mm_per_unit: float) -> GeometryArray:
    """Lines in millimetres, turned so that the least rectangle around them all is upright."""
    # near the origin, where doubles have digits to spare
    start = shapely.get_coordinates(drawn[0])[0]
    lines = shapely.transform(drawn, lambda xy: (xy - start) * mm_per_unit)
    around = shapely.oriented_envelope(shapely.geometrycollections(lines))
    (x0_mm, y0_mm), (x1_mm, y1_mm) = shapely.get_coordinates(around)[:2]
    turn_rad = math.atan2(y1_mm - y0_mm, x1_mm - x0_mm)
    cos, sin = math.cos(turn_rad), math.sin(turn_rad)
    return np.asarray(shapely.transform(lines, lambda xy: xy @ np.array(((cos, -sin), (sin, cos)))))


def _frames(lines: GeometryArray) -> tuple[list[tuple[float, ...]], IntArray]:
    """The rectangles around all else, the outermost first, and in how many others each line is.

    Lines that draw none of them are in all.
    """
    depth = np.full(len(lines), MOST_FRAMES)
    frames: list[tuple[float, ...]] = []
    is_in = np.ones(len(lines), dtype=bool)
    while len(frames) < MOST_FRAMES and is_in.any():
        rim = box(*shapely.total_bounds(lines[is_in])).exterior
        reach = rim.buffer(CLOSE_GAPS_MM)
        shapely.prepare(reach)
        on_rim = is_in & shapely.covers(reach, lines)
        if shapely.union_all(lines[on_rim]).length < WHOLE * rim.length:
            break
        depth[on_rim] = len(frames)
        is_in &= ~on_rim
        frames.append(rim.bounds)
    return frames, depth


def _faces_mm(frames: Sequence[tuple[float, ...]], widest_mm: float) -> float:
    """How far apart two of the rectangles are that may be the faces of a wall; 0 if none are.

    Args:
        frames: Left, bottom, right, top of each, the outermost first.
        widest_mm: No wall is thicker.
    """
    for outer, inner in pairwise(frames):
        apart_mm = np.abs(np.subtract(outer, inner))
        if apart_mm.max() <= widest_mm and np.ptp(apart_mm) <= EVEN_MM:
            return float(apart_mm.max())
    return 0.0


def _may_be_guessed(sheet: Sheet) -> bool:
    """Whether only guesses say that the rectangle is a wall, and the floor hangs on it."""
    verdicts = [entity.verdict for entity, _ in sheet.drawn]
    is_guess = all(
        verdicts[k].meaning is Meaning.WALL and verdicts[k].certainty is Certainty.UNKNOWN
        for k in np.flatnonzero(sheet.is_frame)
    )
    return is_guess and all(verdict.meaning is not Meaning.FLOOR for verdict in verdicts)


def _signs_of_a_wall(sheet: Sheet, rooms: BaseGeometry) -> Iterator[str]:
    """What speaks for a wall rather than a frame where no door tells the building in it.

    Args:
        sheet: The sheet.
        rooms: What the walls in the rectangle enclose.
    """
    if not look_like_walls(sheet.rest, sheet.mm_per_unit):
        yield "the lines in it do not run side by side as the faces of walls do"
    faces_mm = _faces_mm(sheet.frames, WALL_MM)
    _, thicknesses = beside(sheet.rest)
    is_as_thick = np.abs(thicknesses * sheet.mm_per_unit - faces_mm) <= EVEN_MM
    if faces_mm and is_as_thick.any():
        yield f"a second one in it is as far away, {faces_mm:.0f} mm, as the faces of walls there"
    spans_mm, whole_mm = _spans_mm(rooms.bounds), _spans_mm(sheet.frames[-1])
    # two rectangles as far apart as faces of walls are frames only if all but an aisle is filled
    share = (np.min if faces_mm else np.max)(spans_mm / whole_mm)
    if share < FILLED:
        yield f"what the walls in it enclose spans only {share:.0%} of it"
    n_solid = _n_solid(sheet, rooms)
    if n_solid > MARKS:
        yield f"it holds {n_solid} closed things without an opening, as tanks have none"
    count = _n_things(sheet, rooms)
    if count > MARKS:
        yield f"{count} closed things stand between it and the walls"


def _spans_mm(bounds_mm: Sequence[float]) -> FloatArray:
    left, bottom, right, top = bounds_mm
    return np.array((right - left, top - bottom))


def _n_solid(sheet: Sheet, rooms: BaseGeometry) -> int:
    """How many things without an opening make up most of what is taken for rooms; 0 if none do."""
    drawn = shapely.union_all(sheet.lines[~sheet.is_out])
    closed = polygons_in([shapely.union_all(shapely.polygonize([drawn]))])
    solid = [part for part in closed if not is_thin(part, WALL_MM)]
    return len(solid) if shapely.area(solid).sum() > rooms.area / 2 else 0


def _n_things(sheet: Sheet, rooms: BaseGeometry) -> int:
    """How many things, drawn by lines that close, stand neither in rooms nor at them."""
    shapely.prepare(rooms)
    of_rooms = sheet.group[shapely.dwithin(rooms, sheet.lines, WALL_MM)]
    is_beside = ~sheet.is_out & ~np.isin(sheet.group, of_rooms)
    lines, group = sheet.lines[is_beside], sheet.group[is_beside]
    return sum(
        shapely.polygonize([shapely.union_all(lines[group == k])]).area > 0
        for k in np.unique(group)
    )


def _as_frame(sheet: Sheet, areas: str) -> Finding:
    return _finding(
        FRAME,
        "is taken as the frame of the sheet and left out with what is joined to it, "
        f"{counted(len(sheet.left_out), 'shape')} together{areas}",
        "draw the floor's outline on a layer FLOOR if it is a wall",
        sheet,
    )


def _as_wall(sheet: Sheet, areas: str, signs: Sequence[str]) -> Finding:
    return _finding(
        "frame-or-wall",
        f"is taken for a wall, not for the frame of the sheet, since {' and '.join(signs)}{areas}",
        "give the part to read with --region, or draw the frame on a layer FRAME, if it is one",
        sheet,
    )


def _finding(code: str, said: str, remedy: str, sheet: Sheet) -> Finding:
    entity, feature = sheet.outermost
    layer = entity.placed.layer
    x, y = feature.paths[0].start
    return Finding(
        code,
        f"a rectangle on layer '{layer}' lies around everything, and no wall comes near it: it "
        f"{said}",
        remedy,
        layer=layer,
        handle=entity.placed.handle,
        at_mm=(x * sheet.mm_per_unit, y * sheet.mm_per_unit),
    )
