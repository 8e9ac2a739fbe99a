"""What stands on the floor on layers whose names say nothing: obstacles, on the safe side."""

from collections import Counter, defaultdict
from collections.abc import Sequence
from typing import Final

import shapely
from shapely.geometry import LineString
from shapely.geometry.base import BaseGeometry

from satAOI_adapters.dxf_read.features import Feature
from satAOI_adapters.dxf_read.loops import Loop, loops
from satAOI_adapters.dxf_read.obstacles import Standing, area_of
from satAOI_adapters.dxf_read.plans import rough_lines
from satAOI_adapters.dxf_read.shapes import is_thin, shapes_of
from satAOI_geo.plan import Finding, Kind, Obstacle, Region, polygons_in

ROOM_MM: Final = 1000.0
"""An outline at least this wide may be that of a room."""

ALONG_MM: Final = 100.0
"""An outline this close to a wall or to another outline runs along it."""

MOSTLY: Final = 0.5
"""Share of an outline that must run along walls and other outlines to make it a room's."""

WHOLE: Final = 0.9
"""An outline around this share of the floor is a frame, not a thing on it."""


def unclassified(features: Sequence[Feature], floor: Region, known: Sequence[Obstacle]) -> Standing:
    """Closed shapes on layers without a meaning, as far as they are on the floor.

    Patterns are left out, and so are outlines of rooms: wide, and along walls or each other for
    half their length.
    """
    shapely.prepare(floor)
    outlines = loops(features)
    drawn = [*(t for feature in features for t in _closed(feature)), *map(_thing, outlines)]
    things = [thing for thing in drawn if _is_on(thing, floor)]
    rooms = _rooms(things, known)
    in_outlines = {id(feature) for outline in outlines for feature in outline.features}
    open_ones = [f for f in features if id(f) not in in_outlines and _is_open(f)]
    reaches = shapely.intersects(floor, rough_lines(open_ones))
    left_out = [feature for feature, does in zip(open_ones, reaches, strict=True) if does]
    standing = [thing for i, thing in enumerate(things) if i not in rooms]
    findings = [
        *_found(
            "unclassified",
            standing,
            "{count} closed shapes on layer '{layer}', {area:.2f} m² together, are taken as "
            "obstacles: the layer's name says nothing",
            "say what the layer is in a file for --layers",
        ),
        *_found(
            "room-outline",
            [things[i] for i in sorted(rooms)],
            "{count} closed outlines on layer '{layer}', {area:.2f} m² together, run along walls "
            "or each other and are taken as rooms, not as obstacles",
            "say what the layer is in a file for --layers",
        ),
        *_left_out(left_out),
    ]
    return Standing(tuple(standing), tuple(findings))


def _thing(outline: Loop) -> Obstacle:
    placed = outline.features[0].placed
    return Obstacle(outline.shape, Kind.UNCLASSIFIED, placed.layer, placed.handle)


def _counted(n_lines: int, n_patterns: int) -> str:
    said = [(n_lines, "open lines"), (n_patterns, "patterns")]
    return " and ".join(f"{count} {what}" for count, what in said if count)


def _is_open(feature: Feature) -> bool:
    """Whether a feature is a pattern or has open lines: neither counts as a thing."""
    return _is_pattern(feature) or (
        not feature.is_area and not feature.width_mm and not all(p.closed for p in feature.paths)
    )


def _left_out(features: Sequence[Feature]) -> list[Finding]:
    lines: Counter[str] = Counter()
    patterns: Counter[str] = Counter()
    for feature in features:
        (patterns if feature.is_area else lines)[feature.placed.layer] += 1
    return [
        Finding(
            "unclassified-left-out",
            f"{_counted(lines[layer], patterns[layer])} on layer '{layer}' on the floor are left "
            "out: the layer's name says nothing",
            "say what the layer is in a file for --layers if they stop the robot",
            layer=layer,
        )
        for layer in {**lines, **patterns}
    ]


def _closed(feature: Feature) -> list[Obstacle]:
    """The closed shapes of a feature; none of a pattern or a line."""
    placed = feature.placed
    if feature.is_area:
        shapes = [] if _is_pattern(feature) else area_of(feature)
    elif feature.width_mm:
        shapes = area_of(feature)
    else:
        shapes = [s for path in feature.paths if path.closed for s in shapes_of(path)]
    return [
        Obstacle(shape, Kind.UNCLASSIFIED, placed.layer, placed.handle)
        for shape in shapes
        if not isinstance(shape, LineString)
    ]


def _is_pattern(feature: Feature) -> bool:
    entity = feature.placed.entity
    return feature.is_area and feature.placed.kind == "HATCH" and not entity.dxf.solid_fill


def _is_on(thing: Obstacle, floor: Region) -> bool:
    """Whether a shape lies on the floor and is not the frame around it."""
    region = thing.region()
    if not floor.intersects(region):
        return False
    shared_mm2 = floor.intersection(region).area
    return bool(0 < shared_mm2 < WHOLE * floor.area)


def _rooms(things: Sequence[Obstacle], known: Sequence[Obstacle]) -> set[int]:
    """Which of the shapes are outlines of rooms."""
    wide = {
        i: thing.region()
        for i, thing in enumerate(things)
        if any(not is_thin(part, ROOM_MM) for part in polygons_in([thing.region()]))
    }
    walls = [obstacle.region() for obstacle in known if obstacle.kind is Kind.WALL]
    lines = [*walls, *(region.boundary for region in wide.values())]
    owners = [-1] * len(walls) + list(wide)
    tree = shapely.STRtree(lines)
    return {i for i, region in wide.items() if _runs_along(i, region, lines, owners, tree)}


def _runs_along(
    own: int,
    region: BaseGeometry,
    lines: Sequence[BaseGeometry],
    owners: Sequence[int],
    tree: shapely.STRtree,
) -> bool:
    rim = region.boundary
    near = [
        lines[i]
        for i in tree.query(rim, predicate="dwithin", distance=ALONG_MM)
        if owners[i] != own
    ]
    along = rim.intersection(shapely.union_all(near).buffer(ALONG_MM))
    return bool(along.length >= MOSTLY * rim.length)


def _found(code: str, things: Sequence[Obstacle], message: str, remedy: str) -> list[Finding]:
    counts = Counter(thing.layer for thing in things)
    areas_mm2: defaultdict[str, float] = defaultdict(float)
    for thing in things:
        areas_mm2[thing.layer] += thing.region().area
    return [
        Finding(
            code,
            message.format(count=count, layer=layer, area=areas_mm2[layer] / 1e6),
            remedy,
            layer=layer,
        )
        for layer, count in counts.items()
    ]
