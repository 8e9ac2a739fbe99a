"""Nodes at which a convex part touches something, exactly, a row interval at a time.

For a convex part K of the robot (corners relative to the disc centre, radius r) and a piece P of
an obstacle (radius s), the disc centres at which they touch are

    P ⊕ (-K) ⊕ disc(r + s + clearance + CONTACT_MM)

Where P is monotone, each lattice row meets this sum in one closed interval: two parts of P one
above the other share a level cut, and the sum of a convex K with that holds every row that both
their sums hold. The interval's left end is the least of what the left side of -K makes with each
bulge and each hollow of the left side of P:

- with a bulge, both being convex functions x(y), a curve whose edges are those of both in the
  order of their slopes (and circles about its corners, offset lines along its edges);
- with a hollow, the hollow's offset lines at each corner of -K: nothing can be least half-way
  along an edge of -K or at a corner of the hollow, since there the hollow bends away from both
  sides.

Its right end is the same, mirrored. One kernel sets the bits of the intervals. No pixels are
involved; `collision` is the reference it is held to.

Coordinates inside the kernels are lattice units: node [iy, ix] lies at (ix, iy).
"""

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from satAOI_geo.kernels import filled, helper, kernel
from satAOI_geo.lattice import Lattice, Words
from satAOI_geo.nodes import set_bits
from satAOI_geo.pieces import Pieces
from satAOI_geo.plan import CONTACT_MM, BoolArray, FloatArray, FloorPlan, IntArray
from satAOI_geo.robot import Part, Robot

BARRED: Final = 256
"""Steps that there is room for at first: most parts bar none, or a few, between their ends."""

SLACK: Final = 1e-9
"""By how much offset lines end beyond their ends, in lattice units: no row may fall between two
lines for rounding. Coordinates of 1 km are rounded by a hundredth of that."""


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
        asked = np.ones(lattice.n_rows, dtype=np.bool_) if rows is None else rows
        return filled(
            lambda barred: _block(
                words,
                lattice.first_row,
                lattice.n_columns,
                mirrored,
                (part.radius_mm + self.keep_mm) / lattice.step_mm,
                pieces.x,
                pieces.y,
                pieces.first,
                pieces.is_hollow,
                pieces.of_side,
                pieces.bottom,
                pieces.top,
                pieces.radius,
                np.empty((4, len(mirrored) + 1)),
                np.empty((4, lattice.n_rows)),
                asked,
                np.empty((2, lattice.n_rows), dtype=np.int64),
                watch,
                barred,
            ),
            np.empty((BARRED, 3), dtype=np.int64),
        )


def _from_lowest(corners: FloatArray) -> FloatArray:
    """The same ring of corners, starting at the lowest, then leftmost one."""
    lowest = np.lexsort((corners[:, 0], corners[:, 1]))[0]
    return np.concatenate((corners[lowest:], corners[:lowest]))


