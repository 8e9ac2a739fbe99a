"""What the note says: the legend and the figures of a run, row by row."""

from collections import Counter, defaultdict
from dataclasses import dataclass
from pathlib import PurePath
from typing import Final

from satAOI_adapters.dxf_write.layers import (
    AOI,
    EDGE,
    KIND_COLOURS,
    OBSTACLE,
    START,
    UNREACHED,
    UPPER,
    ZONE,
    Style,
)
from satAOI_adapters.wording import coordinate
from satAOI_geo.pipeline import Result
from satAOI_geo.plan import Frame, Kind
from satAOI_geo.reasons import Reason
from satAOI_geo.report import Report

MOST_FINDINGS: Final = 6
"""Sorts of findings that are listed."""

WHY: Final = {
    Reason.DISC: "too narrow for the disc",
    Reason.ARM: "no room for the arm",
    Reason.VEHICLE: "no room for the vehicle",
    Reason.ZONE: "no chain of positions from the start",
    Reason.PATH: "no way to drive there from the start",
}
"""Reasons in a few words."""


@dataclass(frozen=True, slots=True)
class Swatch:
    """A sample of how something is drawn.

    Attributes:
        line: Colour index of its edge.
        lineweight: Of its edge, in hundredths of a millimetre.
        fill: The layer whose fill it has, or None.
        is_round: Whether it is a disc.
    """

    line: int
    lineweight: int
    fill: Style | None = None
    is_round: bool = False


@dataclass(frozen=True, slots=True)
class Row:
    """A line of the note; a heading has no value."""

    label: str
    value: str = ""
    swatch: Swatch | None = None


def note_rows(result: Result) -> list[Row]:
    """The legend and the figures, from the top."""
    report = result.report
    return [
        *_area_rows(report),
        *_unreached_rows(report),
        *_floor_rows(report, result),
        *_run_rows(report, result.plan.frame),
        *_finding_rows(report),
    ]


def point_in_words(at_mm: tuple[float, float], mm_per_unit: float, unit: str) -> str:
    """A point of the drawing in its own unit, to a tenth of a millimetre and no more digits."""
    x, y = (coordinate(mm / mm_per_unit, mm_per_unit) for mm in at_mm)
    return f"{x}, {y} {unit}"


def _area_rows(report: Report) -> list[Row]:
    aoi, disc = report.aoi, report.disc_connected
    area = f"{aoi.area_m2:.2f} m² = {aoi.percent_of_free:.1f} % of the free floor"
    more = Swatch(UPPER.colour, UPPER.lineweight, UPPER)
    rule = (
        [Row("Connectivity", "disc-connected, an upper estimate")]
        if aoi.connectivity == "disc"
        else [
            Row("Connectivity", "pose-connected"),
            Row("Upper estimate", f"{disc.area_m2:.2f} m², disc-connected", more),
        ]
    )
    return [
        Row("Floor the robot can trowel"),
        Row("Area of interest", area, Swatch(EDGE.colour, EDGE.lineweight, AOI)),
        Row("Connected parts", str(aoi.n_parts)),
        *rule,
        Row("Zones", f"{len(report.zones)}, on the frozen layer {ZONE.name}"),
        Row("Set-downs", f"{len(report.set_downs)} reach all that any pose can trowel"),
    ]


def _unreached_rows(report: Report) -> list[Row]:
    areas: defaultdict[str, float] = defaultdict(float)
    for patch in report.unreached:
        areas[patch.reason] += patch.area_m2
    if not areas:
        return []
    sample = Swatch(UNREACHED.colour, UNREACHED.lineweight, UNREACHED)
    return [
        Row("Free floor that is left"),
        Row("Not reached", f"{sum(areas.values()):.2f} m²", sample),
        *(
            Row(reason, f"{areas[reason]:.2f} m²: {WHY[reason]}")
            for reason in Reason
            if areas[reason]
        ),
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
    at = point_in_words(report.start.xy_mm, frame.mm_per_unit, source.unit)
    start = Swatch(START.colour, START.lineweight, is_round=True)
    return [
        Row("Run"),
        Row("Start of the disc", f"{at} ({report.start.source})", start),
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
