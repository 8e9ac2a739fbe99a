"""The figures of a run as data: one versioned schema."""

import math
from dataclasses import asdict
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from satAOI_geo.aoi import Aoi
from satAOI_geo.plan import FloorPlan
from satAOI_geo.reach import State
from satAOI_geo.reasons import Patch
from satAOI_geo.robot import Robot
from satAOI_geo.search import Search
from satAOI_geo.units import MM2_PER_M2
from satAOI_geo.zones import SetDown, Zone


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
    turn_deg: float
    turn_source: Literal["walls", "option"]
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


class PoseFigures(Section):
    """A pose: xy in the drawing's axes, node [row, column], a1 in the drawing's axes, a2."""

    xy_mm: tuple[float, float]
    node: tuple[int, int]
    a1_deg: float
    a2_deg: float


class StartFigures(PoseFigures):
    """Where the robot is set down, and how many components have a pose at that node."""

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


class ZoneFigures(Section):
    """What one set-down can trowel; number 1 is the largest."""

    number: int
    area_m2: float
    n_nodes: int
    set_down: PoseFigures


class SetDownFigures(Section):
    """One of the set-downs that together trowel all that any pose can, in greedy order.

    The gain is what it adds, by the raster; zone is null for one whose area is below 0.5 m².
    """

    zone: int | None
    gain_m2: float
    set_down: PoseFigures


class PatchFigures(Section):
    """Free floor that is not reached; narrow gathers the strips narrower than two cells."""

    reason: Literal["disc", "arm", "vehicle", "zone", "path"]
    area_m2: float
    label_mm: tuple[float, float]
    narrow: bool
    blocker_handle: str
    blocker_layer: str


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
    zones: list[ZoneFigures]
    set_downs: list[SetDownFigures]
    unreached: list[PatchFigures]
    findings: list[FindingFigures]
    timing_s: dict[str, float]


def report_of(
    found: Search,
    *,
    n_nodes: dict[str, int],
    areas: dict[str, Aoi],
    zones: tuple[Zone, ...],
    set_downs: tuple[SetDown, ...],
    patches: tuple[Patch, ...],
    timing_s: dict[str, float],
) -> Report:
    """Gather the figures of a run; n_nodes and areas are given for `disc` and `pose`."""
    plan, lattice, settings = found.plan, found.lattice, found.settings
    connectivity = settings.connectivity
    connected = {
        rule: ConnectedFigures(
            n_nodes=n_nodes[rule],
            area_m2=aoi.area_mm2 / MM2_PER_M2,
            raster_area_m2=aoi.raster_area_mm2 / MM2_PER_M2,
        )
        for rule, aoi in areas.items()
    }
    floor = _floor_figures(plan)
    numbers = {zone.label: number for number, zone in enumerate(zones, start=1)}
    return Report(
        schema="sataoi-report/1",
        input=InputFigures(
            path=plan.source.path,
            sha256=plan.source.sha256,
            format=plan.source.format,
            unit=plan.source.unit,
            unit_source=plan.source.unit_source,
        ),
        robot=_robot_figures(found.robot, settings.clearance_mm),
        lattice=LatticeFigures(
            step_mm=lattice.step_mm,
            origin_mm=_in_drawing_mm(plan, lattice.origin_mm),
            turn_deg=math.degrees(plan.frame.turn_rad),
            turn_source="walls" if settings.align_rad is None else "option",
            shape=lattice.shape,
            n_directions=lattice.n_directions,
            n_swings=len(lattice.swings),
        ),
        floor=floor,
        start=StartFigures(
            **_pose_figures(found, found.start.state),
            source=found.start.source,
            n_components=found.start.n_components,
        ),
        free=FreeFigures(n_nodes=int(found.free.sum()), n_states=found.space.n_states()),
        disc_connected=connected["disc"],
        pose_connected=connected["pose"],
        aoi=AoiFigures(
            connectivity=connectivity,
            area_m2=connected[connectivity].area_m2,
            raster_area_m2=connected[connectivity].raster_area_m2,
            percent_of_free=100 * connected[connectivity].area_m2 / floor.free_area_m2,
            n_parts=len(areas[connectivity].outlines),
        ),
        zones=[
            ZoneFigures(
                number=numbers[zone.label],
                area_m2=zone.aoi.area_mm2 / MM2_PER_M2,
                n_nodes=zone.n_nodes,
                set_down=PoseFigures(**_pose_figures(found, zone.set_down)),
            )
            for zone in zones
        ],
        set_downs=[
            SetDownFigures(
                zone=numbers.get(one.label),
                gain_m2=one.gain_mm2 / MM2_PER_M2,
                set_down=PoseFigures(**_pose_figures(found, one.state)),
            )
            for one in set_downs
        ],
        unreached=[_patch_figures(plan, patch) for patch in patches],
        findings=[FindingFigures(**asdict(finding)) for finding in plan.findings],
        timing_s=timing_s,
    )


def _robot_figures(robot: Robot, clearance_mm: float) -> RobotFigures:
    """The robot's measures."""
    return RobotFigures(
        name=robot.name,
        vehicle_length_mm=robot.vehicle_length_mm,
        vehicle_width_mm=robot.vehicle_width_mm,
        pivot_offset_mm=robot.pivot_offset_mm,
        arm_length_mm=robot.arm_length_mm,
        disc_radius_mm=robot.disc_radius_mm,
        swing_min_deg=math.degrees(robot.swing_min_rad),
        swing_max_deg=math.degrees(robot.swing_max_rad),
        clearance_mm=clearance_mm,
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


def _pose_figures(found: Search, state: State) -> dict[str, Any]:
    """A state in the drawing's axes."""
    plan, lattice = found.plan, found.lattice
    pose = lattice.pose(*state)
    a1_deg = math.degrees(pose.a1_rad + plan.frame.turn_rad) % 360.0
    return {
        "xy_mm": _in_drawing_mm(plan, (pose.x_mm, pose.y_mm)),
        "node": (state.iy, state.ix),
        "a1_deg": a1_deg,
        "a2_deg": math.degrees(pose.a2_rad),
    }


def _patch_figures(plan: FloorPlan, patch: Patch) -> PatchFigures:
    """A patch with its label in the drawing's axes."""
    return PatchFigures(
        reason=patch.reason.value,
        area_m2=patch.area_mm2 / MM2_PER_M2,
        label_mm=_in_drawing_mm(plan, patch.label_mm),
        narrow=patch.narrow,
        blocker_handle=patch.blocker.handle if patch.blocker else "",
        blocker_layer=patch.blocker.layer if patch.blocker else "",
    )


def _in_drawing_mm(plan: FloorPlan, at_mm: tuple[float, float]) -> tuple[float, float]:
    """A point of the plan in the drawing's axes."""
    x_mm, y_mm = plan.frame.to_drawing_mm(at_mm).tolist()
    return x_mm, y_mm
