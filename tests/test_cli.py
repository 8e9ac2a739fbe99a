"""The command line: what goes where, and with which exit code."""

import json
import math
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import ezdxf
import pytest
import rich_click as click

import satAOI_geo
from satAOI_adapters import terminal
from satAOI_geo import pipeline
from satAOI_geo.cli import commands, main
from satAOI_geo.progress import Progress
from tests.ifc_models import Pen

ROOT = Path(__file__).parents[1]
ROOM_M2 = 16.0
COLUMN_M2 = 0.09
CORNER_M2 = (1 - math.pi / 4) * 0.35**2
"""What the disc leaves in a right-angled corner."""

OPTIONS = [
    pytest.param(command, option, id=f"{name} {option.opts[0]}")
    for name, command in commands.commands.items()
    for option in command.params
    if isinstance(option, click.Option)
]


def drawn_room(file: Path, *, insunits: int = 4, unit_mm: float = 1.0) -> Path:
    """A room of 4 × 4 m with its lower left corner at (-1, -1) m, a column at its top right.

    (-1, 3) ┌───────┬┐
            │       └┤  300 × 300 mm
            │        │
    (-1,-1) └────────┘ (3, -1)
    """
    document = ezdxf.new("R2010")
    document.header["$INSUNITS"] = insunits
    for layer, left, bottom, side in (("FLOOR", -1000, -1000, 4000), ("COLUMN", 2700, 2700, 300)):
        corners = [(0, 0), (side, 0), (side, side), (0, side)]
        points = [((left + x) / unit_mm, (bottom + y) / unit_mm) for x, y in corners]
        document.modelspace().add_lwpolyline(points, close=True, dxfattribs={"layer": layer})
    document.saveas(file)
    return file


@pytest.fixture
def room(tmp_path: Path) -> Path:
    return drawn_room(tmp_path / "room.dxf")


def figures(capsys: pytest.CaptureFixture[str], *arguments: object) -> dict:
    """The report of a run that is expected to go well."""
    assert main([*map(str, arguments), "--report", "-"]) == 0
    return json.loads(capsys.readouterr().out)


def the_error(capsys: pytest.CaptureFixture[str]) -> str:
    """The one line that a failed run says."""
    said = capsys.readouterr()
    assert said.out == ""
    (line,) = said.err.splitlines()
    assert line.startswith("error: ")
    return line


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


