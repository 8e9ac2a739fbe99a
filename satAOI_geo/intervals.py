"""Nodes at which a convex part touches something, exactly, a row interval at a time.

For a convex part K of the robot (corners relative to the disc centre, radius r) and a convex
piece P of an obstacle (radius s), the disc centres at which they touch are

    P ⊕ (-K) ⊕ disc(r + s + clearance + CONTACT_MM)

which is convex, so each lattice row meets it in one closed interval: circles about the corners,
offset lines along the sides. One kernel walks both flanks of that shape upwards, row by row, and
sets the interval's bits. No pixels are involved; `collision` is the reference it is held to.

Coordinates inside the kernels are lattice units: node [iy, ix] lies at (ix, iy).
"""

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from shapely.geometry import LineString

from satAOI_geo.convex import convex_pieces
from satAOI_geo.kernels import filled, helper, kernel
from satAOI_geo.lattice import Lattice, Words
from satAOI_geo.plan import (
    CONTACT_MM,
    BoolArray,
    Circle,
    FloatArray,
    FloorPlan,
    IntArray,
    Shape,
    polygons_in,
)
from satAOI_geo.robot import Part, Robot

BARRED: Final = 256
"""Steps that there is room for at first: most parts bar none, or a few, between their ends."""


@dataclass(frozen=True, slots=True)
class Pieces:
    """Convex pieces whose union is every obstacle and the outside of the floor, in lattice units.

    Attributes:
        x: Shape (n,), corners of all pieces, each piece counter-clockwise from its lowest,
            then leftmost corner. One corner is a circle, two are a segment.
        y: Shape (n,).
        first: Shape (m + 1,), where each piece starts in x and y.
        top: Shape (m,), y of the highest corner of each piece.
        radius: Shape (m,), how far each piece reaches beyond its corners.
    """

    x: FloatArray
    y: FloatArray
    first: IntArray
    top: FloatArray
    radius: FloatArray

    @classmethod
    def of(cls, plan: FloorPlan, lattice: Lattice, margin_mm: float) -> "Pieces":
        """The pieces of a plan; the outside of the floor reaches out to the margin."""
        outside = polygons_in([plan.outside(margin_mm)])
        shapes: list[Shape] = [*(o.shape for o in plan.obstacles), *outside]
        corners, radii_mm = [], []
        for shape in shapes:
            for piece_mm in _pieces(shape):
                corners.append(_in_lattice_units(piece_mm, lattice))
                radii_mm.append(shape.radius_mm if isinstance(shape, Circle) else 0.0)
        x, y = np.concatenate(corners).T
        first = np.cumsum([0, *(len(piece) for piece in corners)])
        return cls(
            np.ascontiguousarray(x),
            np.ascontiguousarray(y),
            first.astype(np.int64),
            np.maximum.reduceat(y, first[:-1]),
            np.array(radii_mm) / lattice.step_mm,
        )

    def between(self, low: float, high: float) -> "Pieces":
        """The pieces that reach into the rows from low to high."""
        bottom = self.y[self.first[:-1]]
        kept = (self.top + self.radius >= low) & (bottom - self.radius <= high)
        n_corners = np.diff(self.first)
        corners = np.repeat(kept, n_corners)
        first = np.concatenate(([0], np.cumsum(n_corners[kept])))
        return Pieces(self.x[corners], self.y[corners], first, self.top[kept], self.radius[kept])


