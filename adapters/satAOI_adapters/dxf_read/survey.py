"""What a drawing holds, before a plan is made of it: entities, their meaning, unit and size."""

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from ezdxf.document import Drawing
from shapely.geometry import Polygon

from satAOI_adapters.dxf_read import limits
from satAOI_adapters.dxf_read.boundary import with_boundary
from satAOI_adapters.dxf_read.curves import Point
from satAOI_adapters.dxf_read.dashed import dashed_among
from satAOI_adapters.dxf_read.entities import DRAWN, features_of, mask_of
from satAOI_adapters.dxf_read.estimate import estimate
from satAOI_adapters.dxf_read.expand import Expansion, Placed, expand
from satAOI_adapters.dxf_read.features import Feature
from satAOI_adapters.dxf_read.finite import not_finite
from satAOI_adapters.dxf_read.frames import without_frames
from satAOI_adapters.dxf_read.joints import with_tiles
from satAOI_adapters.dxf_read.lookalikes import with_lookalikes
from satAOI_adapters.dxf_read.meaning import LISTED, Seen, verdict_of, with_meaning
from satAOI_adapters.dxf_read.opening import open_drawing
from satAOI_adapters.dxf_read.options import ReadOptions
from satAOI_adapters.dxf_read.plans import Drawn
from satAOI_adapters.dxf_read.strays import Box, without_strays
from satAOI_adapters.dxf_read.units import Known, Unit, unit_of
from satAOI_adapters.dxf_read.unread import (
    foreign_fault,
    foreign_findings,
    foreign_in,
    xref_fault,
    xref_findings,
)
from satAOI_adapters.dxf_read.xrefs import xrefs_in
from satAOI_adapters.layers import LayerTable, layer_table
from satAOI_adapters.meanings import Certainty, Meaning
from satAOI_adapters.wording import are, counted
from satAOI_geo.errors import DrawingError, EmptyPlanError, UnitError
from satAOI_geo.plan import Finding, Frame, Source

FEET_AND_INCHES: Final = (3, 4)
"""$LUNITS of a drawing that writes lengths in feet and inches."""

OWN_PREFIX: Final = "SATAOI-"
"""Layers of this program's own output, of which some are frozen; a plan needs none of them."""

NO_UNIT: Final = 0
"""$INSUNITS of a drawing that does not say."""


@dataclass(frozen=True, slots=True)
class Survey:
    """What a drawing holds.

    Attributes:
        path: The file.
        sha256: Digest of its bytes.
        encoding: Of the names in it; empty for a binary file.
        document: As ezdxf holds it.
        seen: Visible entities that draw lines or areas, with their meaning.
        expansion: All that the drawing shows, hides or lacks.
        known: The unit of length and what is to be said about it, or why it is not known; the
            layers can be told without it.
        box: Left, bottom, right, top of what is drawn, in drawing units; None if nothing is.
        door_blocks: Names of blocks that are doors.
        door_masks: Masks on door layers and in doors' blocks.
        dashed: Identities of what is drawn dashed on layers of walls, doors or without a meaning.
        is_named: Whether layers tell what stops the robot, rather than everything being walls.
        middle: In the midst of it, in drawing units; a few strays do not move it.
        noticed: What was noticed so far, the unit aside.
        unread: What shows something that cannot be read.
        fault: Why no plan can come of it, whatever the unit; the layers can be told all the same.
    """

    path: Path
    sha256: str
    encoding: str
    document: Drawing
    seen: tuple[Seen, ...]
    expansion: Expansion
    known: Known | UnitError
    box: Box | None
    middle: Point
    door_blocks: frozenset[str]
    door_masks: tuple[Placed, ...]
    dashed: frozenset[int]
    is_named: bool
    noticed: tuple[Finding, ...]
    unread: tuple[Placed, ...]
    fault: DrawingError | None

    @property
    def unit(self) -> Unit:
        """The unit of length.

        Raises:
            UnitError: If it is not known.
        """
        if isinstance(self.known, UnitError):
            raise self.known
        return self.known.unit

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What was noticed so far."""
        of_unit = () if isinstance(self.known, UnitError) else self.known.findings
        return (*of_unit, *self.noticed)

    def has(self, meaning: Meaning) -> bool:
        """Whether anything of a meaning is drawn."""
        return any(entity.verdict.meaning is meaning for entity in self.seen)

    def source(self) -> Source:
        """The file and its unit.

        Raises:
            UnitError: If the unit is not known.
        """
        return Source(
            str(self.path),
            self.sha256,
            "dxf",
            self.unit.name,
            self.unit.source,
            encoding=self.encoding,
        )

    def frame(self) -> Frame:
        """A frame of whole millimetres in the midst of what is drawn.

        Raises:
            UnitError: If the unit is not known.
        """
        return self.frame_in(self.unit.mm)

    def frame_in(self, mm_per_unit: float) -> Frame:
        """The same, were the unit as long as this."""
        x_mm, y_mm = self.middle[0] * mm_per_unit, self.middle[1] * mm_per_unit
        origin_mm = (float(math.floor(x_mm)), float(math.floor(y_mm)))
        return Frame(origin_mm=origin_mm, mm_per_unit=mm_per_unit)

    def given_layers(self, meaning: Meaning) -> frozenset[str]:
        """The layers to which the user's own file gives a meaning."""
        return frozenset(
            entity.placed.layer
            for entity in self.seen
            if entity.verdict.meaning is meaning and entity.verdict.certainty is Certainty.GIVEN
        )

    def drawn(self, frame: Frame, wanted: Iterable[Meaning | None]) -> Drawn:
        """What the entities of some meanings draw, in millimetres of the frame.

        Raises:
            DrawingError: If an entity cannot be read.
            LimitError: If there are too many corners.
        """
        found: Drawn = {meaning: [] for meaning in wanted}
        own = [entity for entity in self.seen if entity.verdict.meaning in found]
        for entity, features in drawn_by(own, frame):
            found[entity.verdict.meaning].extend(features)
        return found

    def masks_of_doors(self, frame: Frame) -> list[Polygon]:
        """What masks of doors hide, in millimetres of a frame."""
        hulls = [mask_of(mask, frame.mm_per_unit, frame.origin_mm) for mask in self.door_masks]
        return [hull for hull in hulls if isinstance(hull, Polygon)]


