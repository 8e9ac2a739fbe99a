"""The floor of a storey: where it is, how high it lies, and what is cut out of it."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import shapely
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from satAOI_adapters.ifc_read.bodies import Body
from satAOI_adapters.ifc_read.meshes import Mesh
from satAOI_adapters.ifc_read.prisms import Prism, Stack, as_polygon
from satAOI_geo.plan import Circle, Region, as_region, polygons_in

RANGE_MM: Final = 500.0
"""How far the top of a slab may be from the height of its storey: screeds, raised floors."""

STEP_MM: Final = 50.0
"""Tops within this height of the floor are floor: finishes, falls, wet rooms."""

THIN_MM: Final = 50.0
"""A slab thinner than this is a finish: it does not close the hole it covers."""

SHARE: Final = 0.1
"""A storey's own height is kept if this share of the largest floor area lies at it."""

JOINT_MM: Final = 20.0
"""Gaps between pieces of floor up to this width are joints: floor."""

JOINT_NOISE_MM2: Final = 100.0
"""Joints of less area in all are rounding."""


@dataclass(frozen=True, slots=True)
class Cut:
    """A hole in a slab."""

    region: Polygon | Circle
    handle: str
    layer: str


@dataclass(frozen=True, slots=True)
class Top:
    """A level face that could be floor.

    Attributes:
        region: The face with its holes filled.
        height_mm: Its height.
        thickness_mm: Of the body under it.
        cuts: Its holes, and what else is cut out of it.
        handle: GlobalId of the slab.
        layer: Its class.
    """

    region: BaseGeometry
    height_mm: float
    thickness_mm: float
    cuts: tuple[Cut, ...]
    handle: str
    layer: str


def tops_of(body: Body, handle: str, layer: str) -> list[Top]:
    """The level faces of a slab, read so that it does not grow; its GlobalId and class."""
    tops = [
        _stack_top(stack, prism, handle, layer) for stack in body.stacks for prism in stack.adds
    ]
    for mesh in body.meshes:
        tops.extend(_mesh_tops(mesh, body.voids, handle, layer))
    return tops


def _stack_top(stack: Stack, prism: Prism, handle: str, layer: str) -> Top:
    face = as_polygon(prism.region, outward=False)
    cuts = [Cut(Polygon(ring), handle, layer) for ring in face.interiors]
    cuts.extend(
        Cut(sub.region, sub.handle or handle, sub.layer or layer)
        for sub in stack.subs
        if sub.opens(prism.top_mm)
    )
    return Top(
        region=Polygon(face.exterior),
        height_mm=prism.top_mm,
        thickness_mm=prism.top_mm - prism.bottom_mm,
        cuts=tuple(cuts),
        handle=handle,
        layer=layer,
    )


def _mesh_tops(mesh: Mesh, voids: Sequence[Prism], handle: str, layer: str) -> list[Top]:
    low_mm, high_mm = mesh.heights_mm()
    tops = []
    for height_mm, face in mesh.level_faces():
        filled = shapely.union_all([Polygon(part.exterior) for part in polygons_in([face])])
        cuts = [
            Cut(hole, *_owner(hole, voids, handle, layer))
            for hole in polygons_in([filled.difference(face)])
        ]
        tops.append(Top(filled, height_mm, high_mm - low_mm, tuple(cuts), handle, layer))
    return tops


def _owner(hole: Polygon, voids: Sequence[Prism], handle: str, layer: str) -> tuple[str, str]:
    """GlobalId and class of the opening that a hole in a mesh is, or of the slab itself."""
    point = hole.representative_point()
    for void in voids:
        if as_polygon(void.region, outward=True).covers(point):
            return void.handle, void.layer
    return handle, layer


def floor_height_mm(storey_mm: float, tops: Iterable[Top]) -> float:
    """The height of a storey's floor: that of the slabs near it with the most area.

    The storey's own height is kept where a fair share of the floor lies at it.
    """
    near = [top for top in tops if abs(top.height_mm - storey_mm) <= RANGE_MM]
    if not near:
        return storey_mm
    heights_mm = np.array([top.height_mm for top in near])
    areas_mm2 = np.array([top.region.area for top in near])

    def area_at_mm2(height_mm: float) -> float:
        return float(areas_mm2[np.abs(heights_mm - height_mm) <= STEP_MM].sum())

    # on equal areas the nearest height wins
    best_mm = max(heights_mm, key=lambda h: (area_at_mm2(h), -abs(h - storey_mm)))
    if area_at_mm2(storey_mm) >= SHARE * area_at_mm2(best_mm):
        return storey_mm
    return float(best_mm)


def at_height(tops: Iterable[Top], height_mm: float) -> list[Top]:
    """The faces that are floor at a height."""
    return [top for top in tops if abs(top.height_mm - height_mm) <= STEP_MM]


def floor_region(tops: Sequence[Top]) -> tuple[Region, float]:
    """The union of faces, joints between them closed, and the area of those joints in mm²."""
    union = shapely.union_all([top.region for top in tops])
    closed = closing(union, JOINT_MM)
    joints = closed.difference(union)
    if isinstance(union, Polygon) and joints.area <= JOINT_NOISE_MM2:
        # leave a plain slab's corners as they are, to the last digit
        return union, 0.0
    joined = as_region(union.union(closed))
    return joined, float(joints.area) if joints.area > JOINT_NOISE_MM2 else 0.0


def closing(region: BaseGeometry, gap_mm: float) -> BaseGeometry:
    """The region with gaps up to a width filled; corners stay corners."""
    grown = region.buffer(gap_mm / 2, join_style="mitre")
    return grown.buffer(-gap_mm / 2, join_style="mitre")


def open_cuts(tops: Sequence[Top]) -> list[Cut]:
    """The holes of faces, less what another slab of some thickness fills."""
    cuts: list[Cut] = []
    for top in tops:
        others = [o for o in tops if o is not top and o.thickness_mm > THIN_MM]
        for cut in top.cuts:
            cuts.extend(_unfilled(cut, others))
    return cuts


def _unfilled(cut: Cut, others: Sequence[Top]) -> list[Cut]:
    region = as_polygon(cut.region, outward=True)
    fillers = [_net(top) for top in others if top.region.intersects(region)]
    filled = shapely.union_all(fillers).intersection(region)
    if filled.area <= JOINT_NOISE_MM2:
        return [cut]
    return [
        Cut(part, cut.handle, cut.layer)
        for part in polygons_in([region.difference(filled)])
        if part.area > JOINT_NOISE_MM2
    ]


def _net(top: Top) -> BaseGeometry:
    """A face less its cuts."""
    return top.region.difference(
        shapely.union_all([as_polygon(cut.region, outward=True) for cut in top.cuts])
    )
