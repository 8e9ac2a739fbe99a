"""The program on half a page: plan → free space → reached set → area → reasons → figures."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from satAOI_geo.aoi import Aoi, area
from satAOI_geo.bands import Crew
from satAOI_geo.lattice import Lattice
from satAOI_geo.memory import give_back
from satAOI_geo.plan import FloorPlan
from satAOI_geo.progress import Progress, Stopwatch
from satAOI_geo.reasons import Patch, unreached
from satAOI_geo.report import Report, report_of
from satAOI_geo.robot import PROTOTYPE, Robot
from satAOI_geo.search import Search, search
from satAOI_geo.settings import DEFAULTS, Connectivity, Settings
from satAOI_geo.start import StartMark
from satAOI_geo.zones import SetDown, Zone, set_downs, zones


@dataclass(frozen=True, slots=True)
class Result:
    """An area of interest with everything that led to it.

    Attributes:
        search: The plan as the lattice sees it, the lattice, the connected sets and the start.
        aoi: The area of interest.
        upper: The area that the paper's rule claims: disc-connected with the start.
        zones: What each set-down can trowel, the largest first.
        set_downs: Set-downs that together trowel all that any pose can.
        patches: The free floor that is not reached, and why.
        report: The figures.
    """

    search: Search
    aoi: Aoi
    upper: Aoi
    zones: tuple[Zone, ...]
    set_downs: tuple[SetDown, ...]
    patches: tuple[Patch, ...]
    report: Report

    @property
    def plan(self) -> FloorPlan:
        """The plan in the lattice's axes."""
        return self.search.plan

    @property
    def robot(self) -> Robot:
        """The robot."""
        return self.search.robot

    @property
    def lattice(self) -> Lattice:
        """Nodes and directions."""
        return self.search.lattice

    @property
    def settings(self) -> Settings:
        """What the search was made with."""
        return self.search.settings


def area_of_interest(
    plan: FloorPlan,
    robot: Robot = PROTOTYPE,
    settings: Settings = DEFAULTS,
    *,
    start: StartMark | None = None,
    progress: Progress | None = None,
    crew: Crew | None = None,
) -> Result:
    """The floor that the robot can trowel from where it is set down.

    Args:
        plan: The floor and its obstacles.
        robot: The robot.
        settings: Connectivity, lattice, clearance and engine.
        start: Where it is set down, in the plan's frame; without it the plan's own mark, without
            that the component of the largest area.
        progress: Called with the stage's name and the share of it that is done.
        crew: Workers in other processes that search the floor in bands, with the same answer.

    Raises:
        InputError: If a setting or the start's pose is out of range.
        EmptyPlanError: If the plan has no floor.
        LimitError: If the lattice would hold too many nodes.
        NothingFreeError: If the robot fits nowhere on the floor.
        StartBlockedError: If no pose is free at the start.
    """
    watch = Stopwatch(progress)
    found = search(plan, robot, settings, start=start, watch=watch, crew=crew)
    with watch.stage("area"):
        areas = _areas(found)
    aoi, upper = areas[settings.connectivity], areas["disc"]

    def of_patches() -> tuple[Patch, ...]:
        with watch.stage("reasons") as share:
            return unreached(found, aoi, upper, share)

    with ThreadPoolExecutor(max_workers=1) as beside:
        waiting = beside.submit(of_patches)
        with watch.stage("zones") as share:
            all_zones, downs = _zones(found, areas["pose"], share)
        patches = waiting.result()
    if len(found.pose.bands) > 1:
        # what both threads took is free now, and figures of a large floor take room, too
        give_back()
    report = report_of(
        found,
        areas=areas,
        zones=all_zones,
        set_downs=downs,
        patches=patches,
        timing_s=watch.timing_s,
    )
    return Result(found, aoi, upper, all_zones, downs, patches, report)


def _zones(
    found: Search, of_start: Aoi, progress: Callable[[float], None]
) -> tuple[tuple[Zone, ...], tuple[SetDown, ...]]:
    """The zones and the set-downs; what is pose-connected with the start is known already."""
    lattice, disc_mm = found.lattice, found.robot.disc_radius_mm
    # its outline would be another one than that of the others
    known = {} if found.settings.exact_outline else {found.start.pose_label: of_start}
    all_zones = zones(found.pose, lattice, disc_mm, known, progress)
    states = {zone.label: zone.set_down for zone in all_zones}
    return all_zones, set_downs(found.pose, found.free, lattice, disc_mm, states)


def _areas(found: Search) -> dict[Connectivity, Aoi]:
    """What is connected with the start by either rule."""
    start, disc_mm, exact = found.start, found.robot.disc_radius_mm, found.settings.exact_outline
    by_rule = [found.disc.nodes(start.disc_label), found.pose.nodes(start.pose_label)]
    # on most floors the one rule joins no more nodes than the other
    sets = by_rule[: 1 if np.array_equal(by_rule[0].words, by_rule[1].words) else 2]
    # what the outline of a large floor takes meanwhile is a good part of a gigabyte
    n_at_once = 2 if len(found.pose.bands) == 1 else 1
    with ThreadPoolExecutor(n_at_once) as threads:
        areas = list(
            threads.map(lambda nodes: area(nodes, found.lattice, disc_mm, exact=exact), sets)
        )
    return {"disc": areas[0], "pose": areas[-1]}
