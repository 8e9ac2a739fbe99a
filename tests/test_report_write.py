"""The report as JSON and as lines."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
from pydantic import TypeAdapter

from satAOI_adapters import report_write
from satAOI_adapters.files import json_of
from satAOI_geo import InputError, Report
from tests.results import furnished_result

REPORT = furnished_result().report


def test_the_json_read_again_is_the_same_report() -> None:
    assert TypeAdapter(Report).validate_json(json_of(REPORT)) == REPORT


def test_the_json_names_its_schema_first() -> None:
    keys = list(json.loads(json_of(REPORT)))
    assert keys[0] == "schema"
    assert json.loads(json_of(REPORT))["schema"] == "sataoi-report/1"


def test_the_file_holds_the_json(tmp_path: Path) -> None:
    file = tmp_path / "report.json"
    report_write.write(file, REPORT)
    assert file.read_text(encoding="utf-8") == json_of(REPORT)


def test_a_name_that_is_no_text_is_written_all_the_same(tmp_path: Path) -> None:
    # the bytes of a name in GBK, as Python sees them where names are in UTF-8
    path = b"\xc6\xbd\xc3\xe6.dxf".decode("utf-8", "surrogateescape")
    report = replace(REPORT, input=replace(REPORT.input, path=path))
    report_write.write(tmp_path / "report.json", report)
    read = json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))
    assert read["input"]["path"].endswith(".dxf")


def test_a_report_is_never_written_over_the_plan(tmp_path: Path) -> None:
    plan = tmp_path / "plan.dxf"
    plan.write_bytes(b"the plan")
    source = replace(REPORT.input, path=str(plan))
    with pytest.raises(InputError, match="is an input"):
        report_write.write(plan, replace(REPORT, input=source))
    assert plan.read_bytes() == b"the plan"


def test_every_line_has_a_label_and_its_figure() -> None:
    lines = dict(report_write.lines_of(REPORT))
    assert lines["floor"] == "35.00 m² (given)"
    assert lines["area of interest"].startswith(f"{REPORT.aoi.area_m2:.2f} m²")
    assert lines["upper estimate"].startswith(f"{REPORT.disc_connected.area_m2:.2f} m²")


def test_a_floor_with_crumbs_only_has_no_zone_and_says_so() -> None:
    lines = dict(report_write.lines_of(replace(REPORT, zones=[])))
    assert lines["zones"] == "none of 0.5 m² or more"


def test_the_reasons_add_up_to_what_is_left_over() -> None:
    (_, total), *reasons = report_write.left_over(REPORT.unreached)
    figures = [float(value.split()[0]) for _, value in reasons]
    # each figure is rounded to 0.01 m², and one below half of that has no line
    assert float(total.split()[0]) == pytest.approx(sum(figures), abs=0.005 * 6)
