"""A page as SVG: it scales without end, and tells layer and handle of what the mouse rests on."""

from collections.abc import Iterable, Iterator
from typing import Final
from xml.sax.saxutils import escape, quoteattr

import shapely
from shapely.geometry import LineString

from satAOI_adapters.plan_picture.page import Area, Disc, Mark, Page, Strokes, Text

FACES: Final = "DejaVu Sans, Verdana, Arial, sans-serif"

MIDDLE: Final = 0.36
"""Half the height of a capital letter, in sizes of the letters."""


def drawn(page: Page) -> bytes:
    """The page as the bytes of an SVG file."""
    size = f'width="{page.width:g}" height="{page.height:g}"'
    view = f'viewBox="0 0 {page.width:g} {page.height:g}"'
    lines = (
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<svg xmlns="http://www.w3.org/2000/svg" {size} {view} font-family="{FACES}">',
        f'<rect {size} fill="#ffffff"/>',
        *(_element(mark) for mark in page.marks),
        "</svg>",
    )
    return ("\n".join(lines) + "\n").encode()


def _element(mark: Mark) -> str:
    if isinstance(mark, Area):
        rings = (mark.shape.exterior, *mark.shape.interiors)
        return _path(rings, mark.title, fill=mark.fill, stroke=mark.stroke, width=mark.width)
    if isinstance(mark, Strokes):
        return _path(mark.lines, mark.title, fill="none", stroke=mark.stroke, width=mark.width)
    if isinstance(mark, Disc):
        return (
            f'<circle cx="{mark.x:.1f}" cy="{mark.y:.1f}" r="{mark.radius:g}" fill="{mark.fill}" '
            f'stroke="{mark.stroke}" stroke-width="{mark.width:g}"/>'
        )
    return _text(mark)


def _path(lines: Iterable[LineString], title: str, *, fill: str, stroke: str, width: float) -> str:
    told = f"<title>{escape(title)}</title>" if title else ""
    return (
        f"<path d={quoteattr(' '.join(map(_chain, lines)))} fill={quoteattr(fill)} "
        f'fill-rule="evenodd" stroke="{stroke}" stroke-width="{width:g}" '
        f'stroke-linejoin="round">{told}</path>'
    )


def _chain(line: LineString) -> str:
    return "M" + " ".join(_pairs(line)) + ("Z" if line.is_ring else "")


def _pairs(line: LineString) -> Iterator[str]:
    return (f"{x:.2f},{y:.2f}" for x, y in shapely.get_coordinates(line).tolist())


def _text(mark: Text) -> str:
    anchor = ' text-anchor="middle"' if mark.centred else ""
    # not every program knows other baselines than that on which the letters stand
    y = mark.y + MIDDLE * mark.size
    return (
        f'<text x="{mark.x:.1f}" y="{y:.1f}" font-size="{mark.size:g}" fill="{mark.colour}"'
        f"{anchor}>{escape(mark.text)}</text>"
    )