@dataclass(frozen=True, slots=True)
class Intervals:
    """The fast engine: tells where a part touches something by row intervals.

    Attributes:
        lattice: Nodes and directions.
        pieces: All that a part can touch at these nodes.
        keep_mm: Distance at which it is touched.
        reach_mm: No part reaches farther from its node.
    """

    lattice: Lattice
    pieces: Pieces
    keep_mm: float
    reach_mm: float

    @classmethod
    def of(
        cls, plan: FloorPlan, robot: Robot, lattice: Lattice, clearance_mm: float = 0.0
    ) -> "Intervals":
        """The engine for a plan and the parts of a robot, at rest or swept by one move.

        The clearance is the distance to keep beyond contact.
        """
        keep_mm = clearance_mm + CONTACT_MM
        # a swept part reaches beyond the robot by one step, or by the push of its convex hull
        # beyond the arc, which is largest, half as far again, at four directions
        reach_mm = 1.5 * robot.reach_mm + lattice.step_mm + keep_mm
        return cls(lattice, Pieces.of(plan, lattice, reach_mm), keep_mm, reach_mm)

    def block(self, words: Words, part: Part) -> IntArray:
        """Set the bits of the nodes at which the part touches something; the steps it bars."""
        return self._block(words, part, None, watch=True)

    def band(self, rows: slice) -> "Intervals":
        """An engine for some rows of the lattice, with start and stop."""
        lattice = self.lattice.band(rows)
        reach = self.reach_mm / lattice.step_mm
        low, high = lattice.first_row, lattice.first_row + lattice.n_rows
        pieces = self.pieces.between(low - reach, high + reach)
        return replace(self, lattice=lattice, pieces=pieces)

    def blocked(self, part: Part, rows: BoolArray | None = None) -> Words:
        """Nodes at which the part touches something, and every bit beyond the last column."""
        words = self.lattice.no_nodes()
        self._block(words, part, rows, watch=False)
        return words

    def _block(self, words: Words, part: Part, rows: BoolArray | None, *, watch: bool) -> IntArray:
        """Set the bits of the nodes at which the part touches something; see the kernel."""
        lattice, pieces = self.lattice, self.pieces
        # -K: a half turn keeps the sense of rotation
        mirrored = _from_lowest(-part.corners_mm / lattice.step_mm)
        part_x, part_y = np.ascontiguousarray(mirrored.T)
        reach = (part.radius_mm + self.keep_mm) / lattice.step_mm
        # no piece has more corners than all have together
        corners = np.empty((2, pieces.x.size + part_x.size + 1))
        flanks = np.empty((2, lattice.n_rows))
        asked = np.ones(lattice.n_rows, dtype=np.bool_) if rows is None else rows
        nearest = np.empty((2, lattice.n_rows), dtype=np.int64)
        return filled(
            lambda barred: _block(
                words,
                lattice.first_row,
                lattice.n_columns,
                part_x,
                part_y,
                reach,
                pieces.x,
                pieces.y,
                pieces.first,
                pieces.top,
                pieces.radius,
                corners,
                flanks,
                asked,
                nearest,
                watch,
                barred,
            ),
            np.empty((BARRED, 3), dtype=np.int64),
        )


def _pieces(shape: Shape) -> list[FloatArray]:
    """Corners of convex polygons, segments or a point whose union is the shape."""
    if isinstance(shape, Circle):
        return [np.array([(shape.x_mm, shape.y_mm)])]
    if isinstance(shape, LineString):
        chain_mm = np.asarray(shape.coords)[:, :2]
        return [chain_mm[i : i + 2] for i in range(len(chain_mm) - 1)]
    return convex_pieces(shape)


def _in_lattice_units(points_mm: FloatArray, lattice: Lattice) -> FloatArray:
    """Points with node [iy, ix] at (ix, iy), from the lowest, then leftmost one on."""
    return _from_lowest((points_mm - np.array(lattice.origin_mm)) / lattice.step_mm - 0.5)


def _from_lowest(corners: FloatArray) -> FloatArray:
    """The same ring of corners, starting at the lowest, then leftmost one."""
    lowest = np.lexsort((corners[:, 0], corners[:, 1]))[0]
    return np.concatenate((corners[lowest:], corners[:lowest]))


