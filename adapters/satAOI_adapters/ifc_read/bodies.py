"""Bodies of products: exact where they are stacks of upright prisms, meshed where not."""

import contextlib
import itertools
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, Final

import ifcopenshell
import ifcopenshell.geom
import numpy as np
import numpy.typing as npt
from ifcopenshell import entity_instance, ifcopenshell_wrapper
from shapely.errors import ShapelyError

from satAOI_adapters.ifc_read.flaws import Flaws
from satAOI_adapters.ifc_read.meshes import DEFLECTION_MM, GROWTH_MM, Mesh
from satAOI_adapters.ifc_read.model import body_items, handle_of, openings_of
from satAOI_adapters.ifc_read.placement import (
    UP,
    axis_placement,
    mapping_matrix,
    point_mm,
    unit_vector,
    world_matrix,
)
from satAOI_adapters.ifc_read.prisms import Prism, Stack, View, as_polygon, merged, stack_of
from satAOI_adapters.ifc_read.profiles import NotExactError, Units, profile_of
from satAOI_geo.plan import FloatArray, Shape
from satAOI_geo.units import MM_PER_UNIT

MALFORMED: Final = (
    ArithmeticError,
    AttributeError,
    LookupError,
    RuntimeError,
    ShapelyError,
    TypeError,
    ValueError,
)
"""What reading raises where a file holds something else than its schema promises.

A reference to nothing arrives as None, a list may be empty or too short, a direction of length 0.
"""

CURVED: Final = frozenset(
    {
        "IfcCircle",
        "IfcEllipse",
        "IfcBSplineCurveWithKnots",
        "IfcRationalBSplineCurveWithKnots",
        "IfcBezierCurve",
        "IfcRationalBezierCurve",
        "IfcBSplineSurfaceWithKnots",
        "IfcRationalBSplineSurfaceWithKnots",
        "IfcCylindricalSurface",
        "IfcSphericalSurface",
        "IfcToroidalSurface",
        "IfcSurfaceOfRevolution",
        "IfcRevolvedAreaSolid",
        "IfcRevolvedAreaSolidTapered",
        "IfcSweptDiskSolid",
        "IfcSweptDiskSolidPolygonal",
        "IfcSphere",
        "IfcRightCircularCone",
        "IfcRightCircularCylinder",
        "IfcCircleProfileDef",
        "IfcCircleHollowProfileDef",
        "IfcEllipseProfileDef",
        "IfcRoundedRectangleProfileDef",
        "IfcRectangleHollowProfileDef",
        "IfcIShapeProfileDef",
        "IfcAsymmetricIShapeProfileDef",
        "IfcLShapeProfileDef",
        "IfcTShapeProfileDef",
        "IfcUShapeProfileDef",
        "IfcCShapeProfileDef",
        "IfcZShapeProfileDef",
    }
)
"""Classes with curved edges or faces, some only where they are filleted."""

POINT_DEFINED: Final = (
    "IfcFacetedBrep",
    "IfcFaceBasedSurfaceModel",
    "IfcShellBasedSurfaceModel",
    "IfcTessellatedFaceSet",
)
"""Items with plane faces whose corners are points in the item's own coordinates."""


NOTHING: Final = "the geometry kernel made nothing of it"


class NoBodyError(ValueError):
    """A body that nothing could be made of; the text says why."""


@dataclass(frozen=True, slots=True)
class Body:
    """What a product is made of between the heights of a view.

    Attributes:
        stacks: The exact part.
        meshes: The rest.
        voids: Its openings, as far as they are prisms.
        why_meshed: What could not be read exactly; empty if all could.
        flaws: What the geometry kernel complained about, and what could not be cut.
    """

    stacks: tuple[Stack, ...]
    meshes: tuple[Mesh, ...] = ()
    voids: tuple[Prism, ...] = ()
    why_meshed: str = ""
    flaws: tuple[str, ...] = ()

    def in_band(self, view: View) -> list[Shape]:
        """The plan of all that stands between the view's heights."""
        shapes: list[Shape] = [shape for stack in self.stacks for shape in stack.in_band(view)]
        for mesh in self.meshes:
            shapes.extend(mesh.in_band(view))
        return shapes


