"""Building verbs that the IFC samples share; lengths in mm, whatever the model's unit."""

import math
import uuid
from collections.abc import Sequence
from typing import Final, TypeAlias

import ifcopenshell
import ifcopenshell.api.aggregate
import ifcopenshell.api.context
import ifcopenshell.api.feature
import ifcopenshell.api.geometry
import ifcopenshell.api.owner
import ifcopenshell.api.project
import ifcopenshell.api.root
import ifcopenshell.api.spatial
import ifcopenshell.api.unit
import ifcopenshell.guid
import numpy as np
from ifcopenshell import entity_instance

Point: TypeAlias = tuple[float, float]
Corner: TypeAlias = tuple[float, ...]
"""x, y, and the bulge of the side that starts there, if it is an arc."""

UNITS: Final = {"mm": ("MILLI", 1.0), "m": (None, 0.001)}
"""Prefix of the metre, and units in a millimetre."""

NAMESPACE: Final = uuid.UUID("6f8a4f0e-3c57-4b6e-9d0a-0f3e6b1f7c55")
"""GlobalIds are hashed within it, so that they are the same on every run."""

WRITTEN: Final = "2025-01-01T00:00:00"
WRITTEN_S: Final = 1_735_689_600
"""The same moment in every file."""


class Model:
    """A building with one storey.

    Args:
        schema: IFC2X3, IFC4 or IFC4X3.
        unit: `mm` or `m`.
        name: Of the building.
    """

    def __init__(self, schema: str, unit: str, name: str) -> None:
        prefix, self._per_mm = UNITS[unit]
        self.file = ifcopenshell.api.project.create_file(version=schema)
        self._sign()
        project = self._root("IfcProject", name)
        length = ifcopenshell.api.unit.add_si_unit(self.file, "LENGTHUNIT", prefix=prefix)
        angle = ifcopenshell.api.unit.add_si_unit(self.file, "PLANEANGLEUNIT")
        ifcopenshell.api.unit.assign_unit(self.file, units=[length, angle])
        model = ifcopenshell.api.context.add_context(self.file, "Model")
        self._body = ifcopenshell.api.context.add_context(
            self.file, "Model", "Body", "MODEL_VIEW", parent=model
        )
        site, building = self._root("IfcSite", "Site"), self._root("IfcBuilding", name)
        self._storey = self._root("IfcBuildingStorey", "Ground floor")
        for whole, part in ((project, site), (site, building), (building, self._storey)):
            ifcopenshell.api.aggregate.assign_object(self.file, [part], whole)
        for spatial in (site, building, self._storey):
            ifcopenshell.api.geometry.edit_object_placement(self.file, spatial)

    def add(self, ifc_class: str, name: str, *solids: entity_instance) -> entity_instance:
        """An element on the storey."""
        element = self._shaped(ifc_class, name, solids)
        ifcopenshell.api.spatial.assign_container(self.file, [element], self._storey)
        return element

    def open(self, element: entity_instance, name: str, solid: entity_instance) -> None:
        """Cut an opening into an element."""
        opening = self._shaped("IfcOpeningElement", name, (solid,))
        ifcopenshell.api.feature.add_feature(self.file, opening, element)

    def box(self, corner: Point, opposite: Point, low: float, high: float) -> entity_instance:
        """A box between two opposite corners in plan and two heights."""
        (left, bottom), (right, top) = corner, opposite
        profile = self.file.create_entity(
            "IfcRectangleProfileDef",
            ProfileType="AREA",
            Position=self._axes_2d((left + right) / 2, (bottom + top) / 2),
            XDim=self._length(right - left),
            YDim=self._length(top - bottom),
        )
        return self._upright(profile, low, high)

    def cylinder(self, centre: Point, diameter: float, low: float, high: float) -> entity_instance:
        """An upright cylinder."""
        profile = self.file.create_entity(
            "IfcCircleProfileDef",
            ProfileType="AREA",
            Position=self._axes_2d(*centre),
            Radius=self._length(diameter / 2),
        )
        return self._upright(profile, low, high)

    def prism(self, corners: Sequence[Corner], low: float, high: float) -> entity_instance:
        """An outline of straight lines and arcs between two heights."""
        vertices = [(x, y, *(bulge or (0.0,))) for x, y, *bulge in corners]
        curve = self._trimmed(vertices) if self.file.schema == "IFC2X3" else self._indexed(vertices)
        profile = self.file.create_entity(
            "IfcArbitraryClosedProfileDef", ProfileType="AREA", OuterCurve=curve
        )
        return self._upright(profile, low, high)

    def text(self) -> str:
        """The model as it is written: the same on every run."""
        for number, root in enumerate(self.file.by_type("IfcRoot")):
            name = f"{number} {root.is_a()} {root.Name}"
            root.GlobalId = ifcopenshell.guid.compress(uuid.uuid5(NAMESPACE, name).hex)
        # ifcopenshell keeps what a storey holds in a set, whose order changes with the addresses
        for rel in self.file.by_type("IfcRelContainedInSpatialStructure"):
            rel.RelatedElements = sorted(rel.RelatedElements, key=lambda element: element.id())
        for history in self.file.by_type("IfcOwnerHistory"):
            history.CreationDate = history.LastModifiedDate = WRITTEN_S
        header = self.file.header.file_name
        header.name, header.time_stamp = "", WRITTEN
        header.preprocessor_version = header.originating_system = "satAOI-geo samples"
        return str(self.file.to_string())

    def _sign(self) -> None:
        """IFC2X3 asks who made each thing."""
        person = ifcopenshell.api.owner.add_person(
            self.file, identification="samples", family_name="Samples", given_name=""
        )
        organisation = ifcopenshell.api.owner.add_organisation(
            self.file, identification="satAOI-geo", name="satAOI-geo"
        )
        ifcopenshell.api.owner.add_person_and_organisation(
            self.file, person=person, organisation=organisation
        )
        self.file.create_entity("IfcApplication", organisation, "1", "samples", "samples")

    def _root(self, ifc_class: str, name: str) -> entity_instance:
        return ifcopenshell.api.root.create_entity(self.file, ifc_class=ifc_class, name=name)

    def _shaped(
        self, ifc_class: str, name: str, solids: Sequence[entity_instance]
    ) -> entity_instance:
        element = self._root(ifc_class, name)
        shape = self.file.create_entity(
            "IfcShapeRepresentation", self._body, "Body", "SweptSolid", list(solids)
        )
        ifcopenshell.api.geometry.assign_representation(self.file, element, shape)
        ifcopenshell.api.geometry.edit_object_placement(self.file, element)
        return element

    def _length(self, mm: float) -> float:
        return mm * self._per_mm

    def _point(self, *mm: float) -> entity_instance:
        return self.file.create_entity("IfcCartesianPoint", [self._length(c) for c in mm])

    def _axes_2d(self, x: float, y: float) -> entity_instance:
        return self.file.create_entity("IfcAxis2Placement2D", self._point(x, y))

    def _upright(self, profile: entity_instance, low: float, high: float) -> entity_instance:
        position = self.file.create_entity("IfcAxis2Placement3D", self._point(0.0, 0.0, low))
        up = self.file.create_entity("IfcDirection", (0.0, 0.0, 1.0))
        return self.file.create_entity(
            "IfcExtrudedAreaSolid", profile, position, up, self._length(high - low)
        )

    def _indexed(self, vertices: Sequence[Corner]) -> entity_instance:
        """A closed curve by indices, as IFC4 has it; each arc through its middle."""
        points: list[Point] = [(x, y) for x, y, _ in vertices]
        segments = []
        for i, (x, y, bulge) in enumerate(vertices):
            after = (i + 1) % len(vertices)
            if bulge:
                points.append(_middle((x, y), points[after], bulge))
                segments.append(
                    self.file.create_entity("IfcArcIndex", [i + 1, len(points), after + 1])
                )
            else:
                segments.append(self.file.create_entity("IfcLineIndex", [i + 1, after + 1]))
        coordinates = [[self._length(x), self._length(y)] for x, y in points]
        listed = self.file.create_entity("IfcCartesianPointList2D", coordinates)
        return self.file.create_entity("IfcIndexedPolyCurve", Points=listed, Segments=segments)

    def _trimmed(self, vertices: Sequence[Corner]) -> entity_instance:
        """A closed curve of lines and trimmed circles, as IFC2X3 has it."""
        segments = []
        for (x, y, bulge), (end_x, end_y, _) in zip(
            vertices, [*vertices[1:], vertices[0]], strict=True
        ):
            if bulge:
                curve = self._arc((x, y), (end_x, end_y), bulge)
            else:
                ends = [self._point(x, y), self._point(end_x, end_y)]
                curve = self.file.create_entity("IfcPolyline", ends)
            segments.append(
                self.file.create_entity(
                    "IfcCompositeCurveSegment",
                    Transition="CONTINUOUS",
                    SameSense=True,
                    ParentCurve=curve,
                )
            )
        return self.file.create_entity("IfcCompositeCurve", Segments=segments, SelfIntersect=False)

    def _arc(self, start: Point, end: Point, bulge: float) -> entity_instance:
        first, last = np.array(start), np.array(end)
        chord = last - first
        across = np.array((-chord[1], chord[0]))
        centre = (first + last) / 2 + (1 - bulge * bulge) / (4 * bulge) * across
        circle = self.file.create_entity(
            "IfcCircle", self._axes_2d(*centre), self._length(math.dist(centre, first))
        )
        return self.file.create_entity(
            "IfcTrimmedCurve",
            circle,
            [self._point(*start)],
            [self._point(*end)],
            bulge > 0,
            "CARTESIAN",
        )


def _middle(start: Point, end: Point, bulge: float) -> Point:
    """The middle of an arc: its bulge is the height over the half chord, to the right of it."""
    (x, y), (end_x, end_y) = start, end
    return (
        (x + end_x) / 2 + bulge * (end_y - y) / 2,
        (y + end_y) / 2 - bulge * (end_x - x) / 2,
    )