@kernel(
    "int64(uint64[:, :], int64, int64, const float64[:], const float64[:], float64, "
    "const float64[:], const float64[:], const int64[:], const float64[:], const float64[:], "
    "float64[:, :], float64[:, :], const bool[:], int64[:, :], bool, int64[:, :])"
)
def _block(
    words: Words,
    first_row: int,
    n_columns: int,
    part_x: FloatArray,
    part_y: FloatArray,
    reach: float,
    x: FloatArray,
    y: FloatArray,
    first: IntArray,
    top: FloatArray,
    radius: FloatArray,
    corners: FloatArray,
    flanks: FloatArray,
    rows: BoolArray,
    nearest: IntArray,
    watch: bool,  # noqa: FBT001  kernels take no keywords
    barred: IntArray,
) -> int:
    """Set the bits of the lattice points in (piece ⊕ part) ⊕ disc(reach + radius), piece by piece.

    The part is already turned by 180°. Lowest corner + lowest corner is the lowest corner of the
    sum, and its other corners follow by taking the edges of both in the order of their direction.

    Args:
        words: Shape (n_rows, n_words), the rows from first_row on.
        first_row: Row of the whole lattice that row 0 of words is.
        n_columns: Columns of the lattice.
        part_x: Corners of the part, from its lowest on.
        part_y: The same.
        reach: Radius of the part and distance to keep.
        x: These and the following are those of `Pieces`.
        y: The same.
        first: The same.
        top: The same.
        radius: The same.
        corners: Room for x and y of the corners of a sum, the first one twice.
        flanks: Room for its left and right end in each row.
        rows: Which rows are asked for; all where steps are looked for.
        nearest: Room for two numbers a row, see `_find_nearest`.
        watch: Whether to look for steps that a piece bars between their ends.
        barred: Room for such steps, three numbers each, see `Engine.block`.

    Returns:
        How many such steps there are.
    """
    n_rows = words.shape[0]
    sum_x, sum_y = corners[0], corners[1]
    left, right = flanks[0], flanks[1]
    n_barred = 0
    _find_nearest(rows, nearest)
    part_top = part_y[_extremes(part_y)[1]]
    for piece in range(radius.size):
        begin, end = first[piece], first[piece + 1]
        r = reach + radius[piece]
        lowest = math.ceil(y[begin] + part_y[0] - r)
        highest = math.floor(top[piece] + part_top + r)
        if lowest >= first_row + n_rows or highest < first_row:
            continue
        low = first_row + nearest[0, max(lowest - first_row, 0)]
        high = first_row + nearest[1, min(highest - first_row, n_rows - 1)]
        # what lies between two rows touches no node, but may bar a step
        if low > high and not watch:
            continue
        n_corners, n_rising = _minkowski_sum(
            x[begin:end], y[begin:end], part_x, part_y, sum_x, sum_y
        )
        _right_flank(sum_x, sum_y, n_rising, r, low, high, first_row, right)
        _left_flank(sum_x, sum_y, n_rising, n_corners, r, low, high, first_row, left)
        _to_columns(left[low - first_row : high - first_row + 1], right[low - first_row :])
        for iy in range(low - first_row, high - first_row + 1):
            begin_ix, end_ix = _columns(left[iy], right[iy], n_columns)
            if begin_ix <= end_ix:
                set_bits(words[iy], begin_ix, end_ix)
            elif watch and end_ix >= 0 and begin_ix < n_columns:
                n_barred = _append(barred, n_barred, 0, iy, end_ix)
        if watch:
            n_barred = _bar_steps_up(
                barred,
                n_barred,
                left,
                right,
                first_row,
                lowest,
                highest,
                sum_x[:n_corners],
                sum_y[:n_corners],
                r,
                n_columns,
            )
    return n_barred


@helper
def _find_nearest(rows: BoolArray, nearest: IntArray) -> None:
    """Write for each row the first one asked for from there on, and the last one up to there.

    The number of rows, or -1, where there is none.
    """
    last = -1
    for iy in range(rows.size):
        if rows[iy]:
            last = iy
        nearest[1, iy] = last
    first = rows.size
    for iy in range(rows.size - 1, -1, -1):
        if rows[iy]:
            first = iy
        nearest[0, iy] = first


@helper
def _to_columns(left: FloatArray, right: FloatArray) -> None:
    """Move the ends of intervals inwards, to the next whole column."""
    for k in range(left.size):
        left[k] = np.ceil(left[k])
        right[k] = np.floor(right[k])


@helper
def _columns(left: float, right: float, n_columns: int) -> tuple[int, int]:
    """First and last of the lattice's columns from one whole number to another.

    The last comes before the first where there are none.
    """
    return int(max(0.0, left)), int(min(n_columns - 1.0, right))


