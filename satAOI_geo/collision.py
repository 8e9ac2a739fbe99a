"""The exact reference: does the robot at one pose touch anything?

Algorithm 1 of the paper with the readings that make it work (contact is collision, the vehicle is
tested, lengths are compared with lengths), on true geometry instead of grid points: the spine of
the capsule and the rectangle of the vehicle against the obstacles, one pose at a time. Written to
be read; `freespace` is the fast one and is held to this one.
"""

from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry import LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry

from satAOI_geo.lattice import Lattice, Words
from satAOI_geo.plan import CONTACT_MM, Circle, FloorPlan, Obstacle, polygons_in
from satAOI_geo.robot import Part, Pose, Robot, unit


@dataclass(frozen=True, slots=True)
class Contact:
    """What the robot touches.

    Attributes:
        part: `capsule` (arm and disc) or `vehicle`.
        obstacle: The obstacle touched, or None for the edge of the floor.
    """

    part: str
    obstacle: Obstacle | None


class Collider:
    """Tells whether a pose touches the obstacles or the edge of the floor.

    Args:
        plan: The floor and its obstacles.
        robot: The robot.
        clearance_mm: Distance to keep beyond contact, the paper's redundancy.

    Raises:
        ImportError: If the installed GEOS answers `dwithin` wrongly.
    """

    def __init__(self, plan: FloorPlan, robot: Robot, clearance_mm: float = 0.0) -> None:
        _refuse_unsound_geos()
        self._robot = robot
        self._limit_mm = clearance_mm + CONTACT_MM
        outside = polygons_in([plan.outside(robot.reach_mm + clearance_mm + 1.0)])
        solids = [o for o in plan.obstacles if not isinstance(o.shape, Circle)]
        self._solids: list[Obstacle | None] = [*solids, *(None for _ in outside)]
        self._tree = shapely.STRtree([*(o.region() for o in solids), *outside])
        self._circles = [o for o in plan.obstacles if isinstance(o.shape, Circle)]
        shapes = [o.shape for o in self._circles if isinstance(o.shape, Circle)]
        self._centres = np.array([Point(c.x_mm, c.y_mm) for c in shapes], dtype=object)
        self._radii_mm = np.array([c.radius_mm for c in shapes])

    def is_free(self, pose: Pose) -> bool:
        """Whether the robot at this pose touches nothing."""
        return self.contact(pose) is None

    def contact(self, pose: Pose) -> Contact | None:
        """What the robot at this pose touches first, arm and disc before the vehicle."""
        arm, heading = unit(pose.a1_rad), unit(pose.a1_rad + pose.a2_rad)
        parts = {
            "capsule": self._robot.capsule(arm),
            "vehicle": self._robot.vehicle(arm, heading),
        }
        for name, part in parts.items():
            touched = self.touched(part.moved(pose.x_mm, pose.y_mm))
            if touched:
                return Contact(name, touched[0])
        return None

    def touched(self, part: Part) -> list[Obstacle | None]:
        """All that a part touches, in the plan's order; None stands for the edge of the floor."""
        core = _core(part)
        limit_mm = part.radius_mm + self._limit_mm
        hits = np.sort(self._tree.query(core, predicate="dwithin", distance=limit_mm))
        solids = [self._solids[i] for i in hits]
        gaps_mm = shapely.distance(core, self._centres) - self._radii_mm
        circles = [self._circles[i] for i in np.flatnonzero(gaps_mm <= limit_mm)]
        return [*circles, *solids]


class Reference:
    """The slow engine: tells where a part touches something by asking a `Collider` node by node.

    It stands in for `intervals.Intervals` wherever an answer is audited.
    """

    def __init__(self, collider: Collider, lattice: Lattice) -> None:
        self._collider = collider
        self._lattice = lattice

    def blocked(self, part: Part) -> Words:
        """Nodes at which the part touches something, and every bit beyond the last column."""
        lattice = self._lattice
        touches = [
            [
                bool(self._collider.touched(part.moved(lattice.x_mm(ix), lattice.y_mm(iy))))
                for ix in range(lattice.n_columns)
            ]
            for iy in range(lattice.n_rows)
        ]
        return lattice.packed(np.array(touches))


def _core(part: Part) -> BaseGeometry:
    """The point, segment or polygon that a part reaches out from."""
    if len(part.corners_mm) == 1:
        return Point(part.corners_mm[0])
    return (LineString if len(part.corners_mm) == 2 else Polygon)(part.corners_mm)


def _refuse_unsound_geos() -> None:
    """Raise where a prepared line misses a line it lies on (shapely issue 1887).

    GEOS releases before 3.13 are known to; a missed contact would let the robot into a wall.
    """
    along = shapely.linestrings(np.arange(10.0), np.arange(10.0))
    within = shapely.linestrings(np.arange(2.0, 8.0), np.arange(2.0, 8.0))
    if shapely.STRtree([along]).query(within, predicate="dwithin", distance=1.0).size == 0:
        version = ".".join(map(str, shapely.geos_version))
        raise ImportError(
            f"GEOS {version} answers 'dwithin' wrongly (shapely issue 1887); install shapely 2.1 "
            "or later from its own wheels, which bring a sound GEOS"
        )
