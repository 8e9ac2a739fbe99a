"""Which plan: several floors, views and a title block often share one model space.

What is drawn falls into clusters with wide blank space between them. A cluster with walls is a
plan, a section or a view; doors that swing and columns and a floor tell a plan from the others.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, TypeAlias

import numpy as np
import numpy.typing as npt
import shapely

from satAOI_adapters.dxf_read.curves import Arc, Point
from satAOI_adapters.dxf_read.entities import Feature
from satAOI_adapters.layers import KINDS, Meaning
from satAOI_geo.errors import InputError
from satAOI_geo.plan import Finding, FloatArray, Frame, polygons_in

Drawn: TypeAlias = dict[Meaning | None, list[Feature]]
"""What is drawn, by meaning."""

BLANK_MM: Final = 2500.0
"""Blank space between two plans on one sheet; within a plan gaps are seldom as wide."""

TOUCH_MM: Final = 1.0
"""Boxes of clusters this close overlap."""

SMALLEST_MM: Final = 2000.0
"""A cluster smaller than this, or without anything that stops the robot, is no plan."""

PLAN_SIGNS: Final = (Meaning.DOOR, Meaning.COLUMN, Meaning.FLOOR, Meaning.WINDOW, Meaning.WALL)
"""Meanings of which a plan shows more than a section or a roof does."""


@dataclass(frozen=True, slots=True)
class Cluster:
    """A part of the drawing with blank space around it.

    Attributes:
        bounds_mm: Left, bottom, right, top in the plan's frame.
        counts: Features in it by meaning.
        n_swings: Quarter turns, such as doors draw.
    """

    bounds_mm: tuple[float, float, float, float]
    counts: Mapping[Meaning, int]
    n_swings: int

    @property
    def is_plan(self) -> bool:
        """Whether it may be a floor plan at all."""
        left, bottom, right, top = self.bounds_mm
        tells = any(meaning in self.counts for meaning in (*KINDS, Meaning.FLOOR))
        return tells and min(right - left, top - bottom) >= SMALLEST_MM

    @property
    def rank(self) -> tuple[int, int]:
        """The more plan-like, the higher; of two equals the one with more in it."""
        signs = sum(meaning in self.counts for meaning in PLAN_SIGNS)
        return signs + (self.n_swings > 0), sum(self.counts.values())


def clusters(drawn: Drawn) -> list[Cluster]:
    """The clusters of a drawing that may be plans, the likeliest first."""
    # what layers say nothing about lies anywhere: frames, legends, the neighbourhood
    pairs = [(m, feature) for m, features in drawn.items() if m is not None for feature in features]
    if not pairs:
        return []
    boxes = np.array([feature.box() for _, feature in pairs])
    owners = _grouped(boxes)
    found = []
    for owner in range(owners.max() + 1):
        members = [pairs[i] for i in np.flatnonzero(owners == owner)]
        left, bottom = boxes[owners == owner, :2].min(axis=0)
        right, top = boxes[owners == owner, 2:].max(axis=0)
        found.append(
            Cluster(
                (float(left), float(bottom), float(right), float(top)),
                Counter(meaning for meaning, _ in members),
                sum(_n_swings(feature) for _, feature in members),
            )
        )
    return sorted((c for c in found if c.is_plan), key=lambda c: c.rank, reverse=True)


def within(drawn: Drawn, bounds_mm: tuple[float, float, float, float]) -> tuple[Drawn, int]:
    """What is drawn in a rectangle, wholly or in part, and how much is left out."""
    left, bottom, right, top = bounds_mm
    kept: Drawn = {}
    n_left_out = 0
    for meaning, features in drawn.items():
        boxes = [feature.box() for feature in features]
        kept[meaning] = [
            feature
            for feature, (x0, y0, x1, y1) in zip(features, boxes, strict=True)
            if x0 <= right and left <= x1 and y0 <= top and bottom <= y1
        ]
        n_left_out += len(features) - len(kept[meaning])
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
        (left, bottom), (right, top) = frame.to_drawing(np.reshape(cluster.bounds_mm, (2, 2)))
        parts.append(f"{number} from ({left:.6g}, {bottom:.6g}) to ({right:.6g}, {top:.6g})")
    return ", ".join(parts)


def _holds(cluster: Cluster, spot_mm: Point) -> bool:
    left, bottom, right, top = cluster.bounds_mm
    return left <= spot_mm[0] <= right and bottom <= spot_mm[1] <= top


def _n_swings(feature: Feature) -> int:
    return sum(
        isinstance(piece, Arc) and np.pi / 3 <= piece.sweep_rad <= 2 * np.pi / 3
        for path in feature.paths
        for piece in path.pieces
    )


def _grouped(boxes: FloatArray) -> npt.NDArray[np.int64]:
    """The number of the cluster that each box belongs to; boxes of clusters do not overlap."""
    owners = _dissolved(boxes, BLANK_MM / 2)
    while True:
        n = owners.max() + 1
        left_bottom, right_top = np.full((n, 2), np.inf), np.full((n, 2), -np.inf)
        np.minimum.at(left_bottom, owners, boxes[:, :2])
        np.maximum.at(right_top, owners, boxes[:, 2:])
        merged = _dissolved(np.hstack((left_bottom, right_top)), TOUCH_MM)
        if merged.max() + 1 == n:
            return owners
        owners = merged[owners]


def _dissolved(boxes: FloatArray, reach_mm: float) -> npt.NDArray[np.int64]:
    """Numbers of the groups that boxes form when each is grown on all sides."""
    left, bottom, right, top = boxes.T
    grown = shapely.box(left - reach_mm, bottom - reach_mm, right + reach_mm, top + reach_mm)
    parts = polygons_in([shapely.union_all(grown)])
    corners = shapely.points(left, bottom)
    return np.asarray(shapely.STRtree(parts).nearest(corners))
