"""Robots by name and from files."""

import math
from pathlib import Path

import pytest

from satAOI_adapters.robot_read import read, robot_from, toml_of
from satAOI_geo import ROBOTS, InputError, RobotError

PROTOTYPE = toml_of(ROBOTS["magicbim"])


def written(folder: Path, text: str) -> Path:
    file = folder / "mine.toml"
    file.write_text(text, encoding="utf-8")
    return file


@pytest.mark.parametrize("name", ROBOTS)
def test_a_robot_written_and_read_again_is_the_same_robot(name: str, tmp_path: Path) -> None:
    assert read(written(tmp_path, toml_of(ROBOTS[name]))) == ROBOTS[name]


def test_a_name_of_this_build_needs_no_file() -> None:
    assert robot_from("magicbim") is ROBOTS["magicbim"]


def test_angles_in_a_file_are_degrees(tmp_path: Path) -> None:
    robot = read(written(tmp_path, PROTOTYPE.replace("-90.0", "-45.0")))
    assert robot.swing_min_rad == -math.pi / 4


def test_a_robot_without_a_name_is_called_after_its_file(tmp_path: Path) -> None:
    nameless = PROTOTYPE.replace('name = "magicbim"\n', "")
    assert read(written(tmp_path, nameless)).name == "mine"


def test_whole_numbers_are_lengths_too(tmp_path: Path) -> None:
    assert read(written(tmp_path, PROTOTYPE.replace("995.0", "995"))) == ROBOTS["magicbim"]


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (("disc_radius_mm", "disc_radius_cm"), "unknown key 'disc_radius_cm'"),
        (("arm_length_mm = 995.0", ""), "key 'arm_length_mm' is missing"),
        (("995.0", '"long"'), "key 'arm_length_mm' is 'long'"),
        (("995.0", "true"), "key 'arm_length_mm' is True"),
        (("995.0", "= 5"), "is not TOML"),
        (("995.0", "nan"), "arm_length_mm is nan"),
        (("995.0", "300.0"), "the arm (300 mm) is shorter than the disc's radius (350 mm)"),
        (("-90.0", "100.0"), "the swing range from 100° to 90°"),
    ],
    ids=lambda value: value[1] if isinstance(value, tuple) else "",
)
def test_a_faulty_file_names_the_key_at_fault(
    change: tuple[str, str], complaint: str, tmp_path: Path
) -> None:
    file = written(tmp_path, PROTOTYPE.replace(*change, 1))
    with pytest.raises(InputError) as caught:
        read(file)
    assert complaint in str(caught.value)
    assert "mine.toml" in str(caught.value)


def test_a_contradiction_in_a_file_is_a_robot_error_with_its_measure(tmp_path: Path) -> None:
    with pytest.raises(RobotError) as caught:
        read(written(tmp_path, PROTOTYPE.replace("995.0", "300.0")))
    assert caught.value.measure == "arm_length_mm"


def test_an_unknown_robot_is_told_the_known_ones() -> None:
    with pytest.raises(InputError, match="no robot 'r2d2'; known are magicbim"):
        robot_from("r2d2")


def test_a_missing_file_is_said_to_be_missing() -> None:
    with pytest.raises(InputError, match="No such file"):
        robot_from("nowhere.toml")


def test_bytes_that_are_no_text_are_not_toml(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_bytes(b"\xff\xfe name")
    with pytest.raises(InputError, match="is not TOML"):
        read(file)