@kernel(
    "int64(uint64[:, :], int64, int64, const float64[:, :], float64, const float64[:], "
    "const float64[:], const int64[:], const bool[:], const int64[:], const float64[:], "
    "const float64[:], const float64[:], float64[:, :], float64[:, :], const bool[:], "
    "int64[:, :], bool, int64[:, :])"
)
def _block(
    words: Words,
    first_row: int,
    n_columns: int,
    part: FloatArray,
    reach: float,
    x: FloatArray,
    y: FloatArray,
    first: IntArray,
    is_hollow: BoolArray,
    of_side: IntArray,
    bottom: FloatArray,
    top: FloatArray,
    radius: FloatArray,
    sides: FloatArray,
    ends: FloatArray,
    rows: BoolArray,
    nearest: IntArray,
    watch: bool,  # noqa: FBT001  kernels take no keywords
    barred: IntArray,
) -> int:
    """Set the bits of the lattice points in (piece ⊕ part) ⊕ disc(reach + radius), piece by piece.

    Args:
        words: Shape (n_rows, n_words), the rows from first_row on.
        first_row: Row of the whole lattice that row 0 of words is.
        n_columns: Columns of the lattice.
        part: Shape (n, 2), corners of the part, already turned by 180°, counter-clockwise from its
            lowest on.
        reach: Radius of the part and distance to keep.
        x: These and the following are those of `Pieces`.
        y: The same.
        first: The same.
        is_hollow: The same.
        of_side: The same.
        bottom: The same.
        top: The same.
        radius: The same.
        sides: Room for the part's left side, x and y, and its right side, mirrored.
        ends: Room for four numbers a row: the left end of a piece's interval, the right end,
            mirrored, and how far the piece reaches to the left and to the right, mirrored, between
            this row and the next, beyond what it does on the two.
        rows: Which rows are asked for; all where steps are looked for.
        nearest: Room for two numbers a row, see `_find_nearest`.
        watch: Whether to look for steps that a piece bars between their ends.
        barred: Room for steps that are barred, three numbers each, see `Engine.block`.

    Returns:
        How many barred steps there are.
    """
    n_rows = words.shape[0]
    n_barred = 0
    _find_nearest(rows, nearest)
    n_left, n_right = _part_sides(part, sides)
    part_bottom, part_top = sides[1, 0], sides[1, n_left - 1]
    for piece in range(radius.size):
        r = reach + radius[piece]
        lowest = math.ceil(bottom[piece] + part_bottom - r)
        highest = math.floor(top[piece] + part_top + r)
        if lowest >= first_row + n_rows or highest < first_row:
            continue
        low = nearest[0, max(lowest - first_row, 0)]
        high = nearest[1, min(highest - first_row, n_rows - 1)]
        # what lies between two rows touches no node, but may bar a step
        if low > high and not watch:
            continue
        for side in range(2):
            n_corners = n_right if side else n_left
            part_x, part_y = sides[2 * side, :n_corners], sides[2 * side + 1, :n_corners]
            begin, end = of_side[2 * piece + side], of_side[2 * piece + side + 1]
            curves, hollows = first[begin : end + 1], is_hollow[begin:end]
            rows_met = ends[side, low : high + 1]
            _meet_side(x, y, curves, hollows, part_x, part_y, r, first_row + low, rows_met)
            if watch:
                below, above = max(lowest - first_row, 1) - 1, min(highest - first_row + 1, n_rows)
                rows_met = ends[2 + side, below:above]
                _watch_side(x, y, curves, part_x, part_y, r, first_row + below, rows_met)
        _to_columns(ends[0, low : high + 1], ends[1, low : high + 1])
        n_barred = _cover(words, ends, low, high, n_columns, barred, n_barred)
        if watch:
            n_barred = _bar_steps_up(
                barred, n_barred, ends, lowest - first_row, highest - first_row, n_columns
            )
    # of those to the right some come along anyway
    return n_barred if watch else 0


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
def _part_sides(part: FloatArray, sides: FloatArray) -> tuple[int, int]:
    """Write the left side of a convex polygon and its right side, mirrored, from the bottom up.

    Returns:
        How many corners each has: a level edge at the bottom or the top is left out.
    """
    n = part.shape[0]
    n_rising = 0
    for k in range(1, n):
        rise = part[k, 1] - part[k - 1, 1]
        if rise > 0.0 or (rise == 0.0 and part[k, 0] > part[k - 1, 0]):
            n_rising = k
    n_left = n_right = 0
    for k in range(n_rising + 1):
        n_right = _put(sides[2:], n_right, -part[k, 0], part[k, 1])
    n_left = _put(sides[:2], n_left, part[0, 0], part[0, 1])
    for k in range(n - 1, n_rising - 1, -1):
        n_left = _put(sides[:2], n_left, part[k, 0], part[k, 1])
    return n_left, n_right


@helper
def _put(side: FloatArray, n: int, x: float, y: float) -> int:
    """Write a corner of a side as number n; of two that are level only the one on the left."""
    if n and y <= side[1, n - 1]:
        n -= 1
        x = min(x, side[0, n])
    side[0, n], side[1, n] = x, y
    return n + 1


@helper
def _to_columns(left: FloatArray, right: FloatArray) -> None:
    """Move the ends of intervals inwards, to the next whole column; right ones are not mirrored."""
    for k in range(left.size):
        left[k] = np.ceil(left[k])
        right[k] = np.floor(-right[k])


@helper
def _columns(left: float, right: float, n_columns: int) -> tuple[int, int]:
    """First and last of the lattice's columns from one whole number to another.

    The last comes before the first where there are none.
    """
    return int(min(max(0.0, left), n_columns)), int(max(min(n_columns - 1.0, right), -1.0))


