"""A plan in a frame of its own, whose origin is the floor's lower left corner."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np
import numpy.typing as npt
import shapely

from satAOI_adapters.dxf_read.curves import Point
from satAOI_adapters.dxf_read.placement import LOCAL_DIGITS, rounded_spot
from satAOI_geo.plan import Circle, FloatArray, FloorPlan, Region, Shape

GeometryT = TypeVar("GeometryT", bound=Region | npt.NDArray[np.object_])


def from_corner(plan: FloorPlan) -> FloorPlan:
    """The plan in a frame whose origin is the floor's lower left corner, in whole millimetres."""
    left_mm, bottom_mm, _, _ = plan.floor.bounds
    shift_mm = np.floor(np.round((left_mm, bottom_mm), LOCAL_DIGITS))
    x_mm, y_mm = plan.frame.origin_mm
    origin_mm = (x_mm + float(shift_mm[0]), y_mm + float(shift_mm[1]))
    shapes = _moved([obstacle.shape for obstacle in plan.obstacles], shift_mm)
    start_mm = plan.start_mm and _from(plan.start_mm, shift_mm)
    return replace(
        plan,
        floor=_shifted(plan.floor, shift_mm),
        obstacles=tuple(
            replace(obstacle, shape=shape)
            for obstacle, shape in zip(plan.obstacles, shapes, strict=True)
        ),
        frame=replace(plan.frame, origin_mm=origin_mm),
        start_mm=start_mm,
    )


def _moved(shapes: Sequence[Shape], shift_mm: FloatArray) -> list[Shape]:
    """Shapes with their coordinates taken from another origin, and still to `LOCAL_DIGITS`."""
    drawn = [shape for shape in shapes if not isinstance(shape, Circle)]
    moved = iter(_shifted(np.array(drawn, dtype=object), shift_mm))
    return [
        _moved_circle(shape, shift_mm) if isinstance(shape, Circle) else next(moved)
        for shape in shapes
    ]


def _moved_circle(circle: Circle, shift_mm: FloatArray) -> Circle:
    x_mm, y_mm = _from((circle.x_mm, circle.y_mm), shift_mm)
    return replace(circle, x_mm=x_mm, y_mm=y_mm)


def _shifted(geometry: GeometryT, shift_mm: FloatArray) -> GeometryT:
    """A geometry, or each of an array of them, from another origin."""
    moved: GeometryT = shapely.transform(
        geometry, lambda points: np.round(points - shift_mm, LOCAL_DIGITS) + 0.0
    )
    return moved


def _from(point_mm: Point, shift_mm: FloatArray) -> Point:
    """A point from another origin."""
    x_mm, y_mm = np.subtract(point_mm, shift_mm).tolist()
    return rounded_spot(x_mm, y_mm)
