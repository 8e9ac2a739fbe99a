"""Compiled kernels are kept where the user may write."""

import os
import sys
from pathlib import Path

import pytest

import satAOI_geo
from satAOI_adapters.kernel_cache import VARIABLE, prepare

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the folders of Linux")


@pytest.fixture(autouse=True)
def no_folder_chosen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, "")
    monkeypatch.delenv(VARIABLE)


def test_kernels_are_kept_in_the_users_cache(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert not prepare()
    assert Path(os.environ[VARIABLE]).is_relative_to(tmp_path / "satAOI-geo")


def test_kernels_of_changed_sources_make_room_for_new_ones(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    caches = tmp_path / "satAOI-geo"
    outdated = caches / f"kernels-{satAOI_geo.__version__}-0123456789ab"
    of_another_version = caches / "kernels-0.0.0-0123456789ab"
    outdated.mkdir(parents=True)
    of_another_version.mkdir()
    prepare()
    assert not outdated.exists()
    assert of_another_version.exists()


def test_kernels_compiled_for_this_python_are_found_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    version = f"py{sys.version_info.major}{sys.version_info.minor}"
    (tmp_path / "freespace.fill-1.py200.nbi").touch()
    assert not prepare()
    (tmp_path / f"freespace.fill-1.{version}.nbi").touch()
    assert prepare()


def test_without_a_place_to_write_they_last_for_the_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    not_a_folder = tmp_path / "file"
    not_a_folder.touch()
    monkeypatch.setenv("XDG_CACHE_HOME", str(not_a_folder))
    assert not prepare()
    assert Path(os.environ[VARIABLE]).is_dir()
    Path(os.environ[VARIABLE]).rmdir()


def test_a_folder_that_the_user_chose_is_left_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    prepare()
    assert os.environ[VARIABLE] == str(tmp_path)
