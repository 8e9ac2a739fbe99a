"""What outlines on floor layers enclose: floors, holes in them, panels and tiles.

An outline within another is a hole, whether it is drawn closed or by loose lines. Lines that reach
the outline they lie in, or hang together with it, are joints: what is between them is floor.

    ┌──────┬──────┐   ┌─────────────┐
    │      │      │   │   ┌───┐     │
    ├──────┼──────┤   │   │ × │     │    × is a hole
    └──────┴──────┘   └───┴───┴─────┘  ← on the edge it would be a panel
"""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Final, TypeAlias

import numpy as np
import shapely
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from satAOI_adapters.dxf_read.features import Feature
from satAOI_adapters.dxf_read.groups import linked
from satAOI_adapters.dxf_read.linework import Network, network
from satAOI_adapters.dxf_read.obstacles import outlines_of
from satAOI_adapters.dxf_read.options import CLOSE_GAPS_MM
from satAOI_adapters.dxf_read.shapes import is_thin
from satAOI_geo.plan import Obstacle, Region, as_region, polygons_in

MANY_TILES: Final = 20
"""So many faces between loose lines of a floor layer are tiles, or panels of a slab."""

TILES_WIDE: Final = 3.0
"""A face in which a disc as wide as so many tiles fits is no tile: a pool, a void."""


Group: TypeAlias = tuple[LineString, ...]
"""Lines that hang together."""


@dataclass(frozen=True, slots=True)
class Outline:
    """An outline on a floor layer.

    Attributes:
        area: What it encloses.
        feature: What draws it, or a part of it.
        lines: The loose lines that draw it, and all that hang together with them; None for one
            that is drawn closed.
    """

    area: Polygon
    feature: Feature
    lines: BaseGeometry | None = None

    def reaches(self, rim: BaseGeometry) -> bool:
        """Whether it is one of panels that go up to a rim."""
        return self.lines is not None and bool(self.lines.dwithin(rim, CLOSE_GAPS_MM))


@dataclass(frozen=True, slots=True)
class Layer:
    """What an outline adds to the floor, or cuts out of it."""

    area: BaseGeometry
    is_hole: bool


@dataclass(frozen=True, slots=True)
class Panels:
    """What loose lines on floor layers enclose.

    Attributes:
        groups: For each group of lines that hang together, these and what they enclose in all.
        tiles: What is between the lines where they are those of many tiles.
        left_out: What is much larger than a tile there.
    """

    groups: tuple[tuple[BaseGeometry, Polygon], ...]
    tiles: tuple[Polygon, ...] = ()
    left_out: tuple[Polygon, ...] = ()


def nested(outlines: Sequence[Outline]) -> tuple[Region, list[Outline]]:
    """Outlines as areas: one inside another is a hole in it, and so on inwards.

    Returns:
        The areas, and the outlines that cut holes, the largest first.
    """
    ordered = sorted(outlines, key=lambda outline: outline.area.area, reverse=True)
    tree = shapely.STRtree([outline.area for outline in ordered])
    laid: dict[int, Layer] = {}
    for i, outline in enumerate(ordered):
        near = tree.query(outline.area, predicate="dwithin", distance=CLOSE_GAPS_MM)
        larger = [j for j in sorted(near.tolist()) if j in laid]
        if not any(_is_copy(outline.area, ordered[j].area) for j in larger):
            rims = [ordered[j].area.exterior for j in larger if not laid[j].is_hole]
            laid[i] = _laid(outline, [laid[j] for j in larger], rims)
    holes = [ordered[i] for i, layer in laid.items() if layer.is_hole]
    return as_region(_seen(laid.values())), holes


