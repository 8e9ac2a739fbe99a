"""Files kept from run to run: whole and unharmed, or not at all."""

import os
from pathlib import Path

import pytest

from satAOI_geo import kept


def test_what_was_kept_comes_back(tmp_path: Path) -> None:
    path = str(tmp_path / "new" / "code")
    kept.write(path, b"some code")
    assert kept.read(path) == b"some code"


@pytest.mark.parametrize("place", [0, 20, -1])
def test_what_has_come_to_harm_is_nothing(tmp_path: Path, place: int) -> None:
    file = tmp_path / "code"
    kept.write(str(file), b"some code")
    harmed = bytearray(file.read_bytes())
    harmed[place] ^= 1
    file.write_bytes(harmed)
    assert kept.read(str(file)) is None


def test_what_cannot_be_kept_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", refuse)
    kept.write(str(tmp_path / "code"), b"some code")
    assert list(tmp_path.iterdir()) == []
