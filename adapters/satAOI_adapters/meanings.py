"""What layers and blocks stand for, and how sure that is."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Final

from satAOI_geo.plan import Kind


class Meaning(StrEnum):
    """What a layer or a block stands for; the first five are kinds of obstacle."""

    WALL = "wall"
    COLUMN = "column"
    HOLE = "hole"
    EMBEDDED = "embedded"
    EQUIPMENT = "equipment"
    WINDOW = "window"
    DOOR = "door"
    FLOOR = "floor"
    ROOM = "room"
    IGNORE = "ignore"


KINDS: Final = {
    Meaning.WALL: Kind.WALL,
    Meaning.WINDOW: Kind.WALL,
    Meaning.COLUMN: Kind.COLUMN,
    Meaning.HOLE: Kind.HOLE,
    Meaning.EMBEDDED: Kind.EMBEDDED,
    Meaning.EQUIPMENT: Kind.EQUIPMENT,
}
"""The kind of obstacle that a meaning makes; the others make none."""


class Certainty(StrEnum):
    """How sure a layer's meaning is."""

    GIVEN = "given"
    """The user's file says so."""
    CERTAIN = "certain"
    """The name is the pattern, nothing else."""
    LIKELY = "likely"
    """The pattern is a part of the name."""
    UNKNOWN = "unknown"
    """No pattern matches."""


@dataclass(frozen=True, slots=True)
class Verdict:
    """What a name means and by which pattern.

    Attributes:
        meaning: None where no pattern matches.
        pattern: As written in the table.
        certainty: How sure it is.
    """

    meaning: Meaning | None = None
    pattern: str = ""
    certainty: Certainty = Certainty.UNKNOWN


@dataclass(frozen=True, slots=True)
class Named:
    """A layer or a block of a drawing, without the prefix of an external reference.

    Attributes:
        name: Its name.
        verdict: What it means by its name alone.
        counts: What is drawn on it or in it: how many entities of each type.
    """

    name: str
    verdict: Verdict
    counts: Mapping[str, int]


@dataclass(frozen=True, slots=True)
class LayerMap:
    """Which layer and which block of a drawing is taken for what.

    Attributes:
        layers: All on which something is drawn, by name.
        blocks: Those whose name means something, by name.
        is_own: Whether the user's file took the place of the built-in table.
    """

    layers: tuple[Named, ...]
    blocks: tuple[Named, ...]
    is_own: bool
