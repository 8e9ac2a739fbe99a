"""The layers and colours of what is drawn; the only place they are chosen."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

from ezdxf.document import Drawing

from satAOI_geo.plan import Kind

PREFIX: Final = "SATAOI-"
"""Layers whose names begin so belong to this program: what lies on them is replaced."""


@dataclass(frozen=True, slots=True)
class Style:
    """How a layer looks. Names are ASCII, since programs disagree on the encoding of others.

    Attributes:
        name: Of the layer.
        colour: AutoCAD colour index, 1 to 255.
        rgb: The same more exactly, for programs that know true colours, or None.
        frozen: Whether the layer stays out of sight until it is asked for.
        lineweight: In hundredths of a millimetre on paper.
        description: For the layer manager.
    """

    name: str
    colour: int
    lineweight: int
    description: str
    rgb: tuple[int, int, int] | None = None
    frozen: bool = False


AOI: Final = Style(
    "SATAOI-AOI", 71, 13, "floor the robot can trowel, one hatch a part", rgb=(197, 232, 183)
)
EDGE: Final = Style("SATAOI-AOI-EDGE", 94, 50, "outline of that floor, with true arcs")
UNREACHED: Final = Style(
    "SATAOI-UNREACHED", 41, 13, "free floor left for hand finishing", rgb=(255, 236, 190)
)
UPPER: Final = Style(
    "SATAOI-UPPER", 31, 13, "what only the disc-connected estimate claims", rgb=(255, 205, 145)
)
ZONE: Final = Style("SATAOI-ZONE", 150, 25, "what each set-down can trowel", frozen=True)
START: Final = Style("SATAOI-START", 6, 35, "disc of the robot where it starts")
OBSTACLE: Final = Style("SATAOI-OBSTACLE", 8, 25, "floor and obstacles as they were read")
NOTE: Final = Style("SATAOI-NOTE", 7, 18, "legend and figures")

ROUTE: Final = Style("SATAOI-ROUTE", 160, 70, "way of the disc's centre and the point it leads to")
ROBOT: Final = Style("SATAOI-ROBOT", 94, 18, "the robot on its way, at intervals")

STYLES: Final = (AOI, EDGE, UNREACHED, UPPER, ZONE, START, OBSTACLE, NOTE)
"""What an area of interest is drawn in."""

ROUTE_STYLES: Final = (ROBOT, ROUTE, START, NOTE)
"""What a route is drawn in."""

TRANSPARENCY: Final = 0.5
"""Of fills, in programs that know it; the others show the walls because fills come first."""

TEXT_STYLE: Final = "SATAOI"
FONT: Final = "arial.ttf"

LABEL_COLOUR: Final = 8
"""Of labels on fills: grey, to be read on both a white and a black screen."""

KIND_COLOURS: Final = {
    Kind.WALL: 1,
    Kind.COLUMN: 5,
    Kind.HOLE: 200,
    Kind.EMBEDDED: 30,
    Kind.EQUIPMENT: 132,
    Kind.UNCLASSIFIED: 54,
}
"""Colour index of an obstacle's outline: red, blue, violet, orange, teal, olive."""


def add_layers(document: Drawing, styles: Iterable[Style]) -> None:
    """Create text style and layers, or give those of an earlier run their looks again."""
    if TEXT_STYLE not in document.styles:
        document.styles.add(TEXT_STYLE, font=FONT)
    for style in styles:
        layer = (
            document.layers.get(style.name)
            if style.name in document.layers
            else document.layers.add(style.name)
        )
        layer.color = style.colour
        layer.on()
        layer.thaw()
        if style.frozen:
            layer.freeze()
        if style.rgb:
            layer.rgb = style.rgb
        layer.dxf.lineweight = style.lineweight
        layer.description = style.description
