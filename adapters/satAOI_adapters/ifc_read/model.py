"""An IFC model as far as it concerns one floor: its unit, its storeys, its elements."""

import re
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import ifcopenshell
from ifcopenshell import entity_instance, ifcopenshell_wrapper
from ifcopenshell.util.unit import calculate_unit_scale

from satAOI_adapters.ifc_read.classes import Choice, wholes_of
from satAOI_adapters.ifc_read.names import printable
from satAOI_adapters.ifc_read.placement import PlacementError, world_matrix
from satAOI_adapters.ifc_read.profiles import Units
from satAOI_adapters.ifc_read.records import Storey
from satAOI_geo.errors import EmptyPlanError, InputError, UnitError, UnreadableError
from satAOI_geo.plan import Finding
from satAOI_geo.units import MM_PER_UNIT

SAME_UNIT: Final = 1e-9
"""Share by which a conversion factor may differ from the exact one: it was written in decimals."""

SAME_HEIGHT_MM: Final = 1.0
"""Heights this close are the same: models carry their rounding along."""

COUNTED: Final = ("IfcWall", "IfcColumn", "IfcSlab", "IfcOpeningElement")
"""Classes counted per storey."""


@dataclass(frozen=True, slots=True)
class Opened:
    """A model that was parsed.

    Attributes:
        model: What the parser made of it.
        dangling: Ids of entities that refer to others which the file does not hold.
        findings: What it left out.
    """

    model: ifcopenshell.file
    dangling: frozenset[int]
    findings: tuple[Finding, ...]


def open_model(path: Path, parsed: Path) -> Opened:
    """The model in a file that was already checked to be whole.

    Args:
        path: The model.
        parsed: Where it is parsed, as in `parsable`.

    Raises:
        UnreadableError: If it cannot be parsed.
        EmptyPlanError: If it holds no product with a representation.
    """
    log = ifcopenshell_wrapper.logger()
    log.output_format(log.FMT_INMEMORY)
    try:
        model = ifcopenshell.open(parsed, format=".ifc", logger=log)
    except (ifcopenshell.Error, OSError, RuntimeError) as error:
        reasons = [m.message for m in log.log_messages() if m.severity >= log.LOG_ERROR]
        raise UnreadableError(
            f"'{path}' cannot be parsed ({reasons[0] if reasons else error}); export the model "
            "again"
        ) from error
    if not any(product.Representation for product in model.by_type("IfcProduct")):
        raise EmptyPlanError(
            f"'{path}' holds no element with geometry; export the model with its walls and slabs"
        )
    said = [message.message for message in log.log_messages()]
    dangling = (DANGLING.search(message) for message in said)
    unknown = (UNKNOWN.search(message) for message in said)
    return Opened(
        model,
        dangling=frozenset(int(match[1]) for match in dangling if match),
        findings=_unknown_classes(model.schema_identifier, {m[1] for m in unknown if m}),
    )


DANGLING: Final = re.compile(r"#\d+ used by instance #(\d+) .*not found")
"""How the parser says that an entity refers to nothing."""

UNKNOWN: Final = re.compile(r"Entity with name '(IFC\w+)' not found in schema")
"""How it says that it leaves out the entities of a class."""


def _unknown_classes(schema: str, names: set[str]) -> tuple[Finding, ...]:
    if not names:
        return ()
    return (
        Finding(
            "unknown-class",
            f"entities of classes that {schema} lacks were left out: {', '.join(sorted(names))}",
            "export the model in the schema that its classes are from if something is missing",
        ),
    )


def units_of(model: ifcopenshell.file, name: str | None) -> tuple[Units, str]:
    """The model's units and the name of its unit of length, `mm` if it has none of ours.

    Args:
        model: The model.
        name: Unit of length given by the user, a key of `MM_PER_UNIT`, or None.

    Raises:
        UnitError: If the model does not say its unit of length.
        InputError: If the given name is unknown.
    """
    angle_rad = calculate_unit_scale(model, "PLANEANGLEUNIT")
    if name is not None:
        if name not in MM_PER_UNIT:
            raise InputError(f"unit '{name}' is unknown; give one of {', '.join(MM_PER_UNIT)}")
        return Units(MM_PER_UNIT[name], angle_rad), name
    if not _states_length_unit(model):
        raise UnitError(
            "the model does not say its unit of length (no LENGTHUNIT in the project's "
            f"IfcUnitAssignment); {_sizes(model)}"
        )
    mm = calculate_unit_scale(model) * MM_PER_UNIT["m"]
    for known, exact_mm in MM_PER_UNIT.items():
        if abs(mm - exact_mm) <= SAME_UNIT * exact_mm:
            return Units(exact_mm, angle_rad), known
    return Units(mm, angle_rad), ""