@helper
def _cover(
    words: Words,
    ends: FloatArray,
    low: int,
    high: int,
    n_columns: int,
    barred: IntArray,
    n_barred: int,
) -> int:
    """Set the bits of a piece's intervals; append steps to the right across those without a node.

    Returns:
        How many barred steps there are then.
    """
    for iy in range(low, high + 1):
        begin_ix, end_ix = _columns(ends[0, iy], ends[1, iy], n_columns)
        if begin_ix <= end_ix:
            set_bits(words[iy], begin_ix, end_ix)
        elif end_ix >= 0 and begin_ix < n_columns:
            n_barred = _append(barred, n_barred, 0, iy, end_ix)
    return n_barred


@helper
def _bar_steps_up(
    barred: IntArray, n_barred: int, ends: FloatArray, lowest: int, highest: int, n_columns: int
) -> int:
    """Append the steps up that a piece meets between their ends only.

    From one row to the next the piece spans all columns from the leftmost to the rightmost that it
    reaches on the two and between them.

    Args:
        barred: Room for three numbers a step, see `Engine.block`.
        n_barred: How many steps there are before.
        ends: See the caller.
        lowest: The first row that the piece meets, in `ends` or not.
        highest: The last one.
        n_columns: Columns of the lattice.

    Returns:
        How many steps there are then.
    """
    left, right = ends[0], ends[1]
    for iy in range(max(0, lowest - 1), min(left.size - 2, highest) + 1):
        is_plain = lowest <= iy < highest and ends[2, iy] == np.inf and ends[3, iy] == np.inf
        if is_plain and max(left[iy], left[iy + 1]) <= min(right[iy], right[iy + 1]):
            # both rows hold a common node, and the piece does not reach beyond them between
            continue
        least, greatest = (
            math.ceil(min(ends[2, iy], n_columns)),
            math.floor(max(-ends[3, iy], -1.0)),
        )
        begin_ix, end_ix = n_columns, -1
        next_begin_ix, next_end_ix = n_columns, -1
        if iy >= lowest:
            least, greatest = min(least, left[iy]), max(greatest, right[iy])
            begin_ix, end_ix = _columns(left[iy], right[iy], n_columns)
        if iy < highest:
            least, greatest = min(least, left[iy + 1]), max(greatest, right[iy + 1])
            next_begin_ix, next_end_ix = _columns(left[iy + 1], right[iy + 1], n_columns)
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
def _append(barred: IntArray, n: int, rows_up: int, iy: int, ix: int) -> int:
    """Write a step as number n, if there is room for it; the next number."""
    if n < barred.shape[0]:
        barred[n, 0], barred[n, 1], barred[n, 2] = rows_up, iy, ix
    return n + 1


@helper
def _watch_side(
    x: FloatArray,
    y: FloatArray,
    first: IntArray,
    part_x: FloatArray,
    part_y: FloatArray,
    r: float,
    low: int,
    left: FloatArray,
) -> None:
    """Write how far left the curves of a side, with a part and rounded, reach.

    That goes to the row, from `low` on, below the place where a curve does so.
    """
    _clear(left)
    at = _leftmost(part_x)
    for curve in range(first.size - 1):
        begin = first[curve]
        of_curve = begin + _leftmost(x[begin : first[curve + 1]])
        iy = math.floor(y[of_curve] + part_y[at]) - low
        if 0 <= iy < left.size:
            left[iy] = min(left[iy], x[of_curve] + part_x[at] - r)


@helper
def _leftmost(x: FloatArray) -> int:
    """Where the least value is; numpy's own takes a second to compile."""
    least = 0
    for k in range(1, x.size):
        if x[k] < x[least]:
            least = k
    return least


@helper
def _meet_side(
    x: FloatArray,
    y: FloatArray,
    first: IntArray,
    is_hollow: BoolArray,
    part_x: FloatArray,
    part_y: FloatArray,
    r: float,
    low: int,
    left: FloatArray,
) -> None:
    """Write the left ends of a side, with a part and rounded, in the rows from `low` on.

    Args:
        x: Corners of curves.
        y: The same.
        first: Where each curve of this side starts, and where the last one ends.
        is_hollow: Whether it is a hollow.
        part_x: Left side of the part.
        part_y: The same.
        r: The radius by which their sum is rounded.
        low: The row that the first left end is of.
        left: The left ends.
    """
    _clear(left)
    for curve in range(is_hollow.size):
        begin, end = first[curve], first[curve + 1]
        if is_hollow[curve]:
            _meet_hollow(x[begin:end], y[begin:end], part_x, part_y, r, low, left)
        else:
            _meet_bulge(x[begin:end], y[begin:end], part_x, part_y, r, low, left)


