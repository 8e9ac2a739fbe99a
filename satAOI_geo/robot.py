"""The swing-arm troweling robot: its measures, its pose, and the floor its parts stand on.

    D  disc centre          u(t) = (cos t, sin t)
    S  arm pivot            S = D + arm_length · u(a1)
    V  vehicle centre       V = S + pivot_offset · u(yaw),   yaw = a1 + a2

              ┌───────────┐
      .-.     │           │
     ( D )════S════▷ V    │  ▷ yaw
      `-'     │           │
              └───────────┘

Source of the model and of the prototype's measures: SatAOI, arXiv 2505.04871, sections 3.2 and 5.1.
"""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from satAOI_geo.errors import RobotError
from satAOI_geo.plan import FloatArray

FULL_TURN_SLACK: Final = 1e-12
"""Degrees turned into radians may end a full turn a rounding early or late: a share of it."""


@dataclass(frozen=True, slots=True)
class Pose:
    """Where the robot stands, seen from the disc.

    Attributes:
        x_mm: Disc centre D.
        y_mm: Disc centre D.
        a1_rad: Direction from the disc centre to the arm pivot.
        a2_rad: Turn of the vehicle against the arm; the paper's swing is its negative.
    """

    x_mm: float
    y_mm: float
    a1_rad: float
    a2_rad: float


def unit(angle_rad: float) -> FloatArray:
    """u(angle), shape (2,); exact at quarter turns, where cos(π/2) would give 6e-17."""
    quarters = round(angle_rad / (math.pi / 2))
    rest_rad = angle_rad - quarters * (math.pi / 2)
    # what is left of a quarter turn after rounding is noise below 1e-15 rad per turn
    cos, sin = (1.0, 0.0) if abs(rest_rad) < 1e-14 else (math.cos(rest_rad), math.sin(rest_rad))
    quarter_turned = ((cos, sin), (-sin, cos), (-cos, -sin), (sin, -cos))
    return np.array(quarter_turned[quarters % 4]) + 0.0


@dataclass(frozen=True, slots=True)
class Part:
    """A convex piece of the robot: all points within a radius of a convex polygon.

    Attributes:
        corners_mm: Shape (n, 2), counter-clockwise; one corner is a point, two are a segment.
        radius_mm: How far the part reaches beyond the polygon.
    """

    corners_mm: FloatArray
    radius_mm: float

    def moved(self, x_mm: float, y_mm: float) -> "Part":
        """The same part with its reference point at (x, y)."""
        return Part(self.corners_mm + np.array((x_mm, y_mm)), self.radius_mm)


