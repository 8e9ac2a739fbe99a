"""Profiles of IFC extrusions as chains of straight lines and arcs, without flattening."""

import itertools
import math
from dataclasses import dataclass

import numpy as np
from ifcopenshell import entity_instance
from shapely.geometry import Polygon

from satAOI_adapters.ifc_read.curves import bulge_through, circle_chain, polygon, transformed
from satAOI_adapters.ifc_read.placement import axis_placement, operator_matrix, point_mm
from satAOI_geo.plan import Circle, FloatArray

CLOSING_MM = 0.01
"""Ends of a closed curve this close are one point; exporters round to about a micrometre."""

SIMILAR = 1e-9
"""How far the axes of a similarity may be off a right angle or off equal length, relative."""


class NotExactError(ValueError):
    """Something that is not made of straight lines and arcs; the text names it."""


@dataclass(frozen=True, slots=True)
class Units:
    """Factors from the model's units."""

    mm: float
    rad: float


@dataclass(frozen=True, slots=True)
class Profile:
    """A plane region between an outer chain and holes, or within a full circle.

    Attributes:
        outer: A chain of shape (n, 3), or a circle.
        holes: The same.
    """

    outer: FloatArray | Circle
    holes: tuple[FloatArray | Circle, ...] = ()

    def placed(self, matrix: FloatArray) -> "Profile":
        """The profile under a similarity, shape (2, 3).

        Raises:
            NotExactError: If the matrix is no similarity; it would turn arcs into ellipses.
        """
        x_axis, y_axis = matrix[:, 0], matrix[:, 1]
        scale = math.hypot(*x_axis)
        skew = max(abs(float(x_axis @ y_axis)) / scale, abs(math.hypot(*y_axis) - scale))
        if skew > SIMILAR * scale:
            raise NotExactError("a scale that differs by direction")
        return Profile(_placed(self.outer, matrix), tuple(_placed(h, matrix) for h in self.holes))

    def shape(self, *, outward: bool) -> Polygon | Circle:
        """The circle itself, or a polygon that contains the region (outward) or lies within it.

        Raises:
            NotExactError: If the profile crosses itself.
        """
        if isinstance(self.outer, Circle) and not self.holes:
            return self.outer
        holes = tuple(_chain(hole) for hole in self.holes)
        region = polygon(_chain(self.outer), holes, outward=outward)
        if not region.is_valid:
            raise NotExactError("a profile that crosses itself")
        return region


def _chain(curve: FloatArray | Circle) -> FloatArray:
    return circle_chain(curve) if isinstance(curve, Circle) else curve


def _placed(curve: FloatArray | Circle, matrix: FloatArray) -> FloatArray | Circle:
    if isinstance(curve, Circle):
        x_mm, y_mm = matrix @ (curve.x_mm, curve.y_mm, 1.0)
        return Circle(x_mm, y_mm, curve.radius_mm * math.hypot(*matrix[:, 0]))
    return transformed(curve, matrix)


def profile_of(definition: entity_instance, units: Units) -> Profile:
    """The region of an IfcProfileDef.

    Raises:
        NotExactError: If it is not made of straight lines and arcs.
    """
    kind = definition.is_a()
    if kind == "IfcArbitraryClosedProfileDef":
        return Profile(closed_curve(definition.OuterCurve, units))
    if kind == "IfcArbitraryProfileDefWithVoids":
        holes = tuple(closed_curve(curve, units) for curve in definition.InnerCurves)
        return Profile(closed_curve(definition.OuterCurve, units), holes)
    if kind == "IfcDerivedProfileDef":
        operator = _plane(operator_matrix(definition.Operator, units.mm))
        return profile_of(definition.ParentProfile, units).placed(operator)
    if kind in PARAMETERS:
        centred = PARAMETERS[kind](definition, units.mm)
        return centred.placed(_plane(axis_placement(definition.Position, units.mm)))
    raise NotExactError(kind)


def _plane(matrix: FloatArray) -> FloatArray:
    """The part of a matrix, shape (2, 3), that acts within the x-y plane."""
    return matrix[:2][:, (0, 1, 3)]


def _rectangle(x_mm: float, y_mm: float) -> FloatArray:
    right_mm, top_mm = x_mm / 2, y_mm / 2
    corners = ((-right_mm, -top_mm), (right_mm, -top_mm), (right_mm, top_mm), (-right_mm, top_mm))
    return np.array([(*corner, 0.0) for corner in corners])


