"""An estimate of the unit of length from what buildings have in common.

Doors are as wide as people, walls as thick as bricks, columns as thick as beams, texts as high as
can be read on paper. Each sort of length speaks for the units in which it falls into its range.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, TypeAlias

import numpy as np
import shapely
from ezdxf.entities import DXFEntity
from shapely.geometry import LineString

from satAOI_adapters.dxf_read.curves import Arc, Line, Path
from satAOI_adapters.dxf_read.features import Feature
from satAOI_adapters.meanings import Meaning
from satAOI_geo.plan import FloatArray
from satAOI_geo.units import MM_PER_UNIT

CANDIDATES: Final = ("mm", "m", "cm", "in")
"""Units that buildings are drawn in."""

SELDOM: Final = ("ft",)
"""Units that are looked at only where none of these is likely: whoever draws in feet mostly says so
in the header."""

ENOUGH: Final = 0.6
"""Share of the evidence that must speak for the best unit."""

LEAD: Final = 0.2
"""By how much the best unit must be ahead of the next, as a share of the evidence."""

SLIM: Final = 0.25
"""A wall is thinner than this share of its length."""

LEAST_WEIGHT: Final = 0.6
"""Signs that weigh less than this together tell no unit: sizes or texts alone are no evidence."""

OFTEN: Final = 20
"""A sign seen so many times needs no second one to contradict a header."""

OFTEN_DOORS: Final = 4
"""The same of doors, which are as wide as people, while a gate or two are not."""

MAX_LINES: Final = 1500
"""Wall lines that are compared with each other, the longest first."""


@dataclass(frozen=True, slots=True)
class Sign:
    """A sort of length and what it is in a building.

    Attributes:
        name: In words.
        least_mm: Hardly any is smaller.
        most_mm: Hardly any is larger.
        weight: How much it counts beside the others.
        at_least: Seen so many times, it may contradict a header together with another sign; 0 if
            never.
        often: Seen so many times, it may do so alone.
    """

    name: str
    least_mm: float
    most_mm: float
    weight: float
    at_least: int
    often: int = OFTEN


DOORS: Final = Sign("door widths", 550, 1350, 1.0, at_least=1, often=OFTEN_DOORS)
ARCS: Final = Sign("quarter turns", 550, 1350, 0.4, at_least=0)
WALLS: Final = Sign("wall thicknesses", 60, 650, 1.0, at_least=4)
COLUMNS: Final = Sign("column sizes", 90, 1600, 0.7, at_least=4)
TEXTS: Final = Sign("text heights", 40, 3000, 0.5, at_least=5)
DIMENSIONS: Final = Sign("dimensions", 200, 60_000, 0.4, at_least=0)
EXTENT: Final = Sign("overall size", 3000, 500_000, 0.3, at_least=0)

Evidence: TypeAlias = Sequence[tuple[Sign, FloatArray]]
"""Sorts of length, and the lengths of each in drawing units."""

CUSTOM: Final = 0.7
"""How much feet and inches as the drawing's number format count beside the other signs."""

