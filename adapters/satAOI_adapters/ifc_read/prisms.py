"""Solids as stacks of upright prisms: what is in the way at a height, without a mesh.

    add  ┌────────────┐         a wall is one prism added,
         │   ┌────┐   │         its openings are prisms taken away,
         │   │ sub│   │         so what stands in a band of heights follows
    ─────┴───┴────┴───┴────     from plane regions alone

A representation item that is no such stack says so by `NotExactError`, and is meshed instead.
"""

import itertools
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import shapely
from ifcopenshell import entity_instance
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from satAOI_adapters.ifc_read.curves import circle_chain, polygon
from satAOI_adapters.ifc_read.placement import UP, axis_placement, mapping_matrix, unit_vector
from satAOI_adapters.ifc_read.profiles import NotExactError, Profile, Units, profile_of
from satAOI_geo.plan import Circle, FloatArray, polygons_in

UPRIGHT: Final = 1e-6
"""Sine of the lean up to which an axis counts as upright or level: 0.01 mm on 10 m."""

RECESS_MM: Final = 1.0
"""A cut in a face deeper than this is a hole; less is the rounding of the model."""

FAR_MM: Final = 1e7
"""Half the side of the square that stands for a half plane; wider than any building."""


@dataclass(frozen=True, slots=True)
class View:
    """What is looked at: heights from low to high, and the side on which curves are flattened.

    Solids are exact between these heights only; a roof that cuts a wall above them is left out.

    Attributes:
        low_mm: Least height in the model.
        high_mm: Greatest height.
        outward: Whether the solid must not shrink (an obstacle) or must not grow (a floor).
    """

    low_mm: float
    high_mm: float
    outward: bool


@dataclass(frozen=True, slots=True)
class Prism:
    """A plane region between two heights.

    Attributes:
        region: Its plan.
        bottom_mm: Least height.
        top_mm: Greatest height.
        handle: GlobalId of the opening it is, or an empty string.
        layer: The opening's class.
    """

    region: Polygon | Circle
    bottom_mm: float
    top_mm: float
    handle: str = ""
    layer: str = ""

    def overlaps(self, low_mm: float, high_mm: float) -> bool:
        """Whether some of it lies strictly between two heights."""
        return self.bottom_mm < high_mm and self.top_mm > low_mm

    def opens(self, height_mm: float) -> bool:
        """Whether, taken away, it opens a face at a height: from above or right through."""
        return self.bottom_mm < height_mm - RECESS_MM and self.top_mm > height_mm - RECESS_MM

    def spans(self, low_mm: float, high_mm: float) -> bool:
        """Whether it reaches over all of the heights from low to high."""
        return self.bottom_mm <= low_mm and self.top_mm >= high_mm


@dataclass(frozen=True, slots=True)
class Stack:
    """Prisms added, less prisms taken away."""

    adds: tuple[Prism, ...]
    subs: tuple[Prism, ...] = ()

    def less(self, subs: Iterable[Prism]) -> "Stack":
        """The stack with more taken away."""
        return replace(self, subs=(*self.subs, *subs))

    def in_band(self, view: View) -> list[Polygon | Circle]:
        """The plan of all that stands between the view's heights, exactly.

        Between two neighbouring heights at which a prism begins or ends nothing changes, so the
        union over these layers is the union over all heights.
        """
        low_mm, high_mm = view.low_mm, view.high_mm
        adds = [add for add in self.adds if add.overlaps(low_mm, high_mm)]
        subs = [sub for sub in self.subs if sub.overlaps(low_mm, high_mm)]
        if not subs:
            return [add.region for add in adds]
        heights_mm = {low_mm, high_mm}
        for prism in (*adds, *subs):
            heights_mm.update(h for h in (prism.bottom_mm, prism.top_mm) if low_mm < h < high_mm)
        ordered_mm = sorted(heights_mm)
        layers = [
            _layer(adds, subs, bottom_mm, top_mm, outward=view.outward)
            for bottom_mm, top_mm in itertools.pairwise(ordered_mm)
        ]
        return list(polygons_in([shapely.union_all(layers)]))


def _layer(
    adds: list[Prism], subs: list[Prism], low_mm: float, high_mm: float, *, outward: bool
) -> BaseGeometry:
    solid = [as_polygon(p.region, outward=outward) for p in adds if p.spans(low_mm, high_mm)]
    void = [as_polygon(p.region, outward=not outward) for p in subs if p.spans(low_mm, high_mm)]
    return shapely.difference(shapely.union_all(solid), shapely.union_all(void))