def _laid(outline: Outline, below: Sequence[Layer], rims: Sequence[BaseGeometry]) -> Layer:
    """What an outline does to those it lies on: it adds to them, or cuts a hole into them.

    Args:
        outline: The outline.
        below: The larger ones near it.
        rims: Of those of them that are no holes.
    """
    if any(map(outline.reaches, rims)):
        cut_out = shapely.union_all([layer.area for layer in below if layer.is_hole])
        return Layer(outline.area.difference(cut_out), is_hole=False)
    # what lies wholly in the area cuts a hole into it, anything else adds to it
    is_within = _seen(below).buffer(CLOSE_GAPS_MM).contains(outline.area)
    return Layer(outline.area, is_hole=bool(is_within) and outline.area.area > 0)


def _seen(layers: Iterable[Layer]) -> BaseGeometry:
    """What layers, each over those before it, leave of the floor."""
    seen: BaseGeometry = Polygon()
    for is_hole, run in groupby(layers, key=lambda layer: layer.is_hole):
        area = shapely.union_all([layer.area for layer in run])
        seen = seen.difference(area) if is_hole else seen.union(area)
    return seen


def _is_copy(polygon: Polygon, other: Polygon) -> bool:
    """Whether two outlines, of which the other is the larger, are drawn one over the other."""
    is_as_large = other.area - polygon.area <= other.length * CLOSE_GAPS_MM
    return is_as_large and bool(polygon.buffer(CLOSE_GAPS_MM).contains(other))


def panels_of(joined: Network, obstacles: Sequence[Obstacle]) -> Panels:
    """What loose lines on floor layers enclose.

    Args:
        joined: The lines.
        obstacles: At which tiles end.
    """
    groups = [(group, replace(joined, lines=group).faces()) for group in _together(joined.lines)]
    # a face by itself has no neighbour to be a tile beside
    grids = [(group, faces) for group, faces in groups if len(faces) != 1]
    if sum(len(faces) for _, faces in grids) < MANY_TILES:
        return Panels(tuple(_around(groups)))
    alone = [(group, faces) for group, faces in groups if len(faces) == 1]
    tiles, left_out = _tiles([line for group, _ in grids for line in group], grids, obstacles)
    return Panels(tuple(_around(alone)), tuple(tiles), tuple(left_out))


def _together(lines: Sequence[LineString]) -> list[Group]:
    """The lines that hang together."""
    if not lines:
        return []
    touching = shapely.STRtree(lines).query(lines, predicate="dwithin", distance=CLOSE_GAPS_MM)
    groups: defaultdict[int, list[LineString]] = defaultdict(list)
    for line, number in zip(lines, linked(touching.T, len(lines)).tolist(), strict=True):
        groups[number].append(line)
    return [tuple(group) for group in groups.values()]


def _around(
    groups: Sequence[tuple[Group, Sequence[Polygon]]],
) -> Iterator[tuple[BaseGeometry, Polygon]]:
    """What groups of lines enclose in all: their faces together."""
    for group, faces in groups:
        lines = shapely.union_all(group)
        for part in polygons_in([shapely.union_all(faces)]):
            yield lines, Polygon(part.exterior)


def _tiles(
    joints: Sequence[LineString],
    grids: Sequence[tuple[Group, Sequence[Polygon]]],
    obstacles: Sequence[Obstacle],
) -> tuple[list[Polygon], list[Polygon]]:
    """The tiles between joints, and what these leave out.

    Tiles end at walls: these close the faces along them.
    """
    sizes_mm2 = [face.area for _, faces in grids for face in faces]
    widest_mm = TILES_WIDE * float(np.median(sizes_mm2)) ** 0.5
    walls = [
        *outlines_of(obstacles),
        *(o.shape for o in obstacles if isinstance(o.shape, LineString)),
    ]
    cut = network([*joints, *walls]).faces()
    tree = shapely.STRtree(joints)
    near, _ = tree.query([f.boundary for f in cut], predicate="dwithin", distance=CLOSE_GAPS_MM)
    faces = [cut[i] for i in np.unique(near)]
    tiles = [face for face in faces if is_thin(face, widest_mm)]
    return tiles, [face for face in faces if not is_thin(face, widest_mm)]
