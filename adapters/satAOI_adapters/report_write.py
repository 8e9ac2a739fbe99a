"""The report as JSON for programs and as lines for people."""

from collections.abc import Sequence
from pathlib import Path

from satAOI_adapters.files import json_of, written_whole
from satAOI_geo.reasons import SENTENCES, Reason
from satAOI_geo.report import PatchFigures, Report
from satAOI_geo.units import MM2_PER_M2
from satAOI_geo.zones import ZONE_MM2

Line = tuple[str, str]
"""A label and what is said under it."""

TOLD_ZONES = 4
"""Zones told by their area; a dense hall has hundreds of small ones."""

TOLD_M2 = 0.005
"""Areas below this print as 0.00 m² and are not worth a line."""


def write(path: Path, report: Report) -> None:
    """Write the report to a file, whole or not at all.

    Raises:
        InputError: If the file cannot be written or is the plan itself.
    """
    with written_whole(path, never_over=[Path(report.input.path)]) as stream:
        stream.write(json_of(report).encode())


def lines_of(report: Report) -> list[Line]:
    """The figures a person asks for first, in reading order."""
    floor, aoi, start = report.floor, report.aoi, report.start
    x_mm, y_mm = start.xy_mm
    obstacles = f"{floor.obstacle_percent:.1f} % of the floor, {floor.n_obstacles} pieces"
    parts = "1 part" if aoi.n_parts == 1 else f"{aoi.n_parts} parts"
    share = f"{aoi.percent_of_free:.1f} % of the free floor, {parts}"
    return [
        ("floor", f"{floor.area_m2:.2f} m² ({floor.source})"),
        ("obstacles", f"{floor.obstacle_area_m2:.2f} m² ({obstacles})"),
        ("free floor", f"{floor.free_area_m2:.2f} m²"),
        ("start", f"({x_mm:.0f}, {y_mm:.0f}) mm ({start.source})"),
        ("area of interest", f"{aoi.area_m2:.2f} m² ({share}, {aoi.connectivity}-connected)"),
        ("upper estimate", f"{report.disc_connected.area_m2:.2f} m² (disc-connected)"),
        ("zones", zones_in_words([zone.area_m2 for zone in report.zones])),
        *left_over(report.unreached),
    ]


def zones_in_words(areas_m2: Sequence[float]) -> str:
    """What the robot trowels from each place it may be set down at, the largest few."""
    if not areas_m2:
        return f"none of {ZONE_MM2 / MM2_PER_M2:g} m² or more"
    told = ", ".join(f"{area_m2:.2f}" for area_m2 in areas_m2[:TOLD_ZONES])
    n_smaller = max(len(areas_m2) - TOLD_ZONES, 0)
    return f"{told} m²" + (f" and {n_smaller} smaller" if n_smaller else "")


def left_over(patches: list[PatchFigures]) -> list[Line]:
    """The free floor that is not reached, by reason."""
    total_m2 = sum(patch.area_m2 for patch in patches)
    by_reason = {
        reason: sum(patch.area_m2 for patch in patches if patch.reason == reason)
        for reason in Reason
    }
    return [
        ("left over", f"{total_m2:.2f} m²"),
        *(
            (f"  {reason}", f"{area_m2:.2f} m²: {SENTENCES[reason]}")
            for reason, area_m2 in by_reason.items()
            if area_m2 >= TOLD_M2
        ),
    ]
