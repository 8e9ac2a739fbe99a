"""Features as obstacles: solids by kind, walls from whatever draughtsmen draw as walls."""

import math
from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import shapely
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from satAOI_adapters.dxf_read.curves import Path
from satAOI_adapters.dxf_read.features import Feature
from satAOI_adapters.dxf_read.linework import (
    WALL_MM,
    Network,
    network,
    with_wall_ends,
    with_wall_ends_at,
)
from satAOI_adapters.dxf_read.options import CLOSE_GAPS_MM
from satAOI_adapters.dxf_read.shapes import (
    band,
    by_chords,
    even_odd,
    is_thin,
    is_wide,
    middle_lines,
    rounded,
    shapes_of,
    slivers,
    traces,
)
from satAOI_adapters.dxf_read.swings import LEAST_LEAF_MM
from satAOI_adapters.dxf_read.terms import Terms
from satAOI_adapters.wording import are, counted
from satAOI_geo.plan import Circle, Finding, Kind, Obstacle, Shape, geometry_of, polygons_in

COVERED_MM: Final = 1e-3
"""A line this close to a solid adds nothing to it."""

THICK_MM: Final = 1500.0
"""Widest space between lines on wall layers that is a wall where no door leads in."""

MOSTLY: Final = 0.5
"""Share of its rim that has walls beyond it where a space lies between walls, not in one."""

AT_DOOR_MM: Final = 100.0
"""A door, shut, is no farther from the space that it leads to."""


@dataclass(frozen=True, slots=True)
class Standing:
    """What stands on the floor, and what is to be said about it."""

    obstacles: tuple[Obstacle, ...]
    findings: tuple[Finding, ...] = ()


def solids(features: Sequence[Feature], kind: Kind, terms: Terms) -> Standing:
    """Columns, holes and the like: what is drawn closed, or as lines that close, is solid."""
    obstacles: list[Obstacle] = []
    open_paths: defaultdict[str, list[tuple[Path, Feature]]] = defaultdict(list)
    for feature in features:
        if feature.is_area or feature.width_mm:
            obstacles.extend(_obstacles(area_of(feature), kind, feature))
            continue
        for path in feature.paths:
            if path.closed:
                obstacles.extend(_obstacles(shapes_of(path), kind, feature))
            else:
                open_paths[feature.placed.layer].append((path, feature))
    findings: list[Finding] = []
    for layer, paths in open_paths.items():
        standing = _loops(layer, paths, kind, terms)
        obstacles.extend(standing.obstacles)
        findings.extend(standing.findings)
    return Standing(tuple(obstacles), tuple(findings))


def walls(
    features: Sequence[Feature],
    columns: Sequence[Obstacle],
    floor_edges: Sequence[LineString],
    doors: Sequence[LineString],
    terms: Terms,
) -> Standing:
    """Walls from fills, bands, outlines and lines.

    A closed outline no wider than a wall is solid. A wider one is the face of a wall around a
    room, and only its line counts; a pattern twice as wide is that of a room's floor. The space
    between faces is filled where it is closed and nowhere wider than a wall; on layers that are
    named as walls also where it is twice as wide, lies between rooms and no door is drawn at it.
    A room never is.

    Args:
        features: What is drawn on wall layers.
        columns: Obstacles that walls may end at.
        floor_edges: Outlines of the floor, which may be the outer faces of walls.
        doors: The lines of doors.
        terms: The terms of the reading.
    """
    obstacles, lines, patterns = _sorted(features)
    left_out = tuple(_wide_patterns(patterns, terms))
    if not lines:
        return Standing(tuple(obstacles), left_out)
    outlines = outlines_of([*obstacles, *columns])
    drawn_lines = middle_lines(path for path, _ in lines)
    joined = with_wall_ends(network([*drawn_lines, *outlines], terms.gap_mm))
    known = shapely.union_all([solid.region() for solid in (*obstacles, *columns)])
    spaces = _spaces(joined.faces(), THICK_MM if terms.is_named else WALL_MM, known)
    thin = [space for space in spaces if is_thin(space, WALL_MM)]
    wider = [space for space in spaces if not is_thin(space, WALL_MM)]
    thick = _without_doors(_between_rooms(wider, shapely.union_all([known, *thin])), doors)
    if floor_edges:
        # between a wall and the edge of the floor anything wider may be a terrace
        at_edges = with_wall_ends_at(joined, floor_edges).lines
        thin = _spaces(network(at_edges, terms.gap_mm).faces(), WALL_MM, known)
    inside = _insides([*thin, *thick], lines)
    drawn = [o for path, feature in lines for o in _obstacles(traces(path), Kind.WALL, feature)]
    findings = (
        *left_out,
        *_wide_outlines(lines, thick),
        *_filled(thin),
        *_thick(thick, terms),
        *_gaps("walls", joined, terms),
    )
    return Standing((*obstacles, *drawn, *inside), findings)


