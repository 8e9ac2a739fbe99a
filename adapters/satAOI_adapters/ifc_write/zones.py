"""Zones for an area of interest and for what it does not reach, as lines of a STEP file."""

import uuid
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final

import ifcopenshell
import ifcopenshell.guid
import numpy as np
from ifcopenshell import entity_instance

from satAOI_adapters.arcs import outlines_with_arcs
from satAOI_adapters.ifc_write import AOI_TYPE, UNREACHED_TYPE
from satAOI_adapters.ifc_write.curves import closed_curve
from satAOI_geo import __version__
from satAOI_geo.aoi import Outline
from satAOI_geo.pipeline import Result
from satAOI_geo.plan import Frame, polygons_in
from satAOI_geo.reasons import SENTENCES, Patch
from satAOI_geo.units import MM2_PER_M2

FILM_MM: Final = 10.0
"""Height of the bodies: high enough to be seen, too low to hide anything."""

NAMESPACE: Final = uuid.UUID("0c4bb8a2-7d3c-4b8e-8a39-3a1f0c7d5e21")
"""GlobalIds are hashed within it from the model and the name: written again, they are the same."""

COLOURS: Final = {AOI_TYPE: (0.20, 0.65, 0.32), UNREACHED_TYPE: (0.90, 0.55, 0.10)}
"""Red, green and blue of each object type."""

TRANSPARENCY: Final = 0.4

STRUCTURES: Final = ("IfcBuildingStorey", "IfcBuilding", "IfcSite")
"""Where the zones are listed: in the plan's storey, else in the first of these."""


def lines_of(path: Path, result: Result) -> list[str]:
    """The added entities, as lines of a STEP file without line ends.

    Args:
        path: The model they are added to, where it can be parsed.
        result: The area of interest.
    """
    writer = _Writer(ifcopenshell.open(path, format=".ifc"), result)
    zones = [writer.area(), *writer.patches()]
    writer.list_in_storey(zones)
    return writer.lines()


