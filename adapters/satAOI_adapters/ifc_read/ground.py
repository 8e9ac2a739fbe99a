"""The floor of a storey: by its slabs, else its spaces, else whatever lies at its height."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import shapely
from ifcopenshell import entity_instance
from shapely.geometry import LineString
from shapely.geometry.base import BaseGeometry

from satAOI_adapters.ifc_read.bodies import NoBodyError
from satAOI_adapters.ifc_read.classes import blocks, is_or_is_part_of
from satAOI_adapters.ifc_read.floor import (
    RANGE_MM,
    STEP_MM,
    Cut,
    Top,
    at_height,
    floor_height_mm,
    floor_region,
    open_cuts,
)
from satAOI_adapters.ifc_read.model import body_items, handle_of, openings_of
from satAOI_adapters.ifc_read.prisms import RECESS_MM, View, as_polygon
from satAOI_adapters.ifc_read.records import Storey
from satAOI_adapters.ifc_read.site import Site
from satAOI_adapters.wording import counted
from satAOI_geo.errors import EmptyPlanError
from satAOI_geo.plan import Region, as_region
from satAOI_geo.units import MM2_PER_M2

UPRIGHTS: Final = ("IfcWall", "IfcColumn")
"""Classes that stand on the floor and so tell its height where there is no storey."""

SUPPORTS: Final = (
    "IfcFooting",
    "IfcBuildingElementProxy",
    "IfcBuildingElementPart",
    "IfcCovering",
    "IfcPlate",
    "IfcRoof",
    "IfcRamp",
    "IfcProxy",
    "IfcGeographicElement",
)
"""Classes whose level tops are taken for the floor where there is neither slab nor space."""


@dataclass(frozen=True, slots=True)
class Ground:
    """A floor with what is cut out of it.

    Attributes:
        region: The floor, its holes filled; None where there was nothing to take it from.
        source: `slab`, `space`, `support`, or `inferred`.
        height_mm: Its height in the model.
        cuts: The holes.
        handles: GlobalIds of the elements whose tops it is.
    """

    region: Region | None
    source: str
    height_mm: float
    cuts: tuple[Cut, ...] = ()
    handles: frozenset[str] = frozenset()


def ground_of(site: Site, storey: Storey | None, asked_mm: float | None) -> Ground:
    """The floor of a storey; without a region if it has to be inferred from what stands on it.

    Args:
        site: The products.
        storey: The storey, or None if the model has none.
        asked_mm: Height of the floor given by the user, or None.

    Raises:
        EmptyPlanError: If nothing tells the height of a floor.
    """
    storey_mm = asked_mm
    if storey_mm is None:
        storey_mm = _usual_height_mm(site) if storey is None else storey.elevation_mm
    slabs = [product for product in site.products if is_or_is_part_of(product, "IfcSlab")]
    tops = site.tops(slabs, storey_mm - RANGE_MM, storey_mm + RANGE_MM)
    height_mm = storey_mm if asked_mm is not None else floor_height_mm(storey_mm, tops)
    if height_mm != storey_mm:
        site.notes.add(
            "floor-height",
            f"the storey lies at {storey_mm:g} mm but its slab's top at {height_mm:g} mm, which "
            "was used",
            "give --floor-z if another height is meant",
        )
    cuts = tuple(_cuts_of_bodiless(site, slabs, height_mm))
    level = at_height(tops, height_mm)
    if level:
        return _ground_by_tops(site, level, "slab", height_mm, cuts)
    spaces = _spaces(site, height_mm)
    if spaces is not None:
        return Ground(spaces, "space", height_mm, cuts)
    level = _supports(site, height_mm)
    if level:
        return _ground_by_tops(site, level, "support", height_mm, cuts)
    return Ground(None, "inferred", height_mm, cuts)


def _usual_height_mm(site: Site) -> float:
    """The height on which most walls and columns stand, else the top of the widest element."""
    uprights = site.extents_of(UPRIGHTS)
    others = site.extents_of(("IfcElement", "IfcProxy"))
    if uprights:
        bottoms = Counter(round(float(extent.least_mm[2])) for extent in uprights)
        height_mm = float(max(bottoms, key=lambda mm: (bottoms[mm], -mm)))
        reason = "where most walls and columns stand"
    elif others:
        widest = max(others, key=lambda e: float(np.prod((e.greatest_mm - e.least_mm)[:2])))
        height_mm = float(widest.greatest_mm[2])
        reason = "the top of the widest element"
    else:
        raise EmptyPlanError(
            "the model has no storey, and no wall or slab tells the height of a floor; give "
            "--floor-z"
        )
    site.notes.add(
        "no-storey",
        f"the model has no storey; the floor was looked for at {height_mm:g} mm, {reason}",
        "give --floor-z if another height is meant",
    )
    return height_mm


def _ground_by_tops(
    site: Site, level: Sequence[Top], source: str, height_mm: float, cuts: Sequence[Cut]
) -> Ground:
    region, joints_mm2 = floor_region(level)
    if joints_mm2:
        site.notes.add(
            "floor-joints",
            f"joints between pieces of the floor were closed: {joints_mm2 / MM2_PER_M2:.3f} m²",
            "check that the pieces of the floor meet",
        )
    handles = frozenset(top.handle for top in level)
    return Ground(region, source, height_mm, (*open_cuts(level), *cuts), handles)


def _cuts_of_bodiless(
    site: Site, slabs: Sequence[entity_instance], height_mm: float
) -> Iterator[Cut]:
    """Openings at the floor's height in slabs that have neither a body nor parts."""
    view = View(height_mm - 2 * RECESS_MM, height_mm - RECESS_MM, outward=True)
    for slab in slabs:
        if body_items(slab) or slab.IsDecomposedBy:
            continue
        for opening in openings_of(slab):
            site.begin(opening)
            try:
                shapes = site.reader.body(opening, view).in_band(view)
            except NoBodyError as error:
                site.notes.fail(opening, str(error))
                continue
            for shape in shapes:
                if not isinstance(shape, LineString):
                    yield Cut(shape, handle_of(opening), opening.is_a())


