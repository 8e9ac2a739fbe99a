"""Drawing verbs that the samples share; lengths in drawing units."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final, TypeAlias

import ezdxf
from ezdxf.document import Drawing
from ezdxf.entities import Insert
from ezdxf.layouts import BaseLayout
from ezdxf.math import Vec2

Point: TypeAlias = tuple[float, float]

MM: Final = 4
METRE: Final = 6
"""Values of the header variable $INSUNITS."""

SEMICIRCLE: Final = 1.0
"""Bulge of a half circle: tan(180° / 4)."""

BY_LAYER: Final = 256
"""The colour number that stands for the layer's colour."""

DIMENSION_STYLE: Final = "SAMPLE"

QUARTER_CIRCLE: Final = math.tan(math.pi / 8)
"""Bulge of a quarter circle."""


@dataclass(frozen=True, slots=True)
class Layer:
    """A layer: its name, its colour by number, its linetype."""

    name: str
    colour: int
    linetype: str = "Continuous"


def new_drawing(
    units: int, layers: Iterable[Layer], *, dimension_height: float, decimals: int = 0
) -> Drawing:
    """An empty drawing with its layers and the style of its dimensions."""
    doc = ezdxf.new("R2010", setup=["linetypes"], units=units)
    for layer in layers:
        doc.layers.add(layer.name, color=layer.colour, linetype=layer.linetype)
    _define_dimension_style(doc, dimension_height, decimals)
    return doc


def rectangle(layout: BaseLayout, layer: str, corner: Point, opposite: Point) -> None:
    """A closed rectangle between two opposite corners."""
    (left, bottom), (right, top) = corner, opposite
    outline(layout, layer, [(left, bottom), (right, bottom), (right, top), (left, top)])


def centred(layout: BaseLayout, layer: str, centre: Point, width: float, height: float) -> None:
    """A closed rectangle about its centre."""
    x, y = centre
    rectangle(layout, layer, (x - width / 2, y - height / 2), (x + width / 2, y + height / 2))


def outline(layout: BaseLayout, layer: str, corners: Sequence[tuple[float, ...]]) -> None:
    """A closed outline; a corner is (x, y) or (x, y, bulge of the side that starts there)."""
    vertices = [(x, y, *(bulge or (0.0,))) for x, y, *bulge in corners]
    layout.add_lwpolyline(vertices, format="xyb", close=True, dxfattribs={"layer": layer})


def slotted(layout: BaseLayout, layer: str, centre: Point, width: float, height: float) -> None:
    """An upright hole with round ends, as large as a rectangle of that width and height."""
    x, y = centre
    side, end = width / 2, (height - width) / 2
    corners = [
        (x + side, y - end, 0.0),
        (x + side, y + end, SEMICIRCLE),
        (x - side, y + end, 0.0),
        (x - side, y - end, SEMICIRCLE),
    ]
    outline(layout, layer, corners)


def circle(layout: BaseLayout, layer: str, centre: Point, diameter: float) -> None:
    """A full circle."""
    layout.add_circle(centre, diameter / 2, dxfattribs={"layer": layer})


def lines(layout: BaseLayout, layer: str, pairs: Iterable[tuple[Point, Point]]) -> None:
    """Single lines."""
    for start, end in pairs:
        layout.add_line(start, end, dxfattribs={"layer": layer})


def solid(layout: BaseLayout, layer: str, *boundaries: Sequence[tuple[float, ...]]) -> None:
    """A solid hatch; the first boundary is the outer one, the others are holes."""
    hatch = layout.add_hatch(BY_LAYER, dxfattribs={"layer": layer})
    for boundary in boundaries:
        hatch.paths.add_polyline_path(boundary, is_closed=True)


def place(
    layout: BaseLayout,
    layer: str,
    block: str,
    at: Point,
    *,
    turn_deg: float = 0.0,
    mirror: bool = False,
) -> Insert:
    """An instance of a block, turned and then placed; mirrored in its own y axis first."""
    attributes = {"layer": layer, "rotation": turn_deg, "xscale": -1.0 if mirror else 1.0}
    return layout.add_blockref(block, at, dxfattribs=attributes)


def text(layout: BaseLayout, layer: str, words: str, at: Point, height: float) -> None:
    """A line of text that starts at a point."""
    layout.add_text(words, height=height, dxfattribs={"layer": layer, "insert": at})


def dimension(layout: BaseLayout, layer: str, start: Point, end: Point, *, offset: float) -> None:
    """The distance between two points along x or y, drawn beside them on the left of the way."""
    way = (Vec2(end) - Vec2(start)).normalize()
    layout.add_linear_dim(
        base=Vec2(start) + way.orthogonal() * offset,
        p1=start,
        p2=end,
        angle=way.angle_deg,
        dimstyle=DIMENSION_STYLE,
        dxfattribs={"layer": layer},
    ).render()


def _define_dimension_style(doc: Drawing, height: float, decimals: int) -> None:
    attributes = {
        "dimtxt": height,
        "dimtsz": height / 2,
        "dimasz": height / 2,
        "dimexe": height / 2,
        "dimexo": height,
        "dimgap": height / 3,
        "dimdec": decimals,
        "dimtad": 1,
    }
    style = doc.dimstyles.new(DIMENSION_STYLE, dxfattribs=attributes)
    # some programs draw dimensions anew, by the header's variables
    style.copy_to_header(doc)