class _Writer:
    """Adds entities to an open model and remembers which."""

    def __init__(self, model: ifcopenshell.file, result: Result) -> None:
        self._model = model
        self._result = result
        self._frame: Frame = result.plan.frame
        self._last_id = max(entity.id() for entity in model)
        # IFC2X3 asks for an owner; every model of that schema has one
        self._owner = next(iter(model.by_type("IfcOwnerHistory")), None)
        self._has_zones = model.schema != "IFC2X3"
        self._context = _body_context(model)
        self._square_metre = self._new("IfcSIUnit", UnitType="AREAUNIT", Name="SQUARE_METRE")

    def lines(self) -> list[str]:
        """All that was added, by id."""
        added = sorted((e for e in self._model if e.id() > self._last_id), key=lambda e: e.id())
        # by default the class is not in capitals, which a STEP file asks for
        in_capitals = True
        return [f"{entity.to_string(in_capitals)};" for entity in added]

    def area(self) -> entity_instance:
        """The area of interest with its figures."""
        result, figures = self._result, self._result.report
        bodies = [self._body(outline) for outline in result.aoi.outlines]
        zone = self._zone("Area of interest", AOI_TYPE, bodies)
        x_mm, y_mm = figures.start.xy_mm
        narrow_m2 = sum(patch.area_m2 for patch in figures.unreached if patch.narrow)
        self._describe(
            zone,
            {
                "Area": self._area_m2(figures.aoi.area_m2),
                "PercentOfFreeFloor": self._value("IfcReal", figures.aoi.percent_of_free),
                "UpperEstimate": self._area_m2(figures.disc_connected.area_m2),
                "StripsTooNarrowToResolve": self._area_m2(narrow_m2),
                "Connectivity": self._value("IfcLabel", figures.aoi.connectivity),
                "Robot": self._value("IfcLabel", figures.robot.name),
                "Clearance": self._length(figures.robot.clearance_mm),
                "StartX": self._length(x_mm),
                "StartY": self._length(y_mm),
                "Program": self._value("IfcLabel", f"satAOI-geo {__version__}"),
                "ModelSha256": self._value("IfcLabel", figures.input.sha256),
            },
        )
        return zone

    def patches(self) -> Iterator[entity_instance]:
        """The patches that are not reached, the largest first; strips are in the figures."""
        patches = [patch for patch in self._result.patches if not patch.narrow]
        patches.sort(key=lambda patch: (-patch.area_mm2, patch.label_mm))
        for number, patch in enumerate(patches, start=1):
            yield self._patch(number, patch)

    def _patch(self, number: int, patch: Patch) -> entity_instance:
        bodies = [self._body(part) for part in outlines_with_arcs(polygons_in([patch.region]))]
        zone = self._zone(f"Not reached {number}: {patch.reason}", UNREACHED_TYPE, bodies)
        properties = {
            "Area": self._area_m2(patch.area_mm2 / MM2_PER_M2),
            "Reason": self._value("IfcLabel", str(patch.reason)),
            "Explanation": self._value("IfcText", SENTENCES[patch.reason]),
        }
        if patch.blocker is not None and patch.blocker.handle:
            properties["BlockedBy"] = self._value("IfcLabel", patch.blocker.handle)
            properties["BlockedByClass"] = self._value("IfcLabel", patch.blocker.layer)
        self._describe(zone, properties)
        return zone

    def list_in_storey(self, zones: Sequence[entity_instance]) -> None:
        """Make the zones a part of the tree in which people look for them."""
        structure = self._structure()
        if structure is None:
            return
        # a zone is referenced; a proxy, which stands for one in IFC2X3, is contained
        relation = "ReferencedIn" if self._has_zones else "ContainedIn"
        self._root(
            f"IfcRel{relation}SpatialStructure",
            "zones in storey",
            RelatedElements=list(zones),
            RelatingStructure=structure,
        )

    def _structure(self) -> entity_instance | None:
        handle = self._result.plan.source.storey
        if handle:
            return self._model.by_guid(handle)
        for name in STRUCTURES:
            for structure in self._model.by_type(name):
                return structure
        return None

    def _new(self, name: str, **attributes: object) -> entity_instance:
        return self._model.create_entity(name, **attributes)

    def _value(self, name: str, value: object) -> entity_instance:
        return self._model.create_entity(name, value)

    def _area_m2(self, area_m2: float) -> entity_instance:
        return self._value("IfcAreaMeasure", float(area_m2))

    def _length(self, length_mm: float) -> entity_instance:
        return self._value("IfcLengthMeasure", length_mm / self._frame.mm_per_unit)

    def _root(self, name: str, key: str, **attributes: object) -> entity_instance:
        """A rooted entity whose GlobalId depends on the model and on its key."""
        digest = self._result.plan.source.sha256
        handle = ifcopenshell.guid.compress(uuid.uuid5(NAMESPACE, f"{digest} {key}").hex)
        return self._new(name, GlobalId=handle, OwnerHistory=self._owner, **attributes)

    def _plan_placement(self) -> entity_instance:
        """The plan's frame at the height of the floor; in IFC2X3 each product has its own."""
        turn_rad, unit_mm = self._frame.turn_rad, self._frame.mm_per_unit
        x, y = self._frame.origin_mm[0] / unit_mm, self._frame.origin_mm[1] / unit_mm
        z = self._result.plan.source.height_mm / unit_mm
        axes = self._new(
            "IfcAxis2Placement3D",
            Location=self._new("IfcCartesianPoint", Coordinates=(x, y, z)),
            Axis=self._new("IfcDirection", DirectionRatios=(0.0, 0.0, 1.0)),
            RefDirection=self._new(
                "IfcDirection",
                DirectionRatios=(float(np.cos(turn_rad)), float(np.sin(turn_rad)), 0.0),
            ),
        )
        return self._new("IfcLocalPlacement", RelativePlacement=axes)

    def _zone(
        self, name: str, object_type: str, bodies: Sequence[entity_instance]
    ) -> entity_instance:
        shape = self._new(
            "IfcShapeRepresentation",
            ContextOfItems=self._context,
            RepresentationIdentifier="Body",
            RepresentationType="SweptSolid",
            Items=list(bodies),
        )
        for body in bodies:
            self._colour(body, object_type)
        own = {"PredefinedType": "USERDEFINED"} if self._has_zones else {}
        return self._root(
            "IfcSpatialZone" if self._has_zones else "IfcBuildingElementProxy",
            name,
            Name=name,
            ObjectType=object_type,
            ObjectPlacement=self._plan_placement(),
            Representation=self._new("IfcProductDefinitionShape", Representations=[shape]),
            **own,
        )

    def _body(self, outline: Outline) -> entity_instance:
        exterior, *holes = (
            closed_curve(self._model, loop.vertices, self._frame.mm_per_unit)
            for loop in (outline.exterior, *outline.holes)
        )
        inner = {"InnerCurves": holes} if holes else {}
        profile = self._new(
            "IfcArbitraryProfileDefWithVoids" if holes else "IfcArbitraryClosedProfileDef",
            ProfileType="AREA",
            OuterCurve=exterior,
            **inner,
        )
        origin = self._new("IfcCartesianPoint", Coordinates=(0.0, 0.0, 0.0))
        return self._new(
            "IfcExtrudedAreaSolid",
            SweptArea=profile,
            Position=self._new("IfcAxis2Placement3D", Location=origin),
            ExtrudedDirection=self._new("IfcDirection", DirectionRatios=(0.0, 0.0, 1.0)),
            Depth=FILM_MM / self._frame.mm_per_unit,
        )

    def _describe(self, zone: entity_instance, properties: dict[str, entity_instance]) -> None:
        """Attach a property set; areas say their unit, since models measure them differently."""
        singles = [
            self._new(
                "IfcPropertySingleValue",
                Name=name,
                NominalValue=value,
                Unit=self._square_metre if value.is_a("IfcAreaMeasure") else None,
            )
            for name, value in properties.items()
        ]
        described = self._root(
            "IfcPropertySet", f"properties of {zone.Name}", Name="satAOI", HasProperties=singles
        )
        self._root(
            "IfcRelDefinesByProperties",
            f"description of {zone.Name}",
            RelatedObjects=[zone],
            RelatingPropertyDefinition=described,
        )

    def _colour(self, body: entity_instance, object_type: str) -> None:
        red, green, blue = COLOURS[object_type]
        colour = self._new("IfcColourRgb", Red=red, Green=green, Blue=blue)
        see_through = {"Transparency": TRANSPARENCY} if self._has_zones else {}
        shading = self._new("IfcSurfaceStyleShading", SurfaceColour=colour, **see_through)
        style = self._new("IfcSurfaceStyle", Name=object_type, Side="BOTH", Styles=[shading])
        if not self._has_zones:
            style = self._new("IfcPresentationStyleAssignment", Styles=[style])
        self._new("IfcStyledItem", Item=body, Styles=[style])


def _body_context(model: ifcopenshell.file) -> entity_instance:
    """The context in which the model keeps its bodies."""
    for context in model.by_type("IfcGeometricRepresentationSubContext"):
        if context.ContextIdentifier == "Body":
            return context
    contexts = model.by_type("IfcGeometricRepresentationContext")
    return next((c for c in contexts if c.ContextType == "Model"), contexts[0])
