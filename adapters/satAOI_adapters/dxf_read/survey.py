"""What a drawing holds, before a plan is made of it: entities, their meaning, unit and size."""

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np
from ezdxf.document import Drawing

from satAOI_adapters.dxf_read import limits
from satAOI_adapters.dxf_read.curves import Arc, Piece, Point
from satAOI_adapters.dxf_read.entities import DRAWN, NO_LINEWORK, Feature, features_of
from satAOI_adapters.dxf_read.estimate import estimate
from satAOI_adapters.dxf_read.expand import Expansion, Placed, expand
from satAOI_adapters.dxf_read.opening import open_drawing
from satAOI_adapters.dxf_read.options import ReadOptions
from satAOI_adapters.dxf_read.units import Unit, unit_of
from satAOI_adapters.layers import KINDS, LayerTable, Meaning, Verdict, layer_table
from satAOI_geo.errors import EmptyPlanError
from satAOI_geo.plan import Finding, Frame

FEET_AND_INCHES: Final = (3, 4)
"""$LUNITS of a drawing that writes lengths in feet and inches."""

LISTED: Final = 5
"""Layers that a message names before it counts the rest."""


@dataclass(frozen=True, slots=True)
class Seen:
    """An entity that is drawn and what it stands for."""

    placed: Placed
    verdict: Verdict


@dataclass(frozen=True, slots=True)
class Survey:
    """What a drawing holds.

    Attributes:
        path: The file.
        sha256: Digest of its bytes.
        document: As ezdxf holds it.
        seen: Visible entities that draw lines or areas, with their meaning.
        hidden: Entities on layers that are frozen or off, by layer.
        unit: The unit of length.
        box: Left, bottom, right, top of what is drawn, in drawing units.
        findings: What was noticed so far.
    """

    path: Path
    sha256: str
    document: Drawing
    seen: tuple[Seen, ...]
    hidden: Counter[str]
    unit: Unit
    box: tuple[float, float, float, float]
    findings: tuple[Finding, ...]

    def frame(self) -> Frame:
        """A frame of whole millimetres at the lower left corner of what is drawn."""
        left_mm, bottom_mm = self.box[0] * self.unit.mm, self.box[1] * self.unit.mm
        origin_mm = (float(math.floor(left_mm)), float(math.floor(bottom_mm)))
        return Frame(origin_mm=origin_mm, mm_per_unit=self.unit.mm)


def survey(path: Path, options: ReadOptions) -> Survey:
    """Open a drawing and say what is in it.

    Raises:
        InputError: If an option or the layer file is wrong.
        DrawingError: If the drawing cannot be used as it is.
        LimitError: If it asks for more than `limits` allows.
    """
    table = layer_table(options.layers)
    opened = open_drawing(path, table, options.encoding)
    expansion = expand(opened.document, include_hidden=options.include_hidden)
    drawn = [placed for placed in expansion.placed if placed.kind in DRAWN]
    seen, fallback = _with_meaning(drawn, table)
    rough = [(e.verdict.meaning, f) for e in seen for f in features_of(e.placed, 1.0, (0.0, 0.0))]
    box = _box(feature for _, feature in rough)
    if box is None:
        raise EmptyPlanError(
            f"'{path.name}' shows nothing in model space that could be a plan; "
            f"{_what_else(expansion)}"
        )
    size = (box[2] - box[0], box[3] - box[1])
    header = opened.document.header
    guess = estimate(
        rough,
        size,
        [placed.entity for placed in expansion.placed if placed.kind not in DRAWN],
        in_feet_and_inches=header.get("$LUNITS", 2) in FEET_AND_INCHES,
    )
    known = unit_of(header.get("$INSUNITS", 0), options.units, guess, size, path.name)
    return Survey(
        path,
        opened.sha256,
        opened.document,
        seen,
        expansion.hidden,
        known.unit,
        box,
        (
            *opened.findings,
            *known.findings,
            *expansion.findings,
            *_hidden(expansion.hidden),
            *_unread(expansion.placed),
            *fallback,
        ),
    )


def verdict_of(placed: Placed, table: LayerTable) -> Verdict:
    """What an entity stands for.

    The layer decides, with two exceptions: what is in a door's block is a door, and where the
    layer says nothing the name of the innermost block that says something decides.
    """
    by_block = _by_block(placed.blocks, table)
    if by_block.meaning is Meaning.DOOR:
        return by_block
    by_layer = table.of_layer(placed.layer)
    return by_block if by_layer.meaning is None else by_layer


def _by_block(blocks: Sequence[str], table: LayerTable) -> Verdict:
    verdicts = (table.of_block(name) for name in reversed(blocks))
    return next((verdict for verdict in verdicts if verdict.meaning is not None), Verdict())