@helper
def _bar_steps_up(
    barred: IntArray,
    n_barred: int,
    left: FloatArray,
    right: FloatArray,
    first_row: int,
    lowest: int,
    highest: int,
    x: FloatArray,
    y: FloatArray,
    r: float,
    n_columns: int,
) -> int:
    """Append the steps up that a rounded polygon meets between their ends only.

    From one row to the next the polygon, which is convex, spans from the lesser of its left ends
    in the two to the greater of its right ends, or to its leftmost and rightmost point if it has
    these between the two.

    Args:
        barred: Room for three numbers a step, see `Engine.block`.
        n_barred: How many steps there are before.
        left: Left end in the rows that the polygon meets, from first_row on.
        right: Right end.
        first_row: See the caller.
        lowest: The first row that the polygon meets, on the lattice or not.
        highest: The last one.
        x: Of the polygon's corners.
        y: The same.
        r: By how much it is rounded.
        n_columns: Columns of the lattice.

    Returns:
        How many steps there are then.
    """
    leftmost, rightmost = _extremes(x)
    leftmost_row, rightmost_row = math.floor(y[leftmost]), math.floor(y[rightmost])
    last_row = first_row + left.size - 1
    for row in range(max(first_row, lowest - 1), min(last_row - 1, highest) + 1):
        iy = row - first_row
        is_plain = lowest <= row < highest and row not in (leftmost_row, rightmost_row)
        if is_plain and max(left[iy], left[iy + 1]) <= min(right[iy], right[iy + 1]):
            # both rows hold a common node, and the polygon does not reach beyond them between
            continue
        least, greatest = math.inf, -math.inf
        begin_ix, end_ix = n_columns, -1
        next_begin_ix, next_end_ix = n_columns, -1
        if row >= lowest:
            least, greatest = left[iy], right[iy]
            begin_ix, end_ix = _columns(least, greatest, n_columns)
        if row < highest:
            least, greatest = min(least, left[iy + 1]), max(greatest, right[iy + 1])
            next_begin_ix, next_end_ix = _columns(left[iy + 1], right[iy + 1], n_columns)
        if row == leftmost_row:
            least = min(least, math.ceil(x[leftmost] - r))
        if row == rightmost_row:
            greatest = max(greatest, math.floor(x[rightmost] + r))
        ix, last_ix = _columns(least, greatest, n_columns)
        while ix <= last_ix:
            if begin_ix <= ix <= end_ix:
                ix = end_ix
            elif next_begin_ix <= ix <= next_end_ix:
                ix = next_end_ix
            else:
                n_barred = _append(barred, n_barred, 1, iy, ix)
            ix += 1
    return n_barred


@helper
def _extremes(values: FloatArray) -> tuple[int, int]:
    """Where the least and the greatest value are; numpy's own takes a second to compile."""
    least = greatest = 0
    for k in range(1, values.size):
        if values[k] < values[least]:
            least = k
        if values[k] > values[greatest]:
            greatest = k
    return least, greatest


@helper
def _append(barred: IntArray, n: int, rows_up: int, iy: int, ix: int) -> int:
    """Write a step as number n, if there is room for it; the next number."""
    if n < barred.shape[0]:
        barred[n, 0], barred[n, 1], barred[n, 2] = rows_up, iy, ix
    return n + 1


@helper
def _minkowski_sum(
    ax: FloatArray,
    ay: FloatArray,
    bx: FloatArray,
    by: FloatArray,
    sum_x: FloatArray,
    sum_y: FloatArray,
) -> tuple[int, int]:
    """Corners of the sum of two convex polygons, the first corner again at the end.

    Both start at their lowest, then leftmost corner and run counter-clockwise. Returns the number
    of edges and the number of those that rise (direction in [0°, 180°)): the right flank.
    """
    n_a = ax.size if ax.size > 1 else 0
    n_b = bx.size if bx.size > 1 else 0
    sum_x[0], sum_y[0] = ax[0] + bx[0], ay[0] + by[0]
    i = j = n = n_rising = 0
    # the corners at which the edges i and j begin: a remainder would take longer than all else
    a = b = 0
    while i < n_a or j < n_b:
        a_next = a + 1 if a + 1 < ax.size else 0
        b_next = b + 1 if b + 1 < bx.size else 0
        adx, ady = ax[a_next] - ax[a], ay[a_next] - ay[a]
        bdx, bdy = bx[b_next] - bx[b], by[b_next] - by[b]
        # rising edges before falling ones, so that the cross product only ever compares
        # directions within the same half turn: parallel edges of a segment cannot be confused
        a_rises = ady > 0.0 or (ady == 0.0 and adx > 0.0)
        b_rises = bdy > 0.0 or (bdy == 0.0 and bdx > 0.0)
        if i == n_a:
            take_a, take_b = False, True
        elif j == n_b:
            take_a, take_b = True, False
        elif a_rises != b_rises:
            take_a, take_b = a_rises, b_rises
        else:
            cross = adx * bdy - ady * bdx
            take_a, take_b = cross >= 0.0, cross <= 0.0
        n += 1
        rises = (take_a and a_rises) or (take_b and b_rises)
        if take_a:
            i, a = i + 1, a_next
        if take_b:
            j, b = j + 1, b_next
        sum_x[n] = ax[a] + bx[b]
        sum_y[n] = ay[a] + by[b]
        if rises:
            n_rising = n
    return n, n_rising


