"""What stands on the floor on layers whose names say nothing: obstacles, on the safe side."""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import shapely
from ezdxf.entities import LWPolyline, Polyline
from shapely.geometry import LineString
from shapely.geometry.base import BaseGeometry

from satAOI_adapters.dxf_read.clouds import is_cloud
from satAOI_adapters.dxf_read.crossed import crossed
from satAOI_adapters.dxf_read.features import Feature
from satAOI_adapters.dxf_read.loops import Loop, loops
from satAOI_adapters.dxf_read.obstacles import Standing, area_of
from satAOI_adapters.dxf_read.options import CLOSE_GAPS_MM
from satAOI_adapters.dxf_read.plans import rough_lines
from satAOI_adapters.dxf_read.rooms import rooms_among
from satAOI_adapters.dxf_read.shapes import TIE_MM, shapes_of
from satAOI_adapters.wording import are, counted
from satAOI_geo.plan import Finding, Frame, Kind, Obstacle, Region

PEN_MM: Final = 100.0
"""An open line no wider than this is drawn with a broad pen: a joint, the mark of a section."""

WHOLE: Final = 0.9
"""An outline around this share of the floor is a frame, not a thing on it."""

SAY_WHAT: Final = "say what the layer is in a file for --layers"

NAMELESS, CROSSED, ROOM = "unclassified", "crossed", "room-outline"
DASHED, CLOUD = "dashed", "revision-cloud"
"""What closed shapes are taken for, as findings call it."""

LEFT_OUT: Final = "unclassified-left-out"
"""What findings call lines and patterns that are left out."""

SAID: Final = {
    NAMELESS: (
        "closed shape",
        "taken for obstacles: the layer's name says nothing",
        SAY_WHAT,
    ),
    CROSSED: (
        "rectangle",
        "taken for openings, since diagonals cross there, and stop the robot",
        SAY_WHAT,
    ),
    ROOM: (
        "closed outline",
        "taken for rooms, not for obstacles, since walls or others run along there",
        f"{SAY_WHAT} if one of them is a pit or stops the robot",
    ),
    DASHED: (
        "dashed outline",
        "left out: things overhead or underground are drawn so",
        "draw them continuous, or name the layer in a file for --layers, if they stop the robot",
    ),
    CLOUD: (
        "outline",
        "taken for revision clouds, since made of bows, and left out",
        f"{SAY_WHAT} if they stop the robot",
    ),
}
"""What each sort of shape is called, what is said of it, and what the user can do."""


@dataclass(frozen=True, slots=True)
class Thing:
    """A closed shape on a layer without a meaning.

    Attributes:
        obstacle: As what it would stand on the floor.
        features: What draws it.
    """

    obstacle: Obstacle
    features: tuple[Feature, ...]

    @classmethod
    def of(cls, outline: Loop) -> "Thing":
        """An outline of several features, named after the first of them."""
        placed = outline.features[0].placed
        obstacle = Obstacle(outline.shape, Kind.UNCLASSIFIED, placed.layer, placed.handle)
        return cls(obstacle, outline.features)

    def is_on(self, floor: Region) -> bool:
        """Whether it lies on the floor and is not the frame around it."""
        region = self.obstacle.region()
        if not floor.intersects(region):
            return False
        shared_mm2 = floor.intersection(region).area
        return bool(0 < shared_mm2 < WHOLE * floor.area)

    def sort(self, dashed: frozenset[int]) -> str:
        """What it is taken for by its own look; a fill or a broad line is never more than a shape.

        Args:
            dashed: Identities of what is placed and dashed.
        """
        if any(feature.is_area or feature.width_mm for feature in self.features):
            return NAMELESS
        if all(id(feature.placed) in dashed for feature in self.features):
            return DASHED
        is_bowed = all(is_cloud(path) for feature in self.features for path in feature.paths)
        return CLOUD if is_bowed else NAMELESS


def unclassified(
    features: Sequence[Feature],
    floor: Region,
    known: Sequence[Obstacle],
    dashed: frozenset[int],
    frame: Frame,
) -> Standing:
    """Closed shapes on layers without a meaning, as far as they are on the floor.

    Patterns are left out, and so are revision clouds and outlines that are dashed or those of
    rooms. What is crossed by its diagonals is an opening, whatever it runs along.

    Args:
        features: What is drawn on these layers.
        floor: Of the plan.
        known: What stands there on layers with a meaning.
        dashed: Identities of what is placed and dashed.
        frame: Of all these.
    """
    shapely.prepare(floor)
    drawn = [_without_pen(feature) for feature in features]
    crosses = [cross for cross in _crosses(drawn, known, dashed) if Thing.of(cross).is_on(floor)]
    diagonals = {id(feature) for cross in crosses for feature in cross.features}
    drawn = [feature for feature in drawn if id(feature) not in diagonals]
    outlines = loops(drawn)
    closed = [*(thing for feature in drawn for thing in _closed(feature)), *map(Thing.of, outlines)]
    on_floor = [thing for thing in closed if thing.is_on(floor)]
    openings = [Thing.of(cross).obstacle for cross in crosses]
    sorts: defaultdict[str, list[Obstacle]] = defaultdict(list)
    for thing in _beside(openings, on_floor):
        sorts[thing.sort(dashed)].append(thing.obstacle)
    things = sorts.pop(NAMELESS, [])
    rooms = rooms_among(things, known)
    standing = [thing for i, thing in enumerate(things) if i not in rooms]
    in_outlines = {id(feature) for outline in outlines for feature in outline.features}
    loose = [feature for feature in drawn if id(feature) not in in_outlines and _is_open(feature)]
    sorts |= {NAMELESS: standing, CROSSED: openings, ROOM: [things[i] for i in sorted(rooms)]}
    found = [finding for code in SAID for finding in _found(code, sorts[code], frame)]
    findings = (*found, *_left_out(loose, floor, frame))
    return Standing((*standing, *openings), findings)


