"""Doors by their swings: an arc, and a leaf that runs from its hinge to it.

Leaves and swings never stop the robot, also where they are drawn among walls or windows. Most arcs
have the hinge for their centre; one drawn by hand, as a spline or by short straight lines, keeps as
far from the hinge as the leaf is long.
"""

import math
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain, pairwise
from typing import Final, TypeAlias

import numpy as np
from shapely.geometry import LineString
from shapely.geometry import Point as Spot

from satAOI_adapters.dxf_read.curves import Arc, Line, Path, Piece, Point, Spline
from satAOI_adapters.dxf_read.features import Feature
from satAOI_adapters.dxf_read.groups import Spots
from satAOI_adapters.dxf_read.options import CLOSE_GAPS_MM
from satAOI_geo.plan import BoolArray, FloatArray

LEAF_MM: Final = 1300.0
"""No door leaf is longer."""

LEAST_LEAF_MM: Final = 400.0
"""No leaf of a door that people go through is shorter."""

LEAF_SLACK_MM: Final = 75.0
"""A leaf may start and end this far from its arc's centre and its arc, as it has a thickness."""

TIP_SLACK_MM: Final = 100.0
"""An arc drawn by hand begins this close to the tip of its leaf."""

LEAST_TURN_MM: Final = 120.0
"""And its ends are farther from each other: the round end of a wall is narrower."""

LEAST_BULGE: Final = 0.5
"""And it runs off the chord between them by this share of what a circle about the hinge does."""

WIDEST_RAD: Final = math.radians(190)
"""Doors are drawn open by up to half a turn."""

FEWEST_SIDES: Final = 3
"""An arc drawn by straight lines has at least so many."""

LEAST_COSINE: Final = math.cos(math.radians(45))
"""And they turn by less from one to the next, where they are not one polyline."""


_Key: TypeAlias = frozenset[Point] | int
"""What tells pieces apart: copies of a straight one, drawn either way, are one."""


@dataclass(frozen=True, slots=True)
class Swing:
    """A door as it is drawn.

    Attributes:
        hinge: About which it turns.
        reach_mm: How long its leaf is.
        shut_at: Where the leaf's tip may be when the door is shut.
        drawn_by: The arc, the sides of the leaf and the short lines that join these.
    """

    hinge: Point
    reach_mm: float
    shut_at: tuple[Point, ...]
    drawn_by: tuple[Piece, ...]


@dataclass(frozen=True, slots=True)
class _Bow:
    """What may be a door's arc: its pieces, and points along it from end to end."""

    pieces: tuple[Piece, ...]
    points: tuple[Point, ...]


