"""What layers of floors show: outlines, fills, and loose lines that enclose."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from satAOI_adapters.dxf_read.curves import Point
from satAOI_adapters.dxf_read.features import Feature
from satAOI_adapters.dxf_read.linework import NEAR_MISS_MM, WALL_MM, Network, network
from satAOI_adapters.dxf_read.options import CLOSE_GAPS_MM
from satAOI_adapters.dxf_read.panels import Outline, Panels, nested, panels_of
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
from satAOI_adapters.wording import are, counted
from satAOI_geo.errors import DrawingError
from satAOI_geo.plan import Finding, Obstacle, Region, geometry_of, polygons_in


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


def shown_by(drawn: Sequence[Feature], obstacles: Sequence[Obstacle], terms: Terms) -> Shown:
    """What is drawn on floor layers shows.

    Args:
        drawn: What is on these layers, at least one thing.
        obstacles: At which tiles end.
        terms: The terms of the reading.
    """
    outlines: list[Outline] = []
    filled: list[BaseGeometry] = []
    lines: list[LineString] = []
    owners: list[Feature] = []
    curved: list[Polygon] = []
    for feature in drawn:
        if feature.is_area:
            filled.extend(_regions(feature))
            continue
        for path in feature.paths:
            if path.closed:
                outlines.extend(Outline(area, feature) for area in room(path))
            else:
                lines.append(middle_line(path))
                owners.append(feature)
                curved.extend(slivers(path))
    joined = network(lines, terms.gap_mm)
    panels = panels_of(joined, obstacles)
    outlines.extend(_drawn_loosely(panels, lines, owners, curved))
    areas, holes = nested(outlines)
    cut_out = tuple(hole.area for hole in holes)
    tiles = shapely.union_all(panels.tiles).difference(shapely.union_all(curved))
    # a fill of all the floor goes over its holes, too
    others = shapely.union_all([tiles, *filled]).difference(shapely.union_all(cut_out))
    return Shown(
        tuple(drawn),
        tidy(areas.union(others)),
        cut_out,
        joined,
        _cut_out(holes, terms),
        (*_no_tiles(panels.left_out, drawn[0]), *_joined_gaps(joined, drawn[0], terms)),
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
    return [geometry_of(shape) for shape in even_odd(feature.paths, outside=False)]


def _drawn_loosely(
    panels: Panels,
    lines: Sequence[LineString],
    owners: Sequence[Feature],
    curved: Sequence[Polygon],
) -> Iterator[Outline]:
    """The outlines that loose lines draw.

    Args:
        panels: What the lines enclose.
        lines: The lines.
        owners: What draws each.
        curved: Slivers around those that are curves: chords reach over curves that bulge inwards.
    """
    tree, bows = shapely.STRtree(lines), shapely.STRtree(curved)
    for group, around in panels.groups:
        at_rim = tree.query(around.exterior, predicate="dwithin", distance=CLOSE_GAPS_MM)
        near = bows.geometries[bows.query(around, predicate="intersects")]
        for area in polygons_in([around.difference(shapely.union_all(near))]):
            # chords and slivers leave crumbs between them
            if not is_thin(area, CLOSE_GAPS_MM):
                yield Outline(area, owners[min(at_rim)], group)


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


def _cut_out(holes: Sequence[Outline], terms: Terms) -> tuple[Finding, ...]:
    """What is to be said about outlines within others, the largest first."""
    if not holes:
        return ()
    largest = holes[0]
    area_m2 = shapely.union_all([hole.area for hole in holes]).area / 1e6
    return (
        said(
            "floor-hole",
            f"{counted(len(holes), 'outline')} within that of the floor, the largest on layer "
            f"'{largest.feature.placed.layer}', {area_m2:.2f} m² together, "
            f"{are(len(holes))} taken as hole or step, and {are(len(holes))} no floor",
            "draw what is level floor on another layer",
            largest.feature,
            terms.place(middle(largest.area)),
        ),
    )


def _no_tiles(left_out: Sequence[Polygon], feature: Feature) -> tuple[Finding, ...]:
    if not left_out:
        return ()
    area_m2 = sum(face.area for face in left_out) / 1e6
    return (
        Finding(
            "floor-without-tiles",
            f"{counted(len(left_out), 'space')} between the tiles of layer "
            f"'{feature.placed.layer}', {area_m2:.2f} m² together, {are(len(left_out))} much "
            "larger than a tile and taken as no floor",
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
            f"{counted(joined.n_joined, 'line end')} of the floor's outline joined over gaps of "
            f"up to {terms.gap_mm:g} mm",
            layer=feature.placed.layer,
        ),
    )
