"""The note beside the plan: a legend with swatches, and the figures of the run.

Every row is a text of its own at a place of its own, so that the columns stay in line whatever
font and line spacing a program puts in place of ours.
"""

import math
from collections import Counter
from dataclasses import dataclass
from pathlib import PurePath
from typing import Final

import numpy as np
from ezdxf.document import Drawing
from ezdxf.layouts import Modelspace
from ezdxf.lldxf.const import MTEXT_MIDDLE_LEFT

from satAOI_adapters.dxf_write.layers import (
    AOI,
    AOI_TRANSPARENCY,
    EDGE,
    KIND_COLOURS,
    NOTE,
    OBSTACLE,
    START,
)
from satAOI_adapters.dxf_write.metadata import attach, one_line
from satAOI_adapters.dxf_write.pen import Pen
from satAOI_adapters.dxf_write.place import (
    Bounds,
    corners_of,
    entity_bounds,
    floor_bounds,
    free_place,
)
from satAOI_geo.aoi import Loop, Outline
from satAOI_geo.pipeline import Result
from satAOI_geo.plan import Frame, Kind
from satAOI_geo.report import Report

TEXT_STYLE: Final = "SATAOI"
FONT: Final = "arial.ttf"

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

MOST_FINDINGS: Final = 6
"""Sorts of findings that are listed."""


@dataclass(frozen=True, slots=True)
class Swatch:
    """A sample of how something is drawn.

    Attributes:
        line: Colour index of its edge.
        lineweight: Of its edge, in hundredths of a millimetre.
        filled: Whether it is filled as the area of interest.
        is_round: Whether it is a disc.
    """

    line: int
    lineweight: int
    filled: bool = False
    is_round: bool = False


@dataclass(frozen=True, slots=True)
class Row:
    """A line of the note; a heading has no value."""

    label: str
    value: str = ""
    swatch: Swatch | None = None

    @property
    def pitch(self) -> float:
        """Room it takes, in text heights."""
        return ROW if self.value else HEADING_ROW


def draw_note(document: Drawing, result: Result) -> None:
    """Draw the note beside the plan, clear of everything that is drawn already."""
    space = document.modelspace()
    if TEXT_STYLE not in document.styles:
        document.styles.add(TEXT_STYLE, font=FONT)
    rows = note_rows(result)
    plan = floor_bounds(result.plan)
    height = text_height(plan)
    value_at = LABEL_AT + CHARACTER * max(len(row.label) for row in rows if row.value) + 1
    width = value_at + CHARACTER * max(len(row.value) for row in rows)
    size = (
        height * (width + 2 * MARGIN),
        height * (sum(row.pitch for row in rows) + 2 * MARGIN),
    )
    within = free_place(plan, size, gap=GAP * height, taken=entity_bounds(space))
    Pen(space, Frame(), NOTE.name).ring(corners_of(within))
    x, y = within[0] + MARGIN * height, within[3] - MARGIN * height
    for row in rows:
        middle = y - row.pitch * height / 2
        _draw_row(space, row, (x, middle), height=height, value_at=value_at)
        y -= row.pitch * height


def note_rows(result: Result) -> list[Row]:
    """The legend and the figures, from the top."""
    report = result.report
    return [
        *_area_rows(report),
        *_floor_rows(report, result),
        *_run_rows(report, result.plan.frame),
        *_finding_rows(report),
    ]


def text_height(plan: Bounds) -> float:
    """Letters that can be read when the plan fills a sheet, in drawing units."""
    width, height = plan[2] - plan[0], plan[3] - plan[1]
    return max(math.sqrt(width * height) / 60, max(width, height) / 150)