def drawn_by(entities: Iterable[Seen], frame: Frame) -> Iterator[tuple[Seen, list[Feature]]]:
    """What each of some entities draws, in millimetres of a frame.

    Raises:
        DrawingError: If an entity cannot be read.
        LimitError: If there are too many corners.
    """
    n_pieces = 0
    for entity in entities:
        features = features_of(entity.placed, frame.mm_per_unit, frame.origin_mm)
        n_pieces += sum(len(path.pieces) for feature in features for path in feature.paths)
        limits.hold("corners", n_pieces, limits.MAX_VERTICES, "simplify the drawing")
        yield entity, features


def survey(path: Path, options: ReadOptions) -> Survey:
    """Open a drawing and say what is in it, and why no plan can come of it if that is so.

    Raises:
        InputError: If an option or the layer file is wrong.
        DrawingError: If the file or its blocks cannot be resolved.
        LimitError: If it asks for more than `limits` allows.
    """
    table = layer_table(options.layers)
    opened = open_drawing(path, table, options.encoding)
    expansion = expand(
        opened.document,
        xrefs=xrefs_in(options.xref_dir, table),
        include_hidden=options.include_hidden,
    )
    foreign = foreign_in(expansion.placed)
    drawn = [placed for placed in expansion.placed if placed.kind in DRAWN]
    meanings = with_meaning(drawn, table)
    rough, broken = _in_drawing_units(meanings.seen)
    near, box, middle, strays = without_strays(rough)
    known = _unit(opened.document, near, box, expansion, option=options.units, name=path.name)
    near, by_look = _looked_at(near, known, is_named=meanings.is_named)
    seen = tuple({id(entity): entity for entity, _ in near}.values())
    return Survey(
        path=path,
        sha256=opened.sha256,
        encoding=opened.encoding,
        document=opened.document,
        seen=seen,
        expansion=expansion,
        known=known,
        box=box,
        middle=middle,
        door_blocks=_door_blocks(meanings.seen, table),
        door_masks=_door_masks(expansion.placed, table),
        dashed=dashed_among(seen),
        is_named=meanings.is_named,
        noticed=(
            *opened.findings,
            *expansion.findings,
            *_hidden(expansion),
            *_mistaken(table, opened.document, expansion),
            *xref_findings(expansion.missing, table),
            *foreign_findings(foreign),
            *strays,
            *meanings.findings,
            *by_look,
        ),
        unread=(*foreign, *(entity for entity, _ in broken)),
        fault=(
            expansion.fault
            or xref_fault(expansion.missing, table)
            or foreign_fault(foreign, table)
            or next((fault for _, fault in broken), None)
            or (None if near else _empty(path.name, expansion))
        ),
    )


def _unit(
    document: Drawing,
    near: Sequence[tuple[Seen, Feature]],
    box: Box | None,
    expansion: Expansion,
    *,
    option: str | None,
    name: str,
) -> Known | UnitError:
    """The unit of length, or why it is not known."""
    left, bottom, right, top = box or (0.0, 0.0, 0.0, 0.0)
    size = (right - left, top - bottom)
    header = document.header
    guess = estimate(
        [(entity.verdict.meaning, feature) for entity, feature in near],
        size,
        [placed.entity for placed in expansion.placed if placed.kind not in DRAWN],
        in_feet_and_inches=header.get("$LUNITS", 2) in FEET_AND_INCHES,
    )
    try:
        return unit_of(header.get("$INSUNITS", NO_UNIT), option, guess, size, name)
    except UnitError as error:
        return error


