"""A robot by name, or from the TOML file its owner wrote; angles in degrees, lengths in mm.

name = "magicbim"
vehicle_length_mm = 875.0
vehicle_width_mm = 830.0
pivot_offset_mm = 142.0
arm_length_mm = 995.0
disc_radius_mm = 350.0
swing_min_deg = -90.0
swing_max_deg = 90.0
"""

import math
from pathlib import Path
from typing import TYPE_CHECKING

from satAOI_adapters.settings_read import read_settings, toml_string
from satAOI_geo.errors import InputError, RobotError
from satAOI_geo.robot import ROBOTS, Robot

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails


def robot_from(name_or_file: str) -> Robot:
    """The robot of this build with that name, or the one a TOML file describes.

    Raises:
        InputError: If it is neither a known name nor a readable robot file.
        RobotError: If the measures in the file contradict each other.
    """
    if name_or_file in ROBOTS:
        return ROBOTS[name_or_file]
    if Path(name_or_file).suffix.lower() == ".toml":
        return read(Path(name_or_file))
    known = ", ".join(sorted(ROBOTS))
    raise InputError(
        f"no robot '{name_or_file}'; known are {known}, or give a file ending in .toml"
    )


def read(path: Path) -> Robot:
    """The robot that a TOML file describes.

    Raises:
        InputError: If the file cannot be read, is not TOML, or lacks or misspells a key.
        RobotError: If its measures contradict each other.
    """
    from satAOI_adapters.robot_file import RobotFile

    file = read_settings(path, RobotFile, what="robot file", complaint=_complaint)
    try:
        return file.robot(unnamed=path.stem)
    except RobotError as error:
        raise RobotError(f"robot file '{path}': {error}", measure=error.measure) from error


def _complaint(key: str, fault: "ErrorDetails") -> str:
    """What is wrong with one key of a robot's file."""
    if fault["type"] == "missing":
        return f"key '{key}' is missing; `satAOI-geo robots magicbim` prints a complete file"
    return f"key '{key}' is {fault['input']!r}: {fault['msg']}"


def toml_of(robot: Robot) -> str:
    """The robot's file: what `read` turns into the same robot."""
    # degrees of a radian value carry rounding in the last digit; a robot's file has round ones
    swing_min_deg = round(math.degrees(robot.swing_min_rad), 9)
    swing_max_deg = round(math.degrees(robot.swing_max_rad), 9)
    return (
        f"name = {toml_string(robot.name)}\n"
        f"vehicle_length_mm = {robot.vehicle_length_mm!r}\n"
        f"vehicle_width_mm = {robot.vehicle_width_mm!r}\n"
        f"pivot_offset_mm = {robot.pivot_offset_mm!r}  # arm pivot to vehicle's centre\n"
        f"arm_length_mm = {robot.arm_length_mm!r}  # disc's centre to arm pivot\n"
        f"disc_radius_mm = {robot.disc_radius_mm!r}\n"
        f"swing_min_deg = {swing_min_deg!r}  # 0 is straight behind the vehicle\n"
        f"swing_max_deg = {swing_max_deg!r}\n"
    )
