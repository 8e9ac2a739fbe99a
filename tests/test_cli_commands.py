"""The commands beside `run`, and the help of all of them."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
import rich_click as click

import satAOI_geo
from satAOI_geo.cli import commands
from satAOI_geo.program import main
from tests.command_line import ROOT, drawn_room, figures, the_error

OPTIONS = [
    pytest.param(command, option, id=f"{name} {option.opts[0]}")
    for name, command in commands.commands.items()
    for option in command.params
    if isinstance(option, click.Option)
]


@pytest.fixture
def room(tmp_path: Path) -> Path:
    return drawn_room(tmp_path / "room.dxf")


def test_no_argument_at_all_shows_the_help(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 0
    assert "Usage: satAOI-geo" in capsys.readouterr().out


def test_help_starts_none_of_the_heavy_libraries() -> None:
    heavy = ("numpy", "scipy", "shapely", "numba", "ezdxf", "ifcopenshell", "pydantic", "PIL")
    code = (
        "import sys; from satAOI_geo.program import main; main(['--help']); "
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


def test_a_run_loads_nothing_that_only_other_plans_robots_and_outputs_need(room: Path) -> None:
    others = ("pydantic", "ifcopenshell", "trimesh", "PIL", "rich.console", "distributed")
    code = (
        f"import sys; from satAOI_geo.program import main; main([{str(room)!r}]); "
        f"print('loaded:', *(name for name in {others} if name in sys.modules))"
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
    assert picture.read_bytes().startswith(b"\x89PNG")
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


def test_a_mistyped_command_is_told_as_one(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["runn", "plan.dxf"]) == 2
    assert "did you mean 'run'?" in the_error(capsys)
    # a plan may have such a name
    Path("runn").touch()
    assert main(["runn"]) == 2
    assert "must end in" in the_error(capsys)