@dataclass(frozen=True, slots=True)
class Extent:
    """A box that holds a body."""

    least_mm: FloatArray
    greatest_mm: FloatArray

    def overlaps(self, other: "Extent") -> bool:
        """Whether two boxes have a point in common."""
        return bool(
            (self.least_mm <= other.greatest_mm).all()
            and (self.greatest_mm >= other.least_mm).all()
        )


@dataclass(frozen=True, slots=True)
class Meshed:
    """Triangles as the geometry kernel makes them, in the item's own coordinates."""

    corners_mm: FloatArray
    triangles: npt.NDArray[np.int64]
    flaws: tuple[str, ...]


class BodyReader:
    """Reads bodies of one model into axes near it.

    Args:
        model: The open model.
        units: Its units.
        origin_mm: What is subtracted from the model's x and y, in whole millimetres.
        flaws: What is known to be wrong with it.
    """

    def __init__(
        self,
        model: ifcopenshell.file,
        units: Units,
        origin_mm: tuple[float, float],
        flaws: Flaws,
    ) -> None:
        self._units = units
        self._flaws = flaws
        self._origin_mm = np.array((*origin_mm, 0.0))
        self._log = ifcopenshell_wrapper.logger()
        self._log.output_format(self._log.FMT_INMEMORY)
        settings = ifcopenshell.geom.settings()
        settings.set("mesher-linear-deflection", DEFLECTION_MM / MM_PER_UNIT["m"])
        self._kernel = ifcopenshell.geom.kernel(settings, model, logger=self._log)
        # trees and fittings repeat: what they map is meshed once
        self._meshed: dict[int, Meshed] = {}
        self._outlying: dict[int, FloatArray] = {}

    def matrix(self, product: entity_instance) -> FloatArray:
        """From a product's coordinates to the plan's axes.

        Raises:
            PlacementError: If its placement cannot be resolved.
        """
        matrix = world_matrix(product.ObjectPlacement, self._units.mm)
        matrix[:3, 3] -= self._origin_mm
        return matrix

    def extent(self, product: entity_instance) -> Extent | None:
        """A box around a product's body, or None where one is not found without meshing."""
        try:
            matrix = self.matrix(product)
            boxes = [self._corners(item, matrix) for item in body_items(product)]
        except MALFORMED:
            return None
        if not boxes:
            return None
        corners_mm = np.concatenate(boxes)
        if not np.isfinite(corners_mm).all():
            return None
        return Extent(corners_mm.min(axis=0), corners_mm.max(axis=0))

    def _corners(self, item: entity_instance, matrix: FloatArray) -> FloatArray:
        """Points, shape (n, 3), whose box holds an item; those of its own are found once.

        Raises:
            NotExactError: If no such points are known without meshing.
        """
        corners = []
        for inner, placed in _resolved([item], matrix, self._units):
            if inner.id() not in self._outlying:
                self._outlying[inner.id()] = _own_corners(inner, self._units)
            corners.append(self._outlying[inner.id()] @ placed[:3, :3].T + placed[:3, 3])
        return np.concatenate(corners)

    def body(self, product: entity_instance, view: View) -> Body:
        """A product's body, its openings cut out.

        Raises:
            NoBodyError: If nothing can be made of it.
        """
        items = body_items(product)
        if not items:
            raise NoBodyError("it has no body")
        flaw = self._flaws.in_geometry(product)
        if flaw:
            raise NoBodyError(flaw)
        openings = list(openings_of(product))
        try:
            matrix = self.matrix(product)
        except MALFORMED as error:
            raise NoBodyError(f"its placement cannot be used: {error}") from error
        try:
            return self._exact(items, openings, matrix, view)
        except MALFORMED as error:
            why = str(error)
        try:
            if not openings:
                return self._by_item(items, matrix, view)
            return self._with_openings(product, matrix, view, why)
        except NoBodyError:
            raise
        except MALFORMED as error:
            raise NoBodyError(f"it does not follow its schema ({error})") from error

    def voids(self, opening: entity_instance, view: View) -> list[Prism]:
        """The prisms that an opening takes away.

        Raises:
            NotExactError: If it is no stack of upright prisms.
        """
        matrix = self.matrix(opening)
        inverse = replace(view, outward=not view.outward)
        stacks = [stack_of(item, matrix, self._units, inverse) for item in body_items(opening)]
        void = merged(stacks)
        if void.subs:
            raise NotExactError("an opening with a cut of its own")
        owner = {"handle": handle_of(opening), "layer": opening.is_a()}
        return [replace(prism, **owner) for prism in void.adds]

    def _with_openings(
        self, product: entity_instance, matrix: FloatArray, view: View, why: str
    ) -> Body:
        """The kernel's mesh, openings cut out; without its openings rather than not at all."""
        voids = self._plain_voids(list(openings_of(product)), view)
        try:
            return replace(self.meshed(product), voids=voids, why_meshed=why)
        except MALFORMED as error:
            uncut = self._by_item(body_items(product), matrix, view)
            flaw = f"its openings were not cut: {error}"
            return replace(uncut, voids=voids, flaws=(*uncut.flaws, flaw))

    def _plain_voids(self, openings: list[entity_instance], view: View) -> tuple[Prism, ...]:
        """The openings that are prisms."""
        voids: list[Prism] = []
        for opening in openings:
            with contextlib.suppress(*MALFORMED):
                voids.extend(self.voids(opening, view))
        return tuple(voids)

    def _exact(
        self,
        items: list[entity_instance],
        openings: list[entity_instance],
        matrix: FloatArray,
        view: View,
    ) -> Body:
        stacks = [stack_of(item, matrix, self._units, view) for item in items]
        voids = tuple(void for opening in openings for void in self.voids(opening, view))
        return Body(tuple(stack.less(voids) for stack in stacks), voids=voids)

    def _by_item(self, items: list[entity_instance], matrix: FloatArray, view: View) -> Body:
        """Each item exactly if it can be, meshed otherwise; some may fail, not all."""
        body = Body(())
        failures: list[str] = []
        for item, placed in _resolved(items, matrix, self._units):
            try:
                stack = stack_of(item, placed, self._units, view)
                body = replace(body, stacks=(*body.stacks, stack))
                continue
            except MALFORMED as error:
                why = str(error)
            try:
                mesh, flaws = self._placed_mesh(item, item.id(), placed, [item])
            except NoBodyError as error:
                failures.append(f"{item.is_a()} #{item.id()}: {error}")
                continue
            body = replace(
                body,
                meshes=(*body.meshes, mesh),
                why_meshed=body.why_meshed or why,
                flaws=(*body.flaws, *flaws),
            )
        if not (body.stacks or body.meshes):
            raise NoBodyError("; ".join(failures) or "its body is empty")
        return replace(body, flaws=(*body.flaws, *failures))

    def meshed(self, product: entity_instance) -> Body:
        """A product's body as the geometry kernel makes it, its openings cut out.

        Raises:
            NoBodyError: If the kernel makes nothing of it.
            PlacementError: If its placement cannot be resolved.
        """
        items = [*body_items(product), *(i for o in openings_of(product) for i in body_items(o))]
        mesh, flaws = self._placed_mesh(product, product.id(), self.matrix(product), items)
        return Body((), (mesh,), flaws=flaws)

    def _placed_mesh(
        self, what: entity_instance, key: int, matrix: FloatArray, parts: list[entity_instance]
    ) -> tuple[Mesh, tuple[str, ...]]:
        if key not in self._meshed:
            self._meshed[key] = self._triangulated(what)
        meshed = self._meshed[key]
        corners_mm = meshed.corners_mm @ matrix[:3, :3].T + matrix[:3, 3]
        growth_mm = GROWTH_MM if any(_is_curved(part) for part in parts) else 0.0
        return Mesh(corners_mm, meshed.triangles, growth_mm), meshed.flaws

    def _triangulated(self, what: entity_instance) -> Meshed:
        self._log.clear()
        try:
            made: Any = self._kernel.create_shape(what)
        except RuntimeError as error:
            raise NoBodyError(str(error).splitlines()[0]) from error
        made = getattr(made, "geometry", made)
        if made is None:
            raise NoBodyError(NOTHING)
        # the kernel works in metres whatever the model's unit
        corners_mm = np.array(made.verts, dtype=np.float64).reshape(-1, 3) * MM_PER_UNIT["m"]
        triangles = np.array(made.faces, dtype=np.int64).reshape(-1, 3)
        if not len(triangles) or not np.isfinite(corners_mm).all():
            raise NoBodyError(NOTHING)
        flaws = tuple(
            sorted(
                {m.message for m in self._log.log_messages() if m.severity >= self._log.LOG_ERROR}
            )
        )
        return Meshed(corners_mm, triangles, flaws)


