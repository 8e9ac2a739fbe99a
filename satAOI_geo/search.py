"""The search: plan → free space → connected sets → start."""

from dataclasses import dataclass

from satAOI_geo.align import wall_direction_rad
from satAOI_geo.bands import Crew, all_explored
from satAOI_geo.collision import Collider, Reference
from satAOI_geo.engine import Engine
from satAOI_geo.errors import EmptyPlanError, InputError, NothingFreeError
from satAOI_geo.intervals import Intervals
from satAOI_geo.lattice import Lattice
from satAOI_geo.nodes import Nodes
from satAOI_geo.plan import FloorPlan
from satAOI_geo.progress import Stopwatch
from satAOI_geo.reach import DiscComponents, PoseComponents
from satAOI_geo.robot import Robot
from satAOI_geo.settings import Settings
from satAOI_geo.start import Start, StartFinder, StartMark
from satAOI_geo.units import MM2_PER_M2


@dataclass(frozen=True, slots=True)
class Search:
    """What a search has found.

    Attributes:
        plan: The plan, seen in the lattice's axes.
        robot: The robot.
        settings: What the search was made with.
        lattice: Nodes and directions.
        engine: Tells where a part touches something.
        free: Nodes at which some pose is free.
        n_states: How many (node, pose) pairs are free.
        disc: The disc-connected sets.
        pose: The pose-connected sets.
        start: Where the robot is set down.
    """

    plan: FloorPlan
    robot: Robot
    settings: Settings
    lattice: Lattice
    engine: Engine
    free: Nodes
    n_states: int
    disc: DiscComponents
    pose: PoseComponents
    start: Start


def search(
    plan: FloorPlan,
    robot: Robot,
    settings: Settings,
    *,
    start: StartMark | None,
    watch: Stopwatch,
    crew: Crew | None = None,
) -> Search:
    """Find where the robot can be and what it can get to.

    Args:
        plan: The floor and its obstacles.
        robot: The robot.
        settings: What the search is made with.
        start: The start in the plan's frame; without it the plan's own mark, without that the
            component of the largest area.
        watch: Times the stages.
        crew: Workers that search the floor in bands.

    Raises:
        InputError: If a setting or the start's pose is out of range.
        EmptyPlanError: If the plan has no floor.
        LimitError: If the lattice would hold too many nodes.
        NothingFreeError: If the robot fits nowhere on the floor.
        StartBlockedError: If no pose is free at the start.
    """
    _refuse_what_cannot_be_searched(plan, robot, settings)
    turn_rad = wall_direction_rad(plan) if settings.align_rad is None else settings.align_rad
    mark = start if start is not None else StartMark.of(plan)
    if mark is not None:
        mark.check(robot)
    plan = plan.turned(turn_rad)
    lattice = Lattice.over(
        plan.floor.bounds, robot, step_mm=settings.step_mm, n_directions=settings.n_directions
    )
    with watch.stage("free space"):
        engine = _engine(plan, robot, lattice, settings)
    free, n_states, bands = all_explored(
        engine, robot, lattice, memory_gb=settings.memory_gb, watch=watch, crew=crew
    )
    if not free.words.any():
        raise _fits_nowhere(plan, robot)
    with watch.stage("reach"):
        disc = DiscComponents.of(free)
        pose = PoseComponents.of(lattice, bands)
        finder = StartFinder(
            plan, robot, Collider(plan, robot, settings.clearance_mm), free, disc, pose
        )
        found = (
            finder.largest(settings.connectivity)
            if mark is None
            else finder.at(mark.turned(turn_rad))
        )
    return Search(plan, robot, settings, lattice, engine, free, n_states, disc, pose, found)


def _refuse_what_cannot_be_searched(plan: FloorPlan, robot: Robot, settings: Settings) -> None:
    """Refuse a plan without a floor, and discs that would leave floor between each other.

    Raises:
        EmptyPlanError: If the plan has no floor.
        InputError: If the disc's positions lie farther apart than it is wide.
    """
    if plan.floor.is_empty:
        raise EmptyPlanError("the plan has no floor; give it one with an area")
    width_mm = 2 * robot.disc_radius_mm
    if settings.step_mm > width_mm:
        raise InputError(
            f"the lattice step is {settings.step_mm:g} mm, but the disc of robot '{robot.name}' is "
            f"{width_mm:g} mm wide; give a shorter --step"
        )


def _engine(plan: FloorPlan, robot: Robot, lattice: Lattice, settings: Settings) -> Engine:
    """The engine the settings name."""
    if settings.engine == "reference":
        return Reference(Collider(plan, robot, settings.clearance_mm), lattice)
    return Intervals.of(plan, robot, lattice, settings.clearance_mm)


def _fits_nowhere(plan: FloorPlan, robot: Robot) -> NothingFreeError:
    """The error of a floor without any free pose, with the obstacle that takes most of it."""
    areas_mm2 = [obstacle.region().intersection(plan.floor).area for obstacle in plan.obstacles]
    largest = ""
    if max(areas_mm2, default=0.0) > 0:
        k = areas_mm2.index(max(areas_mm2))
        label, area_m2 = plan.obstacles[k].label(), areas_mm2[k] / MM2_PER_M2
        largest = f", of which {label} takes {area_m2:.2f} m²"
    return NothingFreeError(
        f"robot '{robot.name}' fits nowhere on this floor of {plan.floor.area / MM2_PER_M2:.2f} m²"
        f"{largest}; check the unit, what is taken for obstacles, which 'inspect' tells, and the "
        "clearance"
    )
