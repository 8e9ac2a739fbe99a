"""How a drawing is read, layer by layer, and what plan comes of it."""

from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import shapely
from shapely.geometry.base import BaseGeometry

from satAOI_adapters.dxf_read.features import Feature
from satAOI_adapters.dxf_read.meaning import Seen, verdict_of
from satAOI_adapters.dxf_read.obstacles import area_of
from satAOI_adapters.dxf_read.options import ReadOptions
from satAOI_adapters.dxf_read.plans import Drawn, clusters
from satAOI_adapters.dxf_read.reading import plan_of
from satAOI_adapters.dxf_read.shapes import middle_line, shapes_of
from satAOI_adapters.dxf_read.survey import Survey, drawn_by, survey
from satAOI_adapters.inspected import Bounds, Inspected, Sketch
from satAOI_adapters.layers import LayerTable, layer_table, without_xref_prefix
from satAOI_adapters.meanings import KINDS, Certainty, LayerMap, Meaning, Named, Verdict
from satAOI_geo.errors import SatAoiError, UnitError
from satAOI_geo.plan import Finding, FloorPlan, Frame, Kind, Source, geometry_of

if TYPE_CHECKING:
    from shapely.geometry import LineString

PART_SIGNS = (*KINDS, Meaning.FLOOR, Meaning.DOOR)
"""Meanings that tell parts of a drawing from one another."""

XREF = "external reference"
"""Said of a reference that is not loaded."""


@dataclass(frozen=True, slots=True)
class LayerFigures:
    """Entities of one layer that are read alike.

    Attributes:
        layer: Its name.
        meaning: What they are taken for; None where neither layer nor block tells.
        certainty: How sure that is.
        pattern: Pattern of the layer table that tells.
        entities: How many of each type draw lines or areas.
        area_mm2: That their fills and closed outlines cover, overlaps counted once; None where
            the unit is not known.
        length_mm: Of all their lines; None where the unit is not known.
        n_hidden: Entities of the layer that are not read since it is frozen or off.
        unread: How many of each type show something that cannot be read.
    """

    layer: str
    meaning: Meaning | None
    certainty: Certainty
    pattern: str
    entities: dict[str, int]
    area_mm2: float | None
    length_mm: float | None
    n_hidden: int
    unread: dict[str, int]


@dataclass(frozen=True, slots=True)
class PlanFigures:
    """A part of the drawing that may be a plan.

    Attributes:
        number: For `--plan`; 1 is the likeliest and is read if nothing is said.
        bounds: Left, bottom, right, top in drawing units.
        size_mm: Width and height.
    """

    number: int
    bounds: Bounds
    size_mm: tuple[float, float]


@dataclass(frozen=True, slots=True)
class Inspection:
    """How a drawing is read.

    Attributes:
        source: The file and its unit; the unit is empty where it is not known.
        version: Of its format, for example AC1024.
        bounds: Left, bottom, right, top of what is drawn, in drawing units; None if nothing is.
        size_mm: Width and height of it; None where that or the unit is not known.
        plans: Parts that may be plans, the likeliest first; none where the unit is not known.
        layers: By name; a layer whose blocks are read differently has several.
        findings: What was skipped, guessed or repaired.
        error: Why the drawing cannot be used as it is; empty where it can.
    """

    source: Source
    version: str
    bounds: Bounds | None
    size_mm: tuple[float, float] | None
    plans: tuple[PlanFigures, ...]
    layers: tuple[LayerFigures, ...]
    findings: tuple[Finding, ...]
    error: str


@dataclass(slots=True)
class _Tally:
    """What is drawn by entities that are read alike, while it is counted."""

    entities: Counter[str] = field(default_factory=Counter)
    features: list[Feature] = field(default_factory=list)
    unread: Counter[str] = field(default_factory=Counter)


def inspect(path: Path, options: ReadOptions) -> Inspected[Inspection]:
    """How a drawing is read with these options.

    A drawing that holds no plan as it is is told of as far as it goes, with the error that reading
    it ends with.

    Raises:
        InputError: If an option or the layer file is wrong.
        DrawingError: If nothing can be told of the drawing: it is no DXF, or its blocks contain
            themselves.
        LimitError: If it asks for more than `limits` allows.
    """
    drawing = survey(path, options)
    plan, error = _plan_or_error(drawing, options)
    is_measured = not isinstance(drawing.known, UnitError)
    # without a unit the drawing can still be seen, if not measured
    frame = drawing.frame() if is_measured else drawing.frame_in(1.0)
    drawn = list(drawn_by(drawing.seen, frame))
    sketch = _sketch(drawn, frame, with_parts=is_measured)
    findings = drawing.findings if plan is None else plan.findings
    table = layer_table(options.layers)
    tallies = _tallies(drawn, drawing, table)
    figures = Inspection(
        source=_source(drawing),
        version=drawing.document.dxfversion,
        bounds=drawing.box,
        size_mm=_size(drawing.box, frame.mm_per_unit) if is_measured and drawing.box else None,
        plans=_plans(sketch),
        layers=_layers(tallies, drawing.expansion.hidden, is_measured=is_measured),
        findings=findings,
        error="" if error is None else str(error),
    )
    return Inspected(figures, findings, plan, error, sketch, _layer_map(drawing, table))


def _plan_or_error(
    drawing: Survey, options: ReadOptions
) -> tuple[FloorPlan | None, SatAoiError | None]:
    try:
        return plan_of(drawing, options), None
    except SatAoiError as error:
        return None, error


def _source(drawing: Survey) -> Source:
    if isinstance(drawing.known, UnitError):
        return Source(str(drawing.path), drawing.sha256, "dxf", unit="", unit_source="unknown")
    return drawing.source()