def _states_length_unit(model: ifcopenshell.file) -> bool:
    return any(
        getattr(unit, "UnitType", None) == "LENGTHUNIT"
        for project in model.by_type("IfcProject")
        if project.UnitsInContext is not None
        for unit in project.UnitsInContext.Units
    )


def _sizes(model: ifcopenshell.file) -> str:
    """What the model would measure in some units, so that the right one can be told."""
    points = [p.Coordinates for p in model.by_type("IfcCartesianPoint") if len(p.Coordinates) == 3]
    size = max((max(abs(c) for c in point) for point in points), default=0.0)
    choices = (f"--units {name} for {size * MM_PER_UNIT[name] / 1000:g} m" for name in GUESSED)
    return f"its largest coordinate is {size:g}: give {', '.join(choices)}"


GUESSED: Final = ("mm", "m", "ft")
"""Units of length that models are commonly drawn in."""


def storeys_of(
    model: ifcopenshell.file, mm: float, flaw_in: Callable[[entity_instance], str]
) -> tuple[list[Storey], list[Finding]]:
    """The storeys, lowest first, and what was odd about their heights.

    The height of a storey's placement counts; the attribute Elevation is informative only, and
    used where no storey is placed at a height of its own.

    Args:
        model: The model.
        mm: Millimetres in its unit of length.
        flaw_in: Says what is broken in a product, or an empty string.

    Raises:
        UnreadableError: If the placement of a storey cannot be resolved.
    """
    entities = sorted(model.by_type("IfcBuildingStorey"), key=handle_of)
    placed_mm = [_placed_mm(storey, mm, flaw_in) for storey in entities]
    stated_mm = [None if s.Elevation is None else s.Elevation * mm for s in entities]
    bases_mm = [_base_mm(storey, mm) for storey in entities]
    findings: list[Finding] = []
    if _all_alike(placed_mm) and not _all_alike(stated_mm):
        findings.append(_UNPLACED)
        placed_mm = [
            None if stated is None else base + stated
            for base, stated in zip(bases_mm, stated_mm, strict=True)
        ]
    counts = _counts(model)
    found = []
    for entity, height_mm, attribute_mm, base_mm in zip(
        entities, placed_mm, stated_mm, bases_mm, strict=True
    ):
        elevation_mm = height_mm if height_mm is not None else attribute_mm or 0.0
        # it counts from the building's own height; some programs state that of the world
        heights_mm = (elevation_mm, elevation_mm - base_mm)
        if attribute_mm is not None and not any(
            abs(attribute_mm - height) <= SAME_HEIGHT_MM for height in heights_mm
        ):
            findings.append(_contradiction(entity, attribute_mm, elevation_mm))
        found.append((elevation_mm, entity, attribute_mm))
    found.sort(key=lambda storey: storey[0])
    storeys = [
        Storey(
            number=number,
            name=printable(entity.Name or ""),
            handle=handle_of(entity),
            elevation_mm=elevation_mm,
            attribute_mm=attribute_mm,
            counts=dict(counts[entity.id()]),
        )
        for number, (elevation_mm, entity, attribute_mm) in enumerate(found, start=1)
    ]
    return storeys, findings


_UNPLACED: Final = Finding(
    "storey-elevation",
    "all storeys are placed at the same height; their attribute Elevation was used instead",
    "check the heights, or give --floor-z",
    layer="IfcBuildingStorey",
)


def _contradiction(storey: entity_instance, attribute_mm: float, used_mm: float) -> Finding:
    name = printable(storey.Name or "")
    return Finding(
        "storey-elevation",
        f"storey '{name}' is placed at {used_mm:g} mm but states an Elevation of "
        f"{attribute_mm:g} mm; the placement was used",
        "give --floor-z if the other height is meant",
        layer="IfcBuildingStorey",
        handle=handle_of(storey),
    )


def _placed_mm(
    storey: entity_instance, mm: float, flaw_in: Callable[[entity_instance], str]
) -> float | None:
    if storey.ObjectPlacement is None:
        return None
    why = flaw_in(storey)
    try:
        height_mm = float(world_matrix(storey.ObjectPlacement, mm)[2, 3])
    except PlacementError as error:
        why = str(error)
    if why:
        raise UnreadableError(
            f"the placement of storey '{printable(storey.Name or '')}' cannot be used: {why}; "
            "repair it in the program that made the model",
            layer="IfcBuildingStorey",
            handle=handle_of(storey),
        )
    return height_mm


