"""Loose lines as a network: ends joined over small gaps, and the faces that lines enclose.

Nothing here moves an obstacle. The joined copies serve to find what is enclosed; the lines
themselves stay where they were drawn.
"""

import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

import numpy as np
import shapely
from shapely.geometry import LineString, Polygon
from shapely.geometry import Point as Spot

from satAOI_adapters.dxf_read.curves import Point
from satAOI_adapters.dxf_read.groups import Spots
from satAOI_adapters.dxf_read.options import CLOSE_GAPS_MM
from satAOI_adapters.dxf_read.shapes import SAME_MM, TIE_MM, GeometryArray, rounded
from satAOI_geo.plan import IntArray, polygons_in

NEAR_MISS_MM: Final = 50.0
"""Ends this close were perhaps meant to meet: reported, left open."""

OVERSHOOT_MM: Final = 0.01
"""How far an end is led beyond the line it should meet, so that the two surely cross."""

WALL_MM: Final = 700.0
"""Widest space between lines of a wall layer that is taken as the inside of a wall.

Few walls are thicker, and a room narrower than this takes in no robot of a usual size.
"""

PARALLEL: Final = 0.02
"""Greatest sine of the angle between the two faces of one wall: about one degree."""

OVER_EACH_OTHER: Final = 1e-3
"""Greatest sine of the angle between lines that are drawn one over the other."""

BACK: Final = 4.0
"""So many gaps back along a line, what is still no farther than a gap beside it is its copy."""

SQUARE: Final = 0.85
"""Greatest cosine of the angle between a wall and its end: 32° to 148°."""


@dataclass(frozen=True, slots=True)
class Gap:
    """Two line ends, or an end and a line, that do not meet."""

    start: Point
    end: Point

    @property
    def width_mm(self) -> float:
        """How far they are apart."""
        return math.dist(self.start, self.end)


@dataclass(frozen=True, slots=True)
class Network:
    """Lines that may be cut into faces.

    Attributes:
        lines: The lines with their joints.
        loose: Ends at which nothing else begins, each with the direction out of its line.
        n_joined: Gaps that were closed.
        gaps: Gaps that were left, up to `NEAR_MISS_MM` wide.
    """

    lines: tuple[LineString, ...]
    loose: tuple[tuple[Point, Point], ...]
    n_joined: int
    gaps: tuple[Gap, ...]

    def faces(self) -> list[Polygon]:
        """What the lines enclose, cut wherever they cross."""
        if not self.lines:
            return []
        noded = shapely.union_all(list(self.lines), grid_size=SAME_MM)
        return rounded(polygons_in(shapely.polygonize([noded]).geoms))


def network(lines: Sequence[LineString] | GeometryArray, gap_mm: float = CLOSE_GAPS_MM) -> Network:
    """Join line ends that are at most `gap_mm` from another end or another line."""
    lines = [line for line in shapely.remove_repeated_points(lines) if line.length]
    if not lines:
        return Network((), (), 0, ())
    corners = [_corners(line) for line in lines]
    ends = _ends(corners)
    joined_mm, missed_mm = gap_mm + TIE_MM, max(gap_mm, NEAR_MISS_MM) + TIE_MM
    joints: list[LineString] = []
    loose: list[tuple[Point, Point]] = []
    gaps: list[Gap] = []
    n_joined = 0
    for (owner, end, outwards), around in zip(ends, _around(ends, lines, missed_mm), strict=True):
        # lines with a corner here lie under the owner: nothing goes on from its end
        near = [lines[i] for i in around if end not in corners[i]]
        foot = _nearest(
            _leading_on(near, end, outwards, joined_mm) or near,
            end,
            _other_end(corners[owner], end, missed_mm),
        )
        width_mm = math.inf if foot is None else math.dist(end, foot)
        if foot is not None and width_mm <= joined_mm:
            joints.append(_joint(end, foot, outwards))
            n_joined += width_mm > OVERSHOOT_MM
            continue
        loose.append((end, outwards))
        if foot is not None and width_mm <= missed_mm:
            gaps.append(Gap(end, foot))
    return Network((*lines, *joints), tuple(loose), n_joined, _without_twins(gaps))


def with_wall_ends(joined: Network) -> Network:
    """Close the ends of walls that are drawn as two open lines.

    Two loose ends are the two faces of one wall when their lines are parallel, point the same
    way, and the ends lie across, no farther apart than `WALL_MM`; nearest pairs first.
    """
    if len(joined.loose) < 2:
        return joined
    near = Spots([end for end, _ in joined.loose]).pairs(WALL_MM + TIE_MM)
    pairs = sorted(
        (math.dist(joined.loose[i][0], joined.loose[j][0]), i, j) for i, j in near.tolist()
    )
    caps: list[LineString] = []
    capped: set[int] = set()
    for _, i, j in pairs:
        if not {i, j} & capped and _are_faces(joined.loose[i], joined.loose[j]):
            caps.append(LineString((joined.loose[i][0], joined.loose[j][0])))
            capped |= {i, j}
    loose = tuple(end for k, end in enumerate(joined.loose) if k not in capped)
    return Network((*joined.lines, *caps), loose, joined.n_joined, joined.gaps)