def _spaces(site: Site, height_mm: float) -> Region | None:
    """The union of the spaces that stand at a height and of the doorways between them."""
    view = View(height_mm + STEP_MM, height_mm + 2 * STEP_MM, outward=False)
    rooms: list[BaseGeometry] = []
    for space in sorted(site.model.by_type("IfcSpace"), key=handle_of):
        extent = site.reader.extent(space)
        if extent is not None and abs(extent.least_mm[2] - height_mm) > RANGE_MM:
            continue
        site.begin(space)
        try:
            shapes = site.reader.body(space, view).in_band(view)
        except NoBodyError:
            # a space is no obstacle; one without a body only bounds no floor
            continue
        rooms.extend(
            as_polygon(shape, outward=False)
            for shape in shapes
            if not isinstance(shape, LineString)
        )
    if not rooms:
        return None
    site.notes.add(
        "floor-from-spaces",
        f"no slab lies at the floor's height; {counted(len(rooms), 'space')} and the doorways "
        "between them were taken for the floor",
        "model the floor as IfcSlab",
    )
    return as_region(shapely.union_all([*rooms, *_doorways(site, view)]))


def _doorways(site: Site, view: View) -> Iterator[BaseGeometry]:
    """Where walls are open from the floor upwards, as far as the walls are thick."""
    for product in site.products:
        if not blocks(product, site.choice):
            continue
        try:
            standing = site.standing(product, view.low_mm, view.high_mm)
        except NoBodyError:
            continue
        if standing is not None:
            solid = standing.region().convex_hull
            for void in standing.body.voids:
                if void.spans(view.low_mm, view.high_mm):
                    yield as_polygon(void.region, outward=False).intersection(solid)


def _supports(site: Site, height_mm: float) -> list[Top]:
    """The level tops, at a height, of what may carry people although it is no slab."""
    products = []
    for product in site.products:
        extent = site.extents[product.id()]
        ends_there = extent is None or abs(extent.greatest_mm[2] - height_mm) <= STEP_MM
        if ends_there and any(product.is_a(name) for name in SUPPORTS):
            products.append(product)
    level = at_height(site.tops(products, height_mm - RANGE_MM, height_mm + RANGE_MM), height_mm)
    if level:
        classes = ", ".join(sorted({top.layer for top in level}))
        site.notes.add(
            "floor-from-supports",
            f"no slab and no space lies at the floor's height; the tops of {classes} were taken "
            "for the floor",
            "model the floor as IfcSlab",
        )
    return level
