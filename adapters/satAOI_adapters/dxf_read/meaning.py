"""What each entity stands for, by its layer and by the block it is in."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

from ezdxf.entities import LWPolyline, Polyline

from satAOI_adapters.dxf_read.expand import Placed
from satAOI_adapters.layers import KINDS, LayerTable, Meaning, Verdict
from satAOI_geo.plan import Finding

LISTED: Final = 5
"""Layers that a message names before it counts the rest."""

TELLING: Final = frozenset(KINDS) - {Meaning.WINDOW}
"""Meanings of which one at least must occur; else no layer tells what stops the robot."""


@dataclass(frozen=True, slots=True)
class Seen:
    """An entity that draws lines or areas, and what it stands for."""

    placed: Placed
    verdict: Verdict


def with_meaning(
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
    is_unnamed = [entity.verdict.meaning is None or _is_face(entity) for entity in seen]
    if any(entity.verdict.meaning in TELLING for entity in seen) or not any(is_unnamed):
        return seen, ()
    as_wall = Verdict(Meaning.WALL)
    return (
        tuple(
            replace(entity, verdict=as_wall) if unnamed else entity
            for entity, unnamed in zip(seen, is_unnamed, strict=True)
        ),
        (_all_walls([e for e, unnamed in zip(seen, is_unnamed, strict=True) if unnamed]),),
    )


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
