"""The building's outline on a layer whose name says nothing, where only what stands in it is known.

Where no layer is one of walls or floors, the linework of one layer that encloses what is known to
stand on the floor is where the floor ends.

    ┌────────────────┐
    │ ▯   ▯   ▯   ▯  │  equipment, known by its layer
    │ ▯   ▯   ▯   ▯  │
    └────────────────┘  on a layer that no pattern knows
"""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import shapely

from satAOI_adapters.dxf_read.dashed import dashed_among
from satAOI_adapters.dxf_read.enclosure import enclosed
from satAOI_adapters.dxf_read.estimate import EXTENT
from satAOI_adapters.dxf_read.features import Feature
from satAOI_adapters.dxf_read.frames import is_sheet
from satAOI_adapters.dxf_read.linework import WALL_MM
from satAOI_adapters.dxf_read.lookalikes import BOUNDING, look_like_walls
from satAOI_adapters.dxf_read.meaning import Seen
from satAOI_adapters.dxf_read.plans import rough_lines
from satAOI_adapters.dxf_read.shapes import GeometryArray
from satAOI_adapters.meanings import KINDS, Meaning, Verdict
from satAOI_geo.plan import Finding, Region

MOST: Final = 2 / 3
"""Share of what is known to stand on the floor that an outline must hold."""


@dataclass(frozen=True, slots=True)
class Outline:
    """Linework of one layer that encloses what stands on the floor.

    Attributes:
        drawn: The entities along its rim, with what they draw in drawing units.
        region: What they enclose.
        share: Share of what is known to stand on the floor that lies in it.
        is_faces: Whether it is drawn as the two faces of walls.
        is_sheet: Whether it is a rectangle with something joined to it, as a title block.
    """

    drawn: Sequence[tuple[Seen, Feature]]
    region: Region
    share: float
    is_faces: bool
    is_sheet: bool

    @property
    def layer(self) -> str:
        """Of the linework."""
        return self.drawn[0][0].placed.layer

    @property
    def rank(self) -> tuple[bool, bool, float, str]:
        """The likelier to bound the floor, the less; in doubt the smallest does."""
        return self.is_sheet, not self.is_faces, self.region.area, self.layer

    def said(self) -> str:
        """Its layer and size."""
        return f"'{self.layer}' ({self.region.area / 1e6:.2f} m²)"


def with_boundary(
    near: Sequence[tuple[Seen, Feature]], mm_per_unit: float
) -> tuple[list[tuple[Seen, Feature]], tuple[Finding, ...]]:
    """What is drawn, with an outline around what stands on the floor among the walls.

    Args:
        near: Entities, with what they draw in drawing units.
        mm_per_unit: Millimetres in a drawing unit.
    """
    meanings = {entity.verdict.meaning for entity, _ in near}
    if meanings & BOUNDING or not meanings & set(KINDS):
        return list(near), ()
    outlines = sorted(_outlines(near, mm_per_unit), key=lambda outline: outline.rank)
    if not outlines:
        return list(near), ()
    if outlines[0].is_sheet:
        return list(near), (_not_used(outlines, mm_per_unit),)
    walls = {id(entity) for entity, _ in outlines[0].drawn}
    as_wall = Verdict(Meaning.WALL)
    return (
        [(replace(e, verdict=as_wall) if id(e) in walls else e, f) for e, f in near],
        (_used(outlines, mm_per_unit),),
    )


def _outlines(near: Sequence[tuple[Seen, Feature]], mm_per_unit: float) -> Iterator[Outline]:
    """The outlines on nameless layers, layer by layer, that hold what stands on the floor."""
    known = _in_mm((f for e, f in near if e.verdict.meaning in KINDS), near, mm_per_unit)
    spots = shapely.centroid(known)
    dashed = dashed_among([entity for entity, _ in near])
    by_layer: defaultdict[str, list[tuple[Seen, Feature]]] = defaultdict(list)
    for entity, feature in near:
        is_line = not feature.is_area and id(entity.placed) not in dashed
        if entity.verdict.meaning is None and is_line:
            by_layer[entity.placed.layer].append((entity, feature))
    for drawn in by_layer.values():
        lines = _in_mm((feature for _, feature in drawn), near, mm_per_unit)
        yield from _of_layer(drawn, lines, spots, mm_per_unit)