@helper
def _right_flank(
    x: FloatArray,
    y: FloatArray,
    n_rising: int,
    r: float,
    low: int,
    high: int,
    first_row: int,
    right: FloatArray,
) -> None:
    """Greatest x of the rounded polygon in each row from low to high, going up its right side.

    The first element of the flank stands for first_row.
    """
    iy = low
    vx, vy = x[0], y[0]
    for k in range(1, n_rising + 1):
        dx, dy = x[k] - vx, y[k] - vy
        if dy > 0.0:
            length = math.hypot(dx, dy)
            nx, ny = dy / length, -dx / length
            iy = _arc(vx, vy, r, 1.0, iy, min(high, vy + r * ny), first_row, right)
            last = min(high, y[k] + r * ny)
            iy = _line(vx + r * nx, vy + r * ny, dx / dy, iy, last, first_row, right)
        vx, vy = x[k], y[k]
    _arc(vx, vy, r, 1.0, iy, high, first_row, right)


@helper
def _left_flank(
    x: FloatArray,
    y: FloatArray,
    n_rising: int,
    n_corners: int,
    r: float,
    low: int,
    high: int,
    first_row: int,
    left: FloatArray,
) -> None:
    """Least x of the rounded polygon in each row from low to high, going up its left side.

    The first element of the flank stands for first_row.
    """
    iy = low
    vx, vy = x[0], y[0]
    for k in range(n_corners - 1, n_rising - 1, -1):
        dx, dy = x[k] - vx, y[k] - vy
        if dy > 0.0:
            length = math.hypot(dx, dy)
            nx, ny = -dy / length, dx / length
            iy = _arc(vx, vy, r, -1.0, iy, min(high, vy + r * ny), first_row, left)
            last = min(high, y[k] + r * ny)
            iy = _line(vx + r * nx, vy + r * ny, dx / dy, iy, last, first_row, left)
        elif dx > 0.0:
            # the level top, met from its left end: the arc about that end takes all rows left
            break
        vx, vy = x[k], y[k]
    _arc(vx, vy, r, -1.0, iy, high, first_row, left)


@helper
def _arc(
    vx: float,
    vy: float,
    r: float,
    side: float,
    iy: int,
    last: float,
    first_row: int,
    flank: FloatArray,
) -> int:
    """Fill rows from iy up to `last` with the circle of radius r about (vx, vy); next row."""
    next_iy = max(iy, math.floor(last) + 1)
    rows = flank[iy - first_row : next_iy - first_row]
    for k in range(rows.size):
        rise = (iy + k) - vy
        rows[k] = vx + side * math.sqrt(max(0.0, r * r - rise * rise))
    return next_iy


@helper
def _line(
    x0: float, y0: float, slope: float, iy: int, last: float, first_row: int, flank: FloatArray
) -> int:
    """Fill rows from iy up to `last` with the line through (x0, y0); next row."""
    next_iy = max(iy, math.floor(last) + 1)
    rows = flank[iy - first_row : next_iy - first_row]
    for k in range(rows.size):
        rows[k] = x0 + ((iy + k) - y0) * slope
    return next_iy


@helper
def set_bits(row: Words, begin: int, end: int) -> None:
    """Set bits begin .. end of a row of words."""
    every = np.uint64(0xFFFFFFFFFFFFFFFF)
    first_word, last_word = begin >> 6, end >> 6
    first_mask = every << np.uint64(begin & 63)
    last_mask = every >> np.uint64(63 - (end & 63))
    if first_word == last_word:
        row[first_word] |= first_mask & last_mask
        return
    row[first_word] |= first_mask
    for word in range(first_word + 1, last_word):
        row[word] = every
    row[last_word] |= last_mask