@dataclass(frozen=True, slots=True)
class _Lines:
    """Straight pieces, which may be leaves or short sides of a bow.

    Attributes:
        lines: The pieces, each once however often it is drawn.
        is_alone: Which of them are drawn other than as part of a polyline.
        ends: Their starts and ends, two a line, shape (2 n, 2).
        spots: The same, to be found by their place.
    """

    lines: Sequence[Line]
    is_alone: BoolArray
    ends: FloatArray
    spots: Spots

    @classmethod
    def of(cls, paths: Sequence[Path]) -> "_Lines":
        """The straight pieces of paths, of which there is one at least."""
        alone_of: dict[_Key, bool] = {}
        line_of: dict[_Key, Line] = {}
        for path in paths:
            for line in path.pieces:
                if isinstance(line, Line):
                    key = _key(line)
                    line_of.setdefault(key, line)
                    alone_of[key] = alone_of.get(key, False) or len(path.pieces) == 1
        lines = list(line_of.values())
        is_alone = np.array(list(alone_of.values()))
        ends = np.array([end for line in lines for end in (line.start, line.end)])
        return cls(lines, is_alone, ends, Spots(ends))

    def spot(self, end: int) -> Point:
        """Where one of the ends is, two a line."""
        line = self.lines[end // 2]
        return line.end if end % 2 else line.start

    def from_near(self, spot: Point, within_mm: float) -> list[tuple[Line, Point, Point]]:
        """Lines that end near a point, each with that end and the other one."""
        near = self.spots.near(spot, within_mm)
        found = [(self.lines[i // 2], i % 2) for i in near]
        return [
            (line, line.end, line.start) if is_end else (line, line.start, line.end)
            for line, is_end in found
        ]


def swings(features: Sequence[Feature]) -> list[Swing]:
    """The doors among what is drawn."""
    paths = [path for feature in features for path in feature.paths]
    if not any(isinstance(piece, Line) for path in paths for piece in path.pieces):
        return []
    known = _Lines.of(paths)
    bows = chain((bow for path in paths for bow in _bows(path)), _bows_of_lines(known))
    found = (_about_centre(bow, known) or _by_hand(bow, known) for bow in bows)
    return [swing for swing in found if swing is not None]


def parted(
    features: Sequence[Feature], found: Sequence[Swing]
) -> tuple[list[Feature], list[Feature]]:
    """Features less the doors found among them, and what draws these.

    With a door go whatever else of the same paths lies within its circle: the other side of the
    leaf.
    """
    doors_of: defaultdict[_Key, list[Swing]] = defaultdict(list)
    for swing in found:
        for piece in swing.drawn_by:
            doors_of[_key(piece)].append(swing)
    rest: list[Feature] = []
    doors: list[Feature] = []
    for feature in features:
        is_door = [_draws_door(path, doors_of) for path in feature.paths]
        for part, wanted in ((rest, False), (doors, True)):
            of_part = zip(feature.paths, is_door, strict=True)
            paths = tuple(path for path, is_one in of_part if is_one is wanted)
            if paths:
                part.append(replace(feature, paths=paths))
    return rest, doors


def may_be_swing(arc: Arc) -> bool:
    """Whether an arc is as large as those that doors draw about their hinges."""
    radius_mm = math.hypot(*arc.u)
    return arc.is_round and LEAST_LEAF_MM <= radius_mm <= LEAF_MM and arc.sweep_rad <= WIDEST_RAD


def _bows(path: Path) -> Iterator[_Bow]:
    for piece in path.pieces:
        if not isinstance(piece, Line) and _may_turn(piece):
            yield _Bow((piece,), tuple(piece.chords()))
    if path.is_straight and not path.closed and len(path.pieces) >= FEWEST_SIDES:
        corners = [path.start, *(piece.end for piece in path.pieces)]
        yield _Bow(path.pieces, _with_middles(corners))


def _may_turn(piece: Arc | Spline) -> bool:
    """Whether a curve may be a door's arc, by a look at no more than its ends."""
    if isinstance(piece, Arc):
        return piece.sweep_rad <= WIDEST_RAD
    return _spans_a_turn(piece.start, piece.end)


def _bows_of_lines(known: _Lines) -> Iterator[_Bow]:
    """The bows that lines shorter than any leaf make, drawn one by one and joined end to end."""
    next_end = _joints(known)
    for first in [end ^ 1 for end in next_end if end ^ 1 not in next_end]:
        ends = [first, first ^ 1]
        while ends[-1] in next_end:
            ends += [next_end[ends[-1]], next_end[ends[-1]] ^ 1]
        # a chain has two ends to begin with
        if first < ends[-1] and len(ends) >= 2 * FEWEST_SIDES:
            pieces = tuple(known.lines[end // 2] for end in ends[::2])
            yield _Bow(pieces, _with_middles([known.spot(end) for end in (first, *ends[1::2])]))


def _joints(known: _Lines) -> dict[int, int]:
    """The end at which each end of a short line goes on, where it does so in a bow and alone."""
    outwards = known.ends - known.ends[np.arange(len(known.ends)) ^ 1]
    length_mm = np.hypot(*outwards.T)
    is_short = (length_mm < LEAST_LEAF_MM) & np.repeat(known.is_alone, 2)
    pairs = known.spots.pairs(CLOSE_GAPS_MM)
    one, other = np.vstack((pairs, pairs[:, ::-1])).T
    has_one = is_short[one] & (np.bincount(one, minlength=len(known.ends))[one] == 1)
    one, other = one[has_one], other[has_one]
    along = -(outwards[one] * outwards[other]).sum(axis=1)
    goes_on = along >= LEAST_COSINE * length_mm[one] * length_mm[other]
    goes_on &= is_short[other]
    joints = dict(zip(one[goes_on].tolist(), other[goes_on].tolist(), strict=True))
    return {end: on for end, on in sorted(joints.items()) if joints.get(on) == end}


def _with_middles(corners: Sequence[Point]) -> tuple[Point, ...]:
    """Corners with the middle of each side: of a bow with few sides these are nearest the hinge."""
    points = [corners[0]]
    for (x, y), end in pairwise(corners):
        points += [((x + end[0]) / 2, (y + end[1]) / 2), end]
    return tuple(points)


def _about_centre(bow: _Bow, known: _Lines) -> Swing | None:
    """The door of an arc about the hinge, with any line from there to the arc as its leaf."""
    (arc, *_) = bow.pieces
    if not isinstance(arc, Arc) or not may_be_swing(arc):
        return None
    turn = LineString(bow.points)
    leaves = [
        (line, tip)
        for line, _, tip in known.from_near(arc.centre, LEAF_SLACK_MM)
        if turn.distance(Spot(tip)) <= LEAF_SLACK_MM
    ]
    if not leaves:
        return None
    # shut, the leaf is where it is not drawn
    ends = (arc.start, arc.end)
    free = [end for end in ends if all(math.dist(end, tip) > LEAF_SLACK_MM for _, tip in leaves)]
    sides = [line for line, _ in leaves]
    reach_mm = math.hypot(*arc.u)
    return Swing(arc.centre, reach_mm, tuple(free or ends), (arc, *sides, *_caps(sides, known)))


def _by_hand(bow: _Bow, known: _Lines) -> Swing | None:
    """The door of an arc that begins at the tip of a leaf and keeps about its length away."""
    if not _spans_a_turn(bow.points[0], bow.points[-1]):
        return None
    bulge_mm = _bulge_mm(bow.points)
    for points in (bow.points, bow.points[::-1]):
        tip, shut_at = points[0], points[-1]
        leaves = [
            (line, hinge)
            for line, _, hinge in known.from_near(tip, TIP_SLACK_MM)
            if line not in bow.pieces
            and _keeps_away(points, hinge, _length_mm(line))
            and bulge_mm >= LEAST_BULGE * _circle_mm(math.dist(tip, shut_at), _length_mm(line))
        ]
        if leaves:
            sides = [line for line, _ in leaves]
            # of the two sides of a leaf the one that fits better, in whatever order they are drawn
            _, hinge = min((abs(math.dist(h, shut_at) - _length_mm(line)), h) for line, h in leaves)
            drawn_by = (*bow.pieces, *sides, *_caps(sides, known))
            return Swing(hinge, math.dist(hinge, tip), (shut_at,), drawn_by)
    return None


def _spans_a_turn(start: Point, end: Point) -> bool:
    """Whether the ends of what may be a door's arc are as far from each other as such ends are."""
    return LEAST_TURN_MM <= math.dist(start, end) <= 2 * LEAF_MM


def _bulge_mm(points: Sequence[Point]) -> float:
    """How far a bow is off its chord: not at all if it is a wall's face, drawn as a spline."""
    (x, y), (end_x, end_y) = points[0], points[-1]
    way_x, way_y = end_x - x, end_y - y
    off_mm2 = max(abs(way_x * (at_y - y) - way_y * (at_x - x)) for at_x, at_y in points)
    return off_mm2 / math.hypot(way_x, way_y)


def _circle_mm(chord_mm: float, radius_mm: float) -> float:
    """How far an arc of a circle is off its chord."""
    return radius_mm - math.sqrt(max(radius_mm**2 - chord_mm**2 / 4, 0.0))


def _keeps_away(points: Sequence[Point], hinge: Point, leaf_mm: float) -> bool:
    return LEAST_LEAF_MM <= leaf_mm <= LEAF_MM and all(
        abs(math.dist(hinge, point) - leaf_mm) <= LEAF_SLACK_MM for point in points
    )


def _length_mm(line: Line) -> float:
    return math.dist(line.start, line.end)


def _caps(leaves: Sequence[Line], known: _Lines) -> list[Line]:
    """The short lines that run from a leaf's one side to its other."""
    ends = [end for leaf in leaves for end in (leaf.start, leaf.end)]
    touched = {i for end in ends for i in known.spots.near(end, CLOSE_GAPS_MM)}
    joining = [known.lines[i // 2] for i in touched if i % 2 == 0 and i + 1 in touched]
    return [line for line in joining if _length_mm(line) <= LEAF_SLACK_MM]


def _key(piece: Piece) -> _Key:
    return frozenset((piece.start, piece.end)) if isinstance(piece, Line) else id(piece)


def _draws_door(path: Path, doors_of: Mapping[_Key, Sequence[Swing]]) -> bool:
    """Whether a path is a door's arc or leaf, and shows nothing beyond the door's circle.

    Args:
        path: What is drawn.
        doors_of: The doors to which a piece belongs.
    """
    return any(
        _holds(swing, path) for piece in path.pieces for swing in doors_of.get(_key(piece), ())
    )


def _holds(swing: Swing, path: Path) -> bool:
    """Whether a path stays within a door's circle."""
    return all(
        math.dist(spot, swing.hinge) <= swing.reach_mm + LEAF_SLACK_MM
        for piece in path.pieces
        for spot in (piece.start, piece.end)
    )
