"""Trenches and the like drawn open: what lines enclose only with walls or the floor's edge.

A trench from wall to wall is two lines; nothing closes its ends but the walls. Seen from the lines
alone, the floor between two such trenches looks the same. What tells them apart is the width: a
trench is no wider than `WIDEST_MM`, and what has narrower trenches on both of its sides is floor.
"""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import shapely
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from satAOI_adapters.dxf_read.curves import Path
from satAOI_adapters.dxf_read.expand import Placed
from satAOI_adapters.dxf_read.linework import network
from satAOI_adapters.dxf_read.obstacles import COVERED_MM, MOSTLY, Standing, outlines_of
from satAOI_adapters.dxf_read.options import CLOSE_GAPS_MM
from satAOI_adapters.dxf_read.plans import Drawn
from satAOI_adapters.dxf_read.shapes import GeometryArray, band, is_thin, middle_line
from satAOI_adapters.dxf_read.terms import Terms
from satAOI_adapters.meanings import KINDS
from satAOI_adapters.wording import are, counted
from satAOI_geo.plan import BoolArray, Finding, FloatArray, Kind, Obstacle, Region, polygons_in

WIDEST_MM: Final = {
    Kind.HOLE: 1500.0,
    Kind.EQUIPMENT: 700.0,
    Kind.COLUMN: 1500.0,
    Kind.EMBEDDED: 700.0,
}
"""Widest space between lines of a kind that is solid; between gutters or rails lies floor."""

KERB_MM: Final = 250.0
"""Lines no farther apart may be the wall or the frame of a trench, not a trench of its own."""

KERBED_MM: Final = 1500.0
"""Widest trench that has kerbs; farther apart they are gutters, and between them lies floor."""

NARROWER: Final = 0.9
"""A trench has less than this share of the width of the floor beside it."""

BETWEEN: Final = 0.75
"""A space lies between trenches if they are beyond this share of its lines: on both sides."""

OPEN: Final = 0.1
"""Share of the rim of a space that open lines must be; more than a line that ends at it."""

LOOSE: Final = 0.5
"""A line of which more than this share bounds nothing is said; ends may go on beyond a space."""

PLACE_MM: Final = 1.0
"""How exactly the widest place of a space is looked for."""


@dataclass(frozen=True, slots=True)
class Stroke:
    """An open line on a layer of things that stop the robot.

    Attributes:
        line: The line; of one with a width its outline.
        kind: What it is drawn as.
        placed: The entity it comes from.
        is_band: Whether it has a width.
    """

    line: LineString
    kind: Kind
    placed: Placed
    is_band: bool


@dataclass(frozen=True, slots=True)
class Space:
    """What may be a trench.

    Attributes:
        region: The space.
        rim: As much of its rim as lines on layers of such things are.
        width_mm: The diameter of the largest disc in it.
        owner: The stroke that is the longest part of its rim.
    """

    region: Polygon
    rim: BaseGeometry
    width_mm: float
    owner: Stroke


def trenches(drawn: Drawn, known: Sequence[Obstacle], floor: Region, terms: Terms) -> Standing:
    """What open lines of columns, holes and the like enclose with whatever else stands there.

    A space is solid where at least half of its rim is such lines, and the rest are walls, other
    solids or the edge of the floor. Lines that enclose nothing stay lines, and are said.

    Args:
        drawn: What is drawn, by its meaning.
        known: What is known to stand there.
        floor: Where the robot may be.
        terms: The terms of the reading.
    """
    strokes = _strokes(drawn)
    lines = np.array([stroke.line for stroke in strokes])
    # else a line with a width would count as a solid that covers its own outline
    bands = {stroke.placed.handle for stroke in strokes if stroke.is_band}
    others = [obstacle for obstacle in known if obstacle.handle not in bands]
    is_covered = _covered(lines, others)
    is_open = shapely.intersects(floor, lines) & ~is_covered
    if not is_open.any():
        return Standing(())
    near = _near(lines[is_open], known)
    faces = _faces(lines[is_open], near, floor, terms)
    beside_mm = 2 * terms.gap_mm + COVERED_MM
    open_ones = [strokes[i] for i in np.flatnonzero(is_open)]
    spaces = _spaces(faces, open_ones, lines[is_covered], beside_mm)
    obstacles = _solid(spaces, _near(lines[is_open], others), beside_mm)
    on_floor = shapely.intersection(lines[is_open], floor)
    bounded = _solid_parts([*known, *obstacles])
    bounding_nothing_mm = shapely.length(shapely.difference(on_floor, bounded))
    is_loose = bounding_nothing_mm > LOOSE * shapely.length(on_floor)
    loose = [open_ones[i] for i in np.flatnonzero(is_loose)]
    return Standing(obstacles, (*_filled(obstacles, terms), *_left_open(loose, terms)))