def _sorted(
    features: Sequence[Feature],
) -> tuple[list[Obstacle], list[tuple[Path, Feature]], list[tuple[Shape, Feature]]]:
    """What on wall layers is solid by itself, the lines besides, and patterns of rooms."""
    obstacles: list[Obstacle] = []
    lines: list[tuple[Path, Feature]] = []
    patterns: list[tuple[Shape, Feature]] = []
    for feature in features:
        if feature.is_area or feature.width_mm:
            shapes = area_of(feature)
            wide = [
                s for s in shapes if feature.is_pattern and not is_thin(geometry_of(s), THICK_MM)
            ]
            patterns.extend((shape, feature) for shape in wide)
            solid = [shape for shape in shapes if shape not in wide]
            obstacles.extend(_obstacles(solid, Kind.WALL, feature))
            continue
        for path in feature.paths:
            is_narrow = path.closed and not is_wide(path, WALL_MM)
            shapes = shapes_of(path) if is_narrow else []
            if shapes and all(_is_wall_thick(shape) for shape in shapes):
                obstacles.extend(_obstacles(shapes, Kind.WALL, feature))
            else:
                lines.append((path, feature))
    if not lines and not obstacles:
        # walls drawn by nothing but wide patterns are what these cover
        patterns, obstacles = [], [o for s, f in patterns for o in _obstacles([s], Kind.WALL, f)]
    return obstacles, lines, patterns


def area_of(feature: Feature) -> list[Shape]:
    """What a fill or a line with a width covers; lines where it covers nothing."""
    if feature.width_mm:
        return [polygon for path in feature.paths for polygon in band(path, feature.width_mm)]
    covered: list[Shape] = list(even_odd(feature.paths))
    return covered or [trace for path in feature.paths for trace in traces(path)]


def _loops(layer: str, paths: Sequence[tuple[Path, Feature]], kind: Kind, terms: Terms) -> Standing:
    """Loose lines of one layer: what they enclose is solid, the rest are lines."""
    lines = middle_lines(path for path, _ in paths)
    joined = network(lines, terms.gap_mm)
    faces = joined.faces()
    tree = shapely.STRtree(faces)
    # curves bulge out of the polygons that their chords enclose
    curves = [s for path, _ in paths for s in slivers(path)]
    bulges = [s for s in curves if tree.query(s, predicate="intersects").size]
    enclosed = rounded(polygons_in([shapely.union_all([*faces, *bulges])]))
    nearest = shapely.STRtree(lines).nearest(enclosed)
    obstacles = [
        Obstacle(Polygon(face.exterior), kind, layer, paths[i][1].placed.handle)
        for face, i in zip(enclosed, nearest, strict=True)
    ]
    grown = shapely.STRtree(shapely.buffer(enclosed, COVERED_MM))
    covered, _ = grown.query(lines, predicate="covered_by")
    for i in np.setdiff1d(np.arange(len(lines)), covered):
        path, feature = paths[i]
        obstacles.extend(_obstacles(traces(path), kind, feature))
    # an arrow on a stair misses nothing
    solid = shapely.union_all(enclosed)
    gaps = tuple(gap for gap in joined.gaps if not solid.contains(LineString((gap.start, gap.end))))
    return Standing(tuple(obstacles), _gaps(f"layer '{layer}'", replace(joined, gaps=gaps), terms))


def _spaces(faces: Sequence[Polygon], widest_mm: float, known: BaseGeometry) -> list[Polygon]:
    """The faces between lines that are nowhere wider than this, less those known to be solid."""
    shapely.prepare(known)
    is_known = shapely.contains(known, shapely.point_on_surface(faces))
    is_crumb = shapely.area(faces) < CLOSE_GAPS_MM**2
    return [
        face
        for face, is_out in zip(faces, is_known | is_crumb, strict=True)
        if not is_out and is_thin(face, widest_mm)
    ]


def _between_rooms(spaces: Sequence[Polygon], walls: BaseGeometry) -> list[Polygon]:
    """The spaces that have no walls around them, as closets and shafts have."""
    around = walls.buffer(CLOSE_GAPS_MM)
    shapely.prepare(around)
    return [
        space
        for space in spaces
        if space.boundary.intersection(around).length <= MOSTLY * space.boundary.length
    ]


def _without_doors(spaces: Sequence[Polygon], doors: Sequence[LineString]) -> list[Polygon]:
    """The spaces along which no door is drawn."""
    tree = shapely.STRtree(doors)
    closed = []
    for space in spaces:
        rim = space.boundary.buffer(AT_DOOR_MM)
        near = tree.geometries[tree.query(rim, predicate="intersects")]
        if shapely.length(shapely.intersection(near, rim)).max(initial=0.0) < LEAST_LEAF_MM:
            closed.append(space)
    return closed


def _insides(spaces: Sequence[Polygon], lines: Sequence[tuple[Path, Feature]]) -> list[Obstacle]:
    """The insides of walls that are drawn by their faces, as obstacles."""
    nearest = shapely.STRtree(middle_lines(path for path, _ in lines)).nearest(spaces)
    owners = [lines[i][1].placed for i in nearest]
    return [
        Obstacle(face, Kind.WALL, placed.layer, placed.handle)
        for face, placed in zip(spaces, owners, strict=True)
    ]


