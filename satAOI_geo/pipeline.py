"""The program on half a page: plan → free space → reached set → area → figures."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, TypeAlias

from satAOI_geo.aoi import Aoi
from satAOI_geo.lattice import Lattice
from satAOI_geo.plan import FloorPlan
from satAOI_geo.report import Report
from satAOI_geo.robot import ROBOTS, Robot

Progress: TypeAlias = Callable[[str, float], None]
"""Called with the stage's name and the share of it that is done, 0 to 1."""


@dataclass(frozen=True, slots=True)
class Result:
    """An area of interest with everything that led to it."""

    plan: FloorPlan
    robot: Robot
    lattice: Lattice
    clearance_mm: float
    connectivity: Literal["disc", "pose"]
    start_node: tuple[int, int]
    aoi: Aoi
    report: Report


def area_of_interest(
    plan: FloorPlan,
    robot: Robot = ROBOTS["magicbim"],
    *,
    start_mm: tuple[float, float] | None = None,
    connectivity: Literal["disc", "pose"] = "disc",
    step_mm: float = 10.0,
    n_directions: int = 24,
    clearance_mm: float = 0.0,
    engine: Literal["fast", "reference"] = "fast",
    exact_outline: bool = False,
    progress: Progress | None = None,
) -> Result:
    """The floor that the robot can trowel from where it is set down.

    start_mm is a disc centre in the plan's frame; without it the plan's own mark is used,
    without that the component with the largest area.
    """
    raise NotImplementedError
