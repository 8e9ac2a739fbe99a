"""Compiled kernels are kept where the user may write."""

import os
import sys
from pathlib import Path

import pytest

from satAOI_adapters import kernel_cache
from satAOI_adapters.kernel_cache import VARIABLE, are_compiled, prepare
from satAOI_geo.kernels import KERNELS
from satAOI_geo.program import main
from tests.command_line import drawn_room

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
    assert not are_compiled()


def test_kernels_are_compiled_when_all_of_them_are(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    assert not are_compiled()
    for kernel in KERNELS:
        Path(kernel._path()).touch()
    assert are_compiled()
    Path(KERNELS[0]._path()).unlink()
    assert not are_compiled()


def test_a_first_run_says_that_it_compiles(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    plan = str(drawn_room(tmp_path / "room.dxf"))
    for kept in (False, True):
        monkeypatch.setattr(kernel_cache, "are_compiled", lambda kept=kept: kept)
        assert main([plan, "--report", str(tmp_path / "report.json")]) == 0
        assert ("compiling takes some seconds" in capsys.readouterr().err) is not kept


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
    assert place is not None
    assert place.is_relative_to(tmp_path / "satAOI-geo")
