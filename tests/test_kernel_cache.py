"""Compiled kernels are kept where the user may write."""

import os
import sys
from pathlib import Path

import pytest

from satAOI_adapters import kernel_cache
from satAOI_adapters.kernel_cache import VARIABLE, compile_missing, prepare
from satAOI_geo.kernels import KERNELS
from tests.command_line import drawn_room, program

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the folders of Linux")


@pytest.fixture(autouse=True)
def no_folder_chosen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, "")
    monkeypatch.delenv(VARIABLE)


def test_kernels_are_kept_in_the_users_cache(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    prepare()
    assert Path(os.environ[VARIABLE]).is_relative_to(tmp_path / "satAOI-geo")
    assert not any(kernel.is_kept() for kernel in KERNELS)


def test_a_first_run_says_that_it_compiles_and_no_later_one_does(tmp_path: Path) -> None:
    plan, folder = str(drawn_room(tmp_path / "room.dxf")), str(tmp_path / "kernels")
    first, later = (program(plan, NUMBA_CACHE_DIR=folder) for _ in range(2))
    assert "compiling takes some seconds" in first.stderr
    assert "compiling" not in later.stderr
    way = program("route", plan, "--to", "1000,1000", NUMBA_CACHE_DIR=folder)
    assert (way.returncode, "compiling" in way.stderr) == (0, False)
    # what later runs did not need to compile they did not compile unsaid either
    assert len(list(Path(folder).glob("*.o"))) == len(KERNELS)


def test_a_kernel_that_is_missing_is_compiled_and_that_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    for kernel in KERNELS:
        Path(kernel._path()).touch()
    compile_missing(quiet=False)
    assert capsys.readouterr().err == ""
    Path(KERNELS[0]._path()).unlink()
    compile_missing(quiet=True)
    assert capsys.readouterr().err == ""
    compile_missing(quiet=False)
    assert "compiling takes some seconds" in capsys.readouterr().err


def test_a_batch_says_once_that_it_compiles(tmp_path: Path) -> None:
    plans = [str(drawn_room(tmp_path / f"{name}.dxf")) for name in "ab"]
    done = program(
        "batch", *plans, "--out-dir", str(tmp_path), NUMBA_CACHE_DIR=str(tmp_path / "kernels")
    )
    assert done.returncode == 0
    assert done.stderr.count("compiling takes some seconds") == 1


def test_without_a_place_to_write_they_last_for_the_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    not_a_folder = tmp_path / "file"
    not_a_folder.touch()
    monkeypatch.setenv("XDG_CACHE_HOME", str(not_a_folder))
    prepare()
    assert Path(os.environ[VARIABLE]).is_dir()
    Path(os.environ[VARIABLE]).rmdir()


def test_a_folder_that_the_user_chose_is_left_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    prepare()
    assert os.environ[VARIABLE] == str(tmp_path)


def test_an_empty_name_is_no_place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv(VARIABLE, "")
    place = kernel_cache.place()
    prepare()
    assert os.environ[VARIABLE] == str(place)
    assert place is not None
    assert place.is_relative_to(tmp_path / "satAOI-geo")
