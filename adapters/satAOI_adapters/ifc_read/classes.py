"""Which IFC classes are in the robot's way, and what kind of obstacle each is."""

import difflib
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from typing import Final

from ifcopenshell import entity_instance, ifcopenshell_wrapper

from satAOI_geo.errors import InputError
from satAOI_geo.plan import Kind

KINDS: Final = (
    ("IfcBuildingElementPart", Kind.UNCLASSIFIED),
    ("IfcWall", Kind.WALL),
    ("IfcCurtainWall", Kind.WALL),
    ("IfcWindow", Kind.WALL),
    ("IfcDoor", Kind.WALL),
    ("IfcPlate", Kind.WALL),
    ("IfcRailing", Kind.WALL),
    ("IfcCovering", Kind.WALL),
    ("IfcColumn", Kind.COLUMN),
    ("IfcMember", Kind.COLUMN),
    ("IfcPile", Kind.COLUMN),
    ("IfcFooting", Kind.COLUMN),
    ("IfcBeam", Kind.COLUMN),
    ("IfcChimney", Kind.COLUMN),
    ("IfcElementComponent", Kind.EMBEDDED),
    ("IfcMechanicalFastener", Kind.EMBEDDED),
    ("IfcSlab", Kind.EQUIPMENT),
    ("IfcStair", Kind.EQUIPMENT),
    ("IfcStairFlight", Kind.EQUIPMENT),
    ("IfcRamp", Kind.EQUIPMENT),
    ("IfcRampFlight", Kind.EQUIPMENT),
    ("IfcDistributionElement", Kind.EQUIPMENT),
    ("IfcTransportElement", Kind.EQUIPMENT),
    ("IfcTransportationDevice", Kind.EQUIPMENT),
    ("IfcFurnishingElement", Kind.EQUIPMENT),
)
"""Kind of a class and of the classes under it; the first that fits."""

PARTS: Final = ("IfcBuildingElementPart", "IfcPlate", "IfcMember")
"""Classes whose kind is that of the whole they are a part of."""

NEVER_BLOCK: Final = (
    "IfcFeatureElementSubtraction",
    "IfcSurfaceFeature",
    "IfcVirtualElement",
    "IfcDoor",
    "IfcFurnishingElement",
    "IfcGeographicElement",
    "IfcCivilElement",
)
"""Elements that do not block unless they are asked for."""

FLOOR_COVERINGS: Final = frozenset({"FLOORING", "MEMBRANE", "INSULATION"})
"""Predefined types of IfcCovering that are the floor, not a thing on it."""

OURS: Final = "SATAOI-"
"""How the object types of what this program writes begin."""

MAX_DEPTH: Final = 50
"""Parts within parts; deeper is a cycle."""


@dataclass(frozen=True, slots=True)
class Choice:
    """What the user says about classes.

    Attributes:
        rules: A class and whether it blocks; a class stands before those that it is under.
    """

    rules: tuple[tuple[str, bool], ...] = ()

    def added(self) -> set[str]:
        """The classes that block."""
        return {name for name, is_in_the_way in self.rules if is_in_the_way}

    def verdict(self, element: entity_instance) -> bool | None:
        """Whether an element blocks, by the most special class that was named; None if none was."""
        named = (is_in_the_way for name, is_in_the_way in self.rules if element.is_a(name))
        return next(named, None)


def chosen_classes(schema: str, added: tuple[str, ...], dropped: tuple[str, ...]) -> Choice:
    """The user's classes, spelled as the schema spells them.

    Args:
        schema: For example IFC4.
        added: Classes that block, whatever the built-in rule.
        dropped: Classes that do not block, whatever the built-in rule.

    Raises:
        InputError: If the schema has no such class of products, or one is both.
    """
    depths = _depths(schema)
    blocking = {_spelled(name, depths, schema): True for name in added}
    passing = {_spelled(name, depths, schema): False for name in dropped}
    if twice := blocking.keys() & passing.keys():
        raise InputError(f"{min(twice)} is given --with and --without; leave one of the two out")
    rules = sorted((blocking | passing).items(), key=lambda rule: -depths[rule[0]])
    return Choice(tuple(rules))


def _depths(schema: str) -> dict[str, int]:
    """The schema's classes of products, and how many classes each is under."""
    depths = {}
    for entity in ifcopenshell_wrapper.schema_by_name(schema).entities():
        lineage = [entity]
        while (above := lineage[-1].supertype()) is not None:
            lineage.append(above)
        if any(one.name() == "IfcProduct" for one in lineage):
            depths[entity.name()] = len(lineage)
    return depths


def _spelled(name: str, names: Collection[str], schema: str) -> str:
    """The one of the names that this is, in whatever case.

    Raises:
        InputError: If it is none of them.
    """
    by_letters = {known.casefold(): known for known in names}
    wanted = name.strip().casefold()
    if wanted in by_letters:
        return by_letters[wanted]
    # people leave out the prefix
    full = f"ifc{wanted.removeprefix('ifc')}"
    near = difflib.get_close_matches(full, by_letters, n=3, cutoff=0.7)
    instead = " or ".join(by_letters[letters] for letters in near) or "a name such as IfcDoor"
    raise InputError(f"'{name}' is no class of products of {schema}; give {instead}")


def blocks(element: entity_instance, choice: Choice) -> bool:
    """Whether an element stands in the way where it occupies the band."""
    if is_ours(element):
        return False
    verdict = choice.verdict(element)
    if verdict is not None:
        return verdict
    if element.is_a("IfcCovering"):
        return element.PredefinedType not in FLOOR_COVERINGS
    return not any(element.is_a(name) for name in NEVER_BLOCK)


def is_ours(element: entity_instance) -> bool:
    """Whether this program wrote it: a result is no part of the building."""
    return bool(str(element.ObjectType or "").startswith(OURS))


def kind_of(element: entity_instance) -> Kind:
    """The kind of obstacle; a part is what the whole is, where that says anything."""
    kind = _own_kind(element)
    if any(element.is_a(name) for name in PARTS):
        wholes = (_own_kind(whole) for whole in wholes_of(element))
        kind = next((whole for whole in wholes if whole is not Kind.UNCLASSIFIED), kind)
    return kind


def _own_kind(element: entity_instance) -> Kind:
    return next((kind for name, kind in KINDS if element.is_a(name)), Kind.UNCLASSIFIED)


def wholes_of(element: entity_instance) -> Iterator[entity_instance]:
    """The elements that an element is a part of, the nearest first."""
    for _ in range(MAX_DEPTH):
        wholes = [relation.RelatingObject for relation in element.Decomposes]
        if not wholes or not wholes[0].is_a("IfcElement"):
            return
        element = wholes[0]
        yield element


def is_or_is_part_of(element: entity_instance, name: str) -> bool:
    """Whether an element is of a class or a part, at any depth, of one that is."""
    return bool(element.is_a(name)) or any(whole.is_a(name) for whole in wholes_of(element))