def _with_meaning(
    drawn: Sequence[Placed], table: LayerTable
) -> tuple[tuple[Seen, ...], tuple[Finding, ...]]:
    """Each entity with its meaning; a drawing without any layer of obstacles is all walls."""
    # a drawing has few layers and blocks, and many entities on each
    known: dict[tuple[str, tuple[str, ...]], Verdict] = {}
    for placed in drawn:
        name = (placed.layer, placed.blocks)
        if name not in known:
            known[name] = verdict_of(placed, table)
    seen = tuple(Seen(placed, known[placed.layer, placed.blocks]) for placed in drawn)
    telling = set(KINDS) - {Meaning.WINDOW}
    if any(entity.verdict.meaning in telling for entity in seen):
        return seen, ()
    unnamed = [entity for entity in seen if entity.verdict.meaning is None]
    layers = sorted({entity.placed.layer for entity in unnamed})
    if not layers:
        return seen, ()
    named = ", ".join(f"'{layer}'" for layer in layers[:LISTED])
    more = f" and {len(layers) - LISTED} more" if len(layers) > LISTED else ""
    finding = Finding(
        "all-walls",
        f"no layer is named as one of obstacles: all {len(unnamed)} entities on {named}{more} "
        "are taken as walls",
        "say what the layers are in a file for --layers",
    )
    as_wall = Verdict(Meaning.WALL)
    return (
        tuple(replace(e, verdict=as_wall) if e.verdict.meaning is None else e for e in seen),
        (finding,),
    )


def _box(features: Iterable[Feature]) -> tuple[float, float, float, float] | None:
    """Left, bottom, right, top of all ends and full circles, in drawing units."""
    points = [
        point
        for feature in features
        for path in feature.paths
        for piece in path.pieces
        for point in _spots(piece)
    ]
    if not points:
        return None
    left, bottom = np.min(points, axis=0)
    right, top = np.max(points, axis=0)
    return float(left), float(bottom), float(right), float(top)


def _spots(piece: Piece) -> tuple[Point, ...]:
    """Points that a piece's box is taken from."""
    if isinstance(piece, Arc) and piece.is_full:
        reach_x = math.hypot(piece.u[0], piece.v[0])
        reach_y = math.hypot(piece.u[1], piece.v[1])
        x, y = piece.centre
        return (x - reach_x, y - reach_y), (x + reach_x, y + reach_y)
    return piece.start, piece.end


def _what_else(expansion: Expansion) -> str:
    """What a drawing without linework does hold."""
    if expansion.hidden:
        return (
            f"{sum(expansion.hidden.values())} entities are on layers that are off or frozen: "
            "switch these on or give --include-hidden"
        )
    kinds = Counter(placed.kind for placed in expansion.placed)
    counts = ", ".join(f"{count} {kind}" for kind, count in kinds.most_common(LISTED))
    if any(kind in DRAWN for kind in kinds):
        return f"it holds {counts}, all without any length: check what was exported"
    if kinds:
        return f"it holds {counts}: save the plan as lines and polylines"
    return "it is empty: check that it was saved from the right file"


def _hidden(hidden: Counter[str]) -> Iterable[Finding]:
    for layer, count in hidden.items():
        yield Finding(
            "layer-hidden",
            f"{count} entities on layer '{layer}' are not read: frozen, off or invisible",
            "thaw the layer or give --include-hidden if they are on the floor",
            layer=layer,
        )


def _unread(placed: Iterable[Placed]) -> Iterable[Finding]:
    """Types of entity that this reader does not know."""
    unknown = Counter(
        (entity.kind, entity.layer)
        for entity in placed
        if entity.kind not in DRAWN and entity.kind not in NO_LINEWORK
    )
    for (kind, layer), count in unknown.items():
        yield Finding(
            "entity-unread",
            f"{count} {kind} on layer '{layer}' cannot be read",
            "explode them or export the drawing as lines and polylines",
            layer=layer,
        )


def features(
    survey: Survey, frame: Frame, wanted: Iterable[Meaning | None]
) -> dict[Meaning | None, list[Feature]]:
    """What the entities of some meanings draw, in millimetres of the frame.

    Raises:
        DrawingError: If an entity cannot be read.
        LimitError: If there are too many corners.
    """
    found: dict[Meaning | None, list[Feature]] = {meaning: [] for meaning in wanted}
    n_pieces = 0
    for entity in survey.seen:
        if entity.verdict.meaning not in found:
            continue
        drawn = features_of(entity.placed, frame.mm_per_unit, frame.origin_mm)
        found[entity.verdict.meaning].extend(drawn)
        n_pieces += sum(len(path.pieces) for feature in drawn for path in feature.paths)
        limits.hold("corners", n_pieces, limits.MAX_VERTICES, "simplify the drawing")
    return found
