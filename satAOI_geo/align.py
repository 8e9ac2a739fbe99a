"""The direction of the walls: a lattice laid along it sees a turned plan as it saw the plan."""

import math
from typing import Final

import numpy as np
from shapely.geometry import LineString

from satAOI_geo.plan import Circle, FloatArray, FloorPlan, Kind, Shape, polygons_in

WINDOW_RAD: Final = math.radians(0.2)
"""Edges this close in direction count as parallel: drawings err less, walls differ more."""

LEVEL_RAD: Final = 1e-9
"""A turn below this is rounding: it moves a point 100 m away by a tenth of a micrometre."""

QUARTER_RAD: Final = math.pi / 2


def wall_direction_rad(plan: FloorPlan) -> float:
    """The direction that most of the plan's wall length runs in, modulo a quarter turn.

    Walls count; where a plan has none, the floor's edge and all obstacles do. The answer is the
    median direction, weighted by length, of the window of `WINDOW_RAD` that holds the most
    length: a median is the direction of a drawn edge, which a few crooked ones do not shift.

    Returns:
        Between -π/4 and π/4; 0 for a plan that lies square in its axes, and for one without a
        straight edge.
    """
    walls = [o.shape for o in plan.obstacles if o.kind is Kind.WALL]
    shapes: list[Shape] = walls or [o.shape for o in plan.obstacles]
    if not walls:
        shapes.extend(polygons_in([plan.floor]))
    edges_mm = np.concatenate([np.zeros((0, 2)), *(_edges_mm(shape) for shape in shapes)])
    lengths_mm = np.hypot(*edges_mm.T)
    edges_mm, lengths_mm = edges_mm[lengths_mm > 0], lengths_mm[lengths_mm > 0]
    if not lengths_mm.size:
        return 0.0
    densest_rad = _densest_rad(np.arctan2(edges_mm[:, 1], edges_mm[:, 0]), lengths_mm)
    turn_rad = densest_rad - QUARTER_RAD * round(densest_rad / QUARTER_RAD)
    return 0.0 if abs(turn_rad) < LEVEL_RAD else turn_rad


def _densest_rad(angles_rad: FloatArray, lengths_mm: FloatArray) -> float:
    """The median direction of the window that holds the most length, modulo a quarter turn."""
    folded_rad = np.mod(angles_rad, QUARTER_RAD)
    order = np.argsort(folded_rad, kind="stable")
    # twice around, so that a window may run over the end of the quarter
    around_rad = np.concatenate((folded_rad[order], folded_rad[order] + QUARTER_RAD))
    weights_mm = np.tile(lengths_mm[order], 2)
    reached_mm = np.concatenate(([0.0], np.cumsum(weights_mm)))
    begins = np.arange(order.size)
    ends = np.searchsorted(around_rad, around_rad[begins] + WINDOW_RAD, side="right")
    held_mm = reached_mm[ends] - reached_mm[begins]
    # sums differ in their last bits with the order of the edges: such windows are equal
    best = int(np.flatnonzero(held_mm >= held_mm.max() * (1 - 1e-9))[0])
    half_mm = reached_mm[best] + held_mm[best] / 2
    return float(around_rad[np.searchsorted(reached_mm[1:], half_mm)])


def _edges_mm(shape: Shape) -> FloatArray:
    """The straight edges of a shape as vectors, shape (n, 2)."""
    if isinstance(shape, Circle):
        return np.zeros((0, 2))
    if isinstance(shape, LineString):
        return np.diff(np.asarray(shape.coords)[:, :2], axis=0)
    rings = [shape.exterior, *shape.interiors]
    return np.concatenate([np.diff(np.asarray(ring.coords)[:, :2], axis=0) for ring in rings])
