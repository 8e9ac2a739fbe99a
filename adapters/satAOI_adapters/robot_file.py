"""The keys of a robot's file, for pydantic, which is slow to load and not needed without a file."""

import math

from pydantic import BaseModel, ConfigDict, Field

from satAOI_geo.robot import Robot


class RobotFile(BaseModel):
    """The keys of a robot's file. No key is guessed and none is ignored."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    name: str = Field("", max_length=100)
    vehicle_length_mm: float
    vehicle_width_mm: float
    pivot_offset_mm: float
    arm_length_mm: float
    disc_radius_mm: float
    swing_min_deg: float = -90.0
    swing_max_deg: float = 90.0

    def robot(self, *, unnamed: str) -> Robot:
        """The robot these measures describe; `unnamed` is its name where the file gives none."""
        return Robot(
            name=self.name or unnamed,
            vehicle_length_mm=self.vehicle_length_mm,
            vehicle_width_mm=self.vehicle_width_mm,
            pivot_offset_mm=self.pivot_offset_mm,
            arm_length_mm=self.arm_length_mm,
            disc_radius_mm=self.disc_radius_mm,
            swing_min_rad=math.radians(self.swing_min_deg),
            swing_max_rad=math.radians(self.swing_max_deg),
        )
