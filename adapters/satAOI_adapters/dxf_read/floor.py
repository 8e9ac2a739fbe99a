"""The floor: as drawn on its layer, or inferred from the walls around it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import shapely
from shapely.geometry import LineString, Polygon, box
from shapely.geometry.base import BaseGeometry

from satAOI_adapters.dxf_read.enclosure import OPENING_MM, enclosed
from satAOI_adapters.dxf_read.features import Feature
from satAOI_adapters.dxf_read.linework import Network, network
from satAOI_adapters.dxf_read.obstacles import outlines_of
from satAOI_adapters.dxf_read.options import CLOSE_GAPS_MM
from satAOI_adapters.dxf_read.shapes import even_odd, is_thin, middle_line, room, slivers, tidy
from satAOI_adapters.dxf_read.terms import Terms
from satAOI_geo.errors import DrawingError, EmptyPlanError
from satAOI_geo.plan import (
    Circle,
    Finding,
    Kind,
    Obstacle,
    Region,
    as_region,
)

MANY_TILES: Final = 20
"""So many faces between loose lines of a floor layer are tiles, or panels of a slab."""

TILES_WIDE: Final = 3.0
"""A face in which a disc as wide as so many tiles fits is no tile: a pool, a void."""

BOUNDING: Final = frozenset({Kind.WALL, Kind.COLUMN})
"""Obstacles that an inferred floor reaches out to; a machine outdoors does not bound it."""


@dataclass(frozen=True, slots=True)
class Floor:
    """The floor and how it is known.

    Attributes:
        region: In the plan's frame.
        source: `layer` or `inferred`.
        findings: What is to be said about it.
    """

    region: Region
    source: str
    findings: tuple[Finding, ...] = ()


def floor_of(
    drawn: Sequence[Feature],
    obstacles: Sequence[Obstacle],
    sills: Sequence[LineString],
    terms: Terms,
) -> Floor:
    """The floor of a plan.

    Args:
        drawn: What is on floor layers.
        obstacles: What bounds the floor where no layer does.
        sills: Lines across openings, which close them.
        terms: The terms of the reading.

    Raises:
        DrawingError: If the outline on a floor layer is not closed.
        EmptyPlanError: If there is nothing on a floor layer and nothing is enclosed by walls.
    """
    floor = _drawn(drawn, obstacles, terms) if drawn else _inferred(obstacles, sills, terms)
    if terms.region_mm is None:
        return floor
    region = tidy(floor.region.intersection(box(*terms.region_mm)))
    return replace(floor, region=region)


def nested(polygons: Sequence[Polygon]) -> Region:
    """Outlines of one layer as areas: one inside another is a hole in it, and so on inwards."""
    area: BaseGeometry = Polygon()
    for polygon in sorted(polygons, key=lambda outline: outline.area, reverse=True):
        # what lies wholly in the area cuts a hole into it, anything else adds to it
        cuts = polygon.area > 0 and area.buffer(CLOSE_GAPS_MM).contains(polygon)
        area = area.difference(polygon) if cuts else area.union(polygon)
    return as_region(area)


def _drawn(drawn: Sequence[Feature], obstacles: Sequence[Obstacle], terms: Terms) -> Floor:
    outlines: list[Polygon] = []
    filled: list[BaseGeometry] = []
    lines: list[LineString] = []
    curved: list[Polygon] = []
    for feature in drawn:
        if feature.is_area:
            filled.extend(_regions(feature))
            continue
        for path in feature.paths:
            if path.closed:
                outlines.extend(room(path))
            else:
                lines.append(middle_line(path))
                curved.extend(slivers(path))
    joined = network(lines, terms.gap_mm)
    panels, left_out = _panels(joined, obstacles)
    # chords reach over curves that bulge inwards
    loops = shapely.union_all(panels).difference(shapely.union_all(curved))
    region = as_region(shapely.union_all([nested(outlines), loops, *filled]))
    if region.is_empty:
        raise _open_outline(drawn[0], joined, terms)
    neat = tidy(region)
    return Floor(
        neat, "layer", (*_no_tiles(left_out, drawn[0]), *_joined_gaps(joined, drawn[0], terms))
    )


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


def _inferred(obstacles: Sequence[Obstacle], sills: Sequence[LineString], terms: Terms) -> Floor:
    region = enclosed([*(o.region() for o in obstacles if o.kind in BOUNDING), *sills])
    if not region.is_empty:
        area_m2 = region.area / 1e6
        return Floor(
            region,
            "inferred",
            (
                Finding(
                    "floor-inferred",
                    f"no layer shows the floor: it is what the walls enclose, {area_m2:.2f} m² "
                    f"with them, openings of up to {OPENING_MM / 1000:g} m closed",
                    "draw its outline on a layer FLOOR",
                ),
            ),
        )
    if terms.region_mm is not None:
        return Floor(box(*terms.region_mm), "inferred", (_of_region(),))
    if not terms.is_named:
        raise EmptyPlanError(
            "no layer shows the floor, and the lines enclose nothing with openings of up to "
            f"{OPENING_MM / 1000:g} m closed; draw the floor's outline on a layer FLOOR, or name "
            "its layer in a file for --layers, or give the part to read with --region"
        )
    return _guessed([o.region() for o in obstacles])


def _of_region() -> Finding:
    return Finding(
        "floor-region",
        "no layer shows the floor and the walls in the region do not enclose any: all of the "
        "region counts as floor",
        "draw the floor's outline on a layer FLOOR",
    )


def _guessed(regions: Sequence[BaseGeometry]) -> Floor:
    """The hull of all obstacles: better than nothing, and said."""
    hull = shapely.union_all(regions).convex_hull
    if not isinstance(hull, Polygon):
        raise EmptyPlanError(
            "the drawing holds no floor and nothing that could enclose one; draw the floor's "
            "outline on a layer FLOOR"
        )
    return Floor(
        tidy(hull),
        "inferred",
        (
            Finding(
                "floor-guessed",
                "no layer shows the floor and the walls do not enclose any: it is guessed as what "
                f"a taut string around all obstacles would hold, {hull.area / 1e6:.2f} m²; where "
                "it really ends is not known",
                "draw its outline on a layer FLOOR, or give the part to read with --region",
            ),
        ),
    )


def _open_outline(feature: Feature, joined: Network, terms: Terms) -> DrawingError:
    placed = feature.placed
    ends = [end for end, _ in joined.loose]
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
