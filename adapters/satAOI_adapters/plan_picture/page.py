"""A page of marks: what the layout puts where, and both kinds of ink draw.

Lengths are page units, a pixel of a screen each; x runs right and y down.
"""

from dataclasses import dataclass
from typing import TypeAlias

from shapely.geometry import LineString, Polygon


@dataclass(frozen=True, slots=True)
class Area:
    """A polygon, filled, with an outline.

    Attributes:
        shape: The polygon; its holes stay open.
        fill: Colour of the inside.
        stroke: Colour of the outline.
        width: Of the outline.
        title: What it is, for pictures that can tell it on demand.
    """

    shape: Polygon
    fill: str
    stroke: str
    width: float
    title: str = ""


@dataclass(frozen=True, slots=True)
class Strokes:
    """Lines of one colour.

    Attributes:
        lines: Each by its corners.
        stroke: Colour.
        width: Of the lines.
        title: What they are, for pictures that can tell it on demand.
    """

    lines: tuple[LineString, ...]
    stroke: str
    width: float
    title: str = ""


@dataclass(frozen=True, slots=True)
class Disc:
    """A filled circle with an outline."""

    x: float
    y: float
    radius: float
    fill: str
    stroke: str
    width: float = 1.0


@dataclass(frozen=True, slots=True)
class Text:
    """One line of text.

    Attributes:
        x: Left end, or the middle if `centred`.
        y: The middle of the line's height.
        text: Printable characters only.
        size: Of the letters.
        colour: Of the letters.
        centred: Whether x is the middle.
    """

    x: float
    y: float
    text: str
    size: float
    colour: str
    centred: bool = False


Mark: TypeAlias = Area | Strokes | Disc | Text


@dataclass(frozen=True, slots=True)
class Page:
    """A page; later marks lie over earlier ones."""

    width: float
    height: float
    marks: tuple[Mark, ...]


def printable(text: str) -> str:
    """The text in one line, with `?` for what no file of text may hold."""
    whole = " ".join(text.split()).encode(errors="replace").decode()
    return "".join(letter if letter.isprintable() else "?" for letter in whole)
