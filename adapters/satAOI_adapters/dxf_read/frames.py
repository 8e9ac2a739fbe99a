"""The frame of a sheet drawn among the walls: a rectangle around all else that no wall touches.

It would be a wall without thickness, a door or an opening, around a building whose walls have all
three. With the frame goes what is joined to it, the title block.

    ┌──────────────────────┐
    │  ┌──────────┐        │
    │  │ building │ ┌──────┤
    │  └───/ ─────┘ │ title│
    └───────────────┴──────┘
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Final

import numpy as np
import shapely
from shapely.geometry import box

from satAOI_adapters.dxf_read.doors import FACES_MM
from satAOI_adapters.dxf_read.features import Feature
from satAOI_adapters.dxf_read.groups import linked
from satAOI_adapters.dxf_read.linework import WALL_MM
from satAOI_adapters.dxf_read.lookalikes import look_like_walls
from satAOI_adapters.dxf_read.meaning import Seen
from satAOI_adapters.dxf_read.options import CLOSE_GAPS_MM
from satAOI_adapters.dxf_read.plans import n_swings, rough_lines
from satAOI_adapters.dxf_read.shapes import GeometryArray
from satAOI_adapters.layers import KINDS, Meaning, Verdict
from satAOI_geo.plan import BoolArray, Finding

IN_A_PLAN: Final = frozenset({*KINDS, Meaning.FLOOR, Meaning.DOOR})
"""Meanings of what a plan consists of; its frame is taken for one of these."""

MOST_FRAMES: Final = 4
"""Rectangles inside each other that are looked at: edge of the paper, margins, borders."""

WHOLE: Final = 0.99
"""Share of a rectangle's rim that must be drawn."""

EVEN_MM: Final = 10.0
"""Rectangles a usual wall's thickness apart, on all sides alike to this, are its faces."""


def without_frames(
    near: Sequence[tuple[Seen, Feature]], mm_per_unit: float
) -> tuple[list[tuple[Seen, Feature]], tuple[Finding, ...]]:
    """What is drawn, with frames and title blocks left out.

    Args:
        near: Entities, with what they draw in drawing units.
        mm_per_unit: Millimetres in a drawing unit.
    """
    of_plan = [k for k, (entity, _) in enumerate(near) if entity.verdict.meaning in IN_A_PLAN]
    drawn = [near[k][1] for k in of_plan]
    if not any(map(n_swings, drawn)):
        return list(near), ()
    start = shapely.get_coordinates(rough_lines(drawn[:1]))[0]
    # near the origin, where doubles have digits to spare
    lines = shapely.transform(rough_lines(drawn), lambda xy: (xy - start) * mm_per_unit)
    is_frame = _frames(lines)
    if not is_frame.any():
        return list(near), ()
    is_out = _joined_to(is_frame, lines)
    rest = [feature for feature, out in zip(drawn, is_out, strict=True) if not out]
    is_apart = shapely.distance(shapely.union_all(lines[is_frame]), lines[~is_out]) > WALL_MM
    is_building = any(map(n_swings, rest)) and look_like_walls(rest, mm_per_unit)
    if not (is_building and is_apart.all()):
        return list(near), ()
    frames = [near[k][0] for k, is_one in zip(of_plan, is_frame, strict=True) if is_one]
    left_out = {id(near[k][0]) for k, out in zip(of_plan, is_out, strict=True) if out}
    ignored = Verdict(Meaning.IGNORE)
    return (
        [(replace(e, verdict=ignored) if id(e) in left_out else e, f) for e, f in near],
        (_finding(frames[0], len(left_out)),),
    )


def _frames(lines: GeometryArray) -> BoolArray:
    """Which lines draw rectangles around all others; none if these are the faces of walls."""
    is_frame = np.zeros(len(lines), dtype=bool)
    around: list[tuple[float, ...]] = []
    while len(around) < MOST_FRAMES and not is_frame.all():
        rim = box(*shapely.total_bounds(lines[~is_frame])).exterior
        reach = rim.buffer(CLOSE_GAPS_MM)
        shapely.prepare(reach)
        on_rim = ~is_frame & shapely.covers(reach, lines)
        if shapely.union_all(lines[on_rim]).length < WHOLE * rim.length:
            break
        is_frame |= on_rim
        around.append(rim.bounds)
    for outer, inner in pairwise(around):
        apart_mm = np.abs(np.subtract(outer, inner))
        if apart_mm.max() <= FACES_MM and np.ptp(apart_mm) <= EVEN_MM:
            return np.zeros(len(lines), dtype=bool)
    return is_frame


def _joined_to(is_frame: BoolArray, lines: GeometryArray) -> BoolArray:
    """Which lines are frames or joined to one, directly or through others."""
    one, other = shapely.STRtree(lines).query(lines, predicate="dwithin", distance=CLOSE_GAPS_MM)
    group = linked(np.column_stack((one, other)), len(lines))
    return np.isin(group, group[is_frame])


def _finding(frame: Seen, count: int) -> Finding:
    layer = frame.placed.layer
    return Finding(
        "frame",
        f"a rectangle on layer '{layer}' lies around everything, and no wall comes near it: it is "
        "taken as the frame of the sheet and left out with what is joined to it, "
        f"{count} entities together",
        "draw the floor's outline on a layer FLOOR if it is a wall",
        layer=layer,
        handle=frame.placed.handle,
    )
