"""What is known to be wrong with a model before any of its geometry is made."""

from collections.abc import Mapping
from dataclasses import dataclass

import ifcopenshell
from ifcopenshell import entity_instance

from satAOI_adapters.ifc_read.model import body_items, handle_of

ROOTS = (("ObjectPlacement", "IfcObjectPlacement"), ("Representation", "IfcProductRepresentation"))
"""What places a product and gives it a shape: attribute and class."""


@dataclass(frozen=True, slots=True)
class Flaws:
    """Entities that must not be used, and products whose geometry must not be made.

    Attributes:
        broken: Ids of entities, with what is broken about them.
        deadly: GlobalIds of elements whose geometry ended an earlier process.
        deadly_maps: Ids of the representation maps that those elements repeat.
    """

    broken: Mapping[int, str]
    deadly: frozenset[str] = frozenset()
    deadly_maps: frozenset[int] = frozenset()

    @classmethod
    def of(
        cls, model: ifcopenshell.file, broken: Mapping[int, str], deadly: frozenset[str]
    ) -> "Flaws":
        """The flaws of a model in which some elements are known to be deadly."""
        products = model.by_type("IfcProduct") if deadly else ()
        maps = [_mapped(product) for product in products if handle_of(product) in deadly]
        return cls(broken, deadly, frozenset[int]().union(*maps))

    def in_product(self, product: entity_instance) -> str:
        """What is broken in a product's placement or shape, or an empty string."""
        for attribute, name in ROOTS:
            root = getattr(product, attribute)
            if root is not None and not root.is_a(name):
                return f"its {attribute} is an {root.is_a()}"
        for attribute, _ in ROOTS if self.broken else ():
            root = getattr(product, attribute)
            parts = () if root is None else product.file.traverse(root)
            for part in parts:
                if part.id() in self.broken:
                    return self.broken[part.id()]
        return ""

    def in_geometry(self, product: entity_instance) -> str:
        """Why a product's geometry must not be made, or an empty string."""
        if handle_of(product) in self.deadly:
            return "its geometry ended the process that makes it"
        if self.deadly_maps and not self.deadly_maps.isdisjoint(_mapped(product)):
            return "it repeats geometry that ended the process that makes it"
        return ""


def _mapped(product: entity_instance) -> set[int]:
    """Ids of the representation maps that a product's body repeats."""
    items = [item for item in body_items(product) if item is not None]
    maps = [item.MappingSource for item in items if item.is_a("IfcMappedItem")]
    return {source.id() for source in maps if source is not None}