def _tallies(
    drawn: Iterable[tuple[Seen, list[Feature]]], drawing: Survey, table: LayerTable
) -> dict[tuple[str, Verdict], _Tally]:
    """What each layer holds, by what it is taken for."""
    tallies: dict[tuple[str, Verdict], _Tally] = {}
    for entity, features in drawn:
        tally = tallies.setdefault((entity.placed.layer, entity.verdict), _Tally())
        tally.entities[entity.placed.kind] += 1
        tally.features.extend(features)
    for placed in drawing.unread:
        key = (placed.layer, verdict_of(placed, table))
        tallies.setdefault(key, _Tally()).unread[placed.kind] += 1
    for missing in drawing.expansion.missing:
        key = (missing.layer, table.of_layer(missing.layer))
        tallies.setdefault(key, _Tally()).unread[XREF] += 1
    return tallies


def _layers(
    tallies: Mapping[tuple[str, Verdict], _Tally], hidden: Counter[str], *, is_measured: bool
) -> tuple[LayerFigures, ...]:
    seen = {layer for layer, _ in tallies}
    # a layer of which nothing is seen has a line of its own
    unseen = {(layer, Verdict()): _Tally() for layer in hidden if layer not in seen}
    return tuple(
        LayerFigures(
            layer=layer,
            meaning=verdict.meaning,
            certainty=verdict.certainty,
            pattern=verdict.pattern,
            entities=dict(tally.entities.most_common()),
            area_mm2=_area_mm2(tally.features) if is_measured else None,
            length_mm=_length_mm(tally.features) if is_measured else None,
            n_hidden=hidden[layer],
            unread=dict(tally.unread.most_common()),
        )
        for (layer, verdict), tally in sorted({**tallies, **unseen}.items(), key=_by_layer)
    )


def _by_layer(item: tuple[tuple[str, Verdict], _Tally]) -> tuple[str, str, str]:
    (layer, verdict), _ = item
    return layer.casefold(), layer, verdict.meaning or ""


def _length_mm(features: Iterable[Feature]) -> float:
    lengths_mm = (middle_line(path).length for feature in features for path in feature.paths)
    return float(sum(lengths_mm))


def _area_mm2(features: Iterable[Feature]) -> float:
    covered = [region for feature in features for region in _covered(feature)]
    return float(shapely.union_all(covered).area)


def _covered(feature: Feature) -> list[BaseGeometry]:
    """What a fill, a line with a width, or closed outlines cover."""
    if feature.is_area or feature.width_mm:
        shapes = area_of(feature)
    else:
        shapes = [s for path in feature.paths if path.closed for s in shapes_of(path)]
    return [geometry_of(shape) for shape in shapes]


def _sketch(
    drawn: Iterable[tuple[Seen, list[Feature]]], frame: Frame, *, with_parts: bool
) -> Sketch:
    """All lines, by the kind of obstacle that they are drawn as."""
    lines: defaultdict[Kind | None, list[LineString]] = defaultdict(list)
    telling: Drawn = {meaning: [] for meaning in PART_SIGNS}
    for entity, features in drawn:
        meaning = entity.verdict.meaning
        kind = None if meaning is None else KINDS.get(meaning)
        lines[kind].extend(middle_line(path) for f in features for path in f.paths)
        if meaning in telling:
            telling[meaning].extend(features)
    parts = clusters(telling) if with_parts else []
    return Sketch(frame, lines, [part.bounds_mm for part in parts])


def _plans(sketch: Sketch) -> tuple[PlanFigures, ...]:
    """The parts that may be plans, numbered as for `--plan`."""
    return tuple(
        PlanFigures(number, _in_drawing(bounds_mm, sketch.frame), _size(bounds_mm, 1.0))
        for number, bounds_mm in enumerate(sketch.parts_mm, start=1)
    )


def _in_drawing(bounds_mm: Bounds, frame: Frame) -> Bounds:
    """Bounds in drawing units."""
    left, bottom = frame.to_drawing(bounds_mm[:2]).tolist()
    right, top = frame.to_drawing(bounds_mm[2:]).tolist()
    return left, bottom, right, top


def _size(bounds: Bounds, mm_per_unit: float) -> tuple[float, float]:
    """Width and height in millimetres."""
    left, bottom, right, top = bounds
    return (right - left) * mm_per_unit, (top - bottom) * mm_per_unit


def _layer_map(drawing: Survey, table: LayerTable) -> LayerMap:
    """What the layers and blocks of the drawing mean by their names."""
    layers: defaultdict[str, Counter[str]] = defaultdict(Counter)
    blocks: defaultdict[str, Counter[str]] = defaultdict(Counter)
    for placed in drawing.expansion.placed:
        layers[without_xref_prefix(placed.layer)][placed.kind] += 1
        for name in placed.blocks:
            blocks[without_xref_prefix(name)][placed.kind] += 1
    for layer, n_hidden in drawing.expansion.hidden.items():
        layers[without_xref_prefix(layer)]["hidden"] += n_hidden
    for missing in drawing.expansion.missing:
        layers[without_xref_prefix(missing.layer)]["reference"] += 1
        blocks[without_xref_prefix(missing.name)]["reference"] += 1
    return LayerMap(
        layers=_named(layers, table.of_layer),
        blocks=tuple(b for b in _named(blocks, table.of_block) if b.verdict.meaning is not None),
        is_own=table.is_own,
    )


def _named(
    counts: Mapping[str, Counter[str]], verdict_of: Callable[[str], Verdict]
) -> tuple[Named, ...]:
    """Names in order, each with what it means and what is drawn under it."""
    return tuple(
        Named(name, verdict_of(name), dict(counts[name].most_common()))
        for name in sorted(counts, key=lambda name: (name.casefold(), name))
    )
