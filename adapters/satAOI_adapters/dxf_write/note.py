"""The note beside the plan: a legend with swatches, and figures.

Every row is a text of its own at a place of its own, so that the columns stay in line whatever
font and line spacing a program puts in place of ours.
"""

from typing import Final

from ezdxf.layouts import Modelspace
from ezdxf.lldxf.const import MTEXT_MIDDLE_LEFT
from shapely.geometry import Polygon

from satAOI_adapters.dxf_write.layers import NOTE, TEXT_STYLE, TRANSPARENCY
from satAOI_adapters.dxf_write.legend import Row, Swatch
from satAOI_adapters.dxf_write.metadata import attach, one_line
from satAOI_adapters.dxf_write.pen import Pen, outline_of
from satAOI_adapters.dxf_write.place import (
    corners_of,
    floor_bounds,
    free_place,
    text_height,
)
from satAOI_geo.plan import FloatArray, FloorPlan, Frame

# The layout, in text heights.
ROW: Final = 1.9
HEADING: Final = 1.3
"""Letters of a heading."""
HEADING_ROW: Final = 2.8
SWATCH: Final = (2.8, 1.1)
"""Width and height of a sample of colour."""
LABEL_AT: Final = 4.0
CHARACTER: Final = 0.85
"""Width allowed for a character; the widest of the usual fonts need so much on average."""
MARGIN: Final = 1.5
GAP: Final = 4.0
"""Between the note and what is drawn already."""

LONGEST_VALUE: Final = 48
"""Characters of a value; a longer name of a file or of a robot is cut."""


def draw_note(space: Modelspace, plan: FloorPlan, rows: list[Row], taken: FloatArray) -> None:
    """Draw the note beside the plan.

    Args:
        space: Where to draw.
        plan: The plan to stand beside.
        rows: What to tell.
        taken: Bounds of what to keep clear of, shape (n, 4), in drawing units.
    """
    floor = floor_bounds(plan)
    height = text_height(floor)
    value_at = LABEL_AT + CHARACTER * max(len(row.label) for row in rows if row.value) + 1
    width = value_at + CHARACTER * max(len(_cut(row.value)) for row in rows)
    size = (
        height * (width + 2 * MARGIN),
        height * (sum(_pitch(row) for row in rows) + 2 * MARGIN),
    )
    within = free_place(floor, size, gap=GAP * height, taken=taken)
    Pen(space, Frame(), NOTE.name).ring(corners_of(within))
    x, y = within[0] + MARGIN * height, within[3] - MARGIN * height
    for row in rows:
        middle = y - _pitch(row) * height / 2
        _draw_row(space, row, (x, middle), height=height, value_at=value_at)
        y -= _pitch(row) * height


def _pitch(row: Row) -> float:
    """Room for a row, in text heights."""
    return ROW if row.value else HEADING_ROW


def _draw_row(
    space: Modelspace, row: Row, at: tuple[float, float], *, height: float, value_at: float
) -> None:
    """Draw a row from the middle of its left edge."""
    x, y = at
    if not row.value:
        _draw_text(space, row.label, at, HEADING * height)
        return
    if row.swatch:
        _draw_swatch(space, row.swatch, at, height)
    _draw_text(space, row.label, (x + LABEL_AT * height, y), height)
    _draw_text(space, row.value, (x + value_at * height, y), height)


def _draw_text(space: Modelspace, text: str, at: tuple[float, float], height: float) -> None:
    space.add_mtext(
        _escaped(one_line(_cut(text))),
        dxfattribs={
            "layer": NOTE.name,
            "style": TEXT_STYLE,
            "char_height": height,
            "attachment_point": MTEXT_MIDDLE_LEFT,
            "insert": at,
        },
    )


def _draw_swatch(space: Modelspace, swatch: Swatch, at: tuple[float, float], height: float) -> None:
    x, y = at
    width, half_height = SWATCH[0] * height, SWATCH[1] * height / 2
    corners = corners_of((x, y - half_height, x + width, y + half_height))
    line_pen = Pen(space, Frame(), NOTE.name, swatch.line)
    if swatch.fill:
        fill_pen = Pen(space, Frame(), NOTE.name, swatch.fill.colour)
        hatch = fill_pen.fill(outline_of(Polygon(corners)))
        hatch.transparency = TRANSPARENCY
        if swatch.fill.rgb:
            hatch.rgb = swatch.fill.rgb
        attach(hatch, {"sample": swatch.fill.name})
    edge = (
        line_pen.circle((x + width / 2, y), half_height)
        if swatch.is_round
        else line_pen.ring(corners)
    )
    edge.dxf.lineweight = swatch.lineweight


def _cut(text: str) -> str:
    """As much of a text as is shown."""
    return text if len(text) <= LONGEST_VALUE else text[: LONGEST_VALUE - 3] + "..."


def _escaped(text: str) -> str:
    """Text without anything that MTEXT takes for an instruction, or for a sign by its code."""
    for special in ("\\", "{", "}"):
        text = text.replace(special, "\\" + special)
    return text.replace("^", "^ ").replace("%%", "% %")
