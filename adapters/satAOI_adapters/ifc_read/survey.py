"""A floor of a model with its obstacles: what the geometry process answers."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

import shapely
from ifcopenshell import entity_instance
from shapely.geometry import LineString, box

from satAOI_adapters.ifc_read.bodies import Body, NoBodyError
from satAOI_adapters.ifc_read.classes import blocks, kind_of
from satAOI_adapters.ifc_read.floor import STEP_MM, closing
from satAOI_adapters.ifc_read.ground import Ground, ground_of
from satAOI_adapters.ifc_read.model import body_items, handle_of
from satAOI_adapters.ifc_read.records import Storey
from satAOI_adapters.ifc_read.site import Site, Standing, called
from satAOI_adapters.wording import are, counted
from satAOI_geo.errors import DrawingError, EmptyPlanError
from satAOI_geo.plan import Finding, Kind, Obstacle, Region, polygons_in
from satAOI_geo.units import MM2_PER_M2

ABOVE_FLOOR_MM: Final = 1.0
"""Things that rise less above the floor are its own rounding; more is struck by the blades."""

FLUSH_MM: Final = 1.0
"""An embedded part this close below the floor's surface lies in it: steel cannot be trowelled."""

HAIR_MM: Final = 1.0
"""Gaps up to this width, between walls or between a wall and the floor, are rounding."""

MOST_FAILED: Final = 0.5
"""A model of whose elements a greater share cannot be read is refused."""


@dataclass(frozen=True, slots=True)
class Survey:
    """A floor and what stands on it, in axes near the model's first element.

    Attributes:
        origin_mm: What was subtracted from the model's x and y.
        floor: The floor.
        floor_source: `slab`, `space`, `support` or `inferred`.
        height_mm: Of the floor, in the model.
        obstacles: Holes first, then by GlobalId.
        findings: What was guessed, repaired or left out.
    """

    origin_mm: tuple[float, float]
    floor: Region
    floor_source: str
    height_mm: float
    obstacles: tuple[Obstacle, ...]
    findings: tuple[Finding, ...]


def survey(site: Site, storey: Storey | None, *, asked_mm: float | None, band_mm: float) -> Survey:
    """The floor of a storey and all that stands in the band above it.

    Args:
        site: The products of the model.
        storey: The storey, or None if the model has none.
        asked_mm: Height of the floor given by the user, or None.
        band_mm: How high above the floor things are in the way.

    Raises:
        EmptyPlanError: If there is no floor and none can be inferred.
        DrawingError: If most elements have no usable geometry.
    """
    _refuse_if_most_failed(site)
    ground = ground_of(site, storey, asked_mm)
    standing = list(_standing(site, ground, band_mm))
    _refuse_if_most_failed(site)
    floor = ground.region
    if floor is None:
        floor = _inferred(site, standing, ground.height_mm)
    on_floor = [thing for thing in (_on(thing, floor) for thing in standing) if thing.shapes]
    obstacles = (*_holes(ground), *_obstacles(site, on_floor))
    _note_the_rest(site, n_outside=len(standing) - len(on_floor), obstacles=obstacles)
    return Survey(
        origin_mm=site.origin_mm,
        floor=floor,
        floor_source=ground.source,
        height_mm=ground.height_mm,
        obstacles=obstacles,
        findings=(*site.notes.failed, *site.notes.others),
    )


def _standing(site: Site, ground: Ground, band_mm: float) -> Iterator[Standing]:
    """All that stands in the band above the floor, as far as the floor's box reaches."""
    high_mm = ground.height_mm + band_mm
    for product in site.products:
        if not blocks(product, site.choice) or not _may_reach(site, product, ground.region):
            continue
        if not body_items(product):
            _note_bodiless(site, product)
            continue
        low_mm = _low_mm(product, ground)
        try:
            standing = site.standing(product, low_mm, high_mm)
        except NoBodyError as error:
            standing = _stand_in(site, product, low_mm, high_mm, str(error))
        if standing is not None:
            yield standing


def _on(thing: Standing, floor: Region) -> Standing:
    """What of a thing stands on the floor or against its edge."""
    near = shapely.dwithin(thing.parts(), floor, HAIR_MM)
    shapes = tuple(shape for shape, is_near in zip(thing.shapes, near, strict=True) if is_near)
    return replace(thing, shapes=shapes)


def _low_mm(product: entity_instance, ground: Ground) -> float:
    """From which height on a product is in the way."""
    if handle_of(product) in ground.handles:
        return ground.height_mm + STEP_MM
    if kind_of(product) is Kind.EMBEDDED:
        return ground.height_mm - FLUSH_MM
    return ground.height_mm + ABOVE_FLOOR_MM