def as_polygon(region: Polygon | Circle, *, outward: bool) -> Polygon:
    """The region as a polygon; a circle's contains it (outward) or lies within it."""
    if isinstance(region, Circle):
        return polygon(circle_chain(region), (), outward=outward)
    return region


def stack_of(item: entity_instance, matrix: FloatArray, units: Units, view: View) -> Stack:
    """The stack of prisms that a representation item is between the view's heights.

    Args:
        item: An item of a body representation.
        matrix: Shape (4, 4), from the item's coordinates in mm to the model's.
        units: Of the model.
        view: Heights and side.

    Raises:
        NotExactError: If the item is no stack of upright prisms; the text says what it is.
    """
    reader = ITEMS.get(item.is_a())
    if reader is None:
        raise NotExactError(item.is_a())
    return reader(item, matrix, units, view)


def _extrusion(item: entity_instance, matrix: FloatArray, units: Units, view: View) -> Stack:
    placed = matrix @ axis_placement(item.Position, units.mm)
    along = unit_vector(item.ExtrudedDirection, UP)
    sweep_mm = placed[:3, :3] @ along * item.Depth * units.mm
    if not (np.isfinite(placed).all() and np.isfinite(sweep_mm).all()):
        raise NotExactError("IfcExtrudedAreaSolid that is not finite")
    profile = profile_of(item.SweptArea, units)
    if _is_upright(sweep_mm):
        return Stack((_upright_prism(profile, placed, sweep_mm[2], view),))
    return Stack((_lying_box(profile, placed, sweep_mm),))


def _is_upright(vector: FloatArray) -> bool:
    return math.hypot(vector[0], vector[1]) <= UPRIGHT * abs(float(vector[2]))


def _upright_prism(profile: Profile, placed: FloatArray, height_mm: float, view: View) -> Prism:
    if not _is_upright(placed[:3, 2]):
        raise NotExactError("IfcExtrudedAreaSolid with a slanting profile")
    region = profile.placed(placed[:2][:, (0, 1, 3)]).shape(outward=view.outward)
    ends_mm = (placed[2, 3], placed[2, 3] + height_mm)
    return Prism(region, min(ends_mm), max(ends_mm))


def _lying_box(profile: Profile, placed: FloatArray, sweep_mm: FloatArray) -> Prism:
    """A rectangle extruded sideways, as openings in walls are; one of its sides is upright."""
    if isinstance(profile.outer, Circle) or profile.holes or profile.outer[:, 2].any():
        raise NotExactError("IfcExtrudedAreaSolid that lies on its side")
    corners = np.column_stack((profile.outer[:, :2], np.zeros(len(profile.outer))))
    corners_mm = corners @ placed[:3, :3].T + placed[:3, 3]
    corners_mm = _without_straight_corners(corners_mm)
    if len(corners_mm) != 4:
        raise NotExactError("IfcExtrudedAreaSolid that lies on its side")
    sides_mm = np.roll(corners_mm, -1, axis=0) - corners_mm
    upright = [_is_upright(side) for side in sides_mm]
    level = [
        abs(side[2]) <= UPRIGHT * float(np.linalg.norm(side)) for side in (*sides_mm, sweep_mm)
    ]
    first = upright.index(True) if True in upright else 0
    if not (upright[first] and upright[first - 2] and level[first - 1] and level[4]):
        raise NotExactError("IfcExtrudedAreaSolid that slants")
    start_mm, along_mm = corners_mm[first, :2], -sides_mm[first - 1, :2]
    ring = [
        start_mm,
        start_mm + along_mm,
        start_mm + along_mm + sweep_mm[:2],
        start_mm + sweep_mm[:2],
    ]
    return Prism(Polygon(ring), float(corners_mm[:, 2].min()), float(corners_mm[:, 2].max()))


def _without_straight_corners(corners_mm: FloatArray) -> FloatArray:
    """The closed polygon's corners without those at which it does not turn."""
    before = corners_mm - np.roll(corners_mm, 1, axis=0)
    after = np.roll(corners_mm, -1, axis=0) - corners_mm
    turn_mm2 = np.linalg.norm(np.cross(before, after), axis=1)
    lengths_mm2 = np.linalg.norm(before, axis=1) * np.linalg.norm(after, axis=1)
    kept: FloatArray = corners_mm[turn_mm2 > UPRIGHT * lengths_mm2]
    return kept


