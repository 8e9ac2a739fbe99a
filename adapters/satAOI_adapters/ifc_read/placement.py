"""Where things are: IFC placements as matrices, in millimetres.

A matrix has shape (4, 4) and turns local coordinates, as a column, into those of the parent. The
directions of an IFC placement need be neither of unit length nor at right angles; they are made
so the way the standard says: z is kept, x is turned into the plane across z.
"""

from typing import Final

import numpy as np
from ifcopenshell import entity_instance

from satAOI_geo.plan import FloatArray

UP: Final = (0.0, 0.0, 1.0)

MAX_NESTING: Final = 200
"""Deeper chains of placements than in any building; only a cycle is this long."""


class PlacementError(ValueError):
    """A placement that is cyclic, of an unknown kind, or without direction."""


def world_matrix(placement: entity_instance | None, mm_per_unit: float) -> FloatArray:
    """Matrix of an object's placement in the model.

    Raises:
        PlacementError: If the placement cannot be resolved.
    """
    try:
        matrix = _resolved(placement, mm_per_unit)
    except (AttributeError, TypeError) as error:
        # a reference to nothing, or to an entity of another kind
        raise PlacementError(f"it does not follow its schema ({error})") from error
    if not np.isfinite(matrix).all():
        raise PlacementError("it is not finite")
    return matrix


def _resolved(placement: entity_instance | None, mm_per_unit: float) -> FloatArray:
    matrix = np.eye(4)
    for _ in range(MAX_NESTING):
        if placement is None:
            return matrix
        if not placement.is_a("IfcLocalPlacement"):
            raise PlacementError(f"{placement.is_a()} #{placement.id()} is not supported")
        matrix = axis_placement(placement.RelativePlacement, mm_per_unit) @ matrix
        placement = placement.PlacementRelTo
    raise PlacementError("the placement refers back to itself")


def axis_placement(axes: entity_instance | None, mm_per_unit: float) -> FloatArray:
    """Matrix of an IfcAxis2Placement2D or 3D; the identity for none.

    Raises:
        PlacementError: If it is of another kind or its directions are void.
    """
    if axes is None:
        return np.eye(4)
    if axes.is_a("IfcAxis2Placement3D"):
        z_axis = unit_vector(axes.Axis, UP)
    elif axes.is_a("IfcAxis2Placement2D"):
        z_axis = np.array(UP)
    else:
        raise PlacementError(f"{axes.is_a()} #{axes.id()} is not supported")
    x_axis = unit_vector(axes.RefDirection, (1.0, 0.0, 0.0))
    return _frame(z_axis, x_axis, point_mm(axes.Location, mm_per_unit))


def point_mm(point: entity_instance, mm_per_unit: float) -> FloatArray:
    """A point, shape (3,); a plane point lies at height 0."""
    coordinates = getattr(point, "Coordinates", None)
    if not coordinates or len(coordinates) > 3:
        raise PlacementError(f"{point.is_a()} #{point.id()} has no coordinates")
    located_mm = np.zeros(3)
    located_mm[: len(coordinates)] = np.asarray(coordinates) * mm_per_unit
    return located_mm


def mapping_matrix(item: entity_instance, mm_per_unit: float) -> FloatArray:
    """Matrix of an IfcMappedItem: from the mapped items' coordinates into the user's.

    Raises:
        PlacementError: If the origin or the target is void.
    """
    # the standard can be read as mapping by the origin's inverse; IfcOpenShell and the viewers
    # multiply, and a model is made to look right in those
    origin = axis_placement(item.MappingSource.MappingOrigin, mm_per_unit)
    return operator_matrix(item.MappingTarget, mm_per_unit) @ origin


def operator_matrix(operator: entity_instance, mm_per_unit: float) -> FloatArray:
    """Matrix of an IfcCartesianTransformationOperator, which may scale and mirror.

    Raises:
        PlacementError: If its axes are void.
    """
    x_axis = unit_vector(operator.Axis1, (1.0, 0.0, 0.0))
    y_axis = unit_vector(operator.Axis2, (0.0, 1.0, 0.0))
    third = getattr(operator, "Axis3", None)
    plane = operator.is_a("IfcCartesianTransformationOperator2D")
    z_axis = np.array(UP) if plane else unit_vector(third, UP)
    matrix = _frame(z_axis, x_axis, point_mm(operator.LocalOrigin, mm_per_unit))
    if operator.Axis2 is not None and matrix[:3, 1] @ y_axis < 0:
        matrix[:3, 1] *= -1
    scale = 1.0 if operator.Scale is None else operator.Scale
    scales = [getattr(operator, name, None) for name in ("Scale2", "Scale3")]
    matrix[:3, :3] *= (scale, *(scale if s is None else s for s in scales))
    return matrix


def unit_vector(direction: entity_instance | None, default: tuple[float, ...]) -> FloatArray:
    """An IfcDirection with length 1, shape (3,); the default for none.

    Raises:
        PlacementError: If it has no length.
    """
    vector = np.zeros(3)
    ratios = default if direction is None else direction.DirectionRatios
    vector[: len(ratios)] = ratios
    length = float(np.linalg.norm(vector))
    if not (np.isfinite(length) and length > 0):
        raise PlacementError(f"direction {tuple(ratios)} has no length")
    return vector / length


def _frame(z_axis: FloatArray, x_axis: FloatArray, origin_mm: FloatArray) -> FloatArray:
    across = x_axis - (x_axis @ z_axis) * z_axis
    length = float(np.linalg.norm(across))
    if not length:
        raise PlacementError("the x axis of a placement is parallel to its z axis")
    matrix = np.eye(4)
    matrix[:3, 0] = across / length
    matrix[:3, 1] = np.cross(z_axis, matrix[:3, 0])
    matrix[:3, 2] = z_axis
    matrix[:3, 3] = origin_mm
    return matrix