def _may_reach(site: Site, product: entity_instance, floor: Region | None) -> bool:
    """Whether a product's box meets the floor's."""
    extent = site.extents[product.id()]
    if floor is None or extent is None:
        return True
    reach = box(*extent.least_mm[:2], *extent.greatest_mm[:2])
    return bool(reach.dwithin(box(*floor.bounds), HAIR_MM))


def _note_bodiless(site: Site, product: entity_instance) -> None:
    # a whole may leave its body to its parts
    if not product.IsDecomposedBy:
        site.notes.add(
            "no-body",
            f"{called(product)} has no body and so is not in the way",
            "export it with its geometry if it is",
            product,
        )


def _stand_in(
    site: Site, product: entity_instance, low_mm: float, high_mm: float, why: str
) -> Standing | None:
    """The box around a body that could not be made, so that the area keeps clear of it."""
    extent = site.extents[product.id()]
    if extent is None:
        site.notes.fail(product, why)
        return None
    if extent.least_mm[2] >= high_mm or extent.greatest_mm[2] <= low_mm:
        return None
    site.notes.add(
        "box-for-body",
        f"the box around {called(product)} stands for it: {why}",
        "repair it in the program that made the model",
        product,
    )
    shape = box(*extent.least_mm[:2], *extent.greatest_mm[:2])
    return Standing(product, Body(()), (shape,))


def _refuse_if_most_failed(site: Site) -> None:
    failed = site.notes.failed
    blocking = {p.GlobalId for p in site.products if blocks(p, site.choice)}
    n_tried = len(blocking | {finding.handle for finding in failed})
    if failed and len(failed) > MOST_FAILED * n_tried:
        first = failed[0]
        raise DrawingError(
            f"{len(failed)} of {n_tried} elements cannot be read, for example {first.message} "
            f"({first.handle}); repair the model and export it again",
            layer=first.layer,
            handle=first.handle,
        )


def _inferred(site: Site, standing: Sequence[Standing], height_mm: float) -> Region:
    """What the obstacles enclose.

    Raises:
        EmptyPlanError: If they enclose nothing.
    """
    # few models need it, and it brings all of ezdxf along
    from satAOI_adapters.dxf_read.enclosure import enclosed

    parts = [part for thing in standing for part in thing.parts()]
    # walls that meet do so up to their rounding: a hair's breadth must not open a room
    solid = closing(shapely.union_all(polygons_in(parts)), HAIR_MM)
    lines = [part for part in parts if isinstance(part, LineString)]
    floor = enclosed([*polygons_in([solid]), *lines]).region
    if floor.is_empty:
        raise EmptyPlanError(
            f"there is no slab, space or other level surface at {height_mm:g} mm, and the walls "
            "there enclose nothing; give --floor-z, or model the floor as IfcSlab"
        )
    site.notes.add(
        "floor-inferred",
        f"no slab and no space lies at {height_mm:g} mm; what the walls there enclose was taken "
        f"for the floor: {floor.area / MM2_PER_M2:.2f} m²",
        "model the floor as IfcSlab",
    )
    return floor


def _holes(ground: Ground) -> list[Obstacle]:
    holes = [Obstacle(cut.region, Kind.HOLE, cut.layer, cut.handle) for cut in ground.cuts]
    return sorted(holes, key=lambda hole: hole.handle)


def _obstacles(site: Site, standing: Sequence[Standing]) -> Iterator[Obstacle]:
    for thing in standing:
        product = thing.product
        kind = kind_of(product)
        for shape in thing.shapes:
            yield Obstacle(shape, kind, product.is_a(), handle_of(product))
        if thing.body.meshes:
            growth_mm = max(mesh.growth_mm for mesh in thing.body.meshes)
            grown = f", grown by {growth_mm:g} mm" if growth_mm else ""
            site.notes.add(
                "mesh-section",
                f"{called(product)} was cut from its mesh{grown}, not read exactly: "
                f"{thing.body.why_meshed}",
                "",
                product,
            )
        for flaw in thing.body.flaws:
            site.notes.add(
                "geometry-flaw",
                f"{called(product)}: {flaw}",
                "compare it with the picture of what was read",
                product,
            )


def _note_the_rest(site: Site, *, n_outside: int, obstacles: Sequence[Obstacle]) -> None:
    if n_outside:
        site.notes.add(
            "outside-floor",
            f"{counted(n_outside, 'element')} beside the floor {are(n_outside)} left out",
            "",
        )
    if not obstacles:
        site.notes.add(
            "no-obstacles",
            "nothing stands on this floor and nothing is cut out of it",
            "check the storey and its height",
        )
