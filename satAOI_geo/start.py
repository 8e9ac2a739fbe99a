"""Where the robot is set down: the node, or an error that says what is in the way."""

import math
from collections import Counter
from dataclasses import dataclass, replace
from typing import Literal, Optional

import numpy as np

from satAOI_geo.collision import Collider
from satAOI_geo.errors import InputError, StartBlockedError
from satAOI_geo.lattice import Lattice
from satAOI_geo.nodes import Nodes
from satAOI_geo.plan import FloorPlan, Frame, Obstacle
from satAOI_geo.reach import DiscComponents, PoseComponents, State
from satAOI_geo.robot import Robot
from satAOI_geo.runs import rows_of
from satAOI_geo.zones import largest, set_down


@dataclass(frozen=True, slots=True)
class StartMark:
    """A start as it was asked for.

    Attributes:
        at_mm: Disc centre in the plan's frame.
        source: `option`, or `drawing` for a mark in the drawing.
        angles_rad: a1 and a2 of the pose, or None for any pose.
    """

    at_mm: tuple[float, float]
    source: Literal["option", "drawing"] = "option"
    angles_rad: tuple[float, float] | None = None

    @classmethod
    def of(cls, plan: FloorPlan) -> Optional["StartMark"]:
        """The mark in the plan's drawing, or None where it has none."""
        return None if plan.start_mm is None else cls(plan.start_mm, "drawing")

    def check(self, robot: Robot) -> None:
        """Refuse a pose that the robot does not have.

        Raises:
            InputError: If the vehicle is turned farther against the arm than the arm swings.
        """
        if self.angles_rad is None:
            return
        _, a2_rad = self.angles_rad
        # the swing is -a2
        least_rad, most_rad = -robot.swing_max_rad, -robot.swing_min_rad
        if not least_rad <= a2_rad <= most_rad:
            raise InputError(
                f"the vehicle of robot '{robot.name}' turns against its arm from "
                f"{math.degrees(least_rad):g}° to {math.degrees(most_rad):g}°; give a start within "
                f"that rather than {math.degrees(a2_rad):g}°"
            )

    def turned(self, turn_rad: float) -> "StartMark":
        """The same mark seen in axes turned by an angle."""
        x_mm, y_mm = Frame(turn_rad=turn_rad).to_local_mm(self.at_mm).tolist()
        if self.angles_rad is None:
            return replace(self, at_mm=(x_mm, y_mm))
        a1_rad, a2_rad = self.angles_rad
        return replace(self, at_mm=(x_mm, y_mm), angles_rad=(a1_rad - turn_rad, a2_rad))


@dataclass(frozen=True, slots=True)
class Start:
    """Where the robot is set down.

    Attributes:
        state: Node and pose.
        source: `option`, `drawing`, or `largest` when it was chosen for its area.
        disc_label: The disc-connected set that holds it.
        pose_label: The pose-connected set that holds it; of several the one of the largest area.
        n_components: How many pose-connected sets have a pose at the node.
    """

    state: State
    source: Literal["option", "drawing", "largest"]
    disc_label: int
    pose_label: int
    n_components: int

    @property
    def node(self) -> tuple[int, int]:
        """Row and column of the disc centre."""
        return self.state.iy, self.state.ix