def _looked_at(
    near: list[tuple[Seen, Feature]], known: Known | UnitError, *, is_named: bool
) -> tuple[list[tuple[Seen, Feature]], tuple[Finding, ...]]:
    """What is drawn, with the meanings that only its look tells, once the unit is known."""
    if isinstance(known, UnitError):
        return near, ()
    # what looks like walls may have a frame around it, which no tile has
    of_named = (with_lookalikes, with_boundary, without_frames)
    findings: list[Finding] = []
    for stage in of_named if is_named else (without_frames, with_tiles):
        near, said = stage(near, known.unit.mm)
        findings.extend(said)
    return near, tuple(findings)


def _door_blocks(seen: Iterable[Seen], table: LayerTable) -> frozenset[str]:
    names = {name for entity in seen for name in entity.placed.blocks}
    return frozenset(name for name in names if table.of_block(name).meaning is Meaning.DOOR)


def _door_masks(placed: Iterable[Placed], table: LayerTable) -> tuple[Placed, ...]:
    masks = (e for e in placed if e.kind == "WIPEOUT" and not not_finite(e.entity))
    return tuple(mask for mask in masks if verdict_of(mask, table).meaning is Meaning.DOOR)


def _in_drawing_units(
    seen: Iterable[Seen],
) -> tuple[list[tuple[Seen, Feature]], list[tuple[Placed, DrawingError]]]:
    """What is drawn, to measure it before the unit is known, and what cannot be read."""
    rough: list[tuple[Seen, Feature]] = []
    broken: list[tuple[Placed, DrawingError]] = []
    for entity in seen:
        try:
            drawn = features_of(entity.placed, 1.0, (0.0, 0.0))
        except DrawingError as error:
            broken.append((entity.placed, error))
        else:
            rough.extend((entity, feature) for feature in drawn)
    return rough, broken


def _empty(name: str, expansion: Expansion) -> EmptyPlanError:
    return EmptyPlanError(
        f"'{name}' shows nothing in model space that could be a plan; {_what_else(expansion)}"
    )


def _what_else(expansion: Expansion) -> str:
    """What a drawing without linework does hold."""
    if expansion.hidden:
        count = sum(expansion.hidden.values())
        return (
            f"{counted(count, 'entity', 'entities')} {are(count)} on layers that are off or "
            "frozen: switch these on or give --include-hidden"
        )
    if expansion.invisible:
        return (
            f"{counted(sum(expansion.invisible.values()), 'entity', 'entities')} in it cannot be "
            "seen: make them visible in the drawing"
        )
    kinds = Counter(placed.kind for placed in expansion.placed)
    counts = ", ".join(f"{count} {kind}" for kind, count in kinds.most_common(LISTED))
    if any(kind in DRAWN for kind in kinds):
        return f"it holds {counts}, all without any length: check what was exported"
    if kinds:
        return f"it holds {counts}: save the plan as lines and polylines"
    return "it is empty: check that it was saved from the right file"


def _mistaken(table: LayerTable, document: Drawing, expansion: Expansion) -> Iterator[Finding]:
    """Names in the user's layer file that no layer has: most often they are mistyped."""
    # a layer need not be in the drawing's table to have something on it
    layers = {layer.dxf.name for layer in document.layers}
    layers |= {placed.layer for placed in expansion.placed}
    layers |= {reference.layer for reference in expansion.missing}
    layers |= {*expansion.hidden, *expansion.invisible}
    names = table.names_not_among(layers)
    if names:
        listed = ", ".join(f"'{name}'" for name in names[:LISTED])
        rest = len(names) - LISTED
        more = f" and {counted(rest, 'other')}" if rest > 0 else ""
        yield Finding(
            "layer-unknown",
            f"no layer of the drawing has a name that the layer file gives: {listed}{more}",
            "correct it there; 'inspect' lists the layers",
        )


def _hidden(expansion: Expansion) -> Iterable[Finding]:
    """What is not shown, and so not read, by layer."""
    for counts, code, why, remedy in (
        (
            expansion.hidden,
            "layer-hidden",
            "the layer is frozen or off",
            "thaw the layer or give --include-hidden if they are on the floor",
        ),
        (
            expansion.invisible,
            "entity-invisible",
            "invisible themselves",
            "make them visible in the drawing if they are on the floor",
        ),
    ):
        for layer, count in counts.items():
            if not layer.upper().startswith(OWN_PREFIX):
                message = (
                    f"{counted(count, 'entity', 'entities')} on layer '{layer}' {are(count)} not "
                    f"read: {why}"
                )
                yield Finding(code, message, remedy, layer=layer)
