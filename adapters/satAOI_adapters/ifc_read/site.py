"""The products of a model with their boxes and bodies, and a notebook for what is odd."""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Final, TypeAlias

import ifcopenshell
import numpy as np
import shapely
from ifcopenshell import entity_instance
from shapely.geometry.base import BaseGeometry

from satAOI_adapters.ifc_read.bodies import MALFORMED, Body, BodyReader, Extent, NoBodyError
from satAOI_adapters.ifc_read.classes import Choice, blocks
from satAOI_adapters.ifc_read.flaws import Flaws
from satAOI_adapters.ifc_read.floor import Top, tops_of
from satAOI_adapters.ifc_read.model import body_items, candidates, handle_of
from satAOI_adapters.ifc_read.names import printable
from satAOI_adapters.ifc_read.placement import world_matrix
from satAOI_adapters.ifc_read.prisms import View
from satAOI_adapters.ifc_read.profiles import Units
from satAOI_geo.plan import Finding, Shape, geometry_of

Begin: TypeAlias = Callable[[entity_instance], None]
"""Called before an element is read."""

FAR_MM: Final = 1e9
"""A thousand kilometres from the first element is no part of its building."""


@dataclass(slots=True)
class Notes:
    """What was odd, in the order in which it was noticed.

    Attributes:
        failed: Elements that nothing could be made of.
        others: The rest.
    """

    failed: list[Finding] = field(default_factory=list)
    others: list[Finding] = field(default_factory=list)

    def add(
        self, code: str, message: str, remedy: str, product: entity_instance | None = None
    ) -> None:
        """Note something about the model or about one product."""
        layer, handle = ("", "") if product is None else (product.is_a(), handle_of(product))
        self.others.append(Finding(code, message, remedy, layer=layer, handle=handle))

    def fail(self, product: entity_instance, why: str) -> None:
        """Note that nothing could be made of a product."""
        self.failed.append(
            Finding(
                "element-unreadable",
                f"{called(product)} is left out: {why}",
                "repair it in the program that made the model; until then the area may reach "
                "over it",
                layer=product.is_a(),
                handle=handle_of(product),
            )
        )


@dataclass(frozen=True, slots=True)
class Standing:
    """What a product has between two heights."""

    product: entity_instance
    body: Body
    shapes: tuple[Shape, ...]

    def parts(self) -> list[BaseGeometry]:
        """Its shapes as shapely sees them."""
        return [geometry_of(shape) for shape in self.shapes]

    def region(self) -> BaseGeometry:
        """Its shapes as one."""
        return shapely.union_all(self.parts())


@dataclass(frozen=True, slots=True)
class Site:
    """All products of a model that could stand on a floor.

    Attributes:
        model: The open model.
        units: Its units.
        choice: The user's classes.
        products: By GlobalId.
        origin_mm: What is subtracted from the model's x and y.
        reader: Of bodies.
        extents: Box of each product by id, None where it is not known without meshing.
        notes: What was odd.
        begin: Called before an element is read.
    """

    model: ifcopenshell.file
    units: Units
    choice: Choice
    products: tuple[entity_instance, ...]
    origin_mm: tuple[float, float]
    reader: BodyReader
    extents: dict[int, Extent | None]
    notes: Notes
    begin: Begin

    @classmethod
    def of(
        cls,
        model: ifcopenshell.file,
        units: Units,
        choice: Choice,
        flaws: Flaws,
        begin: Begin,
    ) -> "Site":
        """The products of a model.

        Args:
            model: The open model.
            units: Its units.
            choice: The user's classes.
            flaws: What is known to be wrong with it.
            begin: Called before an element is read.
        """
        notes = Notes()
        products = []
        for product in candidates(model, choice):
            flaw = flaws.in_product(product)
            if not flaw:
                products.append(product)
            elif blocks(product, choice):
                notes.fail(product, flaw)
        _note_repeated(products, notes)
        origin_mm = _origin_mm(products, units)
        reader = BodyReader(model, units, origin_mm, flaws)
        extents: dict[int, Extent | None] = {}
        for product in products:
            begin(product)
            extents[product.id()] = reader.extent(product)
        return cls(model, units, choice, tuple(products), origin_mm, reader, extents, notes, begin)

    def is_near(self, product: entity_instance, low_mm: float, high_mm: float) -> bool:
        """Whether a product may reach between two heights."""
        extent = self.extents[product.id()]
        if extent is None:
            return bool(body_items(product))
        return bool(extent.least_mm[2] <= high_mm and extent.greatest_mm[2] >= low_mm)

    def extents_of(self, names: Sequence[str]) -> list[Extent]:
        """The boxes of products of some classes."""
        boxes = (
            self.extents[product.id()]
            for product in self.products
            if any(product.is_a(name) for name in names)
        )
        return [extent for extent in boxes if extent is not None]

    def tops(self, products: Sequence[entity_instance], low_mm: float, high_mm: float) -> list[Top]:
        """The level faces of products between two heights."""
        view = View(low_mm, high_mm, outward=False)
        tops: list[Top] = []
        for product in products:
            if self.is_near(product, low_mm, high_mm):
                self.begin(product)
                try:
                    body = self.reader.body(product, view)
                    tops.extend(tops_of(body, handle_of(product), product.is_a()))
                except MALFORMED as error:
                    self._note_no_top(product, str(error))
        return tops

    def _note_no_top(self, product: entity_instance, why: str) -> None:
        # what has no body of its own leaves it to its parts, or to its openings
        if body_items(product):
            self.notes.add(
                "no-top",
                f"{called(product)} may be floor but cannot be read: {why}",
                "repair it in the program that made the model",
                product,
            )

    def standing(self, product: entity_instance, low_mm: float, high_mm: float) -> Standing | None:
        """What a product has between two heights; None for nothing.

        Raises:
            NoBodyError: If nothing can be made of it.
        """
        if not self.is_near(product, low_mm, high_mm):
            return None
        self.begin(product)
        view = View(low_mm, high_mm, outward=True)
        body = self.reader.body(product, view)
        try:
            standing = Standing(product, body, tuple(body.in_band(view)))
            bounds_mm = standing.region().bounds
        except MALFORMED as error:
            raise NoBodyError(f"its section cannot be made ({error})") from error
        if not standing.shapes:
            return None
        if max(map(abs, bounds_mm)) > FAR_MM:
            raise NoBodyError("it lies more than 1000 km away")
        return standing


def _note_repeated(products: Sequence[entity_instance], notes: Notes) -> None:
    for handle, count in Counter(handle_of(product) for product in products).items():
        if count > 1:
            notes.add(
                "repeated-globalid",
                f"{count} elements share the GlobalId {handle}; all were read",
                "give each element a GlobalId of its own",
            )


def called(product: entity_instance) -> str:
    """A product's class and name."""
    name = f" '{printable(product.Name)}'" if product.Name else ""
    return f"{product.is_a()}{name}"


def _origin_mm(products: Sequence[entity_instance], units: Units) -> tuple[float, float]:
    """Whole millimetres near the first product that is placed."""
    for product in products:
        if product.ObjectPlacement is not None:
            try:
                x_mm, y_mm = np.floor(world_matrix(product.ObjectPlacement, units.mm)[:2, 3])
            except MALFORMED:
                continue
            if np.isfinite((x_mm, y_mm)).all():
                return float(x_mm), float(y_mm)
    return 0.0, 0.0
