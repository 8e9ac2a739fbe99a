"""Walls on layers whose names say nothing, told by their look where no other layer has walls.

Where doors, windows, columns or rooms are, there must be walls. Their faces are parallel lines
about as far apart as bricks are thick; hardly anything else in a building consists of these.
Outdoors pipes and kerbs do, and beside layers that are named as walls there is no need: nothing is
told by its look there.
"""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from satAOI_adapters.dxf_read.estimate import WALLS, beside
from satAOI_adapters.dxf_read.features import Feature
from satAOI_adapters.dxf_read.meaning import Seen
from satAOI_adapters.meanings import Meaning, Verdict
from satAOI_geo.plan import Finding

MOSTLY: Final = 0.5
"""Share of a layer's straight lines, by length, that must have another as a wall's face has."""

ENOUGH_MM: Final = 8000.0
"""And so long they must be together: the faces of a room's shorter walls."""

IN_WALLS: Final = frozenset({Meaning.DOOR, Meaning.WINDOW, Meaning.COLUMN, Meaning.ROOM})
"""Meanings of which one on any layer tells that there are walls."""

BOUNDING: Final = frozenset({Meaning.WALL, Meaning.FLOOR})
"""Meanings of which one on any layer makes looks unnecessary."""


def with_lookalikes(
    near: Sequence[tuple[Seen, Feature]], mm_per_unit: float
) -> tuple[list[tuple[Seen, Feature]], tuple[Finding, ...]]:
    """What is drawn, with the walls that are told by their look.

    Args:
        near: Entities, with what they draw in drawing units.
        mm_per_unit: Millimetres in a drawing unit.
    """
    meanings = {entity.verdict.meaning for entity, _ in near}
    if meanings & BOUNDING or not meanings & IN_WALLS:
        return list(near), ()
    unknown: defaultdict[str, list[Feature]] = defaultdict(list)
    for entity, feature in near:
        if entity.verdict.meaning is None:
            unknown[entity.placed.layer].append(feature)
    walls = [layer for layer, drawn in unknown.items() if look_like_walls(drawn, mm_per_unit)]
    as_wall = Verdict(Meaning.WALL)
    told = {
        id(entity): replace(entity, verdict=as_wall)
        for entity, _ in near
        if entity.verdict.meaning is None and entity.placed.layer in walls
    }
    return (
        [(told.get(id(entity), entity), feature) for entity, feature in near],
        tuple(_finding(layer, len(unknown[layer])) for layer in sorted(walls)),
    )


def look_like_walls(drawn: Sequence[Feature], mm_per_unit: float) -> bool:
    """Whether most straight lines, given in drawing units, run side by side as wall faces do."""
    lengths, distances = beside(drawn)
    lengths_mm, thicknesses_mm = lengths * mm_per_unit, distances * mm_per_unit
    is_face = (thicknesses_mm >= WALLS.least_mm) & (thicknesses_mm <= WALLS.most_mm)
    faces_mm = float(lengths_mm[is_face].sum())
    return faces_mm >= max(ENOUGH_MM, MOSTLY * float(lengths_mm.sum()))


def _finding(layer: str, count: int) -> Finding:
    return Finding(
        "walls-by-look",
        f"no layer is named as one of walls: the {count} shapes on layer '{layer}' are taken as "
        "walls, since most of their lines run side by side as the faces of walls do",
        "say what the layer is in a file for --layers",
        layer=layer,
    )
