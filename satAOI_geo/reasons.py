"""Why a patch of free floor is not reached.

Nested sets of disc centres, each a part of the one before, cover nested areas:

    the disc fits ⊇ disc and arm fit in some direction ⊇ some pose is free
                  ⊇ disc-connected with the start ⊇ pose-connected with the start

What lies between two of them has one reason, and all of them together are the free floor that the
area of interest leaves over.
"""

from dataclasses import dataclass
from enum import StrEnum
from functools import reduce
from typing import Final

import numpy as np
import shapely
from shapely.geometry import MultiPolygon, Point

from satAOI_geo.aoi import Aoi, area
from satAOI_geo.freespace import Engine
from satAOI_geo.lattice import Lattice
from satAOI_geo.plan import BoolArray, FloorPlan, Obstacle, Region, as_region, polygons_in
from satAOI_geo.robot import Robot

SAGITTA_MM: Final = 0.01
"""How far the polygons of patches may leave the arcs they share with the area of interest."""


class Reason(StrEnum):
    """Why the disc does not cover a patch, in the order in which they are asked."""

    DISC = "disc"
    ARM = "arm"
    VEHICLE = "vehicle"
    ZONE = "zone"
    PATH = "path"


SENTENCES: Final = {
    Reason.DISC: "too narrow for the troweling disc",
    Reason.ARM: "the disc fits, but the arm behind it finds no room in any direction",
    Reason.VEHICLE: "disc and arm fit, but the vehicle finds no room in any position",
    Reason.ZONE: "the robot fits there, but no chain of positions leads there from the start",
    Reason.PATH: "the robot fits there, but cannot drive there from the start",
}


@dataclass(frozen=True, slots=True)
class Patch:
    """A connected piece of free floor that is not reached.

    Attributes:
        region: Its shape in the plan's frame.
        reason: Why it is not reached.
        label_mm: A point inside it, for its label.
        narrow: Whether it gathers strips narrower than a lattice cell, which the lattice cannot
            resolve; its region then has many parts.
        blocker: The obstacle nearest to the label where one is in the way, else None.
    """

    region: Region
    reason: Reason
    label_mm: tuple[float, float]
    narrow: bool
    blocker: Obstacle | None

    @property
    def area_mm2(self) -> float:
        """Area of the patch."""
        return float(self.region.area)


def fitting_nodes(engine: Engine, robot: Robot, lattice: Lattice) -> tuple[BoolArray, BoolArray]:
    """Nodes at which the disc alone fits, and at which disc and arm fit in some direction."""
    disc = ~engine.blocked(robot.disc())
    capsules = (~engine.blocked(robot.capsule(arm)) for arm in lattice.directions())
    return lattice.unpacked(disc), lattice.unpacked(reduce(np.bitwise_or, capsules))


def unreached(
    plan: FloorPlan,
    robot: Robot,
    lattice: Lattice,
    aoi: Aoi,
    wider: dict[Reason, BoolArray],
) -> tuple[Patch, ...]:
    """The patches of free floor that the area of interest leaves over, largest first.

    Args:
        plan: The floor and its obstacles.
        robot: The robot.
        lattice: Nodes and directions.
        aoi: The area of interest.
        wider: For each reason but `disc` the nodes, shape (n_rows, n_columns), whose discs cover
            what is left over for that reason and all that comes after it in `Reason`.

    Returns:
        Patches whose areas and the area of interest add up to the free floor. Strips narrower
        than a cell are gathered, one patch a reason, at the end.
    """
    rest = as_region(plan.free_region().difference(_region(aoi)))
    by_reason: dict[Reason, Region] = {}
    for reason in reversed(Reason):
        if reason in wider:
            covered = _region(area(wider[reason], lattice, robot.disc_radius_mm))
            by_reason[reason] = as_region(rest.intersection(covered))
            rest = as_region(rest.difference(covered))
        elif reason is Reason.DISC:
            by_reason[reason] = rest
    blockers = _Blockers(plan)
    wide: list[Patch] = []
    narrow: list[Patch] = []
    for reason, region in by_reason.items():
        broad = _opened(region, lattice.step_mm)
        wide.extend(blockers.patch(part, reason) for part in polygons_in([broad]))
        strips = as_region(region.difference(broad))
        if strips.area > 0:
            narrow.append(blockers.patch(strips, reason, narrow=True))
    return (*sorted(wide, key=_order), *sorted(narrow, key=_order))


class _Blockers:
    """Finds the obstacle that stands in the way of a patch."""

    def __init__(self, plan: FloorPlan) -> None:
        self._obstacles = plan.obstacles
        self._tree = shapely.STRtree([o.region() for o in plan.obstacles])
        self._edge = plan.floor.boundary

    def patch(self, region: Region, reason: Reason, *, narrow: bool = False) -> Patch:
        """A patch with its label and, for what is too tight, what it is tight against."""
        label = max(polygons_in([region]), key=lambda p: p.area).representative_point()
        in_the_way = None if reason in (Reason.PATH, Reason.ZONE) else self._nearest(label)
        return Patch(region, reason, (label.x, label.y), narrow, in_the_way)

    def _nearest(self, point: Point) -> Obstacle | None:
        """The nearest obstacle, or None where the edge of the floor is nearer."""
        if not self._obstacles:
            return None
        index, distance_mm = self._tree.query_nearest(point, return_distance=True, all_matches=True)
        if self._edge.distance(point) < distance_mm[0]:
            return None
        return self._obstacles[int(index.min())]


def _region(aoi: Aoi) -> Region:
    """The area as polygons of its own size."""
    parts = [outline.equal_area_polygon(SAGITTA_MM) for outline in aoi.outlines]
    return as_region(shapely.union_all(parts)) if parts else MultiPolygon()


def _opened(region: Region, width_mm: float) -> Region:
    """What is left of a region without its parts narrower than a width."""
    shrunk = region.buffer(-width_mm / 2, join_style="mitre")
    return as_region(shrunk.buffer(width_mm / 2, join_style="mitre").intersection(region))


def _order(patch: Patch) -> tuple[float, tuple[float, float]]:
    """Largest first, then by position."""
    return -patch.area_mm2, patch.label_mm