def _is_wall_thick(shape: Shape) -> bool:
    if isinstance(shape, Circle):
        return 2 * shape.radius_mm <= WALL_MM
    return isinstance(shape, LineString) or is_thin(shape, WALL_MM)


def outlines_of(obstacles: Iterable[Obstacle]) -> list[LineString]:
    """The outlines of solids as lines that walls may end at."""
    return [
        LineString(ring.coords)
        for obstacle in obstacles
        if not isinstance(obstacle.shape, LineString)
        for polygon in polygons_in([obstacle.region()])
        for ring in (polygon.exterior, *polygon.interiors)
    ]


def _obstacles(shapes: Iterable[Shape], kind: Kind, feature: Feature) -> list[Obstacle]:
    placed = feature.placed
    return [Obstacle(shape, kind, placed.layer, placed.handle) for shape in shapes]


def _wide_outlines(
    lines: Sequence[tuple[Path, Feature]], thick: Sequence[Polygon]
) -> Iterable[Finding]:
    tree = shapely.STRtree(thick)
    wide = Counter(
        feature.placed.layer
        for path, feature in lines
        if path.closed and not tree.query(by_chords(path).point_on_surface(), "within").size
    )
    for layer, count in wide.items():
        yield Finding(
            "wide-outline",
            f"{count} closed outlines on wall layer '{layer}' are wider than {WALL_MM:g} mm: "
            "their lines stop the robot, what they enclose counts as floor",
            "draw solid parts filled (HATCH, SOLID) or on a column layer",
            layer=layer,
        )


def _wide_patterns(patterns: Sequence[tuple[Shape, Feature]], terms: Terms) -> Iterable[Finding]:
    if patterns:
        regions = [geometry_of(shape) for shape, _ in patterns]
        area_m2 = float(shapely.area(shapely.union_all(regions))) / 1e6
        spot = regions[0].representative_point()
        x_mm, y_mm = terms.place((spot.x, spot.y))
        placed = patterns[0][1].placed
        yield Finding(
            "wide-pattern",
            f"patterns on wall layers that are wider than {THICK_MM:g} mm, {area_m2:.2f} m² "
            f"together, the first at ({x_mm:.1f}, {y_mm:.1f}) mm, are taken as those of rooms: "
            "they are left out",
            "fill what is a wall (HATCH of pattern SOLID)",
            layer=placed.layer,
            handle=placed.handle,
            at_mm=(x_mm, y_mm),
        )


def _filled(thin: Sequence[Polygon]) -> Iterable[Finding]:
    if thin:
        yield Finding(
            "wall-filled",
            f"{counted(len(thin), 'closed space')} between wall lines, {_area_m2(thin):.2f} m² "
            f"together and nowhere wider than {WALL_MM:g} mm, {are(len(thin))} taken for the "
            "insides of walls",
            "draw walls filled or as closed outlines if one of them is free floor",
        )


def _thick(thick: Sequence[Polygon], terms: Terms) -> Iterable[Finding]:
    if thick:
        spot = thick[0].representative_point()
        x_mm, y_mm = terms.place((spot.x, spot.y))
        yield Finding(
            "wall-thick",
            f"{counted(len(thick), 'closed space')} between wall lines, {_area_m2(thick):.2f} m² "
            f"together, {WALL_MM:g} to {THICK_MM:g} mm wide and without a door, "
            f"{are(len(thick))} taken for thick walls, the first at ({x_mm:.1f}, {y_mm:.1f}) mm",
            "break the wall lines at the door if one of them is a room",
            at_mm=(x_mm, y_mm),
        )


def _area_m2(spaces: Sequence[Polygon]) -> float:
    return float(shapely.area(spaces).sum()) / 1e6


def _gaps(what: str, joined: Network, terms: Terms) -> tuple[Finding, ...]:
    """What was joined and what was left open, on one layer or among all walls."""
    findings = []
    if joined.n_joined:
        findings.append(
            Finding(
                "gap-closed",
                f"{joined.n_joined} line ends of {what} were joined over gaps of up to "
                f"{terms.gap_mm:g} mm",
            )
        )
    for gap in joined.gaps:
        start_mm, end_mm = terms.frame.to_drawing_mm((gap.start, gap.end))
        findings.append(
            Finding(
                "gap-open",
                f"lines of {what} miss each other by {gap.width_mm:.1f} mm, from "
                f"({start_mm[0]:.1f}, {start_mm[1]:.1f}) to ({end_mm[0]:.1f}, {end_mm[1]:.1f}) mm",
                "if they were meant to meet, join them in the drawing or give --close-gaps "
                f"{math.ceil(gap.width_mm)}",
                at_mm=(float(start_mm[0]), float(start_mm[1])),
            )
        )
    return tuple(findings)
