"""Code of dataclasses, kept from run to run."""

from pathlib import Path

import pytest

from satAOI_adapters.kernel_cache import VARIABLE
from tests.command_line import printed

CLASSES = """
from dataclasses import FrozenInstanceError, asdict, dataclass, field, replace

@dataclass(frozen=True, slots=True, kw_only=True)
class Point:
    x_mm: float
    y_mm: float = 0.0

@dataclass(order=True)
class Path:
    points: list = field(default_factory=list)

p = Point(x_mm=1.5)
print(p, p == Point(x_mm=1.5), p == Point(x_mm=2.5), hash(p) == hash(Point(x_mm=1.5)))
print(replace(p, y_mm=3.0), asdict(p), Path([p]), Path([1]) < Path([2]), Path().points is Path())
try:
    p.x_mm = 2.0
except FrozenInstanceError as error:
    print(error)
try:
    Point()
except TypeError as error:
    print(error)
"""
USING_KEPT = "from satAOI_adapters import class_code; class_code.use_kept()\n"
COUNTING = """
import builtins
n, own = 0, compile
def counting(*arguments, **options):
    global n
    n += arguments[1] == "<string>"
    return own(*arguments, **options)
builtins.compile = counting
"""


def said(code: str, folder: Path) -> str:
    """What code prints in a Python of its own whose machine code is kept in a folder."""
    return printed(code, **{VARIABLE: str(folder)})


def kept_in(folder: Path) -> Path:
    """The one file that a folder has."""
    (file,) = folder.iterdir()
    return file


def test_classes_of_kept_code_are_those_that_python_makes(tmp_path: Path) -> None:
    expected = said(CLASSES, tmp_path)
    assert expected.count("\n") == 4
    assert said(USING_KEPT + CLASSES, tmp_path) == expected
    assert kept_in(tmp_path).stat().st_size > 0
    assert said(USING_KEPT + CLASSES, tmp_path) == expected


def test_what_is_kept_is_not_compiled_again(tmp_path: Path) -> None:
    code = f"{USING_KEPT}{COUNTING}{CLASSES}print(n)"
    first, second = (int(said(code, tmp_path).split()[-1]) for _ in range(2))
    # each class has an __init__, a __repr__ and an __eq__ at least
    assert first >= 6
    assert second == 0


def test_the_file_is_left_alone_where_nothing_has_come_up(tmp_path: Path) -> None:
    said(USING_KEPT + CLASSES, tmp_path)
    before = kept_in(tmp_path).stat()
    said(USING_KEPT + CLASSES, tmp_path)
    after = kept_in(tmp_path).stat()
    assert (after.st_ino, after.st_mtime_ns) == (before.st_ino, before.st_mtime_ns)


@pytest.mark.parametrize("harm", [slice(0), slice(40), slice(-1)])
def test_code_that_has_come_to_harm_is_made_anew(tmp_path: Path, harm: slice) -> None:
    expected = said(USING_KEPT + CLASSES, tmp_path)
    file = kept_in(tmp_path)
    whole = file.read_bytes()
    file.write_bytes(whole[harm])
    assert said(USING_KEPT + CLASSES, tmp_path) == expected
    assert file.read_bytes() == whole


def test_code_of_another_python_is_made_anew(tmp_path: Path) -> None:
    another = "import importlib.util; importlib.util.MAGIC_NUMBER = b'another'\n"
    expected = said(another + USING_KEPT + CLASSES, tmp_path)
    code = f"{USING_KEPT}{COUNTING}{CLASSES}print(n)"
    assert int(said(code, tmp_path).split()[-1]) >= 6
    assert said(USING_KEPT + CLASSES, tmp_path) == expected


def test_without_a_place_that_lasts_nothing_is_kept(tmp_path: Path) -> None:
    nowhere = (
        "from satAOI_adapters import kernel_cache; kernel_cache.place = lambda: None\n"
        "import dataclasses\n"
    )
    code = f"{nowhere}{USING_KEPT}print('exec' in vars(dataclasses))"
    assert said(code, tmp_path) == "False\n"
    assert not list(tmp_path.iterdir())


def test_where_nothing_can_be_written_all_is_as_ever(tmp_path: Path) -> None:
    not_a_folder = tmp_path / "file"
    not_a_folder.touch()
    assert said(USING_KEPT + CLASSES, not_a_folder) == said(CLASSES, not_a_folder)