def _rounded_rectangle(x_mm: float, y_mm: float, radius_mm: float) -> FloatArray:
    if not radius_mm:
        return _rectangle(x_mm, y_mm)
    across_mm, along_mm = x_mm / 2 - radius_mm, y_mm / 2 - radius_mm
    quarter = math.tan(math.pi / 8)
    return np.array(
        (
            (-across_mm, -y_mm / 2, 0.0),
            (across_mm, -y_mm / 2, quarter),
            (x_mm / 2, -along_mm, 0.0),
            (x_mm / 2, along_mm, quarter),
            (across_mm, y_mm / 2, 0.0),
            (-across_mm, y_mm / 2, quarter),
            (-x_mm / 2, along_mm, 0.0),
            (-x_mm / 2, -along_mm, quarter),
        )
    )


def _rectangle_profile(definition: entity_instance, mm: float) -> Profile:
    return Profile(_rectangle(definition.XDim * mm, definition.YDim * mm))


def _rounded_profile(definition: entity_instance, mm: float) -> Profile:
    radius_mm = definition.RoundingRadius * mm
    return Profile(_rounded_rectangle(definition.XDim * mm, definition.YDim * mm, radius_mm))


def _tube_profile(definition: entity_instance, mm: float) -> Profile:
    x_mm, y_mm = definition.XDim * mm, definition.YDim * mm
    wall_mm = 2 * definition.WallThickness * mm
    outer = _rounded_rectangle(x_mm, y_mm, (definition.OuterFilletRadius or 0.0) * mm)
    inner_mm = (definition.InnerFilletRadius or 0.0) * mm
    return Profile(outer, (_rounded_rectangle(x_mm - wall_mm, y_mm - wall_mm, inner_mm),))


def _circle_profile(definition: entity_instance, mm: float) -> Profile:
    return Profile(Circle(0.0, 0.0, definition.Radius * mm))


def _pipe_profile(definition: entity_instance, mm: float) -> Profile:
    inner_mm = (definition.Radius - definition.WallThickness) * mm
    return Profile(Circle(0.0, 0.0, definition.Radius * mm), (Circle(0.0, 0.0, inner_mm),))


PARAMETERS = {
    "IfcRectangleProfileDef": _rectangle_profile,
    "IfcRoundedRectangleProfileDef": _rounded_profile,
    "IfcRectangleHollowProfileDef": _tube_profile,
    "IfcCircleProfileDef": _circle_profile,
    "IfcCircleHollowProfileDef": _pipe_profile,
}
"""Profiles given by measures, about the origin of their own position."""


def closed_curve(curve: entity_instance, units: Units) -> FloatArray | Circle:
    """A closed curve as a circle or as a chain whose last piece ends at its first vertex.

    Raises:
        NotExactError: If it is open or not made of straight lines and arcs.
    """
    if curve.is_a("IfcCircle"):
        x_mm, y_mm = axis_placement(curve.Position, units.mm)[:2, 3]
        return Circle(x_mm, y_mm, curve.Radius * units.mm)
    vertices = open_chain(curve, units)
    if math.dist(vertices[0, :2], vertices[-1, :2]) > CLOSING_MM:
        raise NotExactError(f"an open {curve.is_a()}")
    chain = _without_repeats(vertices[:-1])
    if len(chain) < 2 or (len(chain) < 3 and not chain[:, 2].any()):
        raise NotExactError(f"a degenerate {curve.is_a()}")
    return chain


def open_chain(curve: entity_instance, units: Units) -> FloatArray:
    """A curve from its first to its last vertex, whose bulge is 0; shape (n, 3)."""
    for kind, chain_of in CURVES.items():
        if curve.is_a(kind):
            return chain_of(curve, units)
    raise NotExactError(curve.is_a())


def _polyline(curve: entity_instance, units: Units) -> FloatArray:
    return np.array([(*point_mm(point, units.mm)[:2], 0.0) for point in curve.Points])


def _indexed_curve(curve: entity_instance, units: Units) -> FloatArray:
    points_mm = np.array([point[:2] for point in curve.Points.CoordList]) * units.mm
    if not curve.Segments:
        return np.column_stack((points_mm, np.zeros(len(points_mm))))
    pieces = []
    for segment in curve.Segments:
        corners_mm = points_mm[np.array(segment.wrappedValue) - 1]
        if segment.is_a("IfcArcIndex"):
            bulge = bulge_through(*corners_mm)
            pieces.append(np.array(((*corners_mm[0], bulge), (*corners_mm[2], 0.0))))
        else:
            pieces.append(np.column_stack((corners_mm, np.zeros(len(corners_mm)))))
    return _joined(pieces)