def _area_rows(report: Report) -> list[Row]:
    aoi, disc = report.aoi, report.disc_connected
    area = f"{aoi.area_m2:.2f} m² = {aoi.percent_of_free:.1f} % of the free floor"
    rows = [
        Row("Floor the robot can trowel"),
        Row("Area of interest", area, Swatch(EDGE.colour, EDGE.lineweight, filled=True)),
        Row("Connected parts", str(aoi.n_parts)),
    ]
    if aoi.connectivity == "disc":
        return [*rows, Row("Connectivity", "disc-connected, an upper estimate")]
    return [
        *rows,
        Row("Connectivity", "pose-connected"),
        Row("Upper estimate", f"{disc.area_m2:.2f} m², disc-connected"),
    ]


def _floor_rows(report: Report, result: Result) -> list[Row]:
    floor = report.floor
    obstacles = f"{floor.obstacle_area_m2:.2f} m² = {floor.obstacle_percent:.1f} % of the floor"
    counts = Counter(obstacle.kind for obstacle in result.plan.obstacles)
    edge = Swatch(OBSTACLE.colour, OBSTACLE.lineweight)
    return [
        Row("Plan as it was read"),
        Row("Floor", f"{floor.area_m2:.2f} m² ({floor.source})", edge),
        Row("Free floor", f"{floor.free_area_m2:.2f} m²"),
        Row("Obstacles", obstacles),
        *(
            Row(kind.value, str(counts[kind]), Swatch(KIND_COLOURS[kind], OBSTACLE.lineweight))
            for kind in Kind
            if counts[kind]
        ),
    ]


def _run_rows(report: Report, frame: Frame) -> list[Row]:
    source, robot, lattice = report.input, report.robot, report.lattice
    # a tenth of a millimetre and no more digits than that takes in the drawing's unit
    digits = max(0, 1 + round(math.log10(frame.mm_per_unit)))
    x, y = (round(mm / frame.mm_per_unit, digits) for mm in report.start.xy_mm)
    start = Swatch(START.colour, START.lineweight, is_round=True)
    return [
        Row("Run"),
        Row(
            "Start of the disc", f"{x:.12g}, {y:.12g} {source.unit} ({report.start.source})", start
        ),
        Row("Robot", f"{robot.name}, disc radius {robot.disc_radius_mm:g} mm"),
        Row("Clearance", f"{robot.clearance_mm:g} mm"),
        Row(
            "Lattice",
            f"{lattice.step_mm:g} mm, {lattice.n_directions} directions, {lattice.n_swings} swings",
        ),
        Row("Drawing", f"{PurePath(source.path).name or source.format}"),
        Row("Unit", f"{source.unit} ({source.unit_source})"),
    ]


def _finding_rows(report: Report) -> list[Row]:
    if not report.findings:
        return []
    counts = Counter(finding.code for finding in report.findings).most_common()
    rows = [Row(code, str(count)) for code, count in counts[:MOST_FINDINGS]]
    if len(counts) > MOST_FINDINGS:
        rows.append(Row("others", str(sum(count for _, count in counts[MOST_FINDINGS:]))))
    return [Row("Findings of the reader, see the report"), *rows]


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
    shown = text if len(text) <= LONGEST_VALUE else text[: LONGEST_VALUE - 3] + "..."
    space.add_mtext(
        _escaped(one_line(shown)),
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
    if swatch.filled:
        straight = np.column_stack((corners[:-1], np.zeros(4)))
        hatch = Pen(space, Frame(), NOTE.name, AOI.colour).fill(Outline(Loop(straight), ()))
        hatch.rgb = AOI.rgb
        hatch.transparency = AOI_TRANSPARENCY
        attach(hatch, {"sample": AOI.name})
    edge = (
        line_pen.circle((x + width / 2, y), half_height)
        if swatch.is_round
        else line_pen.ring(corners)
    )
    edge.dxf.lineweight = swatch.lineweight


def _escaped(text: str) -> str:
    """Text without anything that MTEXT takes for an instruction."""
    for special in ("\\", "{", "}"):
        text = text.replace(special, "\\" + special)
    return text