def _resolved(
    items: list[entity_instance], matrix: FloatArray, units: Units
) -> Iterator[tuple[entity_instance, FloatArray]]:
    """Items with what maps them opened: each with its matrix."""
    for item in items:
        if item.is_a("IfcMappedItem"):
            inner = item.MappingSource.MappedRepresentation.Items
            yield from _resolved(inner, matrix @ mapping_matrix(item, units.mm), units)
        else:
            yield item, matrix


def _is_curved(item: entity_instance) -> bool:
    """Whether any part of an item is curved."""
    for part in item.file.traverse(item):
        name = part.is_a()
        if name in CURVED:
            return True
        if name == "IfcIndexedPolyCurve" and any(
            segment.is_a("IfcArcIndex") for segment in part.Segments or ()
        ):
            return True
    return False


def _own_corners(item: entity_instance, units: Units) -> FloatArray:
    """Points in an item's coordinates whose hull holds it."""
    if item.is_a("IfcBooleanResult") and item.Operator == "DIFFERENCE":
        return _own_corners(item.FirstOperand, units)
    if item.is_a() == "IfcExtrudedAreaSolid":
        return _extrusion_corners(item, units)
    if any(item.is_a(name) for name in POINT_DEFINED):
        return _box_corners(_points_mm(item, units))
    raise NotExactError(item.is_a())