def _composite_curve(curve: entity_instance, units: Units) -> FloatArray:
    pieces = []
    for segment in curve.Segments:
        if not segment.is_a("IfcCompositeCurveSegment"):
            raise NotExactError(segment.is_a())
        piece = open_chain(segment.ParentCurve, units)
        pieces.append(piece if segment.SameSense else _reversed(piece))
    return _joined(pieces)


def _joined(pieces: list[FloatArray]) -> FloatArray:
    """Pieces laid end to end; each must begin where the one before ends."""
    for before, after in itertools.pairwise(pieces):
        if math.dist(before[-1, :2], after[0, :2]) > CLOSING_MM:
            raise NotExactError("a curve with a gap")
    return np.concatenate([*(piece[:-1] for piece in pieces), pieces[-1][-1:]])


def _reversed(chain: FloatArray) -> FloatArray:
    """The same curve run backwards: each bulge moves to the other end of its piece."""
    bulges = np.append(-chain[-2::-1, 2], 0.0)
    return np.column_stack((chain[::-1, :2], bulges))


def _without_repeats(chain: FloatArray) -> FloatArray:
    """The closed chain without pieces of no length, which have no direction."""
    lengths_mm = np.linalg.norm(np.roll(chain[:, :2], -1, axis=0) - chain[:, :2], axis=1)
    kept: FloatArray = chain[lengths_mm > 0]
    return kept


def _trimmed_curve(curve: entity_instance, units: Units) -> FloatArray:
    basis = curve.BasisCurve
    if basis.is_a("IfcLine"):
        ends_mm = [_on_line(basis, trim, units) for trim in (curve.Trim1, curve.Trim2)]
        return np.array([(*ends_mm[0], 0.0), (*ends_mm[1], 0.0)])
    if not basis.is_a("IfcCircle"):
        raise NotExactError(basis.is_a())
    matrix = axis_placement(basis.Position, units.mm)
    cartesian = curve.MasterRepresentation == "CARTESIAN"
    first_rad, last_rad = (
        _angle_rad(trim, matrix, units, cartesian=cartesian) for trim in (curve.Trim1, curve.Trim2)
    )
    sweep_rad = (last_rad - first_rad) % (2 * math.pi)
    if not curve.SenseAgreement:
        sweep_rad -= 2 * math.pi
    # two halves, since the bulge of a whole turn is infinite
    bulge, radius_mm = math.tan(sweep_rad / 8), basis.Radius * units.mm
    angles_rad = first_rad + np.array((0.0, 0.5, 1.0)) * sweep_rad
    local_mm = np.column_stack((radius_mm * np.cos(angles_rad), radius_mm * np.sin(angles_rad)))
    arc = np.column_stack((local_mm, (bulge, bulge, 0.0)))
    return transformed(arc, _plane(matrix))


def _trims(trim: tuple[entity_instance, ...]) -> tuple[float | None, entity_instance | None]:
    """Parameter and point of a trim, whichever are given."""
    parameter = next((t.wrappedValue for t in trim if t.is_a("IfcParameterValue")), None)
    point = next((t for t in trim if t.is_a("IfcCartesianPoint")), None)
    return parameter, point


def _angle_rad(
    trim: tuple[entity_instance, ...], matrix: FloatArray, units: Units, *, cartesian: bool
) -> float:
    parameter, point = _trims(trim)
    if parameter is not None and not (cartesian and point is not None):
        return float(parameter) * units.rad
    if point is None:
        raise NotExactError("an IfcTrimmedCurve without ends")
    local_mm = np.linalg.inv(matrix) @ (*point_mm(point, units.mm), 1.0)
    return math.atan2(local_mm[1], local_mm[0])


def _on_line(line: entity_instance, trim: tuple[entity_instance, ...], units: Units) -> FloatArray:
    parameter, point = _trims(trim)
    if point is not None:
        return point_mm(point, units.mm)[:2]
    if parameter is None:
        raise NotExactError("an IfcTrimmedCurve without ends")
    vector = line.Dir
    ratios = np.array(vector.Orientation.DirectionRatios)[:2]
    step_mm = ratios / math.hypot(*ratios) * float(vector.Magnitude) * units.mm
    foot_mm: FloatArray = point_mm(line.Pnt, units.mm)[:2]
    return foot_mm + parameter * step_mm


CURVES = {
    "IfcPolyline": _polyline,
    "IfcIndexedPolyCurve": _indexed_curve,
    "IfcCompositeCurve": _composite_curve,
    "IfcTrimmedCurve": _trimmed_curve,
}
"""Curves that are read exactly; the class names its subclasses too."""
