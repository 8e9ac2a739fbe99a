"""Obstacles as monotone pieces, and the sides of these as bulges and hollows.

The left side of a monotone piece is a function x(y) from its lowest to its highest corner, the
right side is another. What is level in between, or at an end, is a jump. A *bulge* is a stretch of
a side that bends outwards at all corners but its ends; a *hollow* one that bends inwards at all,
its ends included. A convex side is one bulge; the inner side of a thin band along an arc is a
hollow between two bulges, its first and its last chord.

Right sides are mirrored at x = 0, so that all are left sides.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from shapely.geometry import LineString

from satAOI_geo.lattice import Lattice
from satAOI_geo.monotone import monotone_pieces
from satAOI_geo.plan import (
    BoolArray,
    Circle,
    FloatArray,
    FloorPlan,
    IntArray,
    Shape,
    polygons_in,
    radius_mm_of,
)


@dataclass(frozen=True, slots=True)
class Pieces:
    """Monotone pieces whose union is every obstacle and the outside of the floor.

    Coordinates are lattice units: node [iy, ix] lies at (ix, iy).

    Attributes:
        x: Shape (n,), corners of all bulges and hollows, each from the bottom up.
        y: Shape (n,).
        first: Shape (n_curves + 1,), where each bulge or hollow starts in x and y.
        is_hollow: Shape (n_curves,).
        of_side: Shape (2 * m + 1,), where each side starts in is_hollow; the sides of piece k are
            2 * k, the left one, and 2 * k + 1.
        bottom: Shape (m,), y of the lowest corner of each piece.
        top: Shape (m,), y of the highest corner.
        radius: Shape (m,), how far each piece reaches beyond its sides.
    """

    x: FloatArray
    y: FloatArray
    first: IntArray
    is_hollow: BoolArray
    of_side: IntArray
    bottom: FloatArray
    top: FloatArray
    radius: FloatArray

    @classmethod
    def of(cls, plan: FloorPlan, lattice: Lattice, margin_mm: float) -> "Pieces":
        """The pieces of a plan; the outside of the floor reaches out to the margin."""
        outside = polygons_in([plan.outside(margin_mm)])
        shapes: list[Shape] = [*(o.shape for o in plan.obstacles), *outside]
        rings, radii_mm = [], []
        for shape in shapes:
            of_shape = list(_rings(shape, lattice))
            rings += of_shape
            radii_mm += [radius_mm_of(shape)] * len(of_shape)
        x, y = np.concatenate(rings).T
        starts = _starts([len(ring) for ring in rings])
        bottom = np.minimum.reduceat(y, starts[:-1])
        top = np.maximum.reduceat(y, starts[:-1])
        curves = _curves(*_sides(x, y, starts))
        return cls(*curves, bottom, top, np.array(radii_mm) / lattice.step_mm)

    def between(self, low: float, high: float) -> "Pieces":
        """The pieces that reach into the rows from low to high."""
        kept = (self.top + self.radius >= low) & (self.bottom - self.radius <= high)
        n_curves, n_corners = np.diff(self.of_side), np.diff(self.first)
        sides = np.repeat(kept, 2)
        curves = np.repeat(sides, n_curves)
        corners = np.repeat(curves, n_corners)
        return Pieces(
            self.x[corners],
            self.y[corners],
            _starts(n_corners[curves]),
            self.is_hollow[curves],
            _starts(n_curves[sides]),
            self.bottom[kept],
            self.top[kept],
            self.radius[kept],
        )


def _rings(shape: Shape, lattice: Lattice) -> Iterator[FloatArray]:
    """Corners of monotone polygons whose union is the shape, in lattice units.

    Lines are there and back again.
    """

    def units(points_mm: FloatArray) -> FloatArray:
        return np.asarray((points_mm - np.array(lattice.origin_mm)) / lattice.step_mm - 0.5)

    if isinstance(shape, Circle):
        yield units(np.array([(shape.x_mm, shape.y_mm)]))
    elif isinstance(shape, LineString):
        # corners on hardly different levels may be on one once they are in lattice units
        for chain in _rising_chains(units(np.asarray(shape.coords)[:, :2])):
            yield np.concatenate((chain, chain[-2:0:-1]))
    else:
        yield from map(units, monotone_pieces(shape))


def _rising_chains(line: FloatArray) -> list[FloatArray]:
    """A line, shape (n, 2), cut where it begins to rise or to fall; level, to go right or left."""
    dx, dy = np.diff(line, axis=0).T
    rises = (dy > 0) | ((dy == 0) & (dx > 0))
    turns = np.flatnonzero(rises[1:] != rises[:-1]) + 1
    ends = [0, *turns.tolist(), len(rises)]
    return [line[begin : end + 1] for begin, end in pairwise(ends)]


def _sides(
    x: FloatArray, y: FloatArray, starts: IntArray
) -> tuple[FloatArray, FloatArray, IntArray]:
    """The sides of monotone rings, right ones mirrored, each from the bottom up.

    Args:
        x: Shape (n,), corners of all rings, counter-clockwise.
        y: The same.
        starts: Shape (m + 1,), where each ring starts.

    Returns:
        x and y of the corners of all sides, and where each side starts, shape (2 * m + 1,).
    """
    n_corners = np.diff(starts)
    n_rings = n_corners.size
    # of corners at one height that on the left counts as the lower
    upwards = np.lexsort((x, y, np.repeat(np.arange(n_rings), n_corners)))
    lowest, highest = upwards[starts[:-1]], upwards[starts[1:] - 1]
    n_rising = (highest - lowest) % n_corners
    first = _starts(np.column_stack((n_corners - n_rising + 1, n_rising + 1)).ravel())
    side = np.repeat(np.arange(2 * n_rings), np.diff(first))
    ring, is_right = side // 2, side % 2 == 1
    from_bottom = np.arange(first[-1]) - first[side]
    # right sides run as the ring does, left ones against it
    from_lowest = np.where(is_right, from_bottom, -from_bottom)
    begin = starts[ring]
    corner = begin + (lowest[ring] - begin + from_lowest) % n_corners[ring]
    return np.where(is_right, -x[corner], x[corner]), y[corner], first


def _curves(
    x: FloatArray, y: FloatArray, starts: IntArray
) -> tuple[FloatArray, FloatArray, IntArray, BoolArray, IntArray]:
    """The bulges and hollows of sides: what `Pieces` has of them, up to of_side.

    Args:
        x: Shape (n,), corners of all sides, each from the bottom up.
        y: The same.
        starts: Shape (n_sides + 1,), where each side starts.
    """
    goes_on = np.ones(x.size, dtype=np.bool_)
    goes_on[starts[1:] - 1] = False
    dx, dy = np.append(np.diff(x), 0.0), np.append(np.diff(y), 0.0)
    rises = goes_on & (dy > 0)
    risen = np.roll(rises, 1)
    bends_in = rises & risen & (dx * np.roll(dy, 1) < np.roll(dx, 1) * dy)
    # pieces of a hollow, by where they begin
    hollow = rises & bends_in & np.roll(bends_in, -1)
    hollowed = np.roll(hollow, 1)
    begins_bulge = rises & ~hollow & (bends_in | ~risen)
    ends_bulge = risen & ~hollowed & (bends_in | ~rises)
    # a corner that is level with its neighbours is a bulge, unless one of these is before it
    is_hidden = (goes_on & (dx <= 0)) | (np.roll(goes_on, 1) & (np.roll(dx, 1) > 0))
    is_alone = ~rises & ~risen & ~is_hidden
    begin_bulge = np.flatnonzero(begins_bulge | is_alone)
    end_bulge = np.flatnonzero(ends_bulge | is_alone)
    begin = np.concatenate((begin_bulge, np.flatnonzero(hollow & ~hollowed)))
    end = np.concatenate((end_bulge, np.flatnonzero(hollowed & ~hollow)))
    order = np.argsort(begin)
    n_corners = (end - begin + 1)[order]
    first = _starts(n_corners)
    corner = np.arange(first[-1]) + np.repeat(begin[order] - first[:-1], n_corners)
    of_side = np.searchsorted(begin[order], starts)
    return x[corner], y[corner], first, order >= begin_bulge.size, of_side


def _starts(sizes: IntArray | list[int]) -> IntArray:
    """Where each of some groups starts, and where the last one ends."""
    return np.concatenate(([0], np.cumsum(sizes, dtype=np.int64)))
