"""How a drawing is read, layer by layer, before a plan is made of it."""

from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from satAOI_adapters.dxf_read.entities import features_of
from satAOI_adapters.dxf_read.options import ReadOptions
from satAOI_adapters.dxf_read.plans import clusters
from satAOI_adapters.dxf_read.shapes import middle_line
from satAOI_adapters.dxf_read.survey import Survey, survey
from satAOI_adapters.layers import KINDS, Certainty, Meaning, Verdict
from satAOI_geo.plan import Finding, Frame, Source


@dataclass(frozen=True, slots=True)
class LayerFigures:
    """Entities of one layer that are read alike.

    Attributes:
        layer: Its name.
        meaning: What they are taken for; None where neither layer nor block tells.
        certainty: How sure that is.
        pattern: Pattern of the layer table that tells.
        entities: How many of each type draw lines or areas.
        length_mm: Of all their lines.
        n_hidden: Entities of the layer that are not read since it is frozen or off.
    """

    layer: str
    meaning: Meaning | None
    certainty: Certainty
    pattern: str
    entities: dict[str, int]
    length_mm: float
    n_hidden: int


@dataclass(frozen=True, slots=True)
class PlanFigures:
    """A part of the drawing that may be a plan.

    Attributes:
        number: For `--plan`; 1 is the likeliest and is read if nothing is said.
        bounds: Left, bottom, right, top in drawing units.
    """

    number: int
    bounds: tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Inspection:
    """How a drawing is read.

    Attributes:
        source: The file and its unit.
        version: Of its format, for example AC1024.
        bounds: Left, bottom, right, top of what is drawn, in drawing units.
        size_mm: Width and height of it.
        plans: Parts that may be plans, the likeliest first.
        layers: By name; a layer whose blocks are read differently has several.
        findings: What was skipped, guessed or repaired.
    """

    source: Source
    version: str
    bounds: tuple[float, float, float, float]
    size_mm: tuple[float, float]
    plans: tuple[PlanFigures, ...]
    layers: tuple[LayerFigures, ...]
    findings: tuple[Finding, ...]


@dataclass(slots=True)
class _Tally:
    """Entities of one layer that are read alike, while they are counted."""

    entities: Counter[str] = field(default_factory=Counter)
    length_mm: float = 0.0


def inspect(path: Path, options: ReadOptions) -> Inspection:
    """How a drawing is read with these options.

    Raises:
        InputError: If an option or the layer file is wrong.
        DrawingError: If the drawing cannot be used as it is.
        LimitError: If it asks for more than `limits` allows.
    """
    drawing = survey(path, options)
    frame = drawing.frame()
    tallies: dict[tuple[str, Verdict], _Tally] = {}
    for entity in drawing.seen:
        tally = tallies.setdefault((entity.placed.layer, entity.verdict), _Tally())
        tally.entities[entity.placed.kind] += 1
        drawn = features_of(entity.placed, frame.mm_per_unit, frame.origin_mm)
        tally.length_mm += sum(
            middle_line(path).length for feature in drawn for path in feature.paths
        )
    # a layer of which nothing is seen has a line of its own
    seen = {layer for layer, _ in tallies}
    tallies.update(((layer, Verdict()), _Tally()) for layer in drawing.hidden if layer not in seen)
    left, bottom, right, top = drawing.box
    return Inspection(
        source=Source(str(path), drawing.sha256, "dxf", drawing.unit.name, drawing.unit.source),
        version=drawing.document.dxfversion,
        bounds=drawing.box,
        size_mm=((right - left) * drawing.unit.mm, (top - bottom) * drawing.unit.mm),
        plans=_plans(drawing, frame),
        layers=tuple(
            LayerFigures(
                layer=layer,
                meaning=verdict.meaning,
                certainty=verdict.certainty,
                pattern=verdict.pattern,
                entities=dict(tally.entities.most_common()),
                length_mm=tally.length_mm,
                n_hidden=drawing.hidden[layer],
            )
            for (layer, verdict), tally in sorted(tallies.items(), key=_by_layer)
        ),
        findings=drawing.findings,
    )


def _plans(drawing: Survey, frame: Frame) -> tuple[PlanFigures, ...]:
    """The parts that may be plans, numbered as for `--plan`."""
    found = clusters(drawing.drawn(frame, (*KINDS, Meaning.FLOOR, Meaning.DOOR)))
    return tuple(
        PlanFigures(number, _in_drawing(cluster.bounds_mm, frame))
        for number, cluster in enumerate(found, start=1)
    )


def _in_drawing(
    bounds_mm: tuple[float, float, float, float], frame: Frame
) -> tuple[float, float, float, float]:
    """Bounds in drawing units."""
    left, bottom = frame.to_drawing(bounds_mm[:2]).tolist()
    right, top = frame.to_drawing(bounds_mm[2:]).tolist()
    return left, bottom, right, top


def _by_layer(item: tuple[tuple[str, Verdict], _Tally]) -> tuple[str, str, str]:
    (layer, verdict), _ = item
    return layer.casefold(), layer, verdict.meaning or ""
