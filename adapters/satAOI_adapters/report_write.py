"""The report as JSON for programs and as lines for people."""

from satAOI_geo.report import Report


def json_of(report: Report) -> str:
    """The report as JSON: the same run gives the same text, `timing_s` aside.

    Floats stand with all their digits, so that reading them back gives the same numbers.
    """
    return report.model_dump_json(by_alias=True, indent=2) + "\n"


def lines_of(report: Report) -> list[tuple[str, str]]:
    """The figures a person asks for first, as (label, value), in reading order."""
    floor, aoi, start = report.floor, report.aoi, report.start
    x_mm, y_mm = start.xy_mm
    obstacles = f"{floor.obstacle_percent:.1f} % of the floor, {floor.n_obstacles} pieces"
    area = f"{aoi.percent_of_free:.1f} % of the free floor, {aoi.n_parts} parts"
    return [
        ("floor", f"{floor.area_m2:.2f} m² ({floor.source})"),
        ("obstacles", f"{floor.obstacle_area_m2:.2f} m² ({obstacles})"),
        ("free floor", f"{floor.free_area_m2:.2f} m²"),
        ("start", f"({x_mm:.0f}, {y_mm:.0f}) mm ({start.source})"),
        (f"{aoi.connectivity}-connected area", f"{aoi.area_m2:.2f} m² ({area})"),
    ]