def _of_layer(
    drawn: Sequence[tuple[Seen, Feature]],
    lines: GeometryArray,
    spots: GeometryArray,
    mm_per_unit: float,
) -> Iterator[Outline]:
    """The outlines on one layer, from the outermost to the innermost.

    Args:
        drawn: The entities, with what they draw in drawing units.
        lines: The same roughly, in millimetres.
        spots: The middles of what stands on the floor.
        mm_per_unit: Millimetres in a drawing unit.
    """
    while lines.size and _may_hold(lines, spots):
        reach = enclosed(list(lines), with_gates=True).region.boundary.buffer(WALL_MM)
        shapely.prepare(reach)
        is_rim = shapely.covers(reach, lines)
        # axes cross what they enclose, and stick out
        region = enclosed(list(lines[is_rim]), with_gates=True).region
        share = float(shapely.dwithin(region, spots, WALL_MM).mean())
        if share < MOST:
            return
        rim = [drawn[k] for k in np.flatnonzero(is_rim).tolist()]
        is_faces = look_like_walls([feature for _, feature in rim], mm_per_unit)
        yield Outline(rim, region, share, is_faces, is_sheet(lines))
        drawn = [drawn[k] for k in np.flatnonzero(~is_rim).tolist()]
        lines = lines[~is_rim]


def _in_mm(
    features: Iterable[Feature], near: Sequence[tuple[Seen, Feature]], mm_per_unit: float
) -> GeometryArray:
    """Roughly what features draw, in millimetres and near the origin."""
    x, y = near[0][1].paths[0].start
    return np.asarray(
        shapely.transform(rough_lines(list(features)), lambda xy: (xy - (x, y)) * mm_per_unit)
    )


def _may_hold(lines: GeometryArray, spots: GeometryArray) -> bool:
    """Whether lines reach around most of some spots, and not farther than any building."""
    left, bottom, right, top = shapely.total_bounds(lines)
    if max(right - left, top - bottom) > EXTENT.most_mm:
        return False
    hull = shapely.convex_hull(shapely.geometrycollections(lines))
    return bool(shapely.dwithin(hull, spots, WALL_MM).mean() >= MOST)


def _used(outlines: Sequence[Outline], mm_per_unit: float) -> Finding:
    chosen, *others = outlines
    more = f"; so do {', '.join(outline.said() for outline in others)}" if others else ""
    return _finding(
        "outline-as-walls",
        f"the linework on layer {chosen.said()} encloses {chosen.share:.0%} of what is known to "
        f"stand on the floor, and is taken for the walls around it{more}",
        chosen,
        mm_per_unit,
    )


def _not_used(outlines: Sequence[Outline], mm_per_unit: float) -> Finding:
    return _finding(
        "outline-not-used",
        f"the linework on layer {' and '.join(outline.said() for outline in outlines)} encloses "
        "most of what is known to stand on the floor, but is taken for the frame of the sheet, "
        "since something is joined to it as a title block",
        outlines[0],
        mm_per_unit,
    )


def _finding(code: str, said: str, outline: Outline, mm_per_unit: float) -> Finding:
    entity, feature = outline.drawn[0]
    x, y = feature.paths[0].start
    return Finding(
        code,
        f"no layer is named as one of walls or floors: {said}",
        "draw the floor's outline on a layer FLOOR, or say what the layers are in a file for "
        "--layers, if the floor ends elsewhere",
        layer=outline.layer,
        handle=entity.placed.handle,
        at_mm=(x * mm_per_unit, y * mm_per_unit),
    )
