"""The program on half a page: plan → free space → reached set → area → figures."""

import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Final, Literal, TypeAlias

from satAOI_geo.aoi import Aoi, area
from satAOI_geo.collision import Collider, Reference
from satAOI_geo.errors import InputError, NothingFreeError
from satAOI_geo.freespace import Engine, free_space
from satAOI_geo.intervals import Intervals
from satAOI_geo.lattice import Lattice
from satAOI_geo.plan import FloorPlan
from satAOI_geo.reach import DiscComponents, PoseComponents
from satAOI_geo.report import Report, report_of
from satAOI_geo.robot import ROBOTS, Robot
from satAOI_geo.start import free_node, largest_start, start_at
from satAOI_geo.units import MM2_PER_M2

Progress: TypeAlias = Callable[[str, float], None]
"""Called with the stage's name and the share of it that is done, 0 to 1."""

PROTOTYPE: Final = ROBOTS["magicbim"]


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
    robot: Robot = PROTOTYPE,
    *,
    start_mm: tuple[float, float] | None = None,
    connectivity: Literal["disc", "pose"] = "pose",
    step_mm: float = 10.0,
    n_directions: int = 24,
    clearance_mm: float = 0.0,
    engine: Literal["fast", "reference"] = "fast",
    exact_outline: bool = False,
    progress: Progress | None = None,
) -> Result:
    """The floor that the robot can trowel from where it is set down.

    Args:
        plan: The floor and its obstacles.
        robot: The robot.
        start_mm: Disc centre to start from, in the plan's frame; without it the plan's own mark,
            without that the component of the largest area.
        connectivity: `pose` for what motions join, `disc` for the paper's rule, an upper estimate.
        step_mm: Side of a lattice cell.
        n_directions: Directions in a full turn, a multiple of 4.
        clearance_mm: Distance to keep beyond contact, 0 or more.
        engine: `fast`, or `reference` to ask the exact collision test node by node.
        exact_outline: Keep the scallops between neighbouring discs in the outline.
        progress: Called with the stage's name and the share of it that is done.

    Raises:
        InputError: If an option is out of range.
        LimitError: If the lattice would hold too many nodes.
        NothingFreeError: If the robot fits nowhere on the floor.
        StartBlockedError: If no pose is free at the start.
    """
    if not (math.isfinite(clearance_mm) and clearance_mm >= 0):
        raise InputError(f"the clearance is {clearance_mm:g} mm; give 0 or more")
    watch = _Stopwatch(progress)
    lattice = Lattice.over(plan.floor.bounds, robot, step_mm=step_mm, n_directions=n_directions)

    with watch.stage("free space"):
        probe = _engine(engine, plan, robot, lattice, clearance_mm)
        space = free_space(probe, robot, lattice, watch.share)
        free = space.free_nodes()
    if not free.any():
        raise NothingFreeError(
            f"robot '{robot.name}' fits nowhere on this floor of {plan.floor.area / MM2_PER_M2:.2f}"
            " m²; check the drawing's unit, the layers taken for obstacles, and the clearance"
        )
    with watch.stage("reach"):
        disc = DiscComponents.of(free)
        pose = PoseComponents.of(probe, robot, space, watch.share)
        marked = _marked_start(plan, start_mm)
        if marked is None:
            start = largest_start(connectivity, disc, pose, robot.disc_radius_mm)
        else:
            at_mm, source = marked
            node = free_node(plan, robot, lattice, free, start_mm=at_mm, clearance_mm=clearance_mm)
            start = start_at(node, source, disc, pose, robot.disc_radius_mm)
    with watch.stage("area"):
        reached = {
            "disc": disc.nodes(start.disc_label),
            "pose": pose.nodes(start.pose_label),
        }
        areas = {
            rule: area(nodes, lattice, robot.disc_radius_mm, exact=exact_outline)
            for rule, nodes in reached.items()
        }
    report = report_of(
        plan,
        robot,
        lattice,
        clearance_mm=clearance_mm,
        start=start,
        free=space,
        n_nodes={rule: int(nodes.sum()) for rule, nodes in reached.items()},
        areas=areas,
        connectivity=connectivity,
        timing_s=watch.timing_s,
    )
    return Result(
        plan, robot, lattice, clearance_mm, connectivity, start.node, areas[connectivity], report
    )


def _engine(
    name: Literal["fast", "reference"],
    plan: FloorPlan,
    robot: Robot,
    lattice: Lattice,
    clearance_mm: float,
) -> Engine:
    """The engine of a name."""
    if name == "reference":
        return Reference(Collider(plan, robot, clearance_mm), lattice)
    return Intervals(plan, robot, lattice, clearance_mm)


def _marked_start(
    plan: FloorPlan, start_mm: tuple[float, float] | None
) -> tuple[tuple[float, float], Literal["option", "drawing"]] | None:
    """The start that was asked for, or that the drawing marks, with its source."""
    if start_mm is not None:
        return start_mm, "option"
    return None if plan.start_mm is None else (plan.start_mm, "drawing")


class _Stopwatch:
    """Times the stages and tells how far each has come."""

    def __init__(self, progress: Progress | None) -> None:
        self._progress = progress
        self._stage = ""
        self.timing_s: dict[str, float] = {}

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Time what happens inside under a name."""
        self._stage = name
        self.share(0.0)
        begin_s = time.perf_counter()
        yield
        self.timing_s[name] = time.perf_counter() - begin_s
        self.share(1.0)

    def share(self, done: float) -> None:
        """Tell which share of the stage is done."""
        if self._progress is not None:
            self._progress(self._stage, done)
