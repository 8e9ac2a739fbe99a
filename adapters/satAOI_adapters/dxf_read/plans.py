"""Which plan: several floors, views and a title block often share one model space.

What is drawn falls into clusters with wide blank space between them. A cluster with walls is a
plan, a section or a view; doors that swing and columns and a floor tell a plan from the others.
Layers that nobody knows tell nothing of this, for they hold frames and legends as well as facades;
but clusters that linework on them runs between from wall to wall are parts of one plan.
"""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, TypeAlias

import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry.base import BaseGeometry

from satAOI_adapters.dxf_read.curves import Arc, Point
from satAOI_adapters.dxf_read.features import Feature
from satAOI_adapters.dxf_read.groups import linked
from satAOI_adapters.dxf_read.shapes import GeometryArray, is_thin
from satAOI_adapters.meanings import KINDS, Meaning
from satAOI_adapters.wording import coordinate
from satAOI_geo.errors import InputError
from satAOI_geo.plan import Finding, Frame, polygons_in

Drawn: TypeAlias = dict[Meaning | None, list[Feature]]
"""What is drawn, by meaning."""

BLANK_MM: Final = 2500.0
"""Blank space between two plans on one sheet; within a plan gaps are seldom as wide."""

TOUCH_MM: Final = 1.0
"""Boxes of clusters this close overlap."""

JOINED_MM: Final = 50.0
"""Linework this close to a wall runs up to it."""

SWING_RAD: Final = (math.radians(25), math.radians(120))
"""Doors are drawn open by 30° to a right angle."""

SMALLEST_MM: Final = 1500.0
"""A cluster in which no disc of this diameter fits, or that stops no robot, is no plan."""

PLAN_SIGNS: Final = (Meaning.DOOR, Meaning.COLUMN, Meaning.FLOOR, Meaning.WINDOW, Meaning.WALL)
"""Meanings of which a plan shows more than a section or a roof does."""


@dataclass(frozen=True, slots=True)
class Cluster:
    """A part of the drawing with blank space around it.

    Attributes:
        hull: What it spans, in the plan's frame; convex.
        counts: Features in it by meaning.
        n_swings: Turns, such as doors draw.
    """

    hull: BaseGeometry
    counts: Mapping[Meaning, int]
    n_swings: int

    @property
    def bounds_mm(self) -> tuple[float, float, float, float]:
        """Left, bottom, right, top in the plan's frame."""
        left, bottom, right, top = self.hull.bounds
        return left, bottom, right, top

    @property
    def is_plan(self) -> bool:
        """Whether it may be a floor plan at all."""
        tells = any(meaning in self.counts for meaning in (*KINDS, Meaning.FLOOR))
        return tells and not is_thin(self.hull, SMALLEST_MM)

    @property
    def rank(self) -> tuple[int, int]:
        """The more plan-like, the higher; of two equals the one with more in it."""
        signs = sum(meaning in self.counts for meaning in PLAN_SIGNS)
        return signs + (self.n_swings > 0), sum(self.counts.values())


def clusters(drawn: Drawn) -> list[Cluster]:
    """The clusters of a drawing that may be plans, the likeliest first."""
    pairs = [(m, feature) for m, features in drawn.items() if m is not None for feature in features]
    if not pairs:
        return []
    lines = rough_lines([feature for _, feature in pairs])
    owners = _grouped(lines)
    if owners.any():
        owners = _apart(lines, _joined(owners, lines, rough_lines(drawn.get(None, []))))
    counts: list[Counter[Meaning]] = [Counter() for _ in range(owners.max() + 1)]
    swings: Counter[int] = Counter()
    for owner, (meaning, feature) in zip(owners.tolist(), pairs, strict=True):
        counts[owner][meaning] += 1
        swings[owner] += n_swings(feature)
    found = [
        Cluster(hull, count, swings[owner])
        for owner, (hull, count) in enumerate(zip(_hulls(lines, owners), counts, strict=True))
    ]
    # of equals the leftmost, then lowest one
    plans = sorted((c for c in found if c.is_plan), key=lambda c: c.bounds_mm)
    return sorted(plans, key=lambda c: c.rank, reverse=True)


def within(drawn: Drawn, part: BaseGeometry) -> tuple[Drawn, Counter[Meaning | None]]:
    """What is drawn in a part of the plane, wholly or partly, and how much of what is left out."""
    reach = part.buffer(TOUCH_MM)
    shapely.prepare(reach)
    kept: Drawn = {}
    n_left_out: Counter[Meaning | None] = Counter()
    for meaning, features in drawn.items():
        is_in = shapely.intersects(reach, rough_lines(features))
        kept[meaning] = [feature for feature, keeps in zip(features, is_in, strict=True) if keeps]
        n_left_out[meaning] = len(features) - len(kept[meaning])
    return kept, n_left_out


