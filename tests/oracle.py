"""The slow, obvious algorithms that the fast ones must agree with.

Nothing here comes from `robot`, `sweep`, `collision` or `intervals`: parts, swept parts and
distances are built again from their definitions, with shapely. Of the program only the plan, the
robot's measures and the lattice's figures are read.
"""

import math
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import compress
from typing import Final, TypeAlias

import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry import LineString, MultiPoint, Point, Polygon
from shapely.geometry.base import BaseGeometry

from satAOI_geo.lattice import Lattice
from satAOI_geo.plan import Circle, FloorPlan
from satAOI_geo.robot import Robot

TOUCH_MM: Final = 1e-4

Node: TypeAlias = tuple[int, int]
"""Row and column."""

Turns: TypeAlias = tuple[int, int]
"""a1 and a2 in whole directions; a2 may be negative."""

State: TypeAlias = tuple[int, int, int, int]
"""Row, column, a1, a2."""

Points: TypeAlias = list[tuple[float, float]]


@dataclass(frozen=True)
class Solid:
    """All points within a radius of a core."""

    core: BaseGeometry
    radius_mm: float = 0.0


class Oracle:
    """Which states are free, which moves are allowed, and what they connect."""

    def __init__(
        self, plan: FloorPlan, robot: Robot, lattice: Lattice, clearance_mm: float = 0.0
    ) -> None:
        self.plan, self.robot, self.lattice = plan, robot, lattice
        self.keep_mm = clearance_mm + TOUCH_MM
        self.turn_rad = 2 * math.pi / lattice.n_directions
        self.obstacles = [solid_of(o.shape) for o in plan.obstacles]
        self.nodes = [(iy, ix) for iy in range(lattice.n_rows) for ix in range(lattice.n_columns)]
        self.swings = self._swings()
        self.is_ring = robot.swing_max_rad - robot.swing_min_rad > 2 * math.pi - 1e-9

    def _swings(self) -> list[int]:
        """The a2 for which the swing -a2 lies in the robot's range; a full turn counts once."""
        n = self.lattice.n_directions
        least, most = self.robot.swing_min_rad - 1e-9, self.robot.swing_max_rad + 1e-9
        allowed = [a2 for a2 in range(-2 * n, 2 * n + 1) if least <= -a2 * self.turn_rad <= most]
        return allowed[:n]

    def capsule(self, a1: int) -> Points:
        """Ends of the spine, seen from the disc centre."""
        return [
            (0.0, 0.0),
            polar(self.robot.arm_length_mm - self.robot.disc_radius_mm, self._rad(a1)),
        ]

    def vehicle(self, a1: int, a2: int) -> Points:
        """Corners of the vehicle, seen from the disc centre."""
        robot, yaw_rad = self.robot, self._rad(a1 + a2)
        x_mm, y_mm = self.pivot(a1)
        corners = []
        for side in (-1, 1):
            for end in (-1, 1):
                # in the vehicle's own frame, heading along x, the pivot at the origin
                ahead_mm = robot.pivot_offset_mm + end * robot.vehicle_length_mm / 2
                left_mm = side * robot.vehicle_width_mm / 2
                dx_mm, dy_mm = rotated((ahead_mm, left_mm), yaw_rad)
                corners.append((x_mm + dx_mm, y_mm + dy_mm))
        return corners

    def pivot(self, a1: int) -> tuple[float, float]:
        """The arm pivot, seen from the disc centre."""
        return polar(self.robot.arm_length_mm, self._rad(a1))

    def free(self, turns: Turns, nodes: list[Node]) -> list[bool]:
        """Whether the pose is free at each of the nodes."""
        return self._clear_of_all(self.capsule(turns[0]), self.vehicle(*turns), nodes)

    def free_states(self) -> set[State]:
        """All free states."""
        found: set[State] = set()
        for a1 in range(self.lattice.n_directions):
            for a2 in self.swings:
                free = self.free((a1, a2), self.nodes)
                found |= {(*node, a1, a2) for node in compress(self.nodes, free)}
        return found

    def partition(self) -> dict[State, int]:
        """Number of the connected set of each free state."""
        states = self.free_states()
        neighbours: dict[State, list[State]] = {state: [] for state in states}
        for one, other in self._moves(states):
            neighbours[one].append(other)
            neighbours[other].append(one)
        return components(neighbours)

    def _moves(self, states: set[State]) -> Iterator[tuple[State, State]]:
        """The allowed moves between free states, each named once."""
        for a1 in range(self.lattice.n_directions):
            for a2 in self.swings:
                yield from self._moves_from((a1, a2), states)

    def _moves_from(self, turns: Turns, states: set[State]) -> Iterator[tuple[State, State]]:
        """The allowed moves from one pose: a step right, a step up, a turn, a swing, an orbit."""
        n, step_mm = self.lattice.n_directions, self.lattice.step_mm
        a1, a2 = turns
        next_a1, one_turn_rad = (a1 + 1) % n, self.turn_rad
        capsule, vehicle = self.capsule(a1), self.vehicle(a1, a2)
        disc, pivot = (0.0, 0.0), self.pivot(a1)
        orbiting = shift_along_arc(vehicle, pivot, one_turn_rad)
        capsule_turned = turn_about(capsule, disc, one_turn_rad)
        for (rows, columns), end, swept_capsule, swept_vehicle in (
            ((0, 1), turns, shift(capsule, (step_mm, 0)), shift(vehicle, (step_mm, 0))),
            ((1, 0), turns, shift(capsule, (0, step_mm)), shift(vehicle, (0, step_mm))),
            ((0, 0), (next_a1, a2), capsule_turned, turn_about(vehicle, disc, one_turn_rad)),
            ((0, 0), (a1, self._beside(a2, 1)), capsule, turn_about(vehicle, pivot, one_turn_rad)),
            ((0, 0), (next_a1, self._beside(a2, -1)), capsule_turned, orbiting),
        ):
            nodes = [
                (iy, ix)
                for iy, ix in self.nodes
                if (iy, ix, *turns) in states and (iy + rows, ix + columns, *end) in states
            ]
            clear = self._clear_of_all(swept_capsule, swept_vehicle, nodes)
            for iy, ix in compress(nodes, clear):
                yield (iy, ix, *turns), (iy + rows, ix + columns, *end)

    def _beside(self, a2: int, step: int) -> int:
        """The next turn of the vehicle, round the ring if there is one.

        Beyond the end of a range it is a turn that no state has.
        """
        least = self.swings[0]
        return least + (a2 + step - least) % len(self.swings) if self.is_ring else a2 + step

    def _clear_of_all(self, capsule: Points, vehicle: Points, nodes: list[Node]) -> list[bool]:
        """Whether the hulls of both parts, seen from each node, touch nothing."""
        if not nodes:
            return []
        clear = np.ones(len(nodes), dtype=bool)
        for points, radius_mm in ((capsule, self.robot.disc_radius_mm), (vehicle, 0.0)):
            cores = self._placed(MultiPoint(points).convex_hull, nodes)
            limit_mm = radius_mm + self.keep_mm
            clear &= shapely.covers(self.plan.floor, cores)
            clear &= shapely.distance(self.plan.floor.boundary, cores) > limit_mm
            for solid in self.obstacles:
                clear &= shapely.distance(solid.core, cores) > limit_mm + solid.radius_mm
        return clear.tolist()

    def _placed(self, core: BaseGeometry, nodes: list[Node]) -> npt.NDArray[np.object_]:
        """Copies of a core, one at each node."""
        left_mm, bottom_mm = self.lattice.origin_mm
        step_mm = self.lattice.step_mm
        at_mm = [
            (left_mm + (ix + 0.5) * step_mm, bottom_mm + (iy + 0.5) * step_mm) for iy, ix in nodes
        ]
        copies = np.array([core] * len(nodes), dtype=object)
        corners_mm = shapely.get_coordinates(copies).reshape(len(nodes), -1, 2)
        placed_mm = corners_mm + np.array(at_mm)[:, np.newaxis]
        shapely.set_coordinates(copies, placed_mm.reshape(-1, 2))
        return copies

    def _rad(self, direction: int) -> float:
        return direction * self.turn_rad


