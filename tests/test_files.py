"""Files appear whole or not at all, and never in the place of something else."""

import stat
from pathlib import Path

import pytest

from satAOI_adapters.files import written_whole
from satAOI_geo.errors import InputError


def names_in(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def write_half(target: Path, error: type[BaseException]) -> None:
    with written_whole(target) as stream:
        stream.write(b"half of the n")
        raise error


def test_the_bytes_appear_under_the_name(tmp_path: Path) -> None:
    with written_whole(tmp_path / "a.dxf") as stream:
        stream.write(b"whole")
    assert (tmp_path / "a.dxf").read_bytes() == b"whole"
    assert names_in(tmp_path) == ["a.dxf"]


def test_until_the_end_the_old_file_stands(tmp_path: Path) -> None:
    target = tmp_path / "a.dxf"
    target.write_bytes(b"old")
    with written_whole(target) as stream:
        stream.write(b"new")
        stream.flush()
        assert target.read_bytes() == b"old"
    assert target.read_bytes() == b"new"


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt])
def test_an_interrupted_write_leaves_the_old_file_and_nothing_else(
    tmp_path: Path, error: type[BaseException]
) -> None:
    target = tmp_path / "a.dxf"
    target.write_bytes(b"old")
    with pytest.raises(error):
        write_half(target, error)
    assert target.read_bytes() == b"old"
    assert names_in(tmp_path) == ["a.dxf"]


def test_a_full_disk_is_an_input_error_with_its_reason(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="No space left"), written_whole(tmp_path / "a.dxf"):
        raise OSError(28, "No space left on device")
    assert names_in(tmp_path) == []


def test_the_error_told_is_that_of_writing_not_of_tidying_up(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise OSError(30, "Read-only file system")

    for action in ("open", "unlink"):
        monkeypatch.setattr(Path, action, refuse)
    complaint = r"cannot write '.*x\.dxf': Read-only file system"
    with pytest.raises(InputError, match=complaint), written_whole(tmp_path / "x.dxf"):
        pass


def test_an_input_is_never_written_over_under_any_of_its_names(tmp_path: Path) -> None:
    read = tmp_path / "plan.dxf"
    read.write_bytes(b"plan")
    second_name = tmp_path / "same.dxf"
    second_name.hardlink_to(read)
    for target in (read, tmp_path / "." / "plan.dxf", second_name):
        with (
            pytest.raises(InputError, match="is an input"),
            written_whole(target, never_over=[read]),
        ):
            pytest.fail("the block must not be entered")
    assert read.read_bytes() == b"plan"


def test_nothing_is_written_through_a_symbolic_link(tmp_path: Path) -> None:
    (tmp_path / "real.dxf").write_bytes(b"real")
    link = tmp_path / "link.dxf"
    link.symlink_to("real.dxf")
    with pytest.raises(InputError, match="symbolic link"), written_whole(link):
        pytest.fail("the block must not be entered")
    assert (tmp_path / "real.dxf").read_bytes() == b"real"


def test_a_folder_is_no_target_and_a_missing_one_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="not an ordinary file"), written_whole(tmp_path):
        pytest.fail("the block must not be entered")
    with (
        pytest.raises(InputError, match=r"no folder .*nowhere"),
        written_whole(tmp_path / "nowhere" / "a.dxf"),
    ):
        pytest.fail("the block must not be entered")


def test_a_name_may_be_as_long_as_the_system_allows(tmp_path: Path) -> None:
    name = "a" * 251 + ".dxf"
    with written_whole(tmp_path / name) as stream:
        stream.write(b"new")
    assert names_in(tmp_path) == [name]


def test_a_replaced_file_keeps_its_permissions(tmp_path: Path) -> None:
    target = tmp_path / "a.dxf"
    target.write_bytes(b"old")
    target.chmod(0o640)
    with written_whole(target) as stream:
        stream.write(b"new")
    assert stat.S_IMODE(target.stat().st_mode) == 0o640