def _extrusion_corners(item: entity_instance, units: Units) -> FloatArray:
    placed = axis_placement(item.Position, units.mm)
    region = as_polygon(profile_of(item.SweptArea, units).shape(outward=True), outward=True)
    left_mm, bottom_mm, right_mm, top_mm = region.bounds
    base_mm = _box_corners(np.array(((left_mm, bottom_mm, 0.0), (right_mm, top_mm, 0.0))))
    sweep_mm = unit_vector(item.ExtrudedDirection, UP) * item.Depth * units.mm
    return np.concatenate((base_mm, base_mm + sweep_mm)) @ placed[:3, :3].T + placed[:3, 3]


def _box_corners(points_mm: FloatArray) -> FloatArray:
    """The eight corners of the box around points."""
    ends_mm = np.stack((points_mm.min(axis=0), points_mm.max(axis=0)))
    return np.array(list(itertools.product(*ends_mm.T)))


def _points_mm(item: entity_instance, units: Units) -> FloatArray:
    found: list[FloatArray] = []
    for part in item.file.traverse(item):
        if part.is_a("IfcCartesianPointList3D"):
            found.append(np.array(part.CoordList, dtype=np.float64) * units.mm)
        elif part.is_a("IfcCartesianPoint"):
            found.append(point_mm(part, units.mm)[np.newaxis])
    return np.concatenate(found)
