"""The geometry process: whatever a model does to it is answered in a line."""

import re
from pathlib import Path

import pytest

from satAOI_adapters.ifc_read import IfcOptions, inspect, process, read, text
from satAOI_adapters.ifc_read.records import Inspected, Request
from satAOI_geo.errors import (
    DrawingError,
    EmptyPlanError,
    InputError,
    LimitError,
    SatAoiError,
    UnreadableError,
)
from tests.ifc_models import Pen

CORPUS = Path(__file__).parents[2] / "shared" / "corpus"
needs_corpus = pytest.mark.skipif(not CORPUS.is_dir(), reason="the corpus is not here")


def hall(folder: Path, schema: str = "IFC4") -> Path:
    """Two storeys, a slab on each, a wall on the lower one."""
    pen = Pen(schema)
    standing = pen.product("IfcWall", pen.box((500.0, 500.0, 0.0), (5500.0, 700.0, 3000.0)))
    pen.contain(pen.storey("Ground"), pen.slab(6000.0, 4000.0), standing)
    pen.contain(pen.storey("First", 3000.0), pen.slab(6000.0, 4000.0, top_mm=3000.0))
    return pen.save(folder)


def fragile(path: str, monkeypatch: pytest.MonkeyPatch, *, timeout_s: float = 60.0) -> Inspected:
    monkeypatch.setattr(process, "WORKER", "tests.fragile_worker")
    monkeypatch.setattr(process, "ELEMENT_S", 2.0)
    request = Request(path=path, parsed=path, options=IfcOptions(), file_mb=0.0, memory_mb=1000)
    return process.answered(request, Inspected, timeout_s=timeout_s)


def test_a_plan_comes_through_the_process_as_it_is(tmp_path: Path) -> None:
    seen: list[tuple[str, float]] = []
    path = hall(tmp_path)
    plan = read(path, IfcOptions(storey="Ground"), lambda *step: seen.append(step))
    assert [o.shape.bounds for o in plan.obstacles] == [(500.0, 500.0, 5500.0, 700.0)]
    assert (plan.source.format, plan.source.unit, plan.source.path) == ("ifc", "mm", str(path))
    assert len(plan.source.sha256) == 64
    assert {stage for stage, _ in seen} == {"reading"}
    assert all(0.0 <= share <= 1.0 for _, share in seen)


def test_inspect_lists_storeys_with_heights_and_counts(tmp_path: Path) -> None:
    ground, first = inspect(hall(tmp_path), IfcOptions()).storeys
    assert (ground.number, ground.name, ground.elevation_mm) == (1, "Ground", 0.0)
    assert ground.counts == {"IfcWall": 1, "IfcSlab": 1}
    assert (first.number, first.name, first.elevation_mm) == (2, "First", 3000.0)


def test_errors_come_through_the_process_as_they_are(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="choose one with --storey"):
        read(hall(tmp_path), IfcOptions())


def test_an_element_that_ends_the_process_is_left_out_by_name(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    answer = fragile("wall crash-1 wall hang-2 wall", monkeypatch)
    assert answer.model.schema_name == "crash-1 hang-2"


def test_a_model_that_ends_the_process_again_and_again_is_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with pytest.raises(UnreadableError, match=r"IfcWall crash-1, IfcWall crash-2, .* crash-5 each"):
        fragile(" ".join(f"crash-{i}" for i in range(1, 7)), monkeypatch)


def test_a_model_that_cannot_even_be_opened_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(process, "WORKER", "satAOI_adapters.no_such_module")
    request = Request(
        path="m.ifc", parsed="m.ifc", options=IfcOptions(), file_mb=0.0, memory_mb=1000
    )
    with pytest.raises(UnreadableError, match="ends the process that opens it"):
        process.answered(request, Inspected, timeout_s=60.0)


def test_the_limit_of_time_holds(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(LimitError, match="took longer than allowed"):
        fragile("hang", monkeypatch, timeout_s=1.0)


def test_the_limit_of_memory_holds(tmp_path: Path) -> None:
    with pytest.raises(SatAoiError, match=r"memory|ends the process"):
        read(hall(tmp_path), IfcOptions(storey="Ground", memory_mb=380))


def test_no_process_is_left_behind(monkeypatch: pytest.MonkeyPatch) -> None:
    # other tests may have processes that go on
    before = children()
    with pytest.raises(LimitError):
        fragile("hang", monkeypatch, timeout_s=1.0)
    assert children() <= before


def children() -> set[str]:
    """The processes that this one has started and not waited for."""
    lists = Path("/proc/self/task").glob("*/children")
    return {number for numbers in lists for number in numbers.read_text().split()}


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "is empty"),
        (b"version https://git-lfs.github.com/spec/v1\n", "Git LFS"),
        (b"\x1f\x8b\x08rest", "gzip"),
        (b"PK\x03\x04rest", "ZIP"),
        (b"%PDF-1.7", "PDF"),
        (b"<!DOCTYPE html><html>", "web page"),
        (b"<?xml version='1.0'?><ifcXML/>", "XML"),
        (b"AC1032\x00\x00", "DWG"),
        (b"0\nSECTION\n2\nHEADER\n", "does not begin with ISO-10303-21"),
        (b"ISO-10303-21;HEADER;ENDSEC;END-ISO-10303-21;", "names no schema"),
        (b"ISO-10303-21;FILE_SCHEMA(('IFC2X_FINAL'));END-ISO-10303-21;", "schema IFC2X_FINAL"),
        (b"ISO-10303-21;FILE_SCHEMA(('IFC4X3_RC2'));END-ISO-10303-21;", "schema IFC4X3_RC2"),
        (b"ISO-10303-21;FILE_SCHEMA(('IFC4'));DATA;#1=IFCWALL(", "was cut off"),
    ],
)
def test_a_file_of_another_kind_is_told_what_it_is(
    tmp_path: Path, content: bytes, message: str
) -> None:
    path = tmp_path / "model.ifc"
    path.write_bytes(content)
    with pytest.raises(UnreadableError, match=message):
        text.read_bytes(path)