def flooded(start: Node, shape: tuple[int, int], is_free: Callable[[Node], bool]) -> set[Node]:
    """Algorithm 2 of the paper: from a free start over the 8 neighbours, each asked once."""
    if not is_free(start):
        return set()
    reached, blocked, queue = {start}, set(), deque([start])
    while queue:
        iy, ix = queue.popleft()
        for node in ((iy + rows, ix + cols) for rows in (-1, 0, 1) for cols in (-1, 0, 1)):
            inside = 0 <= node[0] < shape[0] and 0 <= node[1] < shape[1]
            if not inside or node in reached or node in blocked:
                continue
            if is_free(node):
                reached.add(node)
                queue.append(node)
            else:
                blocked.add(node)
    return reached


def components(neighbours: dict[State, list[State]]) -> dict[State, int]:
    """Number of the connected set of each key, breadth first."""
    label: dict[State, int] = {}
    for n_sets, first in enumerate(neighbours):
        if first in label:
            continue
        label[first] = n_sets
        queue = deque([first])
        while queue:
            for state in neighbours[queue.popleft()]:
                if state not in label:
                    label[state] = n_sets
                    queue.append(state)
    return label


def solid_of(shape: Polygon | LineString | Circle) -> Solid:
    """An obstacle; a circle is its centre with a radius."""
    if isinstance(shape, Circle):
        return Solid(Point(shape.x_mm, shape.y_mm), shape.radius_mm)
    return Solid(shape)


def shift(points: Points, by_mm: tuple[float, float]) -> Points:
    """Corners before and after a straight move."""
    return points + [(x + by_mm[0], y + by_mm[1]) for x, y in points]


def turn_about(points: Points, pivot: tuple[float, float], turn_rad: float) -> Points:
    """Corners before a turn, after it, and half-way, pushed out from the pivot by 1/cos(δ/2)."""
    swept = list(points)
    push = 1 / math.cos(turn_rad / 2)
    for angle_rad, factor in ((turn_rad / 2, push), (turn_rad, 1.0)):
        for x, y in points:
            dx, dy = rotated((x - pivot[0], y - pivot[1]), angle_rad)
            swept.append((pivot[0] + factor * dx, pivot[1] + factor * dy))
    return swept


def shift_along_arc(points: Points, hung_on: tuple[float, float], turn_rad: float) -> Points:
    """Corners that move, unturned, as a point does that turns about the disc centre."""
    path = turn_about([hung_on], (0.0, 0.0), turn_rad)
    return [(x + px - hung_on[0], y + py - hung_on[1]) for px, py in path for x, y in points]


def polar(length_mm: float, angle_rad: float) -> tuple[float, float]:
    return length_mm * math.cos(angle_rad), length_mm * math.sin(angle_rad)


def rotated(vector: tuple[float, float], angle_rad: float) -> tuple[float, float]:
    cos, sin = math.cos(angle_rad), math.sin(angle_rad)
    return vector[0] * cos - vector[1] * sin, vector[0] * sin + vector[1] * cos
