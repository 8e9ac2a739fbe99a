"""What goes wrong on the command line: one line, and an exit code that tells whose turn it is."""

import os
import shlex
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from satAOI_geo import pipeline
from satAOI_geo.kernels import VARIABLE
from satAOI_geo.program import main
from tests.command_line import ROOT, START, drawn_room, program, the_error


@pytest.fixture
def room(tmp_path: Path) -> Path:
    return drawn_room(tmp_path / "room.dxf")


@pytest.mark.parametrize(
    ("arguments", "code", "complaint"),
    [
        (["--start", "1"], 2, "'1' is not two numbers with a comma"),
        (["--start", "1;2"], 2, "'1;2' is not two numbers with a comma"),
        (["--start", "1,2,3"], 2, "nor four numbers with commas, as in 3200,1500.5,90,0"),
        (["--start", "nan,0"], 2, "'nan,0' is not two numbers with a comma"),
        (["--start", "1,2,0,inf"], 2, "'1,2,0,inf' is not two numbers"),
        (["--start", "1000,1000,0,91"], 2, "from -90° to 90°; give a start within"),
        (["--start", "-600,1000,180,0"], 4, "this pose is not free; the edge of the floor"),
        (["--step", "0"], 2, "0"),
        (["--step", "5e-324"], 2, "give a length of at least 0.001"),
        (["--step", "701"], 2, "is 700 mm wide; give a shorter --step"),
        (["--align", "up"], 2, "'up' is neither an angle"),
        (["--step", "ten"], 2, "'ten' is not a valid float"),
        (["--directions", "7"], 2, "multiple of 4"),
        (["--clearance", "-1"], 2, "clearance"),
        (["--clearance", "1e20"], 2, "give 0 to 1e+06"),
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
        (["--report", "room.dxf"], 2, "give a name that ends in .json"),
        (["--raster", "aoi.dxf"], 2, "give a name that ends in .png or .npz"),
        (["-o", "aoi.png", "--raster", "aoi.png"], 2, "asked for twice"),
        (["--region", "90000,90000,91000,91000"], 2, "nothing of the drawing lies in the region"),
        (["--close-gaps", "nan"], 2, "give 0 to 500"),
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


@pytest.mark.skipif(sys.platform == "win32", reason="Windows ends processes in its own way")
@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP"])
def test_a_signal_to_end_is_one_line_and_leaves_nothing(tmp_path: Path, name: str) -> None:
    number = getattr(signal, name)
    hall = str(ROOT / "samples" / "hall_complex.dxf")
    running = subprocess.Popen(
        [sys.executable, "-c", START, f"{ROOT}|{ROOT / 'adapters'}", hall, "--step", "2"],
        env={**os.environ, VARIABLE: "", "XDG_CACHE_HOME": "/proc", "TMPDIR": str(tmp_path)},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
    )
    # without a folder that lasts there is one for this run, which it removes
    while not list(tmp_path.iterdir()):
        assert running.poll() is None
        time.sleep(0.05)
    running.send_signal(number)
    _, said = running.communicate(timeout=60)
    assert said.decode().splitlines()[-1] == f"error: ended by {name}"
    assert running.returncode == 128 + number
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(sys.platform == "win32", reason="a shell of Unix")
@pytest.mark.parametrize(("closed", "code"), [(">&-", 0), ("2>&-", 0)])
def test_what_is_printed_to_may_be_closed(room: Path, closed: str, code: int) -> None:
    asked = shlex.join([sys.executable, "-c", START, f"{ROOT}|{ROOT / 'adapters'}", str(room)])
    done = subprocess.run(["sh", "-c", f"{asked} {closed}"], capture_output=True, check=False)
    assert done.returncode == code
    assert b"Traceback" not in done.stderr


def test_an_output_is_known_by_any_of_its_names(
    room: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (room.parent / "sub").mkdir()
    one, other = room.parent / "aoi.dxf", room.parent / "sub" / ".." / "aoi.dxf"
    assert main([str(room), "-o", str(one), "-o", str(other)]) == 2
    assert "asked for twice" in the_error(capsys)


def test_an_interrupt_while_the_program_loads_is_one_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted() -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("satAOI_geo.program.make_ready", interrupted)
    assert main(["robots"]) == 130
    assert capsys.readouterr().err == "error: interrupted\n"


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


def test_an_error_without_a_number_is_told_in_its_own_words(
    room: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail(*_: object, **__: object) -> None:
        raise OSError("Timed out during handshake")

    monkeypatch.setattr(pipeline, "area_of_interest", fail)
    assert main([str(room)]) == 2
    assert the_error(capsys).endswith("Timed out during handshake")


def test_names_that_are_no_text_are_printed_all_the_same(tmp_path: Path) -> None:
    plan = drawn_room(tmp_path / "room.dxf").rename(os.fsdecode(bytes(tmp_path) + b"/\xff.dxf"))
    done = program(str(plan), "--step", "100", "-o", str(tmp_path / "aoi.dxf"))
    assert done.returncode == 0, done.stderr
    assert program(f"{plan}x").returncode == 2
