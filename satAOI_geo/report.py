"""The figures of a run as data: one versioned schema."""

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Literal

import numpy as np

from satAOI_geo.aoi import Aoi
from satAOI_geo.plan import Finding, FloorPlan
from satAOI_geo.reach import State
from satAOI_geo.reasons import Patch
from satAOI_geo.robot import Robot
from satAOI_geo.search import Search
from satAOI_geo.settings import Connectivity
from satAOI_geo.units import MM2_PER_M2
from satAOI_geo.zones import SetDown, Zone


@dataclass(frozen=True, slots=True, kw_only=True)
class InputFigures:
    """The file that was read."""

    path: str
    sha256: str
    format: str
    unit: str
    unit_source: str

    @classmethod
    def of(cls, plan: FloorPlan) -> "InputFigures":
        """Where a plan came from."""
        source = plan.source
        return cls(
            path=source.path,
            sha256=source.sha256,
            format=source.format,
            unit=source.unit,
            unit_source=source.unit_source,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotFigures:
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

    @classmethod
    def of(cls, robot: Robot, clearance_mm: float) -> "RobotFigures":
        """The measures of a robot, and the clearance it keeps."""
        return cls(
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


@dataclass(frozen=True, slots=True, kw_only=True)
class LatticeFigures:
    """The lattice; the origin in the drawing's axes, shape [rows, columns]."""

    step_mm: float
    origin_mm: tuple[float, float]
    turn_deg: float
    turn_source: Literal["walls", "option"]
    shape: tuple[int, int]
    n_directions: int
    n_swings: int

    @classmethod
    def of(cls, found: Search) -> "LatticeFigures":
        """The lattice of a search."""
        lattice = found.lattice
        return cls(
            step_mm=lattice.step_mm,
            origin_mm=_in_drawing_mm(found.plan, [lattice.origin_mm])[0],
            turn_deg=math.degrees(found.plan.frame.turn_rad),
            turn_source="walls" if found.settings.align_rad is None else "option",
            shape=lattice.shape,
            n_directions=lattice.n_directions,
            n_swings=len(lattice.swings),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class FloorFigures:
    """The floor and what stands on it."""

    area_m2: float
    source: str
    obstacle_area_m2: float
    obstacle_percent: float
    free_area_m2: float
    n_obstacles: int

    @classmethod
    def of(cls, plan: FloorPlan) -> "FloorFigures":
        """The figures of a floor; the obstacle area is that on it, overlaps counted once."""
        obstacle_mm2 = plan.obstacle_area_mm2()
        return cls(
            area_m2=plan.floor.area / MM2_PER_M2,
            source=plan.floor_source,
            obstacle_area_m2=obstacle_mm2 / MM2_PER_M2,
            obstacle_percent=100 * obstacle_mm2 / plan.floor.area,
            free_area_m2=(plan.floor.area - obstacle_mm2) / MM2_PER_M2,
            n_obstacles=len(plan.obstacles),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class PoseFigures:
    """A pose: xy in the drawing's axes, node [row, column], a1 in the drawing's axes, a2."""

    xy_mm: tuple[float, float]
    node: tuple[int, int]
    a1_deg: float
    a2_deg: float

    @classmethod
    def of(cls, found: Search, states: Sequence[State]) -> list["PoseFigures"]:
        """Some states in the drawing's axes."""
        poses = [found.lattice.pose(*state) for state in states]
        turn_rad = found.plan.frame.turn_rad
        at_mm = _in_drawing_mm(found.plan, [(pose.x_mm, pose.y_mm) for pose in poses])
        return [
            cls(
                xy_mm=xy_mm,
                node=(state.iy, state.ix),
                a1_deg=math.degrees(pose.a1_rad + turn_rad) % 360.0,
                a2_deg=math.degrees(pose.a2_rad),
            )
            for state, pose, xy_mm in zip(states, poses, at_mm, strict=True)
        ]


@dataclass(frozen=True, slots=True, kw_only=True)
class StartFigures(PoseFigures):
    """Where the robot is set down, and how many components have a pose at that node."""

    source: Literal["option", "drawing", "largest"]
    n_components: int


@dataclass(frozen=True, slots=True, kw_only=True)
class FreeFigures:
    """Nodes where some pose is free, and all (node, pose) states that are."""

    n_nodes: int
    n_states: int


@dataclass(frozen=True, slots=True, kw_only=True)
class ConnectedFigures:
    """A connected set of nodes and the area its discs cover."""

    n_nodes: int
    area_m2: float
    raster_area_m2: float

    @classmethod
    def of(cls, n_nodes: int, aoi: Aoi) -> "ConnectedFigures":
        """The figures of a set of nodes."""
        return cls(
            n_nodes=n_nodes,
            area_m2=aoi.area_mm2 / MM2_PER_M2,
            raster_area_m2=aoi.raster_area_mm2 / MM2_PER_M2,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class AoiFigures:
    """The area of interest."""

    connectivity: Literal["disc", "pose"]
    area_m2: float
    raster_area_m2: float
    percent_of_free: float
    n_parts: int

    @classmethod
    def of(cls, connectivity: Connectivity, aoi: Aoi, floor: FloorFigures) -> "AoiFigures":
        """The figures of the area on a floor."""
        area_m2 = aoi.area_mm2 / MM2_PER_M2
        return cls(
            connectivity=connectivity,
            area_m2=area_m2,
            raster_area_m2=aoi.raster_area_mm2 / MM2_PER_M2,
            percent_of_free=100 * area_m2 / floor.free_area_m2,
            n_parts=len(aoi.outlines),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class ZoneFigures:
    """What one set-down can trowel; number 1 is the largest."""

    number: int
    area_m2: float
    n_nodes: int
    set_down: PoseFigures

    @classmethod
    def of(cls, found: Search, zones: Sequence[Zone]) -> list["ZoneFigures"]:
        """The zones, numbered from the first."""
        poses = PoseFigures.of(found, [zone.set_down for zone in zones])
        return [
            cls(
                number=number,
                area_m2=zone.area_mm2 / MM2_PER_M2,
                n_nodes=zone.n_nodes,
                set_down=pose,
            )
            for number, (zone, pose) in enumerate(zip(zones, poses, strict=True), start=1)
        ]


@dataclass(frozen=True, slots=True, kw_only=True)
class SetDownFigures:
    """One of the set-downs that together trowel all that any pose can, in greedy order.

    The gain is what it adds, by the raster; zone is null for one whose area is below 0.5 m².
    """

    zone: int | None
    gain_m2: float
    set_down: PoseFigures

    @classmethod
    def of(
        cls, found: Search, set_downs: Sequence[SetDown], zones: Sequence[Zone]
    ) -> list["SetDownFigures"]:
        """Some set-downs, with the numbers of their zones."""
        numbers = {zone.label: number for number, zone in enumerate(zones, start=1)}
        poses = PoseFigures.of(found, [one.state for one in set_downs])
        return [
            cls(zone=numbers.get(one.label), gain_m2=one.gain_mm2 / MM2_PER_M2, set_down=pose)
            for one, pose in zip(set_downs, poses, strict=True)
        ]


@dataclass(frozen=True, slots=True, kw_only=True)
class PatchFigures:
    """Free floor that is not reached; narrow gathers the strips narrower than two cells."""

    reason: Literal["disc", "arm", "vehicle", "zone", "path"]
    area_m2: float
    label_mm: tuple[float, float]
    narrow: bool
    blocker_handle: str
    blocker_layer: str

    @classmethod
    def of(cls, plan: FloorPlan, patches: Sequence[Patch]) -> list["PatchFigures"]:
        """Some patches with their labels in the drawing's axes."""
        at_mm = _in_drawing_mm(plan, [patch.label_mm for patch in patches])
        return [
            cls(
                reason=patch.reason.value,
                area_m2=patch.area_mm2 / MM2_PER_M2,
                label_mm=label_mm,
                narrow=patch.narrow,
                blocker_handle=patch.blocker.handle if patch.blocker else "",
                blocker_layer=patch.blocker.layer if patch.blocker else "",
            )
            for patch, label_mm in zip(patches, at_mm, strict=True)
        ]


@dataclass(frozen=True, slots=True, kw_only=True)
class Report:
    """All figures of a run."""

    schema: Literal["sataoi-report/1"] = "sataoi-report/1"
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
    findings: list[Finding]
    timing_s: dict[str, float]


def report_of(
    found: Search,
    *,
    areas: dict[Connectivity, Aoi],
    zones: tuple[Zone, ...],
    set_downs: tuple[SetDown, ...],
    patches: tuple[Patch, ...],
    timing_s: dict[str, float],
) -> Report:
    """Gather the figures of a run; areas are given for `disc` and `pose`."""
    plan, start, connectivity = found.plan, found.start, found.settings.connectivity
    floor = FloorFigures.of(plan)
    (pose,) = PoseFigures.of(found, [start.state])
    disc_nodes = found.disc.stretches.count(start.disc_label)
    pose_nodes = found.pose.stretches.count(start.pose_label)
    return Report(
        input=InputFigures.of(plan),
        robot=RobotFigures.of(found.robot, found.settings.clearance_mm),
        lattice=LatticeFigures.of(found),
        floor=floor,
        start=StartFigures(**asdict(pose), source=start.source, n_components=start.n_components),
        free=FreeFigures(n_nodes=found.free.count(), n_states=found.n_states),
        disc_connected=ConnectedFigures.of(disc_nodes, areas["disc"]),
        pose_connected=ConnectedFigures.of(pose_nodes, areas["pose"]),
        aoi=AoiFigures.of(connectivity, areas[connectivity], floor),
        zones=ZoneFigures.of(found, zones),
        set_downs=SetDownFigures.of(found, set_downs, zones),
        unreached=PatchFigures.of(plan, patches),
        findings=list(plan.findings),
        timing_s=timing_s,
    )


def _in_drawing_mm(
    plan: FloorPlan, points_mm: Sequence[tuple[float, float]]
) -> list[tuple[float, float]]:
    """Points of the plan in the drawing's axes."""
    drawn_mm = plan.frame.to_drawing_mm(np.reshape(points_mm, (-1, 2)))
    return [(x_mm, y_mm) for x_mm, y_mm in drawn_mm.tolist()]
