"""Why a patch of free floor is not reached.

Nested sets of disc centres, each a part of the one before, cover nested areas:

    the disc fits ⊇ disc and arm fit in some direction ⊇ some pose is free
                  ⊇ disc-connected with the start ⊇ pose-connected with the start

What lies between two of them has one reason, and all of them together are the free floor that the
area of interest leaves over.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from functools import reduce
from itertools import pairwise
from typing import Final

import numpy as np
import shapely
from shapely.geometry import MultiPolygon, Point, Polygon

from satAOI_geo.aoi import Aoi
from satAOI_geo.engine import Engine
from satAOI_geo.lattice import Lattice
from satAOI_geo.nodes import Nodes
from satAOI_geo.plan import FloorPlan, Obstacle, Region, as_region, polygons_in
from satAOI_geo.robot import Robot

SAGITTA_MM: Final = 0.01
"""How far the polygons of patches may leave the arcs they share with the area of interest."""


APART_MM: Final = 0.05
"""By how much outlines that run along each other are set apart before they are overlaid. Lines a
rounding apart cross hundreds of times; what divides one reason from another may move by as much."""

NARROW_CELLS: Final = 2
"""Between the disc and a wall the lattice leaves strips of up to a cell, askew to it 1.4 cells."""


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
    """A connected piece of free floor that is not reached, or all strips of it.

    Attributes:
        region: Its shape in the plan's frame.
        reason: Why it is not reached.
        label_mm: A point inside it, for its label.
        narrow: Whether it gathers the strips narrower than `NARROW_CELLS`, which the lattice does
            not resolve; its region then has many parts.
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


def fitting_nodes(
    engine: Engine, robot: Robot, lattice: Lattice, free: Nodes
) -> dict[Reason, Nodes]:
    """Nodes at which the disc, the disc and the arm, or any pose touches nothing.

    What the disc covers from them holds what is left over for the reason each stands at; `free`
    are the nodes at which some pose is free.
    """
    capsules = (~engine.blocked(robot.capsule(arm)) for arm in lattice.directions())
    return {
        Reason.ARM: Nodes(~engine.blocked(robot.disc()), lattice.n_columns),
        Reason.VEHICLE: Nodes(reduce(np.bitwise_or, capsules), lattice.n_columns),
        Reason.ZONE: free,
    }


def unreached(
    plan: FloorPlan, lattice: Lattice, aoi: Aoi, wider: dict[Reason, Aoi]
) -> tuple[Patch, ...]:
    """The patches of free floor that the area of interest leaves over, largest first.

    Args:
        plan: The floor and its obstacles.
        lattice: Nodes and directions.
        aoi: The area of interest.
        wider: For each reason but `disc` the area that holds what is left over for that reason
            and for all that come after it in `Reason`.

    Returns:
        Patches whose areas and the area of interest add up to the free floor. Strips narrower
        than `NARROW_CELLS`, which finer steps of the disc would cover in part, and crumbs smaller
        than a cell are gathered in one patch at the end.
    """
    rest = as_region(plan.free_region().difference(_region(aoi)))
    covered = {reason: _region(area) for reason, area in wider.items()}
    parts = polygons_in([rest])
    width_mm = NARROW_CELLS * lattice.step_mm
    broad = [_opened(part, width_mm) for part in parts]
    strips = [part.difference(region) for part, region in zip(parts, broad, strict=True)]
    pieces = [
        piece for part in polygons_in(broad) for piece in _split(part, covered, lattice.step_mm)
    ]
    blockers = _Blockers(plan)
    crumb_mm2 = lattice.step_mm**2
    patches = [blockers.patch(piece, reason) for reason, piece in pieces if piece.area >= crumb_mm2]
    patches.sort(key=lambda patch: (-patch.area_mm2, patch.label_mm))
    crumbs = [piece for _, piece in pieces if piece.area < crumb_mm2]
    narrow = as_region(shapely.union_all([*strips, *crumbs]))
    if narrow.area > 0:
        patches.append(blockers.patch(narrow, Reason.DISC, narrow=True))
    return tuple(patches)


def _split(
    part: Polygon, covered: dict[Reason, Region], step_mm: float
) -> Iterator[tuple[Reason, Polygon]]:
    """The pieces of a part by their reasons.

    Outlines of nested areas run along each other, a rounding apart: pieces narrower than a cell
    go to the reason that most of the part has.
    """
    by_reason: dict[Reason, Region] = {}
    inside: Region = part
    for order, (reason, next_reason) in enumerate(pairwise(Reason), start=1):
        # each area holds the next: where one is met by rounding only, so are all after it
        near = as_region(_clipped(covered[next_reason], part).buffer(-APART_MM * order))
        still = as_region(inside.intersection(near))
        if still.area < step_mm**2:
            by_reason[reason] = inside
            break
        by_reason[reason] = as_region(inside.difference(near))
        inside = still
    else:
        by_reason[Reason.PATH] = inside
    most = max(by_reason, key=lambda reason: by_reason[reason].area)
    others = [
        (reason, piece)
        for reason, region in by_reason.items()
        if reason is not most
        for piece in polygons_in([region])
        if piece.area >= step_mm**2 and not piece.buffer(-step_mm / 2).is_empty
    ]
    yield from others
    left = part.difference(shapely.union_all([piece for _, piece in others])) if others else part
    yield from ((most, piece) for piece in polygons_in([left]))


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
    parts = MultiPolygon([outline.equal_area_polygon(SAGITTA_MM) for outline in aoi.outlines])
    # parts that touch may overlap by a rounding once their arcs are polygons
    return parts if parts.is_valid else as_region(shapely.union_all(parts.geoms))


def _clipped(region: Region, part: Polygon) -> Region:
    """A region as far as a part can meet it: overlays of the whole would cost its whole length."""
    left, bottom, right, top = part.bounds
    near = shapely.clip_by_rect(region, left - 1.0, bottom - 1.0, right + 1.0, top + 1.0)
    return as_region(near if near.is_valid else shapely.make_valid(near))


def _opened(region: Region, width_mm: float) -> Region:
    """What is left of a region without its parts narrower than a width."""
    shrunk = region.buffer(-width_mm / 2, join_style="mitre")
    grown = shrunk.buffer(width_mm / 2 + APART_MM, join_style="mitre")
    return as_region(grown.intersection(region))
