"""Small IFC models, entity by entity, so that a test can write what no exporter would."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import ifcopenshell
from ifcopenshell import entity_instance

Point = Sequence[float]
Schema = Literal["IFC2X3", "IFC4", "IFC4X3"]

PREFIX = {"mm": "MILLI", "m": None}
PER_MM = {"mm": 1.0, "m": 0.001}


@dataclass
class Pen:
    """Writes entities; all lengths are given in mm, whatever the model's unit.

    Attributes:
        schema: The edition of IFC.
        unit: `mm` or `m`.
    """

    schema: Schema = "IFC4"
    unit: str = "mm"
    model: ifcopenshell.file = field(init=False)
    project: entity_instance = field(init=False)
    _n_roots: int = 0

    def __post_init__(self) -> None:
        self.model = ifcopenshell.file(schema=self.schema)
        length = self.new(
            "IfcSIUnit", UnitType="LENGTHUNIT", Prefix=PREFIX[self.unit], Name="METRE"
        )
        angle = self.new("IfcSIUnit", UnitType="PLANEANGLEUNIT", Name="RADIAN")
        units = self.new("IfcUnitAssignment", Units=[length, angle])
        context = self.new(
            "IfcGeometricRepresentationContext",
            ContextType="Model",
            CoordinateSpaceDimension=3,
            Precision=1e-5,
            WorldCoordinateSystem=self.axes(),
        )
        self.project = self.root(
            "IfcProject", RepresentationContexts=[context], UnitsInContext=units
        )
        self.context = context

    def new(self, name: str, **attributes: object) -> entity_instance:
        """An entity."""
        return self.model.create_entity(name, **attributes)

    def value(self, name: str, value: object) -> entity_instance:
        """A value of a defined type."""
        return self.model.create_entity(name, value)

    def root(self, name: str, **attributes: object) -> entity_instance:
        """An entity with a GlobalId, numbered in the order of making."""
        self._n_roots += 1
        return self.new(name, GlobalId=f"{self._n_roots:022d}", **attributes)

    def length(self, mm: float) -> float:
        """A length in the model's unit."""
        return mm * PER_MM[self.unit]

    def point(self, *mm: float) -> entity_instance:
        """A point in two or three dimensions."""
        return self.new("IfcCartesianPoint", Coordinates=[self.length(c) for c in mm])

    def direction(self, *ratios: float) -> entity_instance:
        """A direction."""
        return self.new("IfcDirection", DirectionRatios=[float(r) for r in ratios])

    def axes(
        self,
        at_mm: Point = (0.0, 0.0, 0.0),
        *,
        z: Point | None = None,
        x: Point | None = None,
    ) -> entity_instance:
        """An IfcAxis2Placement3D."""
        return self.new(
            "IfcAxis2Placement3D",
            Location=self.point(*at_mm),
            Axis=None if z is None else self.direction(*z),
            RefDirection=None if x is None else self.direction(*x),
        )

    def placement(
        self,
        at_mm: Point = (0.0, 0.0, 0.0),
        *,
        turn_rad: float = 0.0,
        within: entity_instance | None = None,
    ) -> entity_instance:
        """An IfcLocalPlacement, turned about the vertical."""
        return self.new(
            "IfcLocalPlacement",
            PlacementRelTo=within,
            RelativePlacement=self.axes(at_mm, x=(math.cos(turn_rad), math.sin(turn_rad), 0.0)),
        )

    def storey(
        self,
        name: str = "Level",
        z_mm: float = 0.0,
        *,
        elevation_mm: float | None = None,
        within: entity_instance | None = None,
    ) -> entity_instance:
        """A storey placed at a height."""
        placement = self.placement((0.0, 0.0, z_mm), within=within)
        elevation = None if elevation_mm is None else self.length(elevation_mm)
        return self.root(
            "IfcBuildingStorey", Name=name, ObjectPlacement=placement, Elevation=elevation
        )

    def rectangle(self, x_mm: float, y_mm: float, centre_mm: Point = (0.0, 0.0)) -> entity_instance:
        """A rectangular profile."""
        position = self.new("IfcAxis2Placement2D", Location=self.point(*centre_mm))
        return self.new(
            "IfcRectangleProfileDef",
            ProfileType="AREA",
            Position=position,
            XDim=self.length(x_mm),
            YDim=self.length(y_mm),
        )

    def circle(self, radius_mm: float) -> entity_instance:
        """A circular profile."""
        position = self.new("IfcAxis2Placement2D", Location=self.point(0.0, 0.0))
        return self.new(
            "IfcCircleProfileDef",
            ProfileType="AREA",
            Position=position,
            Radius=self.length(radius_mm),
        )

    def outline(self, corners_mm: Sequence[Point], *voids_mm: Sequence[Point]) -> entity_instance:
        """A profile of straight lines, with voids."""
        curve, *voids = (
            self.new("IfcPolyline", Points=[self.point(*c) for c in (*corners, corners[0])])
            for corners in (corners_mm, *voids_mm)
        )
        if voids:
            return self.new(
                "IfcArbitraryProfileDefWithVoids",
                ProfileType="AREA",
                OuterCurve=curve,
                InnerCurves=voids,
            )
        return self.new("IfcArbitraryClosedProfileDef", ProfileType="AREA", OuterCurve=curve)

    def extrusion(
        self,
        profile: entity_instance,
        height_mm: float,
        position: entity_instance | None = None,
        *,
        towards: Point = (0.0, 0.0, 1.0),
    ) -> entity_instance:
        """A profile swept along a direction."""
        return self.new(
            "IfcExtrudedAreaSolid",
            SweptArea=profile,
            Position=self.axes() if position is None else position,
            ExtrudedDirection=self.direction(*towards),
            Depth=self.length(height_mm),
        )

    def box(self, least_mm: Point, greatest_mm: Point) -> entity_instance:
        """A box between two corners, extruded upwards."""
        (left, bottom, low), (right, top, high) = least_mm, greatest_mm
        centre = ((left + right) / 2, (bottom + top) / 2)
        profile = self.rectangle(right - left, top - bottom, centre)
        return self.extrusion(profile, high - low, self.axes((0.0, 0.0, low)))

    def brep(self, corners_mm: Sequence[Point], faces: Sequence[Sequence[int]]) -> entity_instance:
        """A solid with plane faces, each counter-clockwise from outside."""
        points = [self.point(*corner) for corner in corners_mm]
        made = [
            self.new(
                "IfcFace",
                Bounds=[
                    self.new(
                        "IfcFaceOuterBound",
                        Bound=self.new("IfcPolyLoop", Polygon=[points[i] for i in face]),
                        Orientation=True,
                    )
                ],
            )
            for face in faces
        ]
        return self.new("IfcFacetedBrep", Outer=self.new("IfcClosedShell", CfsFaces=made))

    def product(
        self,
        name: str,
        *items: entity_instance,
        placement: entity_instance | None = None,
        kind: str = "SweptSolid",
        **attributes: object,
    ) -> entity_instance:
        """A product with a body of items."""
        body = None
        if items:
            shape = self.new(
                "IfcShapeRepresentation",
                ContextOfItems=self.context,
                RepresentationIdentifier="Body",
                RepresentationType=kind,
                Items=list(items),
            )
            body = self.new("IfcProductDefinitionShape", Representations=[shape])
        return self.root(
            name,
            ObjectPlacement=self.placement() if placement is None else placement,
            Representation=body,
            **attributes,
        )

    def void(self, element: entity_instance, *items: entity_instance) -> entity_instance:
        """An opening in an element."""
        opening = self.product("IfcOpeningElement", *items)
        self.root(
            "IfcRelVoidsElement", RelatingBuildingElement=element, RelatedOpeningElement=opening
        )
        return opening

    def part_of(self, whole: entity_instance, *parts: entity_instance) -> None:
        """Make elements the parts of another."""
        self.root("IfcRelAggregates", RelatingObject=whole, RelatedObjects=list(parts))

    def contain(self, storey: entity_instance, *elements: entity_instance) -> None:
        """Put elements into a storey."""
        self.root(
            "IfcRelContainedInSpatialStructure",
            RelatingStructure=storey,
            RelatedElements=list(elements),
        )

    def slab(self, x_mm: float, y_mm: float, *, top_mm: float = 0.0) -> entity_instance:
        """A slab 200 mm thick with a corner at the origin."""
        return self.product("IfcSlab", self.box((0.0, 0.0, top_mm - 200.0), (x_mm, y_mm, top_mm)))

    def save(self, folder: Path, name: str = "model.ifc") -> Path:
        """Write the model."""
        path = folder / name
        self.model.write(str(path))
        return path
