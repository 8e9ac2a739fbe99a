"""The figures of a run as data: one versioned schema."""

import math
from dataclasses import asdict
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from satAOI_geo.aoi import Aoi
from satAOI_geo.freespace import FreeSpace
from satAOI_geo.lattice import Lattice
from satAOI_geo.plan import FloorPlan
from satAOI_geo.robot import Robot
from satAOI_geo.start import Start
from satAOI_geo.units import MM2_PER_M2


class Section(BaseModel):
    """A group of figures: frozen, and no key that the schema does not know."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class InputFigures(Section):
    """The file that was read."""

    path: str
    sha256: str
    format: str
    unit: str
    unit_source: str


class RobotFigures(Section):
    """The robot's measures; lengths in mm, angles in degrees as in the robot's file."""

    name: str
    vehicle_length_mm: float
    vehicle_width_mm: float
    pivot_offset_mm: float
    arm_length_mm: float
    disc_radius_mm: float
    swing_min_deg: float
    swing_max_deg: float
    clearance_mm: float


class LatticeFigures(Section):
    """The lattice; the origin in the drawing's axes, shape [rows, columns]."""

    step_mm: float
    origin_mm: tuple[float, float]
    shape: tuple[int, int]
    n_directions: int
    n_swings: int


class FloorFigures(Section):
    """The floor and what stands on it."""

    area_m2: float
    source: str
    obstacle_area_m2: float
    obstacle_percent: float
    free_area_m2: float
    n_obstacles: int


class StartFigures(Section):
    """Where the robot is set down; xy in the drawing's axes, node [row, column]."""

    xy_mm: tuple[float, float]
    node: tuple[int, int]
    source: Literal["option", "drawing", "largest"]
    n_components: int


class FreeFigures(Section):
    """Nodes where some pose is free, and all (node, pose) states that are."""

    n_nodes: int
    n_states: int


class ConnectedFigures(Section):
    """A connected set of nodes and the area its discs cover."""

    n_nodes: int
    area_m2: float
    raster_area_m2: float


class AoiFigures(Section):
    """The area of interest."""

    connectivity: Literal["disc", "pose"]
    area_m2: float
    raster_area_m2: float
    percent_of_free: float
    n_parts: int


class FindingFigures(Section):
    """A finding; the position in the drawing's axes."""

    code: str
    message: str
    remedy: str
    layer: str
    handle: str
    at_mm: tuple[float, float] | None


class Report(Section):
    """All figures of a run."""

    model_config = ConfigDict(frozen=True, extra="forbid", populate_by_name=True)

    schema_name: Literal["sataoi-report/1"] = Field(alias="schema")
    input: InputFigures
    robot: RobotFigures
    lattice: LatticeFigures
    floor: FloorFigures
    start: StartFigures
    free: FreeFigures
    disc_connected: ConnectedFigures
    pose_connected: ConnectedFigures
    aoi: AoiFigures
    findings: list[FindingFigures]
    timing_s: dict[str, float]


def report_of(
    plan: FloorPlan,
    robot: Robot,
    lattice: Lattice,
    *,
    clearance_mm: float,
    connectivity: Literal["disc", "pose"],
    start: Start,
    free: FreeSpace,
    n_nodes: dict[str, int],
    areas: dict[str, Aoi],
    timing_s: dict[str, float],
) -> Report:
    """Gather the figures of a run; n_nodes and areas are given for `disc` and `pose`."""
    connected = {
        rule: ConnectedFigures(
            n_nodes=n_nodes[rule],
            area_m2=aoi.area_mm2 / MM2_PER_M2,
            raster_area_m2=aoi.raster_area_mm2 / MM2_PER_M2,
        )
        for rule, aoi in areas.items()
    }
    floor = _floor_figures(plan)
    return Report(
        schema="sataoi-report/1",
        input=InputFigures(
            path=plan.source.path,
            sha256=plan.source.sha256,
            format=plan.source.format,
            unit=plan.source.unit,
            unit_source=plan.source.unit_source,
        ),
        robot=RobotFigures(
            name=robot.name,
            vehicle_length_mm=robot.vehicle_length_mm,
            vehicle_width_mm=robot.vehicle_width_mm,
            pivot_offset_mm=robot.pivot_offset_mm,
            arm_length_mm=robot.arm_length_mm,
            disc_radius_mm=robot.disc_radius_mm,
            swing_min_deg=math.degrees(robot.swing_min_rad),
            swing_max_deg=math.degrees(robot.swing_max_rad),
            clearance_mm=clearance_mm,
        ),
        lattice=LatticeFigures(
            step_mm=lattice.step_mm,
            origin_mm=_in_drawing_mm(plan, lattice.origin_mm),
            shape=lattice.shape,
            n_directions=lattice.n_directions,
            n_swings=len(lattice.swings),
        ),
        floor=floor,
        start=StartFigures(
            xy_mm=_in_drawing_mm(plan, (lattice.x_mm(start.node[1]), lattice.y_mm(start.node[0]))),
            node=start.node,
            source=start.source,
            n_components=start.n_components,
        ),
        free=FreeFigures(n_nodes=int(free.free_nodes().sum()), n_states=free.n_states()),
        disc_connected=connected["disc"],
        pose_connected=connected["pose"],
        aoi=AoiFigures(
            connectivity=connectivity,
            area_m2=connected[connectivity].area_m2,
            raster_area_m2=connected[connectivity].raster_area_m2,
            percent_of_free=100 * connected[connectivity].area_m2 / floor.free_area_m2,
            n_parts=len(areas[connectivity].outlines),
        ),
        findings=[FindingFigures(**asdict(finding)) for finding in plan.findings],
        timing_s=timing_s,
    )


def _floor_figures(plan: FloorPlan) -> FloorFigures:
    """The floor's figures; the obstacle area is that within the floor, overlaps counted once."""
    obstacle_mm2 = plan.obstacle_region().area
    return FloorFigures(
        area_m2=plan.floor.area / MM2_PER_M2,
        source=plan.floor_source,
        obstacle_area_m2=obstacle_mm2 / MM2_PER_M2,
        obstacle_percent=100 * obstacle_mm2 / plan.floor.area,
        free_area_m2=plan.free_region().area / MM2_PER_M2,
        n_obstacles=len(plan.obstacles),
    )


def _in_drawing_mm(plan: FloorPlan, at_mm: tuple[float, float]) -> tuple[float, float]:
    """A point of the plan in the drawing's axes."""
    x_mm, y_mm = plan.frame.to_drawing_mm(at_mm).tolist()
    return x_mm, y_mm