@dataclass(frozen=True, slots=True, kw_only=True)
class Robot:
    """The measures of a swing-arm troweling robot.

    Attributes:
        name: What it is called in reports.
        vehicle_length_mm: Along its heading.
        vehicle_width_mm: Across its heading.
        pivot_offset_mm: From the arm pivot S forward to the vehicle's centre V.
        arm_length_mm: From the disc centre D to the arm pivot S.
        disc_radius_mm: Of the troweling disc; the arm is as wide as the disc.
        swing_min_rad: Least swing of the arm against the vehicle; 0 is straight behind.
        swing_max_rad: Greatest swing.

    Raises:
        RobotError: If a length is not positive, the arm is shorter than the disc's radius, or
            the swing range is empty or wider than a full turn.
    """

    name: str
    vehicle_length_mm: float
    vehicle_width_mm: float
    pivot_offset_mm: float
    arm_length_mm: float
    disc_radius_mm: float
    swing_min_rad: float = -math.pi / 2
    swing_max_rad: float = math.pi / 2

    def __post_init__(self) -> None:
        for measure in (
            "vehicle_length_mm",
            "vehicle_width_mm",
            "arm_length_mm",
            "disc_radius_mm",
        ):
            value_mm = getattr(self, measure)
            if not (math.isfinite(value_mm) and value_mm > 0):
                raise RobotError(
                    f"robot '{self.name}': {measure} is {value_mm:g}; give a length above 0",
                    measure=measure,
                )
        if not math.isfinite(self.pivot_offset_mm):
            raise RobotError(
                f"robot '{self.name}': pivot_offset_mm is {self.pivot_offset_mm:g}; give a number",
                measure="pivot_offset_mm",
            )
        if self.arm_length_mm < self.disc_radius_mm:
            raise RobotError(
                f"robot '{self.name}': the arm ({self.arm_length_mm:g} mm) is shorter than the "
                f"disc's radius ({self.disc_radius_mm:g} mm); make arm_length_mm at least "
                f"{self.disc_radius_mm:g}",
                measure="arm_length_mm",
            )
        swing_rad = self.swing_max_rad - self.swing_min_rad
        if not 0 <= swing_rad <= 2 * math.pi * (1 + FULL_TURN_SLACK):
            raise RobotError(
                f"robot '{self.name}': the swing range from {math.degrees(self.swing_min_rad):g}° "
                f"to {math.degrees(self.swing_max_rad):g}° must span 0° to 360°",
                measure="swing_max_rad",
            )

    @property
    def reach_mm(self) -> float:
        """No point of the robot is farther than this from the disc centre."""
        half_diagonal_mm = math.hypot(self.vehicle_length_mm, self.vehicle_width_mm) / 2
        vehicle_mm = self.arm_length_mm + abs(self.pivot_offset_mm) + half_diagonal_mm
        return max(vehicle_mm, self.disc_radius_mm)

    @property
    def swings_all_round(self) -> bool:
        """Whether the swing range is a full turn, so that no end of it stops the arm."""
        return self.swing_max_rad - self.swing_min_rad >= 2 * math.pi * (1 - FULL_TURN_SLACK)

    @property
    def vehicle_reach_mm(self) -> float:
        """No point of the vehicle is farther than this from the arm pivot."""
        ahead_mm = abs(self.pivot_offset_mm) + self.vehicle_length_mm / 2
        return math.hypot(ahead_mm, self.vehicle_width_mm / 2)

    def disc(self) -> Part:
        """The disc alone, its centre D at the origin."""
        return Part(np.zeros((1, 2)), self.disc_radius_mm)

    def capsule(self, arm: FloatArray) -> Part:
        """Arm and disc about D at the origin; `arm` is u(a1), shape (2,).

        Spine D–D' with D' = D + (arm_length - disc_radius) · u(a1): paper, equations 7 to 11.
        """
        tip_mm = (self.arm_length_mm - self.disc_radius_mm) * arm
        return Part(np.array((np.zeros(2), tip_mm)), self.disc_radius_mm)

    def vehicle(self, arm: FloatArray, heading: FloatArray) -> Part:
        """The vehicle with D at the origin; `arm` is u(a1), `heading` u(yaw), shape (2,) each."""
        return self.vehicles(arm, heading[np.newaxis])[0]

    def vehicles(self, arm: FloatArray, headings: FloatArray) -> list[Part]:
        """The vehicle at several headings, shape (n, 2), all with the same arm."""
        centres_mm = self.arm_length_mm * arm + self.pivot_offset_mm * headings
        ahead_mm = self.vehicle_length_mm / 2 * headings
        left_mm = self.vehicle_width_mm / 2 * np.column_stack((-headings[:, 1], headings[:, 0]))
        corners_mm = np.stack(
            (-ahead_mm - left_mm, ahead_mm - left_mm, ahead_mm + left_mm, left_mm - ahead_mm),
            axis=1,
        )
        return [Part(ring_mm, 0.0) for ring_mm in centres_mm[:, np.newaxis] + corners_mm]


ROBOTS: Final = {
    "magicbim": Robot(
        name="magicbim",
        vehicle_length_mm=875.0,
        vehicle_width_mm=830.0,
        pivot_offset_mm=142.0,
        arm_length_mm=995.0,
        disc_radius_mm=350.0,
    ),
}
"""Robots of this build by name; `magicbim` is the paper's prototype (section 5.1)."""

PROTOTYPE: Final = ROBOTS["magicbim"]