def chosen(
    found: Sequence[Cluster], number: int | None, near_mm: Point | None, frame: Frame
) -> tuple[Cluster | None, tuple[Finding, ...]]:
    """The plan that is read, and what is to be said about the others.

    Args:
        found: The plans, the likeliest first.
        number: The user's choice, counted from 1.
        near_mm: The start; the plan that holds it goes before the likeliest.
        frame: For positions in messages.

    Raises:
        InputError: If there is no plan of that number.
    """
    if number is not None and not 1 <= number <= len(found):
        raise InputError(
            f"there is no plan {number}; the drawing holds {len(found)}: "
            f"{_listed(found, frame) or 'none that can be told from the rest'}"
        )
    if not found:
        return None, ()
    holding = [i for i, c in enumerate(found) if near_mm is not None and _holds(c, near_mm)]
    index = number - 1 if number is not None else next(iter(holding), 0)
    if len(found) == 1 or number is not None:
        return found[index], ()
    return found[index], (
        Finding(
            "several-plans",
            f"{len(found)} parts of the drawing may be plans: {_listed(found, frame)}; "
            f"number {index + 1} is read",
            "choose another with --plan N or --region",
        ),
    )


def _listed(found: Sequence[Cluster], frame: Frame) -> str:
    """The plans with their corners in drawing units."""
    parts = []
    for number, cluster in enumerate(found, start=1):
        corners = frame.to_drawing(np.reshape(cluster.bounds_mm, (2, 2))).ravel().tolist()
        left, bottom, right, top = (coordinate(value, frame.mm_per_unit) for value in corners)
        parts.append(f"{number} from ({left}, {bottom}) to ({right}, {top})")
    return ", ".join(parts)


def _holds(cluster: Cluster, spot_mm: Point) -> bool:
    left, bottom, right, top = cluster.bounds_mm
    return left <= spot_mm[0] <= right and bottom <= spot_mm[1] <= top


def n_swings(feature: Feature) -> int:
    """How many turns, such as doors draw, a feature has."""
    least_rad, most_rad = SWING_RAD
    return sum(
        isinstance(piece, Arc) and least_rad <= piece.sweep_rad <= most_rad
        for path in feature.paths
        for piece in path.pieces
    )


def rough_lines(features: Sequence[Feature]) -> GeometryArray:
    """Roughly what features draw: a geometry for each."""
    paths = [path.rough() for feature in features for path in feature.paths]
    if not paths:
        return np.array([], dtype=object)
    of_path = np.repeat(np.arange(len(paths)), [len(path) for path in paths])
    of_feature = np.repeat(np.arange(len(features)), [len(feature.paths) for feature in features])
    chains = shapely.linestrings(np.concatenate(paths), indices=of_path)
    return np.asarray(shapely.multilinestrings(chains, indices=of_feature))


def _grouped(lines: GeometryArray) -> npt.NDArray[np.int64]:
    """The number of the cluster that each drawn thing belongs to; hulls of clusters are apart."""
    if _are_under_one_hull(lines):
        return np.zeros(len(lines), dtype=np.int64)
    return _apart(lines, _dissolved(shapely.buffer(lines, BLANK_MM / 2, quad_segs=2), lines))


def _apart(lines: GeometryArray, owners: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """The clusters, those made one whose hulls overlap."""
    while True:
        hulls = _hulls(lines, owners)
        merged = _dissolved(shapely.buffer(hulls, TOUCH_MM, quad_segs=2), hulls)
        if merged.max() + 1 == len(hulls):
            return owners
        owners = merged[owners]


def _joined(
    owners: npt.NDArray[np.int64], lines: GeometryArray, nameless: GeometryArray
) -> npt.NDArray[np.int64]:
    """The clusters, those made one that nameless linework runs between."""
    n_clusters = owners.max() + 1
    own, other = shapely.STRtree([*lines, *nameless]).query(
        nameless, predicate="dwithin", distance=JOINED_MM
    )
    node = np.concatenate((owners, n_clusters + np.arange(len(nameless))))
    pairs = np.column_stack((n_clusters + own, node[other]))
    group = linked(pairs, n_clusters + len(nameless))[:n_clusters]
    return np.unique(group, return_inverse=True)[1][owners]


def _are_under_one_hull(lines: GeometryArray) -> bool:
    """Whether the hull of the largest thing, and of what it meets, meets all the others.

    They are one cluster then, as where a floor is drawn, and nothing has to be dissolved.
    """
    hull = shapely.convex_hull(lines[np.argmax(shapely.area(shapely.convex_hull(lines)))])
    n_met = 0
    while True:
        shapely.prepare(hull)
        meets = shapely.intersects(hull, lines)
        if meets.sum() == n_met:
            return bool(meets.all())
        n_met = meets.sum()
        hull = shapely.convex_hull(shapely.geometrycollections(lines[meets]))


def _hulls(lines: GeometryArray, owners: npt.NDArray[np.int64]) -> GeometryArray:
    """The convex hull of each cluster."""
    order = np.argsort(owners, kind="stable")
    together = shapely.geometrycollections(lines[order], indices=owners[order])
    return np.asarray(shapely.convex_hull(together))


def _dissolved(grown: GeometryArray, things: GeometryArray) -> npt.NDArray[np.int64]:
    """Numbers of the groups that things form whose grown shapes overlap."""
    parts = polygons_in([shapely.union_all(grown)])
    spots = shapely.point_on_surface(things)
    return np.asarray(shapely.STRtree(parts).nearest(spots))
