"""Marks of doors: a text beside an opening that says what is in it and how wide it is.

Chinese drawings mark doors with letters that end in M and windows with letters that end in C, and
a door with a window beside it with MC or MLC; then come the width and the height in decimetres.
JLM4045 is a roller shutter of 4.0 × 4.5 m, C1515 a window.
"""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

from ezdxf.entities import DXFEntity, MText, Text
from ezdxf.math import Vec3

from satAOI_adapters.dxf_read.curves import Point
from satAOI_adapters.dxf_read.expand import Placed
from satAOI_adapters.dxf_read.finite import not_finite
from satAOI_adapters.dxf_read.placement import Placement
from satAOI_geo.plan import Frame

MARK: Final = re.compile(
    r"(?P<letters>[A-Z]{0,4}[MC])[甲乙丙]?-?(?P<width>\d{1,2})\d\d[甲乙丙A-Z]?"
)
"""Letters, the rating of a fire door, width, height, and a letter that tells variants apart."""

DOOR: Final = re.compile(r"[A-Z]*M(L?C)?")
"""Letters of a mark that say that there is a door."""

DECIMETRE_MM: Final = 100.0


@dataclass(frozen=True, slots=True)
class Mark:
    """A text that says what is in an opening.

    Attributes:
        text: As it is written.
        at: Where it is.
        is_door: Whether there is a door, be it with a window beside it.
        width_mm: Of the opening.
    """

    text: str
    at: Point
    is_door: bool
    width_mm: float

    def fits(self, width_mm: float) -> bool:
        """Whether an opening is as wide as the mark says, which it does in decimetres."""
        return abs(width_mm - self.width_mm) <= DECIMETRE_MM


def marks_of(placed: Iterable[Placed], frame: Frame) -> list[Mark]:
    """The marks among the entities of a drawing, in millimetres of a frame."""
    found = []
    for entity in placed:
        text = _text(entity.entity).strip()
        mark = MARK.fullmatch(text.upper())
        if mark and not not_finite(entity.entity):
            is_door = DOOR.fullmatch(mark["letters"]) is not None
            width_mm = int(mark["width"]) * DECIMETRE_MM
            found.append(Mark(text, _place(entity, frame), is_door=is_door, width_mm=width_mm))
    return found


def places_of_texts(placed: Iterable[Placed], frame: Frame) -> list[Point]:
    """Where a drawing says something, in millimetres of a frame."""
    return [
        _place(entity, frame)
        for entity in placed
        if _text(entity.entity).strip() and not not_finite(entity.entity)
    ]


def are_believed(marks: Sequence[Mark]) -> bool:
    """Whether a drawing marks its openings: one text alone may name a machine or a room."""
    doors_at = {mark.at for mark in marks if mark.is_door}
    return bool(doors_at) and (len(doors_at) > 1 or not all(mark.is_door for mark in marks))


def _text(entity: DXFEntity) -> str:
    """What a text says; empty for anything else."""
    if isinstance(entity, MText):
        return str(entity.plain_text(split=False))
    return entity.plain_text() if entity.dxftype() == "TEXT" and isinstance(entity, Text) else ""


def _place(placed: Placed, frame: Frame) -> Point:
    """Where a text begins, or what it is aligned to."""
    entity = placed.entity
    own = Placement.of(placed, frame.mm_per_unit, frame.origin_mm)
    place = Vec3(entity.dxf.insert)
    if isinstance(entity, Text):
        own = own.in_axes_of(entity)
        is_aligned = entity.dxf.halign or entity.dxf.valign
        place = Vec3(entity.dxf.get("align_point", place)) if is_aligned else place
    return own.points((place,))[0]