def _base_mm(storey: entity_instance, mm: float) -> float:
    """Height of what a storey is placed in, which its Elevation counts from."""
    within = storey.ObjectPlacement and storey.ObjectPlacement.PlacementRelTo
    return float(world_matrix(within, mm)[2, 3]) if within else 0.0


def _all_alike(heights_mm: list[float | None]) -> bool:
    known_mm = [height for height in heights_mm if height is not None]
    return not known_mm or max(known_mm) - min(known_mm) <= SAME_HEIGHT_MM


def _counts(model: ifcopenshell.file) -> dict[int, Counter[str]]:
    counts = {storey.id(): Counter[str]() for storey in model.by_type("IfcBuildingStorey")}
    for relation in model.by_type("IfcRelContainedInSpatialStructure"):
        if relation.RelatingStructure.id() not in counts:
            continue
        counter = counts[relation.RelatingStructure.id()]
        for element in relation.RelatedElements:
            openings = len(getattr(element, "HasOpenings", ()))
            counter.update({"IfcOpeningElement": openings} if openings else {})
            counter.update(name for name in COUNTED if element.is_a(name))
    return counts


def chosen_storey(storeys: list[Storey], wanted: str | None) -> Storey | None:
    """The storey a user asked for, the only one in use, or None if there is none.

    Raises:
        InputError: If the storey is not there, or several are and none was asked for.
    """
    if wanted is None:
        used = [storey for storey in storeys if storey.counts] or storeys
        if len(used) > 1:
            raise InputError(
                f"the model has {len(used)} storeys; choose one with --storey: {_listed(used)}"
            )
        return used[0] if used else None
    if not storeys:
        raise InputError(
            f"storey '{wanted}' was asked for but the model has none; give --floor-z instead"
        )
    exact = [storey for storey in storeys if storey.name == wanted]
    loose = [s for s in storeys if s.name.strip().casefold() == wanted.strip().casefold()]
    numbered = [storey for storey in storeys if str(storey.number) == wanted.strip()]
    for matches in (exact, loose, numbered):
        if len(matches) == 1:
            return matches[0]
        if matches:
            raise InputError(
                f"{len(matches)} storeys are named '{wanted}'; choose by number: {_listed(storeys)}"
            )
    raise InputError(f"the model has no storey '{wanted}'; choose one of {_listed(storeys)}")


def _listed(storeys: list[Storey]) -> str:
    return ", ".join(f"{s.number} '{s.name}' at {s.elevation_mm / 1000:g} m" for s in storeys)


def candidates(model: ifcopenshell.file, choice: Choice) -> list[entity_instance]:
    """All products that could stand on a floor, by GlobalId."""
    names = {"IfcElement", *choice.added()}
    if model.schema != "IFC4X3":
        names.add("IfcProxy")
    found = {
        product.id(): product
        for name in names
        for product in model.by_type(name)
        if name != "IfcElement" or not product.is_a("IfcFeatureElementSubtraction")
    }
    return sorted(found.values(), key=lambda product: (handle_of(product), product.id()))


def body_items(product: entity_instance) -> list[entity_instance]:
    """The items of a product's body; none if it has no solid or surface representation."""
    definition = product.Representation
    if definition is None:
        return []
    shapes = [r for r in definition.Representations if r.is_a("IfcShapeRepresentation")]
    bodies = [shape for shape in shapes if shape.RepresentationIdentifier == "Body"]
    if not bodies:
        bodies = [shape for shape in shapes if shape.RepresentationType in SOLID_TYPES]
    return list(bodies[0].Items) if bodies else []


SOLID_TYPES: Final = frozenset(
    {
        "SweptSolid",
        "AdvancedSweptSolid",
        "Brep",
        "AdvancedBrep",
        "CSG",
        "Clipping",
        "SolidModel",
        "SurfaceModel",
        "Surface3D",
        "Tessellation",
        "MappedRepresentation",
    }
)
"""Representation types that are a body where none is called Body."""


def handle_of(product: entity_instance) -> str:
    """A product's GlobalId, or an empty string where it has none although it must."""
    return str(product.GlobalId or "")


def openings_of(element: entity_instance) -> Iterator[entity_instance]:
    """The openings cut into an element and into the wholes that it is a part of."""
    for host in (element, *wholes_of(element)):
        for relation in getattr(host, "HasOpenings", ()):
            if relation.RelatedOpeningElement is not None:
                yield relation.RelatedOpeningElement
