"""The command line: what a run takes and gives."""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import ezdxf
import pytest

from satAOI_adapters import terminal
from satAOI_geo.program import main
from satAOI_geo.progress import Progress
from tests.command_line import ROOT, drawn_room, figures, the_error
from tests.ifc_models import Pen

ROOM_M2 = 16.0
COLUMN_M2 = 0.09
CORNER_M2 = (1 - math.pi / 4) * 0.35**2
"""What the disc leaves in a right-angled corner."""


@pytest.fixture
def room(tmp_path: Path) -> Path:
    return drawn_room(tmp_path / "room.dxf")


def test_the_figures_are_the_output_where_no_other_is_asked_for(
    room: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([str(room)]) == 0
    said = capsys.readouterr()
    assert "16.00 m² (layer)" in said.out
    assert "no file was written" in said.err
    assert list(room.parent.iterdir()) == [room]


def test_run_may_be_left_out(room: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([str(room)]) == 0
    short = capsys.readouterr()
    assert main(["run", str(room)]) == 0
    assert capsys.readouterr() == short


def test_options_may_stand_before_the_plan(room: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert figures(capsys, "--step", 20, room)["lattice"]["step_mm"] == 20


def test_the_area_of_a_room_is_all_but_its_corners(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    report = figures(capsys, drawn_room(tmp_path / "room.dxf"))
    assert report["floor"]["area_m2"] == ROOM_M2
    assert report["floor"]["obstacle_area_m2"] == pytest.approx(COLUMN_M2, rel=1e-12)
    # three corners of the room and two beside the column; the lattice leaves less than one step
    # along the 16 m of walls
    ideal_m2 = ROOM_M2 - COLUMN_M2 - 5 * CORNER_M2
    assert 0 < ideal_m2 - report["aoi"]["area_m2"] < 16 * 0.010


def test_talk_goes_to_standard_error_and_quiet_ends_it(
    room: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = room.with_name("aoi.dxf")
    assert main([str(room), "-o", str(output)]) == 0
    said = capsys.readouterr()
    assert said.out == ""
    assert f"wrote {output}" in said.err
    assert "\x1b" not in said.err  # neither colour nor progress, for this is no terminal
    assert main([str(room), "-o", str(output), "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")


def test_every_output_is_written(room: Path) -> None:
    names = {"aoi.dxf", "aoi.json", "aoi.npz", "aoi.png"}
    drawing, report, array, picture = (str(room.with_name(name)) for name in sorted(names))
    outputs = ["-o", drawing, "-o", picture, "--report", report, "--raster", array]
    assert main([str(room), *outputs]) == 0
    assert {file.name for file in room.parent.iterdir()} == {room.name, *names}


def test_a_storey_of_a_model_goes_into_a_drawing_and_back_into_the_model(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model = ROOT / "samples" / "two_rooms_900.ifc"
    drawing, zones = tmp_path / "aoi.dxf", tmp_path / "aoi.ifc"
    outputs = ["-o", str(drawing), "-o", str(zones)]
    assert main([str(model), "--storey", "1", "--step", "50", *outputs]) == 0
    assert "m²" in capsys.readouterr().err
    assert ezdxf.readfile(drawing).modelspace().query("HATCH[layer=='SATAOI-AOI']")
    assert b"IFCSPATIALZONE" in zones.read_bytes()


def test_an_option_of_drawings_is_refused_for_a_model(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main([str(ROOT / "samples" / "flat.ifc"), "--region", "0,0,1,1"]) == 2
    assert "--region says nothing about a plan in IFC" in the_error(capsys)


@pytest.fixture
def furnished_model(tmp_path: Path) -> Path:
    """A floor of 4 × 4 m with a cupboard of 1 m² and a column of 0.09 m²."""
    pen = Pen()
    cupboard = pen.product("IfcFurniture", pen.box((3000, 0, 0), (4000, 1000, 2000)))
    column = pen.product("IfcColumn", pen.box((3700, 3700, 0), (4000, 4000, 3000)))
    pen.contain(pen.storey(), pen.slab(4000, 4000), cupboard, column)
    return pen.save(tmp_path)


@pytest.mark.parametrize(
    ("asked", "blocked_m2"),
    [
        ([], COLUMN_M2),
        (["--with", "IfcFurniture"], 1 + COLUMN_M2),
        (["--without", "IfcColumn"], 0),
        (["--with", "IfcElement", "--without", "IfcColumn", "--without", "IfcSlab"], 1),
    ],
)
def test_the_command_line_chooses_the_classes_that_block(
    furnished_model: Path,
    asked: list[str],
    blocked_m2: float,
    capsys: pytest.CaptureFixture[str],
) -> None:
    report = figures(capsys, furnished_model, "--step", 100, *asked)
    assert report["floor"]["obstacle_area_m2"] == pytest.approx(blocked_m2, abs=1e-9)


@pytest.mark.parametrize("command", ["run", "inspect"])
def test_a_class_that_does_not_exist_is_refused_in_a_line(
    furnished_model: Path, command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([command, str(furnished_model), "--with", "IfcFurnitur"]) == 2
    assert "give IfcFurniture" in the_error(capsys)


def test_a_terminal_sees_how_far_the_reading_of_a_model_is(
    furnished_model: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[tuple[str, float]] = []

    @contextmanager
    def progress(*, quiet: bool) -> Iterator[Progress]:
        assert not quiet
        yield lambda stage, share: seen.append((stage, share))

    monkeypatch.setattr(terminal, "progress", progress)
    assert main([str(furnished_model), "--step", "100"]) == 0
    shares = [share for stage, share in seen if stage == "reading"]
    # slab and column are looked at twice each, the cupboard only once
    assert shares == [0, *(pytest.approx(n / 6) for n in range(1, 6)), 1]
    assert {stage for stage, _ in seen} > {"reading", "free space", "reach"}


def test_two_runs_write_the_same_report_but_for_the_time(
    room: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    first, second = figures(capsys, room), figures(capsys, room)
    assert first.pop("timing_s").keys() == second.pop("timing_s").keys()
    assert first == second


def test_both_engines_give_the_same_figures(room: Path, capsys: pytest.CaptureFixture[str]) -> None:
    coarse = (room, "--step", 250, "--directions", 4)
    fast = figures(capsys, *coarse)
    reference = figures(capsys, *coarse, "--engine", "reference")
    del fast["timing_s"], reference["timing_s"]
    assert fast == reference


def test_the_start_is_in_drawing_units(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    in_metres = drawn_room(tmp_path / "room.dxf", insunits=6, unit_mm=1000)
    start = figures(capsys, in_metres, "--start", "-0.4,1.2")["start"]
    assert start["source"] == "option"
    assert start["xy_mm"] == pytest.approx([-395, 1205], abs=10)


@pytest.mark.parametrize("align_deg", ["none", "30"])
def test_a_start_with_angles_is_that_pose_in_the_drawings_axes(
    align_deg: str, room: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    start = figures(capsys, room, "--start", "1000,1000,75,-30", "--align", align_deg)["start"]
    assert start["xy_mm"] == pytest.approx([1000, 1000], abs=10)
    assert (start["a1_deg"], start["a2_deg"]) == (pytest.approx(75), pytest.approx(-30))


def test_of_several_plans_the_one_that_is_named_is_read(
    room: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    document = ezdxf.readfile(room)
    outline = [(20_000, 0), (25_000, 0), (25_000, 5000), (20_000, 5000)]
    document.modelspace().add_lwpolyline(outline, close=True, dxfattribs={"layer": "FLOOR"})
    document.save()
    coarse = (room, "--step", 100)
    floors_m2 = {
        figures(capsys, *coarse, *choice)["floor"]["area_m2"]
        for choice in (
            ("--region", "19000,-1000,26000,6000"),
            ("--start", "22500,2500"),
        )
    }
    assert floors_m2 == {25}
    assert {
        figures(capsys, *coarse, "--plan", number)["floor"]["area_m2"] for number in (1, 2)
    } == {16, 25}


def test_the_unit_that_is_given_goes_before_the_headers(
    room: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    report = figures(capsys, room, "--units", "cm", "--step", 100)
    assert report["input"]["unit"] == "cm"
    assert report["floor"]["area_m2"] == pytest.approx(ROOM_M2 * 100, rel=1e-12)


def test_clearance_narrows_the_floor(room: Path, capsys: pytest.CaptureFixture[str]) -> None:
    free = [
        figures(capsys, room, "--clearance", clearance)["free"]["n_nodes"]
        for clearance in (0, 50, 500)
    ]
    assert free == sorted(free, reverse=True)
    assert len(set(free)) == len(free)


def test_a_robot_of_ones_own_is_used(room: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["robots", "magicbim"]) == 0
    file = room.with_name("mine.toml")
    file.write_text(capsys.readouterr().out.replace("350.0", "300.0"), encoding="utf-8")
    assert figures(capsys, room, "--robot", file)["robot"]["disc_radius_mm"] == 300


def test_strict_tells_findings_by_its_exit_code(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plan = drawn_room(tmp_path / "room.dxf")
    document = ezdxf.readfile(plan)
    corners = [(0, 0), (300, 0), (300, 300), (0, 300)]
    document.modelspace().add_lwpolyline(corners, close=True, dxfattribs={"layer": "MYSTERY"})
    document.save()
    assert main([str(plan)]) == 0
    assert "MYSTERY" in capsys.readouterr().err
    assert main([str(plan), "--strict"]) == 1


def test_the_lattice_lies_as_it_is_told(room: Path, capsys: pytest.CaptureFixture[str]) -> None:
    turned = figures(capsys, room, "--step", 100, "--align", "30")["lattice"]
    assert turned["turn_deg"] == pytest.approx(30)
    straight = figures(capsys, room, "--step", 100, "--align", "none")["lattice"]
    assert straight["turn_deg"] == 0
    found = figures(capsys, room, "--step", 100)["lattice"]
    assert (found["turn_deg"], found["turn_source"]) == (0, "walls")
