"""A page as PNG, for where a picture is wanted that any program shows."""

import io
from typing import Final

import numpy as np
import shapely
from PIL import Image, ImageDraw
from shapely.geometry import LineString

from satAOI_adapters.plan_picture.fonts import face_for, font, spelt
from satAOI_adapters.plan_picture.page import Area, Disc, Mark, Page, Strokes, Text

FINER: Final = 2
"""Everything is drawn this many times larger and reduced, which smooths its edges."""

PIXELS_PER_UNIT: Final = 1.5
"""Small letters of a page can still be read at this size."""

SCALE: Final = FINER * PIXELS_PER_UNIT

Spots = list[tuple[float, float]]


def drawn(page: Page) -> bytes:
    """The page as the bytes of a PNG file."""
    size = (round(page.width * SCALE), round(page.height * SCALE))
    picture = Image.new("RGB", size, "white")
    face = face_for(mark.text for mark in page.marks if isinstance(mark, Text))
    for mark in page.marks:
        _draw(picture, mark, face)
    buffer = io.BytesIO()
    picture.reduce(FINER).save(buffer, format="PNG", optimize=True)
    return buffer.getvalue()


def _draw(picture: Image.Image, mark: Mark, face: str) -> None:
    pen = ImageDraw.Draw(picture)
    if isinstance(mark, Area):
        _fill(picture, mark)
        for ring in (mark.shape.exterior, *mark.shape.interiors):
            pen.line(_spots(ring), fill=mark.stroke, width=_width(mark.width), joint="curve")
    elif isinstance(mark, Strokes):
        for line in mark.lines:
            pen.line(_spots(line), fill=mark.stroke, width=_width(mark.width), joint="curve")
    elif isinstance(mark, Disc):
        pen.circle(
            (mark.x * SCALE, mark.y * SCALE),
            mark.radius * SCALE,
            fill=mark.fill,
            outline=mark.stroke,
            width=_width(mark.width),
        )
    else:
        _write(pen, mark, face)


def _fill(picture: Image.Image, area: Area) -> None:
    """Fill a polygon and leave what shows through its holes as it was."""
    if not area.shape.interiors:
        ImageDraw.Draw(picture).polygon(_spots(area.shape.exterior), fill=area.fill)
        return
    left, top = np.floor(np.array(area.shape.bounds[:2]) * SCALE).astype(int).tolist()
    right, bottom = np.ceil(np.array(area.shape.bounds[2:]) * SCALE).astype(int).tolist()
    mask = Image.new("1", (right - left + 1, bottom - top + 1), 0)
    pen = ImageDraw.Draw(mask)
    rings = ((area.shape.exterior, 1), *((hole, 0) for hole in area.shape.interiors))
    for ring, value in rings:
        pen.polygon([(x - left, y - top) for x, y in _spots(ring)], fill=value)
    picture.paste(area.fill, (left, top), mask)


def _write(pen: ImageDraw.ImageDraw, mark: Text, face: str) -> None:
    pen.text(
        (mark.x * SCALE, mark.y * SCALE),
        spelt(mark.text, face),
        fill=mark.colour,
        font=font(face, mark.size * SCALE),
        anchor="mm" if mark.centred else "lm",
    )


def _spots(line: LineString) -> Spots:
    return [(x, y) for x, y in (shapely.get_coordinates(line) * SCALE).tolist()]


def _width(width: float) -> int:
    return max(round(width * SCALE), 1)