@dataclass(frozen=True, slots=True)
class StartFinder:
    """Finds the start among the connected sets.

    Attributes:
        plan: The floor and its obstacles, in the lattice's axes.
        robot: The robot.
        collider: The exact collision test, to name what is in the way.
        free: Nodes at which some pose is free.
        disc: The disc-connected sets.
        pose: The pose-connected sets.
    """

    plan: FloorPlan
    robot: Robot
    collider: Collider
    free: Nodes
    disc: DiscComponents
    pose: PoseComponents

    def at(self, mark: StartMark) -> Start:
        """The start at the node nearest to a mark.

        Raises:
            StartBlockedError: If the pose asked for, or every pose, is blocked there; it names
                what is in the way and the nearest node with a free pose.
        """
        lattice = self.pose.lattice
        node = lattice.nearest_node(*mark.at_mm)
        if node is None or not self.free.has(*node):
            raise self._blocked(mark, node, None)
        labels = self.pose.at_node(*node)
        if mark.angles_rad is None:
            label = largest(self.pose, labels, lattice, self.robot.disc_radius_mm)
            state = self.pose.straightest(*node, label)
        else:
            state = _nearest_state(lattice, node, mark.angles_rad)
            found = self.pose.at(*state)
            if found is None:
                raise self._blocked(mark, node, state)
            label = found
        return Start(state, mark.source, int(self.disc.labels_at(*node)), label, len(labels))

    def largest(self, connectivity: Literal["disc", "pose"]) -> Start:
        """The start that trowels the largest area, by the connectivity that is asked for."""
        lattice, disc_mm = self.pose.lattice, self.robot.disc_radius_mm
        disc_of_pose = self.disc.labels_at(*self.pose.first_nodes().T)
        labels = np.arange(disc_of_pose.size)
        if connectivity == "disc":
            best = largest(self.disc, range(len(self.disc.boxes)), lattice, disc_mm)
            labels = np.flatnonzero(disc_of_pose == best)
        label = largest(self.pose, labels.tolist(), lattice, disc_mm)
        state = set_down(self.pose, label)
        n_components = len(self.pose.at_node(state.iy, state.ix))
        return Start(state, "largest", int(disc_of_pose[label]), label, n_components)

    def _blocked(
        self, mark: StartMark, node: tuple[int, int] | None, state: State | None
    ) -> StartBlockedError:
        """The error for a mark; state is the pose asked for where another one is free."""
        frame, lattice = self.plan.frame, self.pose.lattice
        x_mm, y_mm = frame.to_drawing_mm(mark.at_mm).tolist()
        obstacle = None
        if node is None:
            reason = "lies outside the floor"
        else:
            obstacle = self._in_the_way(node, state)
            what = "no pose is free there" if state is None else "this pose is not free"
            name = obstacle.label() if obstacle else "the edge of the floor"
            reason = f"is blocked: {what}; {name} is in the way"
        nearest_mm = frame.to_drawing_mm(_nearest_free_mm(self.free, lattice, mark.at_mm))
        nearest = nearest_mm / frame.mm_per_unit
        return StartBlockedError(
            f"start ({x_mm:.1f}, {y_mm:.1f}) mm {reason}; the nearest node with a free pose is "
            f"--start {nearest[0]:.12g},{nearest[1]:.12g}",
            at_mm=(x_mm, y_mm),
            handle=obstacle.handle if obstacle else "",
            layer=obstacle.layer if obstacle else "",
            nearest_mm=(float(nearest_mm[0]), float(nearest_mm[1])),
        )

    def _in_the_way(self, node: tuple[int, int], state: State | None) -> Obstacle | None:
        """What the disc touches at a node, else what most of the poses asked for touch there.

        None stands for the edge of the floor.
        """
        lattice, (iy, ix) = self.pose.lattice, node
        touched = self.collider.touched(self.robot.disc().moved(lattice.x_mm(ix), lattice.y_mm(iy)))
        if touched:
            return touched[0]
        every = np.ndindex(lattice.n_directions, len(lattice.swings))
        poses = every if state is None else [(state.a1, state.swing)]
        contacts = (self.collider.contact(lattice.pose(iy, ix, *pose)) for pose in poses)
        (obstacle, _), *_ = Counter(c.obstacle for c in contacts if c is not None).most_common(1)
        return obstacle


def _nearest_state(
    lattice: Lattice, node: tuple[int, int], angles_rad: tuple[float, float]
) -> State:
    """The lattice's pose nearest to two angles."""
    turn_rad = 2 * math.pi / lattice.n_directions
    a1 = round(angles_rad[0] / turn_rad) % lattice.n_directions
    wanted = angles_rad[1] / turn_rad
    apart = np.abs(np.array(lattice.swings) - wanted)
    if lattice.swings_all_round:
        apart = np.minimum(apart, lattice.n_directions - apart)
    return State(*node, a1, int(apart.argmin()))


def _nearest_free_mm(
    free: Nodes, lattice: Lattice, at_mm: tuple[float, float]
) -> tuple[float, float]:
    """The free node nearest to a point, the lowest row and column among equals."""
    # in cells from the first node; a large floor has too many nodes to ask each of them
    x, y = (np.array(at_mm) - lattice.origin_mm) / lattice.step_mm - 0.5
    stretches = rows_of(free)
    rows = stretches.rows()
    columns = np.clip(np.ceil(x - 0.5), stretches.begin, stretches.end)
    nearest = int(np.hypot(columns - x, rows - y).argmin())
    return lattice.x_mm(int(columns[nearest])), lattice.y_mm(int(rows[nearest]))
