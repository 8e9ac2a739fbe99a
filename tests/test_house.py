"""The rules of the house, checked by the tools that know them."""

import ast
import re
import subprocess
import sys
import tomllib
import zipfile
from importlib import import_module
from pathlib import Path

import pytest

import satAOI_geo
from satAOI_adapters.exit_codes import DONE, FINDINGS, INTERRUPTED
from satAOI_geo.cli import commands
from satAOI_geo.program import EXIT_CODES

ROOT = Path(__file__).parents[1]
CORE = ROOT / "satAOI_geo"


def configuration() -> dict:
    return tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def run(*command: str) -> None:
    """Run a checker at the root of the project; its words are the failure's message."""
    done = subprocess.run(
        [sys.executable, "-m", *command], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_ruff_finds_nothing() -> None:
    run("ruff", "check", ".")


def test_every_file_is_formatted() -> None:
    run("ruff", "format", "--check", ".")


def test_every_type_holds() -> None:
    run("mypy")


def test_imports_point_one_way() -> None:
    source = "import sys; from importlinter.cli import lint_imports; sys.exit(lint_imports())"
    path = f"import sys; sys.path[:0] = ['.', 'adapters']; {source}"
    done = subprocess.run(
        [sys.executable, "-c", path], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_import_contracts_name_every_module() -> None:
    modules = {f"satAOI_geo.{file.stem}" for file in CORE.glob("*.py")} - {"satAOI_geo.__init__"}
    direction, core = configuration()["tool"]["importlinter"]["contracts"]
    layers = [name.strip() for layer in direction["layers"] for name in layer.split("|")]
    assert set(layers) == modules | {"satAOI_adapters"}
    assert set(core["source_modules"]) == set(layers[layers.index("satAOI_adapters") + 1 :])


def test_the_wheel_holds_two_packages_and_all_their_files(tmp_path: Path) -> None:
    run("hatchling", "build", "-t", "wheel", "-d", str(tmp_path))
    (wheel,) = tmp_path.glob("*.whl")
    names = [name for name in zipfile.ZipFile(wheel).namelist() if ".dist-info/" not in name]
    assert {name.split("/")[0] for name in names} == {"satAOI_geo", "satAOI_adapters"}
    tracked = {
        str(file.relative_to(root))
        for root in (ROOT, ROOT / "adapters")
        for package in ("satAOI_geo", "satAOI_adapters")
        for file in (root / package).rglob("*")
        if file.is_file() and "__pycache__" not in file.parts
    }
    assert set(names) == tracked


@pytest.mark.parametrize("name", satAOI_geo.__all__)
def test_every_public_name_is_there(name: str) -> None:
    assert getattr(satAOI_geo, name) is not None
    assert name in dir(satAOI_geo)


def test_no_public_name_is_hidden_by_a_module_of_the_same_name() -> None:
    assert not {file.stem for file in CORE.glob("*.py")} & set(satAOI_geo.__all__)


def test_every_public_name_is_also_known_to_type_checkers() -> None:
    tree = ast.parse((CORE / "__init__.py").read_text(encoding="utf-8"))
    imported = {
        alias.name
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("satAOI_geo.")
        for alias in node.names
    }
    assert imported == set(satAOI_geo.__all__)


def test_every_error_is_public() -> None:
    errors = import_module("satAOI_geo.errors")
    defined = {name for name, value in vars(errors).items() if isinstance(value, type)}
    assert defined <= set(satAOI_geo.__all__)


def test_a_name_that_is_not_public_is_not_there() -> None:
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        _ = satAOI_geo.nonsense


def test_the_continuous_check_runs_the_test_command_of_the_readme() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    last_line = (ROOT / ".ci" / "run").read_text(encoding="utf-8").strip().splitlines()[-1]
    assert last_line in readme


def test_the_readme_names_every_option_and_every_exit_code() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    options = {
        opt for command in commands.commands.values() for p in command.params for opt in p.opts
    }
    assert {opt for opt in options if opt.startswith("--") and f"`{opt}" not in readme} == set()
    for code in {DONE, FINDINGS, INTERRUPTED, *EXIT_CODES.values()}:
        assert re.search(rf"^\| {code} \|", readme, re.MULTILINE)


def test_every_option_that_a_message_names_is_there() -> None:
    sources = [*CORE.glob("*.py"), *(ROOT / "adapters").rglob("*.py")]
    texts = {
        node.value
        for source in sources
        for node in ast.walk(ast.parse(source.read_text(encoding="utf-8")))
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    }
    named = {option for text in texts for option in re.findall(r"--[a-z][a-z-]+", text)}
    own = {
        option
        for command in commands.commands.values()
        for p in command.params
        for option in p.opts
    }
    assert named - own - {"--help", "--version"} == set()


def test_the_changelog_has_the_version_on_top() -> None:
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    versions = re.findall(r"^## \[?(\d+\.\d+\.\d+)", changelog, re.MULTILINE)
    assert versions[0] == satAOI_geo.__version__


def test_no_file_names_the_machine_it_was_written_on() -> None:
    tracked = subprocess.run(
        ["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    if tracked.returncode:
        pytest.skip("not a git checkout")
    places = re.compile(r"(?<![\w.])/(?:work|home|root|Users)/\w")
    files = [ROOT / name for name in tracked.stdout.split("\0") if name]
    named = {
        file.name
        for file in files
        if file.is_file() and places.search(file.read_text(encoding="utf-8", errors="replace"))
    }
    assert named == set()


def test_the_python_of_the_readme_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"```python\n(.*?)```", readme, re.DOTALL)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "samples").symlink_to(ROOT / "samples")
    exec(compile(block, "README.md", "exec"), {})  # noqa: S102  that is what a reader does
    assert capsys.readouterr().out.endswith(" m²\n")
    assert (tmp_path / "aoi.dxf").exists()


def test_the_commands_of_the_readme_name_commands_and_options_that_exist() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    blocks = "\n".join(re.findall(r"```bash\n(.*?)```", readme, re.DOTALL))
    for line in re.findall(r"satAOI-geo (.*)", blocks):
        words = line.split("#")[0].split(">")[0].split()
        command = commands.commands.get(words[0], commands.commands["run"])
        own = {option for parameter in command.params for option in parameter.opts}
        assert {word for word in words if word.startswith("-")} <= own
