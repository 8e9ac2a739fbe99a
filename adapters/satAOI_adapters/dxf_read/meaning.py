"""What each entity stands for, by its layer and by the block it is in."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

from ezdxf.entities import LWPolyline, Polyline

from satAOI_adapters.dxf_read.expand import Placed
from satAOI_adapters.layers import LayerTable
from satAOI_adapters.meanings import KINDS, Certainty, Meaning, Verdict
from satAOI_geo.plan import Finding

LISTED: Final = 5
"""Layers that a message names before it counts the rest."""

FILLS: Final = frozenset({"HATCH", "MPOLYGON", "SOLID", "TRACE"})
"""Types of entity that fill."""

BY_FILLS: Final = (Meaning.WALL, Meaning.COLUMN)
"""What some offices draw by nothing but fills, on layers that are named after these."""

TELLING: Final = frozenset(KINDS) - {Meaning.WINDOW}
"""Meanings of which one at least must occur; else no layer tells what stops the robot."""


@dataclass(frozen=True, slots=True)
class Seen:
    """An entity that draws lines or areas, and what it stands for."""

    placed: Placed
    verdict: Verdict


@dataclass(frozen=True, slots=True)
class Meanings:
    """What the entities of a drawing stand for.

    Attributes:
        seen: The entities.
        is_named: Whether layers tell what stops the robot, rather than everything being walls.
        findings: What was guessed.
    """

    seen: tuple[Seen, ...]
    is_named: bool
    findings: tuple[Finding, ...]


def with_meaning(drawn: Sequence[Placed], table: LayerTable) -> Meanings:
    """Each entity with its meaning; a drawing without any layer of obstacles is all walls."""
    # a drawing has few layers and blocks, and many entities on each
    known: dict[tuple[str, tuple[str, ...]], Verdict] = {}
    for placed in drawn:
        name = (placed.layer, placed.blocks)
        if name not in known:
            known[name] = verdict_of(placed, table)
    seen = [Seen(placed, known[placed.layer, placed.blocks]) for placed in drawn]
    filled: list[Finding] = []
    for meaning in BY_FILLS:
        if all(entity.verdict.meaning is not meaning for entity in seen):
            seen, findings = _with_fills(seen, meaning, table)
            filled.extend(findings)
    is_unnamed = [entity.verdict.meaning is None or _is_face(entity) for entity in seen]
    if any(_tells(entity, table) for entity in seen) or not any(is_unnamed):
        return Meanings(tuple(seen), is_named=True, findings=tuple(filled))
    as_wall = Verdict(Meaning.WALL)
    walls = [entity for entity, unnamed in zip(seen, is_unnamed, strict=True) if unnamed]
    return Meanings(
        tuple(
            replace(entity, verdict=as_wall) if unnamed else entity
            for entity, unnamed in zip(seen, is_unnamed, strict=True)
        ),
        is_named=False,
        findings=(*filled, _all_walls(walls)),
    )


def _with_fills(
    seen: Sequence[Seen], meaning: Meaning, table: LayerTable
) -> tuple[list[Seen], list[Finding]]:
    """The fills of walls, or of columns, on layers of patterns, where nothing else draws these."""
    verdicts = {
        layer: table.of_fill(layer)
        for layer in {e.placed.layer for e in seen if is_ignored_fill(e)}
    }
    told = [
        replace(entity, verdict=verdicts[entity.placed.layer])
        if is_ignored_fill(entity) and verdicts[entity.placed.layer].meaning is meaning
        else entity
        for entity in seen
    ]
    layers = sorted(layer for layer, verdict in verdicts.items() if verdict.meaning is meaning)
    return told, [
        Finding(
            "fills-only",
            f"no layer draws a {meaning} by its lines: the fills on layer '{layer}' are taken as "
            f"{meaning}s",
            "say what the layer is in a file for --layers",
            layer=layer,
        )
        for layer in layers
    ]


def _tells(entity: Seen, table: LayerTable) -> bool:
    """Whether an entity's layer tells what stops the robot.

    A block named as a stair or a column says nothing about the layers around it, unless the user's
    file names it.
    """
    verdict = entity.verdict
    if verdict.meaning not in TELLING:
        return False
    by_layer = table.of_layer(entity.placed.layer)
    return by_layer.meaning is verdict.meaning or verdict.certainty is Certainty.GIVEN


def is_ignored_fill(entity: Seen) -> bool:
    """Whether a fill is left out for its layer; what the user's file leaves out stays out."""
    verdict = entity.verdict
    is_left_out = verdict.meaning is Meaning.IGNORE and verdict.certainty is not Certainty.GIVEN
    return is_left_out and entity.placed.kind in FILLS


def _is_face(entity: Seen) -> bool:
    """Whether an entity is the outline of a room, drawn along the faces of its walls."""
    shape = entity.placed.entity
    is_outline = isinstance(shape, LWPolyline | Polyline) and shape.is_closed
    return entity.verdict.meaning is Meaning.ROOM and is_outline


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


def _all_walls(unnamed: Sequence[Seen]) -> Finding:
    layers = sorted({entity.placed.layer for entity in unnamed})
    named = ", ".join(f"'{layer}'" for layer in layers[:LISTED])
    more = f" and {len(layers) - LISTED} more" if len(layers) > LISTED else ""
    return Finding(
        "all-walls",
        f"no layer is named as one of obstacles: all {len(unnamed)} entities on {named}{more} "
        "are taken as walls",
        "say what the layers are in a file for --layers",
    )
