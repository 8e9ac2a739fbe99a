"""Kernels run as machine code that is made once, and what they are given is looked at first."""

import os
import re
import subprocess
import sys
from collections.abc import Callable
from ctypes import ArgumentError
from importlib.metadata import version
from pathlib import Path
from zipfile import ZipFile

import llvmlite.binding as llvm
import numpy as np
import pytest

from satAOI_geo import bitcode, kernels
from satAOI_geo.kept import read
from satAOI_geo.kernels import KERNELS, N_KEPT, VARIABLE, Kernel, filled, helper, kernel
from satAOI_geo.machine_code import machine, object_file, target_machine
from satAOI_geo.plan import FloatArray, IntArray
from tests.command_line import ROOT, drawn_room

WEIGHTED = "float64(const int64[:], const float64[:, :], float64, int64)"
WEIGHT = 3

of_the_same_sort = pytest.mark.skipif(
    not target_machine().triple.startswith("x86_64"),
    reason="the bitcode that comes with the program is for x86-64",
)


@helper
def weighted(value: float) -> float:
    return WEIGHT * value


def total(columns: IntArray, table: FloatArray, power: float, sign: int) -> float:
    """Of some of a table's columns, by all a kernel may use: loops, helpers, functions of C."""
    found = 0.0
    for row in range(table.shape[0]):
        for k in range(columns.size):
            found += weighted(np.sin(table[row, columns[k]]) % power)
    return sign * found


def number_up(count: int, numbers: IntArray) -> int:
    """As many numbers as there is room for."""
    for k in range(min(count, numbers.shape[0])):
        numbers[k, 0] = k
    return count