def _strokes(drawn: Drawn) -> list[Stroke]:
    return [
        Stroke(line, kind, feature.placed, is_band=feature.width_mm > 0)
        for meaning, kind in KINDS.items()
        if kind in WIDEST_MM
        for feature in drawn[meaning]
        if not feature.is_area
        for path in feature.paths
        if not path.closed
        for line in _lines(path, feature.width_mm)
    ]


def _lines(path: Path, width_mm: float) -> list[LineString]:
    if not width_mm:
        return [middle_line(path)]
    return [LineString(polygon.exterior.coords) for polygon in band(path, width_mm)]


def _covered(lines: GeometryArray, obstacles: Sequence[Obstacle]) -> BoolArray:
    """Which of the lines add nothing to the solids among obstacles."""
    return np.asarray(shapely.covers(_solid_parts(obstacles), lines), dtype=np.bool_)


def _solid_parts(obstacles: Sequence[Obstacle]) -> BaseGeometry:
    """Where the solids among obstacles are, and what is drawn along them."""
    solid = shapely.union_all([o.region() for o in obstacles if _is_solid(o)])
    grown: BaseGeometry = solid.buffer(COVERED_MM)
    shapely.prepare(grown)
    return grown


def _is_solid(obstacle: Obstacle) -> bool:
    """Whether an obstacle is more than a line: a curve without width is a sliver that holds it."""
    region = obstacle.region()
    return bool(region.area > CLOSE_GAPS_MM * region.length)


def _near(lines: GeometryArray, known: Sequence[Obstacle]) -> list[Obstacle]:
    """What may close a trench between the lines, without the lines themselves."""
    others = [o for o in known if _is_solid(o) or o.kind not in WIDEST_MM]
    tree = shapely.STRtree([obstacle.region() for obstacle in others])
    widest_mm = max(WIDEST_MM.values())
    _, near = tree.query(lines, predicate="dwithin", distance=widest_mm)
    return [others[i] for i in np.unique(near)]


def _solid(
    spaces: Iterable[Space], near: Sequence[Obstacle], beside_mm: float
) -> tuple[Obstacle, ...]:
    """The spaces that do not lie between trenches, narrow ones first."""
    standing = [obstacle.region() for obstacle in near if obstacle.kind in WIDEST_MM]
    narrow = [(_width_mm(region), region) for region in standing]
    found: list[Obstacle] = []
    for space in sorted(spaces, key=lambda space: space.width_mm):
        beyond = [region for width_mm, region in narrow if _is_beside(width_mm, space.width_mm)]
        trenches_beyond = shapely.union_all(beyond).buffer(beside_mm)
        if space.rim.intersection(trenches_beyond).length <= BETWEEN * space.rim.length:
            placed = space.owner.placed
            found.append(Obstacle(space.region, space.owner.kind, placed.layer, placed.handle))
            narrow.append((space.width_mm, space.region))
    return tuple(found)


def _is_beside(trench_mm: float, space_mm: float) -> bool:
    """Whether what is as wide as this may be a trench beside a space of floor of that width."""
    may_be_kerb = trench_mm <= KERB_MM and space_mm <= KERBED_MM
    return trench_mm < NARROWER * space_mm and not may_be_kerb


def _spaces(
    faces: Sequence[Polygon],
    strokes: Sequence[Stroke],
    covered: GeometryArray,
    beside_mm: float,
) -> Iterator[Space]:
    """The faces that strokes enclose for half of their rim at least, as wide as they may be.

    Args:
        faces: What lines and other things enclose.
        strokes: The open lines.
        covered: Lines that solids cover; a cover between two bays of a trench, of which one ends
            at the wall.
        beside_mm: What is this close to a line is at it.
    """
    tree = shapely.STRtree([stroke.line for stroke in strokes])
    tree_of_covered = shapely.STRtree(covered)
    for face in faces:
        touching = tree.query(face, predicate="dwithin", distance=beside_mm)
        at_strokes = _along(face, tree.geometries[touching], beside_mm)
        if at_strokes.sum() < OPEN * face.exterior.length:
            continue
        others = tree_of_covered.query(face, predicate="dwithin", distance=beside_mm)
        drawn = shapely.union_all([*tree.geometries[touching], *covered[others]])
        rim = face.exterior.intersection(drawn.buffer(beside_mm))
        # of equally long ones that of the wider kind, whichever was drawn first
        owner, _ = max(
            zip((strokes[i] for i in touching), at_strokes, strict=True),
            key=lambda one: (round(one[1]), WIDEST_MM[one[0].kind]),
        )
        is_enclosed = rim.length >= MOSTLY * face.exterior.length
        if is_enclosed and is_thin(face, WIDEST_MM[owner.kind]):
            yield Space(face, rim, _width_mm(face), owner)


