"""The exact reference: does the robot at one pose touch anything?

Algorithm 1 of the paper with the readings that make it work (contact is collision, the vehicle is
tested, lengths are compared with lengths), on true geometry instead of grid points: the spine of
the capsule and the rectangle of the vehicle against the obstacles, one pose at a time. Written to
be read; `freespace` is the fast one and is held to this one.
"""

from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry import LineString, Point, Polygon, box
from shapely.geometry.base import BaseGeometry

from satAOI_geo.lattice import Lattice, Words
from satAOI_geo.nodes import Nodes
from satAOI_geo.plan import (
    CONTACT_MM,
    BoolArray,
    FloorPlan,
    IntArray,
    Obstacle,
    core_of,
    polygons_in,
    radius_mm_of,
)
from satAOI_geo.robot import Part, Pose, Robot, unit
from satAOI_geo.sweep import stepped


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
        ImportError: If the installed GEOS is known to answer questions of distance wrongly.
    """

    def __init__(self, plan: FloorPlan, robot: Robot, clearance_mm: float = 0.0) -> None:
        _refuse_unsound_geos()
        self._robot = robot
        self._keep_mm = clearance_mm + CONTACT_MM
        # parts swept by a move reach beyond the robot by a step or the push of their hull
        outside = polygons_in([plan.outside(2 * robot.reach_mm + clearance_mm)])
        self._obstacles: list[Obstacle | None] = [*plan.obstacles, *(None for _ in outside)]
        shapes = [*(obstacle.shape for obstacle in plan.obstacles), *outside]
        self._cores = np.array([core_of(shape) for shape in shapes])
        self._radii_mm = np.array([radius_mm_of(shape) for shape in shapes])
        left, bottom, right, top = shapely.bounds(self._cores).T
        r_mm = self._radii_mm
        self._tree = shapely.STRtree(
            shapely.box(left - r_mm, bottom - r_mm, right + r_mm, top + r_mm)
        )

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
        core = _part_core(part)
        keep_mm = part.radius_mm + self._keep_mm
        left, bottom, right, top = core.bounds
        around = box(left - keep_mm, bottom - keep_mm, right + keep_mm, top + keep_mm)
        near = np.sort(self._tree.query(around))
        # measured, not asked with `dwithin`, which misses lines of no length
        gaps_mm = shapely.distance(core, self._cores[near]) - self._radii_mm[near]
        return [self._obstacles[i] for i in near[gaps_mm <= keep_mm]]


class Reference:
    """The slow engine: tells where a part touches something by asking a `Collider` node by node.

    It stands in for `intervals.Intervals` wherever an answer is audited.
    """

    def __init__(self, collider: Collider, lattice: Lattice) -> None:
        self._collider = collider
        self._lattice = lattice

    def block(self, words: Words, part: Part) -> IntArray:
        """Set the bits of the nodes at which the part touches something; the steps it bars."""
        blocked = self.blocked(part)
        words |= blocked
        barred = []
        for rows_up, columns_right in ((0, 1), (1, 0)):
            step_mm = np.array((columns_right, rows_up)) * self._lattice.step_mm
            (swept,) = stepped([part], step_mm)
            nodes = Nodes(self.blocked(swept) & ~blocked, self._lattice.n_columns).as_array()
            barred += [(rows_up, iy, ix) for iy, ix in np.argwhere(nodes).tolist()]
        return np.array(barred, dtype=np.int64).reshape(-1, 3)

    def band(self, rows: slice) -> "Reference":
        """An engine for some rows of the lattice, with start and stop."""
        return Reference(self._collider, self._lattice.band(rows))

    def blocked(self, part: Part, rows: BoolArray | None = None) -> Words:
        """Nodes at which the part touches something, and every bit beyond the last column."""
        lattice = self._lattice
        touches = np.zeros(lattice.shape, dtype=np.bool_)
        for iy in range(lattice.n_rows) if rows is None else np.flatnonzero(rows).tolist():
            for ix in range(lattice.n_columns):
                at_node = part.moved(lattice.x_mm(ix), lattice.y_mm(iy))
                touches[iy, ix] = bool(self._collider.touched(at_node))
        return Nodes.of(touches).words | lattice.no_nodes()


def _part_core(part: Part) -> BaseGeometry:
    """The point, segment or polygon that a part reaches out from."""
    if len(part.corners_mm) == 1:
        return Point(part.corners_mm[0])
    return (LineString if len(part.corners_mm) == 2 else Polygon)(part.corners_mm)


def _refuse_unsound_geos() -> None:
    """Raise where a prepared line misses a line it lies on (shapely issue 1887).

    GEOS releases before 3.13 are known to. The test measures distances and does not ask this
    question; but a GEOS that errs here is not trusted to tell where a robot meets a wall.
    """
    along = shapely.linestrings(np.arange(10.0), np.arange(10.0))
    within = shapely.linestrings(np.arange(2.0, 8.0), np.arange(2.0, 8.0))
    if shapely.STRtree([along]).query(within, predicate="dwithin", distance=1.0).size == 0:
        version = ".".join(map(str, shapely.geos_version))
        raise ImportError(
            f"GEOS {version} answers 'dwithin' wrongly (shapely issue 1887); install shapely 2.1 "
            "or later from its own wheels, which bring a sound GEOS"
        )