def _without_pen(feature: Feature) -> Feature:
    """An open line that a broad pen drew, as a line without width; all else as it is."""
    is_broad = feature.width_mm > PEN_MM + TIE_MM or any(path.closed for path in feature.paths)
    return feature if is_broad else replace(feature, width_mm=0.0)


def _crosses(
    drawn: Sequence[Feature], known: Sequence[Obstacle], dashed: frozenset[int]
) -> list[Loop]:
    """The signs for openings; a dashed cross is above the cut, as all that is dashed."""
    walls = [obstacle.region() for obstacle in known if obstacle.kind is Kind.WALL]
    return crossed([f for f in drawn if id(f.placed) not in dashed], drawn, walls)


def _beside(openings: Sequence[Obstacle], things: Iterable[Thing]) -> list[Thing]:
    """The things that do not lie wholly in openings."""
    inside = shapely.union_all([opening.region() for opening in openings]).buffer(CLOSE_GAPS_MM)
    shapely.prepare(inside)
    return [thing for thing in things if not inside.contains(thing.obstacle.region())]


def _is_open(feature: Feature) -> bool:
    """Whether a feature is a pattern or has open lines: neither counts as a thing."""
    if feature.is_area:
        return feature.is_pattern or _is_arrow(feature)
    return not feature.width_mm and not all(path.closed for path in feature.paths)


def _left_out(loose: Sequence[Feature], floor: Region, frame: Frame) -> list[Finding]:
    """What is to be said about lines and patterns, as far as they reach the floor."""
    drawn = rough_lines(loose)
    by_layer: defaultdict[str, dict[int, tuple[Feature, BaseGeometry]]] = defaultdict(dict)
    for i in np.flatnonzero(shapely.intersects(floor, drawn)).tolist():
        placed = loose[i].placed
        by_layer[placed.layer].setdefault(id(placed), (loose[i], drawn[i]))
    found = []
    for layer, entities in by_layer.items():
        n_patterns = sum(feature.is_pattern for feature, _ in entities.values())
        first, line = next(iter(entities.values()))
        found.append(
            Finding(
                LEFT_OUT,
                f"{_counted(len(entities) - n_patterns, n_patterns)} on layer '{layer}' on the "
                f"floor {are(len(entities))} left out: the layer's name says nothing",
                f"{SAY_WHAT} if they stop the robot",
                layer=layer,
                handle=first.placed.handle,
                at_mm=_place_mm(line, frame),
            )
        )
    return found


def _counted(n_lines: int, n_patterns: int) -> str:
    said = [(n_lines, "open line"), (n_patterns, "pattern")]
    return " and ".join(counted(count, what) for count, what in said if count)


def _closed(feature: Feature) -> list[Thing]:
    """The closed shapes of a feature; none of a pattern or a line."""
    placed = feature.placed
    if _is_open(feature) and feature.is_area:
        return []
    if feature.is_area or feature.width_mm:
        shapes = area_of(feature)
    else:
        shapes = [s for path in feature.paths if path.closed for s in shapes_of(path)]
    return [
        Thing(Obstacle(shape, Kind.UNCLASSIFIED, placed.layer, placed.handle), (feature,))
        for shape in shapes
        if not isinstance(shape, LineString)
    ]


def _is_arrow(feature: Feature) -> bool:
    """Whether a fill is a piece of an open polyline whose width varies, as arrows are drawn."""
    entity = feature.placed.entity
    return feature.is_area and isinstance(entity, LWPolyline | Polyline) and not entity.is_closed


def _found(code: str, things: Sequence[Obstacle], frame: Frame) -> list[Finding]:
    """A finding for each layer, with the handle and the place of the first thing on it."""
    by_layer: defaultdict[str, list[Obstacle]] = defaultdict(list)
    for thing in things:
        by_layer[thing.layer].append(thing)
    noun, said, remedy = SAID[code]
    return [
        Finding(
            code,
            f"{counted(len(on_layer), noun)} {_where(layer, on_layer)}, {are(len(on_layer))} "
            f"{said}",
            remedy,
            layer=layer,
            handle=on_layer[0].handle,
            at_mm=_place_mm(on_layer[0].region(), frame),
        )
        for layer, on_layer in by_layer.items()
    ]


def _where(layer: str, things: Sequence[Obstacle]) -> str:
    area_m2 = sum(thing.region().area for thing in things) / 1e6
    return f"on layer '{layer}', {area_m2:.2f} m² together"


def _place_mm(shape: BaseGeometry, frame: Frame) -> tuple[float, float]:
    """A spot in a shape, in the drawing's axes."""
    spot = shape.representative_point()
    x_mm, y_mm = frame.to_drawing_mm([(spot.x, spot.y)])[0]
    return float(x_mm), float(y_mm)
