"""The paper's own program: Algorithms 1 and 2 as printed, over a KD-tree of occupied cells.

Where the printed lines cannot work they are read as the text around them says: the tree is built
once, contact is a collision, lengths are compared with lengths, all pairs of angles are tried, a
node is tried once. Comments give the lines of the two algorithms (SatAOI, arXiv 2505.04871).
"""

import math
from typing import TypeAlias

import numpy as np
from scipy.spatial import cKDTree

from benchmarks.cells import centres_mm, in_capsule, in_vehicle
from satAOI_geo.lattice import Lattice
from satAOI_geo.plan import BoolArray, FloatArray
from satAOI_geo.robot import Robot, unit

Node: TypeAlias = tuple[int, int]


class KdTreeLoop:
    """The program of the paper on one map.

    Args:
        occupied: Shape (n_rows, n_columns).
        lattice: Nodes and directions.
        robot: The robot.
    """

    def __init__(self, occupied: BoolArray, lattice: Lattice, robot: Robot) -> None:
        self._lattice, self._robot = lattice, robot
        x_mm, y_mm = centres_mm(lattice)
        step_mm = lattice.step_mm
        x_mm = np.concatenate(([x_mm[0] - step_mm], x_mm, [x_mm[-1] + step_mm]))
        y_mm = np.concatenate(([y_mm[0] - step_mm], y_mm, [y_mm[-1] + step_mm]))
        # beyond the map's edge is no floor: a rim of occupied cells, which no part steps across
        rimmed = np.pad(occupied, 1, constant_values=True)
        cells_mm = np.stack(np.meshgrid(x_mm, y_mm), axis=-1)
        self._obstacles = cKDTree(cells_mm[rimmed])
        self._floor = cKDTree(cells_mm[~rimmed])
        turn_rad = 2 * math.pi / lattice.n_directions
        self._angles1_rad = [k * turn_rad for k in range(lattice.n_directions)]
        self._angles2_rad = [k * turn_rad for k in lattice.swings]

    def is_collision(self, disc_mm: FloatArray, a1_rad: float, a2_rad: float) -> bool:
        """Algorithm 1."""
        robot, tree = self._robot, self._obstacles
        arm_mm, radius_mm = robot.arm_length_mm, robot.disc_radius_mm
        if tree.query_ball_point(disc_mm, radius_mm):  # 3
            return True
        arm, heading = unit(a1_rad), unit(a1_rad + a2_rad)
        middle_mm = disc_mm + (arm_mm - radius_mm) / 2 * arm  # 5
        near = tree.query_ball_point(middle_mm, (arm_mm + radius_mm) / 2)  # 7
        if self._any_in_capsule(tree.data[near] - middle_mm, arm):  # 8-17
            return True
        vehicle_mm = disc_mm + arm_mm * arm + robot.pivot_offset_mm * heading  # 18
        around_mm = math.hypot(robot.vehicle_length_mm, robot.vehicle_width_mm) / 2  # 19
        near = tree.query_ball_point(vehicle_mm, around_mm)  # 20
        return self._any_in_vehicle(tree.data[near] - vehicle_mm, heading)  # 21-32

    def fits(self, node: Node) -> bool:
        """Whether some pair of angles is free of collisions at a node: Algorithm 2, 11-19."""
        disc_mm = self._at_mm(node)
        return any(
            not self.is_collision(disc_mm, a1_rad, a2_rad)
            for a1_rad in self._angles1_rad
            for a2_rad in self._angles2_rad
        )

    def trowel(self, node: Node, trowelled: set[int]) -> None:
        """Add the cells that the disc covers at a node: Algorithm 2, 21-22."""
        radius_mm = self._robot.disc_radius_mm
        trowelled.update(self._floor.query_ball_point(self._at_mm(node), radius_mm))

    def _at_mm(self, node: Node) -> FloatArray:
        return np.array((self._lattice.x_mm(node[1]), self._lattice.y_mm(node[0])))

    def _any_in_capsule(self, from_middle_mm: FloatArray, arm: FloatArray) -> bool:
        """Whether a cell, shape (n, 2) from the middle of the spine, is within R of the spine."""
        radius_mm = self._robot.disc_radius_mm
        half_mm = (self._robot.arm_length_mm - radius_mm) / 2
        for cell_mm in from_middle_mm:
            along_mm = abs(cell_mm @ arm)
            if along_mm <= half_mm:  # 12
                if math.sqrt(max(0.0, cell_mm @ cell_mm - along_mm**2)) <= radius_mm:  # 13
                    return True
            elif min(math.dist(cell_mm, end * half_mm * arm) for end in (-1, 1)) <= radius_mm:  # 16
                return True
        return False

    def _any_in_vehicle(self, from_centre_mm: FloatArray, heading: FloatArray) -> bool:
        """Whether a cell, shape (n, 2) from the vehicle's centre, is in the vehicle."""
        half_length_mm = self._robot.vehicle_length_mm / 2
        half_width_mm = self._robot.vehicle_width_mm / 2
        for cell_mm in from_centre_mm:
            ahead_mm = abs(cell_mm @ heading)  # 28
            aside_mm = math.sqrt(max(0.0, cell_mm @ cell_mm - ahead_mm**2))  # 29
            if ahead_mm <= half_length_mm and aside_mm <= half_width_mm:  # 30
                return True
        return False


class KdTreeArrays(KdTreeLoop):
    """The same program with numpy's arrays for the loops over cells."""

    def _any_in_capsule(self, from_middle_mm: FloatArray, arm: FloatArray) -> bool:
        half_mm = (self._robot.arm_length_mm - self._robot.disc_radius_mm) / 2
        return bool(in_capsule(from_middle_mm + half_mm * arm, arm, self._robot).any())

    def _any_in_vehicle(self, from_centre_mm: FloatArray, heading: FloatArray) -> bool:
        return bool(in_vehicle(from_centre_mm, heading, self._robot).any())