def _mapped(item: entity_instance, matrix: FloatArray, units: Units, view: View) -> Stack:
    inner = matrix @ mapping_matrix(item, units.mm)
    items = item.MappingSource.MappedRepresentation.Items
    return merged([stack_of(part, inner, units, view) for part in items])


def merged(stacks: list[Stack]) -> Stack:
    """Several stacks as one.

    Raises:
        NotExactError: If what one takes away could lie in another.
    """
    if len(stacks) > 1 and any(stack.subs for stack in stacks):
        raise NotExactError("several solids with cuts of their own")
    return Stack(
        tuple(add for stack in stacks for add in stack.adds),
        tuple(sub for stack in stacks for sub in stack.subs),
    )


def _boolean(item: entity_instance, matrix: FloatArray, units: Units, view: View) -> Stack:
    if item.Operator != "DIFFERENCE":
        raise NotExactError(f"IfcBooleanResult ({item.Operator})")
    first = stack_of(item.FirstOperand, matrix, units, view)
    second = item.SecondOperand
    if second.is_a("IfcHalfSpaceSolid"):
        return _clipped(first, second, matrix, units, view)
    cut = stack_of(second, matrix, units, replace(view, outward=not view.outward))
    if cut.subs:
        raise NotExactError("IfcBooleanResult of a solid with cuts of its own")
    return first.less(cut.adds)


def _clipped(
    stack: Stack, half: entity_instance, matrix: FloatArray, units: Units, view: View
) -> Stack:
    """The stack less a half space, if that is plain to see between the view's heights."""
    plane = half.BaseSurface
    if not plane.is_a("IfcPlane"):
        raise NotExactError(f"{half.is_a()} behind {plane.is_a()}")
    placed = matrix @ axis_placement(plane.Position, units.mm)
    # the half space lies behind the plane if the flag is set, and it is what is taken away
    normal = placed[:3, 2] if half.AgreementFlag else -placed[:3, 2]
    offset_mm = float(normal @ placed[:3, 3])
    bounded = half.is_a() != "IfcHalfSpaceSolid"
    kept: list[Prism] = []
    for add in stack.adds:
        kept.extend(_clipped_prism(add, normal, offset_mm, view, bounded=bounded))
    return replace(stack, adds=tuple(kept))


def _clipped_prism(
    prism: Prism, normal: FloatArray, offset_mm: float, view: View, *, bounded: bool
) -> list[Prism]:
    low_mm, high_mm = max(prism.bottom_mm, view.low_mm), min(prism.top_mm, view.high_mm)
    if low_mm >= high_mm:
        return [prism]
    base = as_polygon(prism.region, outward=view.outward)
    corners_mm = np.array(base.exterior.coords)
    levels_mm = corners_mm @ normal[:2] - offset_mm
    depths_mm = np.concatenate((levels_mm + normal[2] * low_mm, levels_mm + normal[2] * high_mm))
    slack_mm = UPRIGHT * float(np.ptp(depths_mm))
    if depths_mm.min() >= -slack_mm:
        return [prism]
    if bounded:
        raise NotExactError("a body clipped at working height")
    if depths_mm.max() <= slack_mm:
        return []
    if abs(normal[2]) > UPRIGHT:
        raise NotExactError("a body clipped aslant at working height")
    kept = base.intersection(_half_plane(normal[:2], offset_mm))
    return [replace(prism, region=part) for part in polygons_in([kept])]


def _half_plane(normal: FloatArray, offset_mm: float) -> Polygon:
    """A large square on the side to which the normal points."""
    normal = normal / math.hypot(*normal)
    along = np.array((-normal[1], normal[0]))
    foot_mm = normal * offset_mm
    near, far = foot_mm, foot_mm + 2 * FAR_MM * normal
    return Polygon(
        [near - FAR_MM * along, far - FAR_MM * along, far + FAR_MM * along, near + FAR_MM * along]
    )


ITEMS: Final[dict[str, Callable[[entity_instance, FloatArray, Units, View], Stack]]] = {
    "IfcExtrudedAreaSolid": _extrusion,
    "IfcMappedItem": _mapped,
    "IfcBooleanResult": _boolean,
    "IfcBooleanClippingResult": _boolean,
}
"""Representation items that are read exactly."""