def test_a_missing_file_is_told_so(tmp_path: Path) -> None:
    with pytest.raises(UnreadableError, match="No such file"):
        read(tmp_path / "model.ifc", IfcOptions())


def test_a_file_too_large_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(text, "MAX_FILE_BYTES", 100)
    with pytest.raises(LimitError, match="more than 100"):
        text.read_bytes(hall(tmp_path))


def test_what_does_not_parse_is_told_where(tmp_path: Path) -> None:
    path = hall(tmp_path)
    path.write_text(path.read_text().replace("IFCWALL(", "IFCWALL(:", 1))
    with pytest.raises(UnreadableError, match=r"cannot be parsed \(.+\)"):
        read(path, IfcOptions())


def test_names_and_comments_that_look_like_numbers_are_no_numbers() -> None:
    data = b"#1=IFCWALL('x(nan,inf)',$);/* (nan) */#2=IFCCARTESIANPOINT((0., NaN));#3=X((nano))"
    assert list(text.ids_with_bad_numbers(data)) == [2]


@pytest.mark.parametrize(
    ("schema", "written"),
    [("IFC4X3", "IFC4X3"), ("IFC4X3", "ifc4x3_add1"), ("IFC4", "IFC4X2"), ("IFC2X3", "IFC2X3_TC1")],
)
def test_a_schema_by_another_name_is_read_and_told_of(
    tmp_path: Path, schema: str, written: str
) -> None:
    path = hall(tmp_path, schema)
    plain = read(path, IfcOptions(storey="Ground"))
    text = path.read_text()
    path.write_text(re.sub(r"(FILE_SCHEMA\(\(')\w+", rf"\g<1>{written}", text))
    plan = read(path, IfcOptions(storey="Ground"))
    assert (plan.floor, plan.obstacles) == (plain.floor, plain.obstacles)
    assert [finding.code for finding in plan.findings] == ["schema-alias"]
    assert f"the schema {written.upper()} was read as {schema}" in plan.findings[0].message
    assert inspect(path, IfcOptions()).findings == plan.findings


def test_a_byte_order_mark_does_no_harm(tmp_path: Path) -> None:
    path = hall(tmp_path)
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    assert not read(path, IfcOptions(storey="Ground")).findings


def test_classes_that_the_schema_lacks_are_told_of(tmp_path: Path) -> None:
    path = hall(tmp_path)
    strange = "#901=IFCKERB($);\n#902=IFCKERB($);\n#903=IFCALIGNMENT($);\nENDSEC;\nEND-ISO"
    path.write_text(path.read_text().replace("ENDSEC;\nEND-ISO", strange))
    (finding,) = read(path, IfcOptions(storey="Ground")).findings
    assert finding.code == "unknown-class"
    assert finding.message.endswith("that IFC4 lacks were left out: IFCALIGNMENT, IFCKERB")


@needs_corpus
@pytest.mark.parametrize(
    ("name", "error", "message"),
    [
        ("derived_dangling_reference", UnreadableError, "refers to something"),
        ("derived_gzip_renamed", UnreadableError, "gzip"),
        ("derived_lfs_pointer", UnreadableError, "Git LFS"),
        ("derived_no_unit_assignment", DrawingError, "unit of length"),
        ("derived_self_referencing_placement", UnreadableError, "refers back to itself"),
        ("derived_truncated_mid_data", UnreadableError, "cut off"),
        ("derived_zero_bytes", UnreadableError, "empty"),
        ("real_empty_data", EmptyPlanError, "no element with geometry"),
        ("real_ifc2x_final_unsupported_schema", UnreadableError, "schema"),
        ("real_ifc4rc4_unsupported_schema", UnreadableError, "schema"),
        ("real_ifc4x3_rc2_road_unsupported", UnreadableError, "schema"),
        ("real_invalid_header", UnreadableError, "ISO-10303-21"),
        ("real_not_a_building_walls_spell_YAY", EmptyPlanError, "enclose nothing"),
        ("real_opens_but_empty", EmptyPlanError, "no element with geometry"),
        ("real_project_only", EmptyPlanError, "no element with geometry"),
        ("real_schema_name_ifc4x3_add1", EmptyPlanError, "no element with geometry"),
        ("real_sewer_pipes_no_storey", EmptyPlanError, "no element with geometry"),
        ("real_single_brep_wall", EmptyPlanError, "enclose nothing"),
        ("real_sjis_bytes_storey_names", InputError, "choose one with --storey"),
        ("real_slab_without_representation_65_openings", EmptyPlanError, "enclose nothing"),
        ("real_syntax_error", UnreadableError, "cannot be parsed"),
    ],
)
def test_bad_models_get_a_clear_message(name: str, error: type[SatAoiError], message: str) -> None:
    with pytest.raises(error, match=message) as caught:
        read(CORPUS / "bad" / f"{name}.ifc", IfcOptions())
    assert "\n" not in str(caught.value)


@needs_corpus
def test_a_model_with_repeated_globalids_is_read_and_says_so() -> None:
    plan = read(CORPUS / "bad" / "real_duplicate_guids.ifc", IfcOptions())
    assert "repeated-globalid" in {finding.code for finding in plan.findings}