@helper
def _clear(left: FloatArray) -> None:
    """No left ends yet."""
    for k in range(left.size):
        left[k] = np.inf


@helper
def _meet_bulge(
    ax: FloatArray,
    ay: FloatArray,
    bx: FloatArray,
    by: FloatArray,
    r: float,
    low: int,
    left: FloatArray,
) -> None:
    """Lower the left ends in the rows from `low` on to those of two bulges, added and rounded."""
    i = j = 0
    n_a, n_b = ax.size - 1, bx.size - 1
    vx, vy = ax[0] + bx[0], ay[0] + by[0]
    last = min(low + left.size - 1.0, ay[n_a] + by[n_b] + r)
    iy = max(low, math.ceil(vy - r))
    while i < n_a or j < n_b:
        if i == n_a:
            takes_a = False
        elif j == n_b:
            takes_a = True
        else:
            rise_a, rise_b = ay[i + 1] - ay[i], by[j + 1] - by[j]
            takes_a = (ax[i + 1] - ax[i]) * rise_b < (bx[j + 1] - bx[j]) * rise_a
        if takes_a:
            i += 1
        else:
            j += 1
        next_x, next_y = ax[i] + bx[j], ay[i] + by[j]
        dx, dy = next_x - vx, next_y - vy
        if dy > 0.0:
            length = math.sqrt(dx * dx + dy * dy)
            nx, ny = -r * dy / length, r * dx / length
            iy = _arc(vx, vy, r, iy, min(last, vy + ny), low, left)
            iy = _line(vx + nx, vy + ny, dx / dy, iy, min(last, next_y + ny), low, left)
        elif dx >= 0.0:
            # level for rounding: only its left end matters
            continue
        vx, vy = next_x, next_y
    _arc(vx, vy, r, iy, last, low, left)


@helper
def _arc(vx: float, vy: float, r: float, iy: int, last: float, low: int, left: FloatArray) -> int:
    """Lower left ends from row iy up to `last` to the circle about (vx, vy); next row."""
    next_iy = max(iy, math.floor(last) + 1)
    rows = left[iy - low : next_iy - low]
    for k in range(rows.size):
        rise = (iy + k) - vy
        rows[k] = min(rows[k], vx - math.sqrt(max(0.0, r * r - rise * rise)))
    return next_iy


@helper
def _line(
    x0: float, y0: float, slope: float, iy: int, last: float, low: int, left: FloatArray
) -> int:
    """Lower left ends from row iy up to `last` to the line through (x0, y0); next row."""
    next_iy = max(iy, math.floor(last) + 1)
    rows = left[iy - low : next_iy - low]
    for k in range(rows.size):
        rows[k] = min(rows[k], x0 + ((iy + k) - y0) * slope)
    return next_iy


@helper
def _meet_hollow(
    ax: FloatArray,
    ay: FloatArray,
    bx: FloatArray,
    by: FloatArray,
    r: float,
    low: int,
    left: FloatArray,
) -> None:
    """Lower the left ends in the rows from `low` on to a hollow's offset lines at corners b."""
    last_row = low + left.size - 1
    for i in range(ax.size - 1):
        dx, dy = ax[i + 1] - ax[i], ay[i + 1] - ay[i]
        length = math.sqrt(dx * dx + dy * dy)
        x0, y0 = ax[i] - r * dy / length, ay[i] + r * dx / length
        slope, least = dx / dy, min(0.0, dx)
        for j in range(bx.size):
            vx, vy = x0 + bx[j], y0 + by[j]
            for iy in range(
                max(low, math.ceil(vy - SLACK)), min(last_row, math.floor(vy + dy + SLACK)) + 1
            ):
                across = max((iy - vy) * slope, least)
                left[iy - low] = min(left[iy - low], vx + across)
