"""Floor and robot as cells, which is what the alternatives work on.

A cell is occupied when its centre lies in an obstacle or off the floor: obstacle maps are drawn
this way from CAD drawings in the paper, section 3.1. Cells are those of the lattice, so a cell's
centre is a node.
"""

import numpy as np
import shapely
from shapely.geometry import LineString

from satAOI_geo.lattice import Lattice
from satAOI_geo.plan import BoolArray, FloatArray, FloorPlan, Obstacle, Region
from satAOI_geo.robot import Robot


def occupied_cells(plan: FloorPlan, lattice: Lattice) -> BoolArray:
    """Whether each cell is occupied, shape (n_rows, n_columns); contact counts."""
    x_mm, y_mm = centres_mm(lattice)
    occupied: BoolArray = ~shapely.contains_xy(plan.floor, *np.meshgrid(x_mm, y_mm))
    for obstacle in plan.obstacles:
        region = _with_area(obstacle, lattice.step_mm)
        left, bottom, right, top = region.bounds
        rows = slice(*np.searchsorted(y_mm, (bottom, np.nextafter(top, np.inf))))
        columns = slice(*np.searchsorted(x_mm, (left, np.nextafter(right, np.inf))))
        near_mm = np.meshgrid(x_mm[columns], y_mm[rows])
        occupied[rows, columns] |= shapely.intersects_xy(region, *near_mm)
    return occupied


def centres_mm(lattice: Lattice) -> tuple[FloatArray, FloatArray]:
    """x of the columns and y of the rows, shape (n_columns,) and (n_rows,)."""
    x_mm = np.array([lattice.x_mm(ix) for ix in range(lattice.n_columns)])
    y_mm = np.array([lattice.y_mm(iy) for iy in range(lattice.n_rows)])
    return x_mm, y_mm


def in_capsule(offsets_mm: FloatArray, arm: FloatArray, robot: Robot) -> BoolArray:
    """Whether arm and disc cover points, shape (..., 2) from the disc's centre."""
    along_mm, aside_mm = offsets_mm @ arm, offsets_mm @ left_of(arm)
    spine_mm = robot.arm_length_mm - robot.disc_radius_mm
    beyond_mm = along_mm - np.clip(along_mm, 0.0, spine_mm)
    inside: BoolArray = np.hypot(beyond_mm, aside_mm) <= robot.disc_radius_mm
    return inside


def in_vehicle(offsets_mm: FloatArray, heading: FloatArray, robot: Robot) -> BoolArray:
    """Whether the vehicle covers points, shape (..., 2) from its own centre."""
    ahead_mm, aside_mm = np.abs(offsets_mm @ heading), np.abs(offsets_mm @ left_of(heading))
    inside: BoolArray = ahead_mm <= robot.vehicle_length_mm / 2
    return inside & (aside_mm <= robot.vehicle_width_mm / 2)


def left_of(direction: FloatArray) -> FloatArray:
    """The direction a quarter turn to the left, shape (2,)."""
    return np.array((-direction[1], direction[0]))


def _with_area(obstacle: Obstacle, step_mm: float) -> Region:
    """The obstacle's region; a chain, which no cell's centre need lie on, as wide as a cell."""
    region: Region = obstacle.region()
    return region.buffer(step_mm / 2) if isinstance(obstacle.shape, LineString) else region
