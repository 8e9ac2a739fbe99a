"""What a drawing holds that cannot be read: said where it does not matter, else a fault."""

from collections import Counter
from collections.abc import Sequence
from typing import Final

from satAOI_adapters.dxf_read.entities import DRAWN, NO_LINEWORK
from satAOI_adapters.dxf_read.expand import Missing, Placed
from satAOI_adapters.layers import LayerTable
from satAOI_adapters.meanings import KINDS, Meaning
from satAOI_geo.errors import DrawingError
from satAOI_geo.plan import Finding

STOPPING: Final = frozenset({*KINDS, Meaning.FLOOR})
"""Meanings of layers on which nothing may be overlooked."""

BUILDING_PARTS: Final = ("WALL", "COLUMN", "SLAB")
"""Words in the names of other programs' objects (TCH_WALL, AEC_COLUMN) that stop the robot."""


def xref_fault(missing: Sequence[Missing], table: LayerTable) -> DrawingError | None:
    """What is wrong if a reference is missing that the layer file does not call unimportant."""
    needed = [xref for xref in missing if not _is_ignored(xref, table)]
    if not needed:
        return None
    files = ", ".join(sorted({f"'{xref.path or xref.name}'" for xref in needed}))
    return DrawingError(
        f"external references are not loaded: {files}; bind them in the drawing, or save them "
        "as DXF and give their folder with --xref-dir",
        layer=needed[0].layer,
        handle=needed[0].handle,
    )


def xref_findings(missing: Sequence[Missing], table: LayerTable) -> tuple[Finding, ...]:
    """What is to be said about external references that may be missing."""
    return tuple(
        Finding(
            "xref-missing",
            f"external reference '{xref.path or xref.name}' is not loaded and not needed",
            layer=xref.layer,
            handle=xref.handle,
        )
        for xref in missing
        if _is_ignored(xref, table)
    )


def _is_ignored(xref: Missing, table: LayerTable) -> bool:
    by_name, by_layer = table.of_block(xref.name), table.of_layer(xref.layer)
    return Meaning.IGNORE in {by_name.meaning, by_layer.meaning}


def foreign_in(placed: Sequence[Placed]) -> list[Placed]:
    """Objects of other programs, and other types that cannot be read."""
    return [e for e in placed if e.kind not in DRAWN and e.kind not in NO_LINEWORK]


def foreign_fault(foreign: Sequence[Placed], table: LayerTable) -> DrawingError | None:
    """What is wrong if some are on a layer of obstacles or of the floor, or are walls by name."""
    stopping = next((entity for entity in foreign if _may_stop(entity, table)), None)
    if stopping is None:
        return None
    counts = Counter((entity.kind, entity.layer) for entity in foreign)
    said = ", ".join(f"{n} {kind} on layer '{layer}'" for (kind, layer), n in counts.items())
    return DrawingError(
        f"{said} cannot be read, and some may be walls or floor; explode them, or export "
        "the drawing without objects of other programs (TArch: export as T3)",
        layer=stopping.layer,
        handle=stopping.handle,
    )


def foreign_findings(foreign: Sequence[Placed]) -> tuple[Finding, ...]:
    """What is to be said about objects that cannot be read."""
    counts = Counter((entity.kind, entity.layer) for entity in foreign)
    return tuple(
        Finding(
            "entity-unread",
            f"{count} {kind} on layer '{layer}' cannot be read",
            "explode them or export the drawing as lines and polylines",
            layer=layer,
        )
        for (kind, layer), count in counts.items()
    )


def _may_stop(entity: Placed, table: LayerTable) -> bool:
    is_part = any(word in entity.kind for word in BUILDING_PARTS)
    return is_part or table.of_layer(entity.layer).meaning in STOPPING