@pytest.mark.parametrize(
    ("arguments", "code", "complaint"),
    [
        (["--start", "1"], 2, "'1' is not two numbers with a comma"),
        (["--start", "1;2"], 2, "'1;2' is not two numbers with a comma"),
        (["--start", "1,2,3"], 2, "nor four, as in 3200,1500.5,90,0"),
        (["--start", "nan,0"], 2, "'nan,0' is not two numbers with a comma"),
        (["--start", "1,2,0,inf"], 2, "'1,2,0,inf' is not two numbers"),
        (["--start", "1000,1000,0,91"], 2, "from -90° to 90°; give a start within"),
        (["--start", "-600,1000,180,0"], 4, "this pose is not free; the edge of the floor"),
        (["--step", "0"], 2, "0"),
        (["--align", "up"], 2, "'up' is neither an angle"),
        (["--step", "ten"], 2, "'ten' is not a valid float"),
        (["--directions", "7"], 2, "multiple of 4"),
        (["--clearance", "-1"], 2, "clearance"),
        (["--storey", "2"], 2, "--storey says nothing about a plan in DXF"),
        (["--floor-z", "0"], 2, "--floor-z says nothing about a plan in DXF"),
        (["--with", "IfcDoor"], 2, "--with says nothing about a plan in DXF"),
        (["--without", "IfcWall"], 2, "--without says nothing about a plan in DXF"),
        (["--region", "1,2,3"], 2, "'1,2,3' is not four numbers with commas"),
        (["--plan", "9"], 2, "there is no plan 9"),
        (["--units", "parsec"], 2, "'parsec' is not one of"),
        (["--robot", "r2d2"], 2, "no robot 'r2d2'"),
        (["--layers", "none.toml"], 2, "none.toml"),
        (["--nonsense"], 2, "--nonsense"),
        (["-o", "aoi.odt"], 2, "must end in"),
        (["-o", "aoi.ifc"], 2, "'aoi.ifc' adds to an IFC model, and 'room.dxf' is none"),
        (["-o", "aoi.dxf", "-o", "aoi.dxf"], 2, "asked for twice"),
        (["-o", "nowhere/aoi.dxf"], 2, "no folder 'nowhere'"),
        (["-o", "room.dxf"], 2, "is an input"),
        (["--report", "room.dxf"], 2, "is an input"),
        (["-o", "aoi.dxf", "--report", "aoi.dxf"], 2, "asked for twice"),
        (["--start", "2800,2800"], 4, "on layer 'COLUMN' is in the way"),
        (["--start", "90000,90000"], 4, "outside"),
        (["--clearance", "5000"], 4, "nowhere"),
        (["--step", "0.001"], 5, "nodes"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_bad_input_is_one_line_and_an_exit_code(
    arguments: list[str],
    code: int,
    complaint: str,
    room: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(room.parent)
    before = room.read_bytes()
    assert main([room.name, "--quiet", *arguments]) == code
    assert complaint in the_error(capsys)
    assert list(room.parent.iterdir()) == [room]
    assert room.read_bytes() == before


@pytest.mark.parametrize(
    ("name", "content", "code", "complaint"),
    [
        ("missing.dxf", None, 3, "missing.dxf"),
        ("empty.dxf", b"", 3, "empty.dxf"),
        ("picture.dxf", b"\x89PNG\r\n\x1a\n" + bytes(64), 3, "picture.dxf"),
        ("plan.dwg", b"AC1032", 2, "save the drawing as DXF"),
        ("plan", b"", 2, "must end in"),
    ],
)
def test_a_file_that_is_no_drawing_is_one_line_and_an_exit_code(
    name: str,
    content: bytes | None,
    code: int,
    complaint: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    plan = tmp_path / name
    if content is not None:
        plan.write_bytes(content)
    assert main([str(plan), "--quiet"]) == code
    assert complaint in the_error(capsys)


def test_a_drawing_without_a_unit_says_which_option_supplies_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # 400 units may be 4 m in cm, or as well 10 m in inches
    plan = drawn_room(tmp_path / "room.dxf", insunits=0, unit_mm=10)
    assert main([str(plan), "--quiet"]) == 3
    assert "--units" in the_error(capsys)


def test_no_argument_at_all_shows_the_help(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 0
    assert "Usage: satAOI-geo" in capsys.readouterr().out


def test_an_interrupt_has_an_exit_code_of_its_own(
    room: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(pipeline, "area_of_interest", interrupted)
    output = room.with_name("aoi.dxf")
    assert main([str(room), "--quiet", "-o", str(output)]) == 130
    assert "error: interrupted" in capsys.readouterr().err
    assert not output.exists()


def test_too_little_memory_is_a_limit(
    room: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def exhausted(*_: object, **__: object) -> None:
        raise MemoryError

    monkeypatch.setattr(pipeline, "area_of_interest", exhausted)
    assert main([str(room), "--quiet"]) == 5
    assert "coarser --step" in the_error(capsys)


def test_a_mistake_of_the_program_is_not_made_to_look_like_bad_input(
    room: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def mistaken(*_: object, **__: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr(pipeline, "area_of_interest", mistaken)
    with pytest.raises(ZeroDivisionError):
        main([str(room), "--quiet"])


def test_names_that_are_no_text_are_printed_all_the_same(tmp_path: Path) -> None:
    plan = drawn_room(tmp_path / "room.dxf").rename(os.fsdecode(bytes(tmp_path) + b"/\xff.dxf"))
    done = program(str(plan), "--step", "100", "-o", str(tmp_path / "aoi.dxf"))
    assert done.returncode == 0, done.stderr
    assert program(f"{plan}x").returncode == 2


def program(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """The program as a shell would start it."""
    start = "import sys; sys.path[:0] = sys.argv.pop(1).split('|'); "
    start += "from satAOI_geo.cli import main; sys.exit(main())"
    return subprocess.run(
        [sys.executable, "-W", "error", "-c", start, f"{ROOT}|{ROOT / 'adapters'}", *arguments],
        capture_output=True,
        encoding="utf-8",
        errors="replace",
        env={**os.environ, **environment},
        check=False,
        timeout=300,
    )


def test_help_starts_none_of_the_heavy_libraries() -> None:
    heavy = ("numpy", "scipy", "shapely", "numba", "ezdxf", "ifcopenshell", "pydantic", "PIL")
    code = (
        "import sys; from satAOI_geo.cli import main; main(['--help']); "
        f"print('loaded:', *(name for name in {heavy} if name in sys.modules))"
    )
    done = subprocess.run(
        [sys.executable, "-c", f"import sys; sys.path[:0] = ['.', 'adapters']; {code}"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.splitlines()[-1] == "loaded:"


@pytest.mark.parametrize(("command", "option"), OPTIONS)
def test_every_option_has_help_and_where_it_takes_a_value_an_example(
    command: click.Command, option: click.Option
) -> None:
    assert option.help, command.name
    if not option.is_flag:
        longest = max(option.opts, key=len)
        assert f"e.g. {longest} " in option.help


@pytest.mark.parametrize("name", commands.commands)
def test_every_command_has_help(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([name, "--help"]) == 0
    assert f"satAOI-geo {name}" in capsys.readouterr().out


def test_an_inspection_is_a_table_of_layers(room: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["inspect", str(room)]) == 0
    said = capsys.readouterr()
    assert "COLUMN" in said.out
    assert "4.00 × 4.00 m" in said.out
    assert said.err == ""


def test_an_inspection_in_json_is_nothing_else(
    room: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["inspect", str(room), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["source"]["unit"] == "mm"


def test_an_inspection_draws_the_plan_and_writes_its_layers(
    room: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    picture, layers = room.with_name("room.png"), room.with_name("mine.toml")
    written = ["--picture", str(picture), "--write-layers", str(layers)]
    assert main(["inspect", str(room), *written]) == 0
    said = capsys.readouterr()
    assert "COLUMN" in said.out
    assert said.err == f"note: wrote {layers}\nnote: wrote {picture}\n"
    assert picture.read_bytes().startswith(b"\x89PNG")
    without = figures(capsys, room, "--step", 100)
    with_layers = figures(capsys, room, "--step", 100, "--layers", layers)
    del without["timing_s"], with_layers["timing_s"]
    assert with_layers == without


def test_a_model_is_drawn_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    picture = tmp_path / "storey.svg"
    model = ROOT / "samples" / "two_rooms_900.ifc"
    assert main(["inspect", str(model), "--picture", str(picture)]) == 0
    assert "storey" in capsys.readouterr().out
    assert b"<svg" in picture.read_bytes()


def test_an_inspection_tells_the_layers_of_a_drawing_whose_unit_is_not_known(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plan = drawn_room(tmp_path / "room.dxf", insunits=0, unit_mm=10)
    layers, picture = tmp_path / "mine.toml", tmp_path / "room.png"
    written = ["--write-layers", str(layers), "--picture", str(picture)]
    assert main(["inspect", str(plan), *written]) == 3
    said = capsys.readouterr()
    assert "COLUMN" in said.out
    assert "=COLUMN" in layers.read_text(encoding="utf-8")
    assert not picture.exists()
    assert said.err.splitlines()[-1].startswith("error: no unit of length")
    assert main(["inspect", str(plan), "--json"]) == 3
    assert "--units" in json.loads(capsys.readouterr().out)["error"]


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["--picture", "plan.pdf"], "must end in .png or .svg"),
        (["--write-layers", "layers.dxf"], "must end in .toml"),
        (["--picture", "nowhere/plan.png"], "no folder 'nowhere'"),
        (["--layers", "mine.toml", "--write-layers", "mine.toml"], "is an input"),
        (["--plan", "9"], "there is no plan 9"),
    ],
    ids=" ".join,
)
def test_an_inspection_that_cannot_be_written_is_one_line_and_an_exit_code(
    arguments: list[str],
    complaint: str,
    room: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(room.parent)
    Path("mine.toml").write_text("", encoding="utf-8")
    assert main(["inspect", room.name, *arguments]) == 2
    assert complaint in capsys.readouterr().err
    assert {file.name for file in room.parent.iterdir()} == {"room.dxf", "mine.toml"}


def test_layers_of_a_model_cannot_be_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model = ROOT / "samples" / "two_rooms_900.ifc"
    assert main(["inspect", str(model), "--write-layers", str(tmp_path / "mine.toml")]) == 2
    assert "--write-layers says nothing about a plan in IFC" in the_error(capsys)


def test_the_version_is_the_packages(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"satAOI-geo {satAOI_geo.__version__}\n"


@pytest.mark.parametrize(
    ("at", "word"),
    [
        ("1,1", "trowels"),
        ("2.85,2.85", "COLUMN"),
        ("-0.99,-0.99", "left over"),
        ("9,9", "not on the floor"),
    ],
)
def test_a_point_is_explained_in_a_sentence(
    at: str, word: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plan = drawn_room(tmp_path / "room.dxf", insunits=6, unit_mm=1000)
    assert main(["explain", str(plan), "--at", at, "--step", "100"]) == 0
    said = capsys.readouterr()
    assert word in said.out
    assert len(said.out.splitlines()) == 1


def test_an_explanation_needs_a_point(room: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["explain", str(room)]) == 2
    assert "--at" in the_error(capsys)


def test_the_lattice_lies_as_it_is_told(room: Path, capsys: pytest.CaptureFixture[str]) -> None:
    turned = figures(capsys, room, "--step", 100, "--align", "30")["lattice"]
    assert turned["turn_deg"] == pytest.approx(30)
    straight = figures(capsys, room, "--step", 100, "--align", "none")["lattice"]
    assert straight["turn_deg"] == 0
    found = figures(capsys, room, "--step", 100)["lattice"]
    assert (found["turn_deg"], found["turn_source"]) == (0, "walls")


def test_the_robots_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["robots"]) == 0
    heads, *rows = capsys.readouterr().out.splitlines()
    assert heads.startswith("name")
    assert [row.split()[0] for row in rows] == list(satAOI_geo.ROBOTS)


def test_the_demos_plan_is_one_of_the_samples() -> None:
    (plan,) = (ROOT / "adapters" / "satAOI_adapters" / "demo").iterdir()
    assert plan.read_bytes() == (ROOT / "samples" / plan.name).read_bytes()


def test_the_demo_needs_no_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["demo", "-o", "demo.dxf"]) == 0
    assert "m² (layer)" in capsys.readouterr().err
    assert [file.name for file in tmp_path.iterdir()] == ["demo.dxf"]
