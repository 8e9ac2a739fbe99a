"""Doors on layers that are left out: they open nothing, and where walls are whole that is said.

Some programs draw doors as furniture. What is furniture says nothing about walls, and so these stay
as they are drawn.
"""

from collections import defaultdict
from collections.abc import Sequence
from typing import Final

from satAOI_adapters.dxf_read.curves import Arc
from satAOI_adapters.dxf_read.entities import features_of
from satAOI_adapters.dxf_read.features import Feature
from satAOI_adapters.dxf_read.meaning import Seen
from satAOI_adapters.dxf_read.openings import over_whole_walls
from satAOI_adapters.dxf_read.swings import may_be_swing, swings
from satAOI_adapters.dxf_read.terms import Terms
from satAOI_adapters.meanings import Certainty, Meaning
from satAOI_adapters.wording import counted
from satAOI_geo.plan import Finding, Kind, Obstacle

DRAW_DOORS: Final = frozenset({"ARC", "LINE", "LWPOLYLINE", "POLYLINE"})
"""Types of entity that leaves and swings are drawn as."""


def left_out_doors(
    seen: Sequence[Seen], standing: Sequence[Obstacle], terms: Terms
) -> list[Finding]:
    """What is to be said about doors on layers that the built-in table leaves out.

    Args:
        seen: The entities of the drawing.
        standing: What stops the robot.
        terms: The terms of the reading.
    """
    drawn: defaultdict[str, list[Feature]] = defaultdict(list)
    for entity in seen:
        if _is_left_out(entity) and entity.placed.kind in DRAW_DOORS:
            features = features_of(entity.placed, terms.frame.mm_per_unit, terms.frame.origin_mm)
            drawn[entity.placed.layer].extend(features)
    walls = [obstacle.region() for obstacle in standing if obstacle.kind is Kind.WALL]
    found: list[Finding] = []
    for layer in sorted(drawn):
        spans = over_whole_walls(swings(drawn[layer]), walls) if _swings(drawn[layer]) else []
        if spans:
            found.append(_finding(layer, [terms.place(span.start) for span in spans]))
    return found


def _is_left_out(entity: Seen) -> bool:
    # what the user leaves out needs no word
    verdict = entity.verdict
    return verdict.meaning is Meaning.IGNORE and verdict.certainty is not Certainty.GIVEN


def _swings(drawn: Sequence[Feature]) -> bool:
    """Whether any arc may be a door's, which few layers have that are left out."""
    pieces = (piece for feature in drawn for path in feature.paths for piece in path.pieces)
    return any(isinstance(piece, Arc) and may_be_swing(piece) for piece in pieces)


def _finding(layer: str, places_mm: Sequence[tuple[float, float]]) -> Finding:
    x_mm, y_mm = min(places_mm)
    lie = "lies over a wall" if len(places_mm) == 1 else "lie over walls, the first"
    return Finding(
        "door-left-out",
        f"{counted(len(places_mm), 'door')} on layer '{layer}', which is left out, {lie} at "
        f"({x_mm:.1f}, {y_mm:.1f}) mm: the walls stay closed",
        "break the walls in the drawing, or draw the doors on a layer of doors",
        layer=layer,
        at_mm=(x_mm, y_mm),
    )
