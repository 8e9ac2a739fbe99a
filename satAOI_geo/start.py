"""Where the robot is set down: the node, or an error that says what is in the way."""

from collections import Counter
from dataclasses import dataclass
from typing import Literal

import numpy as np

from satAOI_geo.collision import Collider
from satAOI_geo.errors import StartBlockedError
from satAOI_geo.lattice import Lattice
from satAOI_geo.plan import BoolArray, FloatArray, FloorPlan, Obstacle
from satAOI_geo.reach import DiscComponents, PoseComponents
from satAOI_geo.robot import Part, Robot
from satAOI_geo.zones import largest, set_down


@dataclass(frozen=True, slots=True)
class Start:
    """Where the robot is set down.

    Attributes:
        node: Row and column of the disc centre.
        source: `option`, `drawing`, or `largest` when it was chosen for its area.
        disc_label: The disc-connected set that holds it.
        pose_label: The pose-connected set that holds it; of several the one of the largest area.
        n_components: How many pose-connected sets have a pose at the node.
    """

    node: tuple[int, int]
    source: Literal["option", "drawing", "largest"]
    disc_label: int
    pose_label: int
    n_components: int


def start_at(
    node: tuple[int, int],
    source: Literal["option", "drawing"],
    disc: DiscComponents,
    pose: PoseComponents,
    disc_mm: float,
) -> Start:
    """The start at a free node."""
    labels = pose.at_node(*node)
    label = largest(pose, labels, pose.lattice, disc_mm)
    return Start(node, source, int(disc.labels[node]), label, len(labels))


def largest_start(
    connectivity: Literal["disc", "pose"],
    disc: DiscComponents,
    pose: PoseComponents,
    disc_mm: float,
) -> Start:
    """The start that trowels the largest area, by the connectivity that is asked for."""
    one_run_each = pose.members[pose.first[:-1]]
    disc_of_pose = disc.labels[pose.runs.row[one_run_each], pose.runs.begin[one_run_each]]
    labels = np.arange(len(disc_of_pose))
    if connectivity == "disc":
        best = largest(disc, range(len(disc.boxes)), pose.lattice, disc_mm)
        labels = np.flatnonzero(disc_of_pose == best)
    label = largest(pose, labels.tolist(), pose.lattice, disc_mm)
    state = set_down(pose, label)
    node = (state.iy, state.ix)
    return Start(node, "largest", int(disc_of_pose[label]), label, len(pose.at_node(*node)))


def free_node(
    plan: FloorPlan,
    robot: Robot,
    lattice: Lattice,
    free: BoolArray,
    *,
    start_mm: tuple[float, float],
    clearance_mm: float,
) -> tuple[int, int]:
    """The node nearest to a start in the plan's frame.

    Args:
        plan: The floor and its obstacles.
        robot: The robot.
        lattice: Nodes and directions.
        free: Nodes at which some pose is free, shape (n_rows, n_columns).
        start_mm: Disc centre to start from.
        clearance_mm: Distance kept beyond contact.

    Raises:
        StartBlockedError: If no pose is free there; it names what is in the way and the nearest
            node with a free pose.
    """
    node = lattice.nearest_node(*start_mm)
    if node is not None and free[node]:
        return node
    at_mm = _in_drawing_mm(plan, start_mm)
    where = f"start ({at_mm[0]:.1f}, {at_mm[1]:.1f}) mm"
    obstacle = None
    if node is None:
        message = f"{where} lies outside the floor"
    else:
        obstacle = _in_the_way(Collider(plan, robot, clearance_mm), robot, lattice, node)
        message = f"{where} is blocked: no pose is free there; {_named(obstacle)} is in the way"
    nearest_mm = _in_drawing_mm(plan, _nearest_free_mm(free, lattice, start_mm))
    nearest = nearest_mm / plan.frame.mm_per_unit
    raise StartBlockedError(
        f"{message}; the nearest node with a free pose is --start {nearest[0]:g},{nearest[1]:g}",
        at_mm=(float(at_mm[0]), float(at_mm[1])),
        handle=obstacle.handle if obstacle else "",
        layer=obstacle.layer if obstacle else "",
        nearest_mm=(float(nearest_mm[0]), float(nearest_mm[1])),
    )


def _in_the_way(
    collider: Collider, robot: Robot, lattice: Lattice, node: tuple[int, int]
) -> Obstacle | None:
    """What the disc touches at a node, else what most poses there touch; None for the edge."""
    iy, ix = node
    disc = Part(np.zeros((2, 2)), robot.disc_radius_mm)
    touched = collider.touched(disc.moved(lattice.x_mm(ix), lattice.y_mm(iy)))
    if touched:
        return touched[0]
    contacts = (
        collider.contact(lattice.pose(iy, ix, a1, swing))
        for a1 in range(lattice.n_directions)
        for swing in range(len(lattice.swings))
    )
    (obstacle, _), *_ = Counter(c.obstacle for c in contacts if c is not None).most_common(1)
    return obstacle


def _named(obstacle: Obstacle | None) -> str:
    """An obstacle as a person can find it in the drawing."""
    if obstacle is None:
        return "the edge of the floor"
    return f"{obstacle.kind} {obstacle.handle} on layer '{obstacle.layer}'"


def _nearest_free_mm(
    free: BoolArray, lattice: Lattice, at_mm: tuple[float, float]
) -> tuple[float, float]:
    """The free node nearest to a point, the lowest row and column among equals."""
    rows, columns = np.nonzero(free)
    x_mm = lattice.origin_mm[0] + (columns + 0.5) * lattice.step_mm
    y_mm = lattice.origin_mm[1] + (rows + 0.5) * lattice.step_mm
    nearest = int(np.hypot(x_mm - at_mm[0], y_mm - at_mm[1]).argmin())
    return float(x_mm[nearest]), float(y_mm[nearest])


def _in_drawing_mm(plan: FloorPlan, at_mm: tuple[float, float]) -> FloatArray:
    """A point of the plan in the drawing's axes, shape (2,)."""
    return plan.frame.to_drawing_mm(at_mm)
