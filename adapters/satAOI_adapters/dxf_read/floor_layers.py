"""What layers of floors show: outlines, fills, and loose lines that enclose."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import shapely
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from satAOI_adapters.dxf_read.curves import Point
from satAOI_adapters.dxf_read.features import Feature
from satAOI_adapters.dxf_read.linework import NEAR_MISS_MM, WALL_MM, Network, network
from satAOI_adapters.dxf_read.obstacles import outlines_of
from satAOI_adapters.dxf_read.options import CLOSE_GAPS_MM
from satAOI_adapters.dxf_read.shapes import (
    by_chords,
    even_odd,
    is_thin,
    middle_line,
    room,
    slivers,
    tidy,
)
from satAOI_adapters.dxf_read.terms import Terms
from satAOI_geo.errors import DrawingError
from satAOI_geo.plan import Circle, Finding, Obstacle, Region, as_region

MANY_TILES: Final = 20
"""So many faces between loose lines of a floor layer are tiles, or panels of a slab."""

TILES_WIDE: Final = 3.0
"""A face in which a disc as wide as so many tiles fits is no tile: a pool, a void."""


@dataclass(frozen=True, slots=True)
class Shown:
    """What floor layers show.

    Attributes:
        features: All that is drawn on them.
        region: What that encloses or fills; empty where it does neither.
        holes: Outlines that are cut out of it.
        joined: The loose lines.
        cut_out: What is to be said about the holes.
        findings: What is to be said about the rest.
    """

    features: tuple[Feature, ...]
    region: Region
    holes: tuple[Polygon, ...]
    joined: Network
    cut_out: tuple[Finding, ...]
    findings: tuple[Finding, ...]

    @property
    def first(self) -> Feature:
        """The first thing drawn on them."""
        return self.features[0]

    @property
    def layers(self) -> str:
        """The names of the layers."""
        names = sorted({feature.placed.layer for feature in self.features})
        return ", ".join(f"'{name}'" for name in names)


def nested(polygons: Sequence[Polygon]) -> tuple[Region, list[Polygon]]:
    """Outlines as areas: one inside another is a hole in it, and so on inwards.

    Returns:
        The areas, and the outlines that cut holes.
    """
    area: BaseGeometry = Polygon()
    drawn: list[Polygon] = []
    holes: list[Polygon] = []
    for polygon in sorted(polygons, key=lambda outline: outline.area, reverse=True):
        if any(_is_copy(polygon, other) for other in drawn):
            continue
        drawn.append(polygon)
        # what lies wholly in the area cuts a hole into it, anything else adds to it
        if polygon.area > 0 and area.buffer(CLOSE_GAPS_MM).contains(polygon):
            area = area.difference(polygon)
            holes.append(polygon)
        else:
            area = area.union(polygon)
    return as_region(area), holes


def _is_copy(polygon: Polygon, other: Polygon) -> bool:
    """Whether two outlines, of which the other is the larger, are drawn one over the other."""
    is_as_large = other.area - polygon.area <= other.length * CLOSE_GAPS_MM
    return is_as_large and bool(polygon.buffer(CLOSE_GAPS_MM).contains(other))


def shown_by(drawn: Sequence[Feature], obstacles: Sequence[Obstacle], terms: Terms) -> Shown:
    """What is drawn on floor layers shows.

    Args:
        drawn: What is on these layers, at least one thing.
        obstacles: At which tiles end.
        terms: The terms of the reading.
    """
    outlines: list[tuple[Polygon, Feature]] = []
    filled: list[BaseGeometry] = []
    lines: list[LineString] = []
    curved: list[Polygon] = []
    for feature in drawn:
        if feature.is_area:
            filled.extend(_regions(feature))
            continue
        for path in feature.paths:
            if path.closed:
                outlines.extend((outline, feature) for outline in room(path))
            else:
                lines.append(middle_line(path))
                curved.extend(slivers(path))
    joined = network(lines, terms.gap_mm)
    panels, left_out = _panels(joined, obstacles)
    # chords reach over curves that bulge inwards
    loops = shapely.union_all(panels).difference(shapely.union_all(curved))
    areas, holes = nested([outline for outline, _ in outlines])
    owners = {id(outline): feature for outline, feature in outlines}
    return Shown(
        tuple(drawn),
        tidy(shapely.union_all([areas, loops, *filled])),
        tuple(holes),
        joined,
        _cut_out(holes, owners, terms),
        (*_no_tiles(left_out, drawn[0]), *_joined_gaps(joined, drawn[0], terms)),
    )


def outer_edges(drawn: Sequence[Feature]) -> list[LineString]:
    """The outlines on floor layers that may be the outer faces of walls.

    Outlines with nothing but a wall between them are those of single rooms, and one no wider than
    a wall is that of a threshold: they would make walls of doorways.
    """
    paths = [path for feature in drawn for path in feature.paths if path.closed]
    areas = np.array([by_chords(path) for path in paths], dtype=object)
    if not paths:
        return []
    one, other = shapely.STRtree(areas).query(areas, predicate="dwithin", distance=WALL_MM)
    is_apart = shapely.distance(areas[one], areas[other]) > NEAR_MISS_MM
    of_rooms = set(one[is_apart].tolist())
    return [
        middle_line(path)
        for i, (path, area) in enumerate(zip(paths, areas, strict=True))
        if i not in of_rooms and not is_thin(area, WALL_MM)
    ]


def _regions(feature: Feature) -> list[BaseGeometry]:
    return [
        shape.polygon() if isinstance(shape, Circle) else shape
        for shape in even_odd(feature.paths, outside=False)
    ]


def _panels(joined: Network, obstacles: Sequence[Obstacle]) -> tuple[list[Polygon], list[Polygon]]:
    """What loose lines on a floor layer enclose: panels, and what tiles leave out.

    Tiles end at walls: these close the faces along them.
    """
    faces = joined.faces()
    if len(faces) < MANY_TILES:
        return faces, []
    widest_mm = TILES_WIDE * float(np.median([face.area for face in faces])) ** 0.5
    walls = [
        *outlines_of(obstacles),
        *(o.shape for o in obstacles if isinstance(o.shape, LineString)),
    ]
    joints = shapely.STRtree(joined.lines)
    cut = network([*joined.lines, *walls]).faces()
    near, _ = joints.query([f.boundary for f in cut], predicate="dwithin", distance=CLOSE_GAPS_MM)
    faces = [cut[i] for i in np.unique(near)]
    tiles = [face for face in faces if is_thin(face, widest_mm)]
    return tiles, [face for face in faces if not is_thin(face, widest_mm)]


def open_outline(shown: Shown, terms: Terms) -> DrawingError:
    """Why no floor comes of layers that enclose nothing."""
    placed = shown.first.placed
    ends = [end for end, _ in shown.joined.loose]
    if len(ends) < 2:
        return DrawingError(
            f"layer '{placed.layer}' should show the floor's outline, but encloses nothing; "
            "draw it as a closed polyline",
            layer=placed.layer,
            handle=placed.handle,
        )
    start_mm, end_mm = terms.frame.to_drawing_mm(ends[:2])
    gap_mm = float(np.hypot(*(end_mm - start_mm)))
    return DrawingError(
        f"the floor's outline on layer '{placed.layer}' is open: its ends at ({start_mm[0]:.1f}, "
        f"{start_mm[1]:.1f}) and ({end_mm[0]:.1f}, {end_mm[1]:.1f}) mm are {gap_mm:.1f} mm apart; "
        "close it in the drawing",
        layer=placed.layer,
        handle=placed.handle,
        at_mm=(float(start_mm[0]), float(start_mm[1])),
    )


def only_lines(shown: Shown) -> DrawingError:
    """Why no floor comes of layers that hold nothing but the lines of a plan."""
    placed = shown.first.placed
    return DrawingError(
        f"{shown.layers} should show the floor by name, but what is drawn there encloses nothing "
        f"wider than {WALL_MM:g} mm; draw the floor's outline on a layer FLOOR, or say in a file "
        "for --layers what the layer is",
        layer=placed.layer,
        handle=placed.handle,
    )


def said(code: str, message: str, remedy: str, feature: Feature, at_mm: Point) -> Finding:
    """What is to be said about something drawn on floor layers."""
    placed = feature.placed
    return Finding(code, message, remedy, layer=placed.layer, handle=placed.handle, at_mm=at_mm)


def middle(part: Polygon) -> Point:
    """A point well inside a part of the plan."""
    spot = part.representative_point()
    return spot.x, spot.y


def _cut_out(
    holes: Sequence[Polygon], owners: Mapping[int, Feature], terms: Terms
) -> tuple[Finding, ...]:
    """What is to be said about outlines within others.

    Args:
        holes: These outlines, the largest first.
        owners: Whose each is, by its identity.
        terms: The terms of the reading.
    """
    if not holes:
        return ()
    owner = owners[id(holes[0])]
    return (
        said(
            "floor-hole",
            f"{len(holes)} outlines within that of the floor, the largest on layer "
            f"'{owner.placed.layer}', {shapely.union_all(holes).area / 1e6:.2f} m² together, are "
            "taken as holes or steps, and are no floor",
            "draw what is level floor on another layer",
            owner,
            terms.place(middle(holes[0])),
        ),
    )


def _no_tiles(left_out: Sequence[Polygon], feature: Feature) -> tuple[Finding, ...]:
    if not left_out:
        return ()
    area_m2 = sum(face.area for face in left_out) / 1e6
    return (
        Finding(
            "floor-without-tiles",
            f"{len(left_out)} spaces between the tiles of layer '{feature.placed.layer}', "
            f"{area_m2:.2f} m² together, are much larger than a tile and taken as no floor",
            "draw the floor's outline as a closed polyline on a layer FLOOR",
            layer=feature.placed.layer,
        ),
    )


def _joined_gaps(joined: Network, feature: Feature, terms: Terms) -> tuple[Finding, ...]:
    if not joined.n_joined:
        return ()
    return (
        Finding(
            "gap-closed",
            f"{joined.n_joined} line ends of the floor's outline were joined over gaps of up to "
            f"{terms.gap_mm:g} mm",
            layer=feature.placed.layer,
        ),
    )