CUSTOM_NAME: Final = "lengths in feet and inches"
"""How messages call that."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """The units that most of the evidence speaks for.

    Attributes:
        units: Keys of `units.MM_PER_UNIT`; more than one where none of them leads.
        reasons: What speaks for these, in words: a plural.
        doubted: Units in which a sort of length is out of range.
        against: Units that two sorts rule out, or one seen often where a unit leads.
    """

    units: tuple[str, ...]
    reasons: str
    doubted: frozenset[str] = frozenset()
    against: frozenset[str] = frozenset()


def estimate(
    features: Sequence[tuple[Meaning | None, Feature]],
    size: tuple[float, float],
    others: Iterable[DXFEntity],
    *,
    in_feet_and_inches: bool,
) -> Estimate | None:
    """The likely units of a drawing, or None if the evidence is thin or divided.

    Args:
        features: What is drawn, in drawing units, with its meaning.
        size: Width and height of it.
        others: Entities that draw no lines: texts and dimensions among them.
        in_feet_and_inches: Whether the drawing writes lengths as feet and inches, which makes its
            unit the inch.
    """
    evidence = _evidence(features, size, list(others))
    custom = CUSTOM if in_feet_and_inches else 0.0
    likely = _likely(_scores(evidence, custom))
    for_it = [
        sign
        for sign, lengths in evidence
        if any(_share(sign, lengths, unit) >= ENOUGH for unit in likely)
    ]
    is_custom = in_feet_and_inches and "in" in likely
    if sum(sign.weight for sign in for_it) + custom * is_custom < LEAST_WEIGHT:
        return None
    names = [*[CUSTOM_NAME] * is_custom, *(sign.name for sign in for_it)]
    signs = {unit: _out_of_range(unit, evidence) for unit in MM_PER_UNIT if unit not in likely}
    leads = len(likely) == 1
    return Estimate(
        likely,
        " and ".join(names),
        doubted=frozenset(unit for unit in signs if signs[unit]),
        against=frozenset(unit for unit in signs if _rule_out(signs[unit], leads=leads)),
    )


def _evidence(
    features: Sequence[tuple[Meaning | None, Feature]],
    size: tuple[float, float],
    explained: Sequence[DXFEntity],
) -> Evidence:
    """The sorts of length that a drawing holds; arguments as for `estimate`."""
    found = [
        (DOORS, _quarter_turns(features, of_doors=True)),
        (ARCS, _quarter_turns(features, of_doors=False)),
        (WALLS, _wall_thicknesses(features)),
        (COLUMNS, _column_sizes(features)),
        (TEXTS, _attributes(explained, {"TEXT": "height", "MTEXT": "char_height"})),
        (DIMENSIONS, _attributes(explained, {"DIMENSION": "actual_measurement"})),
        (EXTENT, np.array([max(size)])),
    ]
    return [(sign, lengths) for sign, lengths in found if lengths.size]


def _scores(evidence: Evidence, custom: float) -> dict[str, float]:
    """Which share of the evidence speaks for each unit."""
    total = custom + sum(sign.weight for sign, _ in evidence)
    scores = dict.fromkeys((*CANDIDATES, *SELDOM), 0.0)
    scores["in"] += custom / total
    for sign, lengths in evidence:
        for unit in scores:
            scores[unit] += sign.weight * _share(sign, lengths, unit) / total
    return scores


def _likely(scores: Mapping[str, float]) -> tuple[str, ...]:
    """The unit that leads, else those between which the evidence is divided."""
    usual, all_ = _foremost(scores, CANDIDATES), _foremost(scores, scores)
    return all_ if len(all_) == 1 and len(usual) != 1 else usual or all_


def _foremost(scores: Mapping[str, float], units: Iterable[str]) -> tuple[str, ...]:
    """The unit that enough of the evidence speaks for, and those that are not clearly behind it."""
    ordered = sorted(units, key=scores.__getitem__, reverse=True)
    best = scores[ordered[0]]
    return tuple(unit for unit in ordered if best >= ENOUGH and best - scores[unit] < LEAD)


def _out_of_range(unit: str, evidence: Evidence) -> Evidence:
    """The sorts of length that are mostly out of range in a unit."""
    return [pair for pair in evidence if _share(*pair, unit) <= 1 - ENOUGH]


def _rule_out(signs: Evidence, *, leads: bool) -> bool:
    """Whether two sorts of length were seen often enough to rule a unit out.

    One sort, seen more often, is enough where another unit leads: joints of tiles may look like
    thin walls, and no unit fits them.
    """
    telling = [(sign, lengths.size) for sign, lengths in signs if sign.at_least]
    n_seen = sum(count >= sign.at_least for sign, count in telling)
    return n_seen > 1 or (leads and any(count >= sign.often for sign, count in telling))


def _share(sign: Sign, lengths: FloatArray, unit: str) -> float:
    """Which share of the lengths falls into the range, were this their unit."""
    lengths_mm = lengths * MM_PER_UNIT[unit]
    return float(np.mean((sign.least_mm <= lengths_mm) & (lengths_mm <= sign.most_mm)))


def _quarter_turns(
    features: Sequence[tuple[Meaning | None, Feature]], *, of_doors: bool
) -> FloatArray:
    """Radii of arcs that turn by about 90°, as doors do, on door layers or on others."""
    return np.array(
        [
            math.hypot(*piece.u)
            for meaning, feature in features
            if (meaning is Meaning.DOOR) == of_doors
            for path in feature.paths
            for piece in path.pieces
            if isinstance(piece, Arc) and math.radians(60) <= piece.sweep_rad <= math.radians(120)
        ]
    )


def _column_sizes(features: Sequence[tuple[Meaning | None, Feature]]) -> FloatArray:
    """The shorter sides of closed shapes on column layers."""
    sizes: list[float] = []
    for meaning, feature in features:
        if meaning is Meaning.COLUMN:
            sizes.extend(_shorter_side(path) for path in feature.paths if path.closed)
    return np.array(sizes)


def _shorter_side(path: Path) -> float:
    first = path.pieces[0]
    if isinstance(first, Arc) and first.is_full:
        return 2 * min(math.hypot(*first.u), math.hypot(*first.v))
    corners = np.array([piece.start for piece in path.pieces])
    return float(np.ptp(corners, axis=0).min())


def _wall_thicknesses(features: Sequence[tuple[Meaning | None, Feature]]) -> FloatArray:
    """For each line of a wall its own width, or the distance to the nearest one that runs beside.

    Lines with a width are the middles of walls: what runs beside them is another wall.
    """
    walls = [feature for meaning, feature in features if meaning is Meaning.WALL]
    _, distances = beside(wall for wall in walls if not wall.width_mm)
    widths = [
        wall.width_mm
        for wall in walls
        for path in wall.paths
        for piece in path.pieces
        if 0 < wall.width_mm < SLIM * math.dist(piece.start, piece.end)
    ]
    return np.concatenate((distances[np.isfinite(distances)], np.array(widths)))


def beside(features: Iterable[Feature]) -> tuple[FloatArray, FloatArray]:
    """How long straight lines are, and how far beside each the nearest parallel one runs.

    Args:
        features: What is drawn; of many lines the longest `MAX_LINES` are looked at.

    Returns:
        The lengths and the distances, infinite where no line runs beside, each of shape (n,).
    """
    lines = [
        (piece.start, piece.end)
        for feature in features
        for path in feature.paths
        for piece in path.pieces
        if isinstance(piece, Line)
    ]
    if len(lines) < 2:
        return np.array([]), np.array([])
    lines.sort(key=lambda line: -math.dist(*line))
    ends = np.array(lines[:MAX_LINES])
    along = ends[:, 1] - ends[:, 0]
    lengths = np.hypot(*along.T)
    along /= lengths[:, np.newaxis]
    middles = shapely.points(ends.mean(axis=1))
    # they are in the order of length; for its median numpy would load a library of its own
    median = (lengths[(lengths.size - 1) // 2] + lengths[lengths.size // 2]) / 2
    own, other = shapely.STRtree([LineString(line) for line in ends]).query(
        middles, predicate="dwithin", distance=median
    )
    sines = np.abs(along[own, 0] * along[other, 1] - along[own, 1] * along[other, 0])
    offsets = ends[other, 0] - ends[own].mean(axis=1)
    distances = np.abs(offsets[:, 0] * along[own, 1] - offsets[:, 1] * along[own, 0])
    slim = (distances > 1e-3 * lengths[own]) & (distances < SLIM * lengths[own])
    is_beside = (sines < 0.02) & slim
    nearest = np.full(len(ends), np.inf)
    np.minimum.at(nearest, own[is_beside], distances[is_beside])
    return lengths, nearest


def _attributes(entities: Iterable[DXFEntity], names: dict[str, str]) -> FloatArray:
    """Positive numbers that entities of some types carry."""
    values = [
        entity.dxf.get(names[entity.dxftype()], 0.0)
        for entity in entities
        if entity.dxftype() in names
    ]
    return np.array([value for value in values if math.isfinite(value) and value > 0])