def _along(face: Polygon, lines: GeometryArray, beside_mm: float) -> FloatArray:
    """How long each of some lines runs along the rim of a face."""
    at_lines = shapely.intersection(face.exterior, shapely.buffer(lines, beside_mm))
    return np.asarray(shapely.length(at_lines), dtype=np.float64)


def _faces(
    lines: GeometryArray, near: Sequence[Obstacle], floor: Region, terms: Terms
) -> list[Polygon]:
    """What lines, obstacles and the edge of the floor cut the floor into, where nothing stands."""
    edges = [LineString(r.coords) for f in polygons_in([floor]) for r in (f.exterior, *f.interiors)]
    drawn = [o.shape for o in near if isinstance(o.shape, LineString)]
    faces = network([*lines, *outlines_of(near), *drawn, *edges], terms.gap_mm).faces()
    free = floor.difference(shapely.union_all([o.region() for o in near if _is_solid(o)]))
    shapely.prepare(free)
    return [
        face
        for face, is_free in zip(
            faces, shapely.contains(free, shapely.point_on_surface(faces)), strict=True
        )
        # what is left between a curve and its chords is no space
        if is_free
        and face.area > CLOSE_GAPS_MM * face.length
        and is_thin(face, max(WIDEST_MM.values()))
    ]


def _width_mm(region: BaseGeometry) -> float:
    """The diameter of the largest disc in a region."""
    return 2 * float(shapely.maximum_inscribed_circle(region, tolerance=PLACE_MM).length)


def _filled(obstacles: Sequence[Obstacle], terms: Terms) -> Iterator[Finding]:
    by_layer: defaultdict[str, list[Obstacle]] = defaultdict(list)
    for obstacle in obstacles:
        by_layer[obstacle.layer].append(obstacle)
    for layer, own in by_layer.items():
        largest = max(own, key=lambda obstacle: obstacle.region().area)
        spot = largest.region().representative_point()
        x_mm, y_mm = terms.place((spot.x, spot.y))
        area_m2 = sum(obstacle.region().area for obstacle in own) / 1e6
        yield Finding(
            "trench-filled",
            f"{counted(len(own), 'space')} between open lines of layer '{layer}', {area_m2:.2f} m² "
            "together, closed by walls, other solids or the edge of the floor and nowhere wider "
            f"than {WIDEST_MM[largest.kind]:g} mm, {are(len(own))} taken as solid "
            f"({largest.kind}), the largest at ({x_mm:.1f}, {y_mm:.1f}) mm",
            "if one of them is free floor, draw what stands beside it as closed outlines",
            layer=layer,
            handle=largest.handle,
            at_mm=(x_mm, y_mm),
        )


def _left_open(strokes: Sequence[Stroke], terms: Terms) -> Iterator[Finding]:
    by_layer: defaultdict[str, list[Stroke]] = defaultdict(list)
    for stroke in strokes:
        by_layer[stroke.placed.layer].append(stroke)
    for layer, own in by_layer.items():
        longest = max(own, key=lambda stroke: stroke.line.length)
        ends = [longest.line.coords[0], longest.line.coords[-1]]
        start_mm, end_mm = terms.frame.to_drawing_mm(ends)
        yield Finding(
            "lines-open",
            f"{counted(len(own), 'open line')} on layer '{layer}' ({longest.kind}), with "
            "nothing enclosed that can be told from floor: the robot is stopped where they are "
            f"drawn, not beside them; the longest runs from ({start_mm[0]:.1f}, "
            f"{start_mm[1]:.1f}) to ({end_mm[0]:.1f}, {end_mm[1]:.1f}) mm",
            "close the outline in the drawing, or give --close-gaps if it ends short of a wall, "
            "if the robot must keep out of what is beside it",
            layer=layer,
            handle=longest.placed.handle,
            at_mm=(float(start_mm[0]), float(start_mm[1])),
        )