def with_wall_ends_at(joined: Network, edges: Sequence[LineString]) -> Network:
    """Close the ends of walls whose outer face is the edge of the floor.

    A loose end is led straight across to a parallel edge no farther away than `WALL_MM`.
    """
    sides = [LineString(side) for edge in edges for side in pairwise(edge.coords)]
    tree = shapely.STRtree(sides)
    caps = []
    for end, outwards in joined.loose:
        spot = Spot(end)
        near = [sides[i] for i in tree.query(spot, predicate="dwithin", distance=WALL_MM + TIE_MM)]
        beside = [side for side in near if _is_parallel(side, outwards) and side.distance(spot)]
        if beside:
            nearest = min(beside, key=spot.distance)
            foot = nearest.interpolate(nearest.project(spot))
            caps.append(_joint(end, (foot.x, foot.y), outwards))
    return replace(joined, lines=(*joined.lines, *edges, *caps))


def _is_parallel(side: LineString, along: Point) -> bool:
    way = _direction(side.coords[0], side.coords[-1])
    return abs(way[0] * along[1] - way[1] * along[0]) <= PARALLEL


def _corners(line: LineString) -> list[Point]:
    return [(x, y) for x, y in shapely.get_coordinates(line).tolist()]


def _ends(lines: Sequence[Sequence[Point]]) -> list[tuple[int, Point, Point]]:
    """The ends from which nothing goes on: owner, place and direction out of the line.

    Lines drawn twice, or one over the other, count once.

    Args:
        lines: The corners of each line.
    """
    ways: defaultdict[Point, list[Point]] = defaultdict(list)
    for line in lines:
        for start, end in pairwise(line):
            way = _direction(start, end)
            ways[start].append(way)
            ways[end].append((-way[0], -way[1]))
    found: dict[Point, tuple[int, Point, Point]] = {}
    for owner, points in enumerate(lines):
        for end, before in ((points[0], points[1]), (points[-1], points[-2])):
            out = _direction(before, end)
            if all(_leads_back(way, out) for way in ways[end]):
                found.setdefault(end, (owner, end, out))
    return list(found.values())


def _leads_back(way: Point, out: Point) -> bool:
    """Whether a way from an end lies over the line that ends there."""
    along = way[0] * out[0] + way[1] * out[1]
    return along < 0 and abs(way[0] * out[1] - way[1] * out[0]) <= OVER_EACH_OTHER


def _around(
    ends: Sequence[tuple[int, Point, Point]], lines: Sequence[LineString], within_mm: float
) -> list[IntArray]:
    """For each end, the numbers of the lines within a distance of it."""
    if not ends:
        return []
    spots = shapely.points([end for _, end, _ in ends])
    of_end, near = shapely.STRtree(lines).query(spots, predicate="dwithin", distance=within_mm)
    return np.split(near, np.searchsorted(of_end, np.arange(1, len(ends))))


def _other_end(own: Sequence[Point], end: Point, within_mm: float) -> list[Point]:
    """The other end of a line if it is near, and the line leads there in a bow."""
    other = own[-1] if own[0] == end else own[0]
    length_mm = sum(math.dist(*side) for side in pairwise(own))
    return [other] if math.dist(other, end) <= min(within_mm, length_mm / 2) else []


def _leading_on(
    near: Sequence[LineString], end: Point, outwards: Point, joined_mm: float
) -> list[LineString]:
    """The lines that an end may be joined to, less copies of its own line drawn beside it.

    Joined to such a copy, the end would lead back to where it comes from.
    """
    if len(near) == 1:
        return []
    back_mm = BACK * joined_mm
    back = Spot(end[0] - back_mm * outwards[0], end[1] - back_mm * outwards[1])
    spot = Spot(end)
    return [
        line
        for line in near
        if line.distance(spot) <= joined_mm and line.distance(back) > joined_mm
    ]


def _nearest(near: Sequence[LineString], end: Point, feet: list[Point]) -> Point | None:
    """The point nearest to an end, of lines near it and of other feet.

    A corner of a line counts if it is hardly farther than the line.
    """
    if near:
        spot = Spot(end)
        line = min(near, key=spot.distance)
        on_line = line.interpolate(line.project(spot))
        corner = min(line.coords, key=lambda corner: math.dist(corner, end))
        is_corner = math.dist(corner, end) <= spot.distance(on_line) + CLOSE_GAPS_MM
        feet = [*feet, corner if is_corner else (on_line.x, on_line.y)]
    return min(feet, key=lambda foot: math.dist(foot, end), default=None)


def _joint(end: Point, foot: Point, outwards: Point) -> LineString:
    """A short line from an end through the place where it should meet another."""
    length_mm = math.dist(end, foot)
    ahead = outwards if length_mm < 1e-9 else _direction(end, foot)
    beyond = (foot[0] + OVERSHOOT_MM * ahead[0], foot[1] + OVERSHOOT_MM * ahead[1])
    return LineString((end, foot, beyond) if length_mm else (end, beyond))


def _are_faces(one: tuple[Point, Point], other: tuple[Point, Point]) -> bool:
    (end, out), (other_end, other_out) = one, other
    if end == other_end:
        return False
    across = _direction(end, other_end)
    sine = out[0] * other_out[1] - out[1] * other_out[0]
    cosine = out[0] * other_out[0] + out[1] * other_out[1]
    lean = abs(across[0] * out[0] + across[1] * out[1])
    return cosine > 0 and abs(sine) <= PARALLEL and lean <= SQUARE


def _direction(start: Point, end: Point) -> Point:
    length_mm = math.dist(start, end)
    return (end[0] - start[0]) / length_mm, (end[1] - start[1]) / length_mm


def _without_twins(gaps: Sequence[Gap]) -> tuple[Gap, ...]:
    """Each gap once, though it is seen from both of its ends."""
    kept = {frozenset((gap.start, gap.end)): gap for gap in reversed(gaps)}
    return tuple(reversed(kept.values()))