def of(function: Callable[..., object], signature: str) -> Kernel:
    """A kernel that is none of the program's."""
    made = kernel(signature)(function)
    KERNELS.remove(made)
    return made


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where machine code is kept, empty at first."""
    monkeypatch.setenv(VARIABLE, str(tmp_path / "code"))
    return tmp_path / "code"


COLUMNS = np.array([2, 0])
TABLE = np.arange(12.0).reshape(4, 3)


def test_a_kernel_gives_what_its_python_gives(folder: Path) -> None:
    expected = total(COLUMNS, TABLE, 0.7, -1)
    compiled, found_again = of(total, WEIGHTED), of(total, WEIGHTED)
    assert compiled(COLUMNS, TABLE, 0.7, -1) == expected
    (kept,) = folder.iterdir()
    written = kept.stat().st_mtime_ns
    assert found_again(COLUMNS, TABLE, 0.7, -1) == expected
    assert kept.stat().st_mtime_ns == written


@pytest.mark.usefixtures("folder")
def test_an_empty_array_has_no_elements() -> None:
    assert of(total, WEIGHTED)(COLUMNS, np.empty((0, 3)), 0.7, 1) == 0.0


@pytest.mark.parametrize("harm", [b"", b"nonsense", None])
def test_machine_code_that_came_to_harm_is_made_anew(folder: Path, harm: bytes | None) -> None:
    of(total, WEIGHTED).ready()
    (kept,) = folder.iterdir()
    whole = kept.read_bytes()
    harmed = whole[:-1] if harm is None else harm
    kept.write_bytes(harmed)
    assert of(total, WEIGHTED)(COLUMNS, TABLE, 0.7, 1) == total(COLUMNS, TABLE, 0.7, 1)
    assert read(str(kept)) is not None


def test_machine_code_of_changed_sources_makes_room_for_new(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    of(number_up, "int64(int64, int64[:, :])").ready()
    made = []
    for weight in range(N_KEPT + 2):
        monkeypatch.setattr(sys.modules[__name__], "WEIGHT", weight)
        made.append(of(total, WEIGHTED))
        made[-1].ready()
        os.utime(made[-1]._path(), (weight, weight))
    assert [each.is_kept() for each in made] == [False] * 2 + [True] * N_KEPT
    assert len(list(folder.iterdir())) == N_KEPT + 1


@pytest.mark.usefixtures("folder")
def test_machine_code_is_another_for_other_types_and_for_changed_helpers(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    of(total, WEIGHTED).ready()
    assert of(total, WEIGHTED).is_kept()
    assert not of(total, WEIGHTED.replace("int64)", "int32)")).is_kept()
    monkeypatch.setattr(weighted, "__code__", (lambda value: WEIGHT + value).__code__)
    assert not of(total, WEIGHTED).is_kept()


@pytest.mark.parametrize("package", ["numba", "llvmlite"])
def test_machine_code_is_another_for_another_release_of_what_makes_it(package: str) -> None:
    assert f"{package}-{version(package)}." in machine()


def test_without_a_place_to_write_a_kernel_runs_all_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    not_a_folder = tmp_path / "file"
    not_a_folder.touch()
    monkeypatch.setenv(VARIABLE, str(not_a_folder))
    unkept = of(total, WEIGHTED)
    assert unkept(COLUMNS, TABLE, 0.7, 1) == total(COLUMNS, TABLE, 0.7, 1)
    assert not unkept.is_kept()


def test_without_a_folder_chosen_it_is_kept_beside_what_python_has_compiled(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv(VARIABLE, "")
    assert Path(of(total, WEIGHTED)._path()).parent == Path(kernels.__file__).parent / "__pycache__"


def test_machine_code_that_calls_python_is_not_kept(folder: Path) -> None:
    def allocating(n: int) -> float:
        return np.ones(n).sum()

    assert of(allocating, "float64(int64)")(5) == 5.0
    assert not folder.exists()


@pytest.mark.parametrize(
    "table",
    [
        TABLE.astype(np.float32),
        TABLE.astype(">f8"),
        TABLE[0],
        TABLE[np.newaxis],
        TABLE.tolist(),
        None,
        7.0,
    ],
)
@pytest.mark.usefixtures("folder")
def test_what_is_not_the_array_expected_is_refused(table: object) -> None:
    with pytest.raises(TypeError, match=r"an array .*is expected"):
        of(total, WEIGHTED)(COLUMNS, table, 0.7, 1)


@pytest.mark.parametrize("number", ["0.7", None, TABLE, 0.7j])
@pytest.mark.usefixtures("folder")
def test_what_is_not_the_number_expected_is_refused(number: object) -> None:
    with pytest.raises(ArgumentError):
        of(total, WEIGHTED)(COLUMNS, TABLE, number, 1)


@pytest.mark.usefixtures("folder")
def test_too_few_arguments_are_refused() -> None:
    with pytest.raises(ValueError, match="shorter"):
        of(total, WEIGHTED)(COLUMNS, TABLE)


@pytest.mark.usefixtures("folder")
def test_an_array_that_is_only_read_may_lie_in_memory_as_it_likes() -> None:
    expected = total(COLUMNS, TABLE, 0.7, 1)
    summed = of(total, WEIGHTED)
    for_reading = TABLE.copy()
    for_reading.flags.writeable = False
    at_an_odd_address = np.frombuffer(b"." + TABLE.tobytes(), offset=1).reshape(TABLE.shape)
    others = np.repeat(TABLE, 2, axis=1)[:, ::2]
    for table in (for_reading, at_an_odd_address, others, np.asfortranarray(TABLE)):
        assert summed(COLUMNS, table, 0.7, 1) == expected


@pytest.mark.usefixtures("folder")
def test_an_array_to_write_to_must_be_one_and_in_order() -> None:
    numbered = of(number_up, "int64(int64, int64[:, :])")
    room = np.zeros((4, 1), dtype=np.int64)
    assert numbered(np.int64(9), room) == 9
    assert room.ravel().tolist() == [0, 1, 2, 3]
    room.flags.writeable = False
    for wrong in (room, np.zeros((4, 2), dtype=np.int64)[:, :1]):
        with pytest.raises(TypeError, match="order of C, or not to be written to"):
            numbered(4, wrong)


@pytest.mark.parametrize("n_rows", [0, 3, 5, 8])
def test_rows_for_which_there_was_no_room_are_there_the_second_time(n_rows: int) -> None:
    rows = filled(lambda room: number_up(n_rows, room), np.zeros((5, 1), dtype=np.int64))
    assert rows.ravel().tolist() == list(range(n_rows))


def test_machine_code_of_all_kernels_of_the_program_is_kept() -> None:
    for each in KERNELS:
        each.ready()
    assert len(KERNELS) > 10
    assert {each.__name__ for each in KERNELS if not each.is_kept()} == set()


def test_bitcode_of_all_kernels_comes_with_the_program() -> None:
    names = sorted(each.bitcode_name for each in KERNELS)
    with ZipFile(bitcode.ARCHIVE) as archive:
        assert sorted(archive.namelist()) == names, "run python -m satAOI_adapters.bitcode_write"


@of_the_same_sort
def test_bitcode_that_comes_with_the_program_is_all_that_its_machine_code_needs() -> None:
    for each in KERNELS:
        code = each.shipped()
        assert code is not None
        assert object_file(code, each.__name__) is not None, each


def test_bitcode_that_comes_with_the_program_knows_no_processor_and_no_folder() -> None:
    for each in KERNELS:
        code = each.shipped()
        assert code is not None
        text = str(llvm.parse_bitcode(code))
        assert "target-cpu" not in text
        assert not re.search(r"<\d+ x (i|float|double)", text), "vectors of one processor"
        assert str(ROOT).encode() not in code


@of_the_same_sort
def test_the_program_runs_without_numba(tmp_path: Path, folder: Path) -> None:
    plan = drawn_room(tmp_path / "room.dxf")
    code = (
        "import sys; from satAOI_geo.program import main; "
        f"assert not main([{str(plan)!r}, '-o', {str(tmp_path / 'aoi.dxf')!r}, '--quiet']); "
        "print('loaded:', *(name for name in ('numba', 'llvmlite') if name in sys.modules))"
    )
    done = subprocess.run(
        [sys.executable, "-c", f"import sys; sys.path[:0] = ['.', 'adapters']; {code}"],
        cwd=ROOT,
        env=dict(os.environ),
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.splitlines()[-1] == "loaded: llvmlite"
    assert len(list(folder.iterdir())) > 10


@of_the_same_sort
def test_machine_code_of_bitcode_gives_what_its_python_gives(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    code = of(total, WEIGHTED).made_by_numba().bitcode
    monkeypatch.setattr(bitcode, "shipped", lambda _: code)
    monkeypatch.delattr(bitcode, "made")
    assert of(total, WEIGHTED)(COLUMNS, TABLE, 0.7, -1) == total(COLUMNS, TABLE, 0.7, -1)
    assert len(list(folder.iterdir())) == 1


@pytest.mark.usefixtures("folder")
def test_bitcode_of_a_later_llvm_or_another_processor_is_left_alone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    module = llvm.parse_assembly('target triple = "riscv64-unknown-linux-gnu"')
    for unfit in (b"nonsense", module.as_bitcode()):
        monkeypatch.setattr(bitcode, "shipped", lambda _, unfit=unfit: unfit)
        assert of(total, WEIGHTED)(COLUMNS, TABLE, 0.7, 1) == total(COLUMNS, TABLE, 0.7, 1)


@pytest.mark.parametrize("begin", [0, 100, 1000, -100])
def test_an_archive_of_bitcode_that_came_to_harm_is_left_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, begin: int
) -> None:
    whole = bytearray(Path(bitcode.ARCHIVE).read_bytes())
    whole[begin : begin + 90] = b"harm!" * 18
    harmed = tmp_path / "kernels.zip"
    harmed.write_bytes(whole)
    sound = [each.shipped() for each in KERNELS]
    monkeypatch.setattr(bitcode, "ARCHIVE", str(harmed))
    found = [each.shipped() for each in KERNELS]
    assert None in found
    assert all(code in {None, expected} for code, expected in zip(found, sound, strict=True))
    harmed.unlink()
    assert {each.shipped() for each in KERNELS} == {None}


def test_bitcode_is_another_for_other_types_and_for_changed_helpers(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    name = of(total, WEIGHTED).bitcode_name
    assert of(total, WEIGHTED).bitcode_name == name
    assert of(total, WEIGHTED.replace("int64)", "int32)")).bitcode_name != name
    monkeypatch.setattr(sys.modules[__name__], "WEIGHT", WEIGHT + 1)
    assert of(total, WEIGHTED).bitcode_name != name


def test_comments_and_docstrings_change_no_bitcode() -> None:
    def plain(number: int) -> int:
        return number + 1

    def told(number: int) -> int:
        """The next one."""
        # comments say why
        return (number  # and where
                + 1)  # fmt: skip

    def other(number: int) -> int:
        return number + 2

    plainly, in_words, otherwise = (
        bitcode.text_of(each).partition("(")[2] for each in (plain, told, other)
    )
    assert in_words == plainly != otherwise


def test_without_its_source_a_kernel_runs_all_the_same(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def no_source(_: object) -> str:
        raise OSError("could not get source code")

    monkeypatch.setattr(bitcode, "text_of", no_source)
    assert of(total, WEIGHTED)(COLUMNS, TABLE, 0.7, 1) == total(COLUMNS, TABLE, 0.7, 1)
    assert len(list(folder.iterdir())) == 1
