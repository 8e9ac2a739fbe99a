"""The union of equal discs on lattice nodes: the arcs that bound it.

Coordinates are lattice units here: node [iy, ix] lies at (ix, iy), and the discs have the radius
ρ = R / step. A lattice makes exact ties the rule. With R = 350 and a step of 10 the Pythagorean
triple 21, 28, 35 alone puts dozens of circles through one point, and discs 70 steps apart touch.

                  ρ·u(b)
          arc  .-'‾‾‾'-.  ρ·u(a)        An arc of the boundary runs counter-clockwise about its
             .'         '.              node p, the union on its left. It begins where the disc of
             '     p     '              one node (its opener) ends to cover p's circle, and ends
    closer ◦  '.       .'  ◦ opener     where the disc of another (its closer) begins to.
"""

import math
from dataclasses import dataclass

import numpy as np

from satAOI_geo.cells import TIE
from satAOI_geo.kernels import filled, helper, kernel
from satAOI_geo.lattice import Words
from satAOI_geo.nodes import Nodes, from_above, from_below, from_left, from_right
from satAOI_geo.plan import BoolArray, FloatArray, IntArray
from satAOI_geo.runs import rows_of

WELD = 1e-7
"""Ends of arcs this close, in steps, are one point: a nanometre at a step of 10 mm. Rounding moves
an end by 1e-13, and by 4e-9 where two discs all but touch."""

NOISE_RAD = 1e-13
"""Gaps this narrow come from rounding, and so are left out."""

TURN = 2 * math.pi


BEGIN, END, BEGIN_AT, END_AT = 0, 1, 2, 4
"""Columns of an array of gaps, stretches of a node's circle that no disc looked at so far covers:
directions in which the gap begins and ends, counter-clockwise in rad, begin < end; then x and y
from the node to where it begins, and to where it ends. A circle that nothing covers yet is one gap
from -π to π. The kernels pass plain arrays: a cache of compiled code that names a class cannot be
read once the class is gone."""

N_GAPS = 9
"""Room for what 8 neighbours leave of a circle: each parts one gap in two at most."""

N_AROUND = 9
"""Nodes of the square of a node and its 8 neighbours."""


@dataclass(frozen=True, slots=True)
class Arcs:
    """The boundary of a union of discs, loop after loop; each arc ends where the next begins.

    Attributes:
        nodes: Shape (n, 2), x and y of the node each arc runs about, counter-clockwise.
        begins: Shape (n, 2), where each arc begins. Loops that touch share this point exactly.
        spans_rad: Shape (n,), above 0, at most π.
        loops: Shape (m + 1,); loop k is the arcs from loops[k] up to, not including, loops[k + 1].
            No loop passes a point twice; the union lies on the left.
    """

    nodes: IntArray
    begins: FloatArray
    spans_rad: FloatArray
    loops: IntArray


def boundary(reached: Nodes, radius: float) -> Arcs:
    """The boundary of the union of the discs on the reached nodes.

    A covered point x of the circle about a reached node p (closer than ρ to some reached node) is
    covered by a 4-neighbour of p or by an *exposed* node, one with an unreached 4-neighbour; so
    only these are looked at. For let q be the node nearest to x. If q is not reached, go from any
    reached node that covers x towards q, one coordinate at a time, never farther from x: the last
    node before the first unreached one covers x and is exposed. If q is reached, go from q to p
    the same way: every node on the way is closer to x than p is, and so covers x. Either all of
    them are reached, then one is a 4-neighbour of p; or the last before the first unreached one
    is exposed. A node that is not exposed has no arc: a 4-neighbour covers acos(1 / 2ρ) to both
    sides of its direction, more than the 45° that are needed when 2ρ² > 1. Where the lattice is
    coarser than that, every node counts as exposed.
    """
    is_fine = 2 * radius * radius > 1 + TIE
    # smaller squares let fewer nodes be looked at that are not near, but are more to go through
    side = math.ceil(radius / 3)
    nodes, first = _sorted(_exposed(reached) if is_fine else reached, side)
    beside, n_beside = _beside_neighbours(radius)
    # each disc looked at parts one gap in two at most
    gaps = np.empty((1 + len(nodes), 6))
    table = filled(
        lambda room: _uncovered(
            reached.words, nodes, first, side, beside, n_beside, gaps, radius, room
        ),
        # most exposed nodes have one arc
        np.empty((2 * len(nodes), 7)),
    )
    return _linked(table[:, :2].astype(np.int64), table[:, 2:4], table[:, 4:6], table[:, 6])


def _beside_neighbours(radius: float) -> tuple[FloatArray, IntArray]:
    """What every choice of neighbours leaves of a circle, see `_cut_by_neighbours`."""
    n_gaps = np.empty(2**N_AROUND, dtype=np.int64)
    gaps = np.empty((n_gaps.size, N_GAPS, 6))
    _cut_by_neighbours(gaps, n_gaps, radius)
    return gaps, n_gaps


def _exposed(reached: Nodes) -> Nodes:
    """The reached nodes with a 4-neighbour that is not reached."""
    words = reached.words
    inner = from_right(words) & from_left(words) & from_above(words) & from_below(words)
    return Nodes(words & ~inner, reached.n_columns)


def _sorted(chosen: Nodes, side: int) -> tuple[IntArray, IntArray]:
    """The nodes of a set, sorted into squares so that those near a place are found quickly.

    Args:
        chosen: The nodes.
        side: Of a square, in steps.

    Returns:
        x and y of the nodes, shape (n, 2); and where those of each square begin in it, shape
        (rows, columns + 1): square [row, column] holds first[row, column]:first[row, column + 1].
    """
    rows, columns = (size // side + 1 for size in chosen.shape)
    runs = rows_of(chosen)
    width = runs.end.astype(np.int64) - runs.begin + 1
    y = np.repeat(runs.rows(), width)
    x = np.arange(y.size) + np.repeat(runs.begin - np.cumsum(width) + width, width)
    square = y // side * columns + x // side
    order = np.argsort(square, kind="stable")
    ends = np.append(0, np.cumsum(np.bincount(square, minlength=rows * columns)))
    first = ends[np.arange(rows)[:, np.newaxis] * columns + np.arange(columns + 1)]
    return np.column_stack((x, y))[order], first


def _linked(nodes: IntArray, begins: FloatArray, ends: FloatArray, spans_rad: FloatArray) -> Arcs:
    """The arcs in the order of the loops they make.

    Once ends closer than `WELD` are one point, as many arcs end at each point as begin there:
    so it is for the true boundary, and arcs that rounding adds or loses are shorter than that.
    Where two arcs meet two others, two discs touch, and each arc goes on about its own node; a
    loop that comes by the same point twice is cut in two there. In this way parts that only touch
    get a loop each, and a part that touches itself around a hole gets one for the hole.
    """
    n = len(nodes)
    points, labels = _welded(np.concatenate((begins, ends)))
    begin_labels, end_labels = labels[:n], labels[n:]
    kept = begin_labels != end_labels
    nodes, spans_rad = nodes[kept], spans_rad[kept]
    begin_labels, end_labels = begin_labels[kept], end_labels[kept]
    successors = np.empty(len(nodes), dtype=np.int64)
    ending = np.lexsort((nodes[:, 0], nodes[:, 1], end_labels))
    successors[ending] = np.lexsort((nodes[:, 0], nodes[:, 1], begin_labels))
    order, loops = _in_loops(successors, begin_labels, len(points))
    return Arcs(nodes[order], points[begin_labels[order]], spans_rad[order], loops)


def _in_loops(successors: IntArray, labels: IntArray, n_labels: int) -> tuple[IntArray, IntArray]:
    """The arcs in the order of loops, and where each loop begins, see `_simple_loops`."""
    n = successors.size
    walked = np.zeros(n, dtype=np.bool_)
    place = np.full(n_labels, -1)
    way, order, loops = (np.empty(n + 1, dtype=np.int64) for _ in range(3))
    n_loops = _simple_loops(successors, labels, walked, place, way, order, loops)
    return order[: loops[n_loops]], loops[: n_loops + 1]


def _welded(ends: FloatArray) -> tuple[FloatArray, IntArray]:
    """The distinct points among the ends of arcs, and the number of each end's point.

    Ends in a chain of steps up to `WELD` in x make a column, those of a column in a chain of such
    steps in y a point.
    """
    x, y = ends.T
    nowhere = np.zeros(max(len(ends) - 1, 0), dtype=np.bool_)
    columns = _chained(x, np.argsort(x), nowhere)
    order = np.lexsort((y, columns))
    points = _chained(y, order, np.diff(columns[order]) > 0)
    representatives = np.empty(points.max(initial=-1) + 1, dtype=np.int64)
    # of the ends that are one point the first in the order they came in stands for it
    representatives[points[::-1]] = np.arange(len(ends))[::-1]
    return ends[representatives], points


def _chained(values: FloatArray, order: IntArray, apart: BoolArray) -> IntArray:
    """Numbers of the chains of values up to `WELD` from one to the next in an order.

    A chain ends, too, where two values in a row are apart for another reason, shape (n - 1,).
    """
    begins = np.zeros(values.size, dtype=np.bool_)
    begins[1:] = (np.diff(values[order]) > WELD) | apart
    numbers = np.empty(values.size, dtype=np.int64)
    numbers[order] = np.cumsum(begins)
    return numbers


@kernel("void(float64[:, :, :], int64[:], float64)")
def _cut_by_neighbours(gaps: FloatArray, n_gaps: IntArray, radius: float) -> None:
    """Write what every choice of neighbours, numbered as `_around` does, leaves of a circle.

    The 4 would do; with the diagonal ones less is left to look for.

    Args:
        gaps: Room for `N_GAPS` gaps of each choice.
        n_gaps: Room for how many there are.
        radius: ρ.
    """
    for choice in range(n_gaps.size):
        left = gaps[choice]
        # a circle that meets no other begins and ends at its left
        _set_end(left[0], BEGIN, -math.pi, -radius, 0.0)
        _set_end(left[0], END, math.pi, -radius, 0.0)
        n = 1
        for place in range(N_AROUND):
            if choice >> place & 1:
                n = _cut(left, n, place % 3 - 1, place // 3 - 1, radius)
        n_gaps[choice] = n


@kernel(
    "int64(const uint64[:, :], const int64[:, :], const int64[:, :], int64, "
    "const float64[:, :, :], const int64[:], float64[:, :], float64, float64[:, :])"
)
def _uncovered(
    reached: Words,
    nodes: IntArray,
    first: IntArray,
    side: int,
    beside: FloatArray,
    n_beside: IntArray,
    gaps: FloatArray,
    radius: float,
    arcs: FloatArray,
) -> int:
    """Write the arcs that no other disc covers, unordered, and return how many there are.

    Args:
        reached: The reached nodes, shape (n_rows, n_words).
        nodes: The exposed nodes, see `_sorted`.
        first: Where those of each square begin.
        side: Of a square.
        beside: The gaps that every choice of neighbours leaves, see `_cut_by_neighbours`.
        n_beside: How many these are.
        gaps: Room for what exposed nodes leave of one of them.
        radius: ρ.
        arcs: Room for 7 numbers an arc: x and y of the node, of the arc's begin and of its end,
            and the arc's angle.
    """
    n_arcs = 0
    for k in range(nodes.shape[0]):
        x, y = nodes[k, 0], nodes[k, 1]
        choice = _around(reached, x, y)
        for gap in range(n_beside[choice]):
            _copy(beside[choice, gap], gaps[0])
            n = _cut_by_exposed(gaps, nodes, first, side, x, y, radius)
            for left in range(n):
                n_arcs = _append_arcs(arcs, n_arcs, gaps[left], float(x), float(y), radius)
    return n_arcs


@helper
def _around(reached: Words, x: int, y: int) -> int:
    """Which nodes of the square around a node are reached: a bit each, row by row from the left."""
    choice = 0
    for iy in range(max(0, y - 1), min(reached.shape[0], y + 2)):
        # bits beyond the last column are clear
        for ix in range(max(0, x - 1), min(64 * reached.shape[1], x + 2)):
            if reached[iy, ix >> 6] >> np.uint64(ix & 63) & np.uint64(1):
                choice |= 1 << (iy - y + 1) * 3 + ix - x + 1
    return choice


@helper
def _cut_by_exposed(
    gaps: FloatArray, nodes: IntArray, first: IntArray, side: int, x: int, y: int, radius: float
) -> int:
    """Write what the exposed nodes leave of a gap in the circle about (x, y); return how many.

    A disc meets a gap when its centre is within ρ of some point of it, so within
    ρ + 2ρ·sin(angle / 4) of its middle. For the gap of a straight wall that is little over ρ,
    and hardly any node that is not a neighbour comes so close.
    """
    begin_rad, end_rad = gaps[0, BEGIN], gaps[0, END]
    middle_rad = (begin_rad + end_rad) / 2
    middle_x, middle_y = x + radius * math.cos(middle_rad), y + radius * math.sin(middle_rad)
    reach = radius * (1 + 2 * math.sin((end_rad - begin_rad) / 4))
    # where discs touch, the centre of one lies on the rim of this reach
    square = reach * reach * (1 + TIE)
    low, high = _squares(middle_y, reach, side, first.shape[0])
    begin, end = _squares(middle_x, reach, side, first.shape[1] - 1)
    n = 1
    for row in range(low, high):
        for node in range(first[row, begin], first[row, end]):
            node_x, node_y = nodes[node, 0], nodes[node, 1]
            dx, dy = node_x - x, node_y - y
            # what its neighbours leave is what is asked about
            is_beside = -1 <= dx <= 1 and -1 <= dy <= 1
            away = (node_x - middle_x) ** 2 + (node_y - middle_y) ** 2
            if away <= square and not is_beside:
                n = _cut(gaps, n, dx, dy, radius)
                if n == 0:
                    return 0
    return n


@helper
def _squares(middle: float, reach: float, side: int, n_squares: int) -> tuple[int, int]:
    """The squares, from the first up to, not including, the last, within reach of a coordinate."""
    first = max(0, math.floor(middle - reach) // side)
    return first, max(first, min(n_squares, math.ceil(middle + reach) // side + 1))


@helper
def _cut(gaps: FloatArray, n: int, dx: int, dy: int, radius: float) -> int:
    """Take what the open disc at (dx, dy) from the node covers out of n gaps; return how many.

    A disc that only touches covers nothing, but parts the gap at the point it touches.
    """
    # backwards, so that the gaps this makes, at the end, are not looked at again
    for k in range(n - 1, -1, -1):
        if _may_meet(gaps[k], dx, dy, radius):
            n = _cut_one(gaps, n, k, dx, dy, radius)
    return n


@helper
def _may_meet(gap: FloatArray, dx: int, dy: int, radius: float) -> bool:
    """Whether the disc at (dx, dy) could meet a gap.

    If it does, it holds an end of the gap, or lies in a direction between the ends; for gaps of
    more than half a circle nothing is said about directions.
    """
    begin_x, begin_y = gap[BEGIN_AT], gap[BEGIN_AT + 1]
    end_x, end_y = gap[END_AT], gap[END_AT + 1]
    # discs that pass through an end are the rule
    square = radius * radius * (1 + TIE)
    may_meet: bool = (
        (dx - begin_x) ** 2 + (dy - begin_y) ** 2 <= square
        or (dx - end_x) ** 2 + (dy - end_y) ** 2 <= square
        or (begin_x * dy >= begin_y * dx and end_y * dx >= end_x * dy)
        or gap[END] - gap[BEGIN] > math.pi
    )
    return may_meet


@helper
def _cut_one(gaps: FloatArray, n: int, k: int, dx: int, dy: int, radius: float) -> int:
    """Take what the open disc at (dx, dy) covers out of gap k of n; return how many there are."""
    spread = _spread(dx, dy, radius)
    if spread < 0:
        return n
    gap = gaps[k]
    half_rad = math.atan(spread)
    covers_rad = math.atan2(dy, dx) - half_rad
    # from the integers, not from the angle: so the ends along a straight wall lie on a straight
    # line to the last bit
    enters_x, enters_y = (dx + dy * spread) / 2, (dy - dx * spread) / 2
    leaves_x, leaves_y = (dx - dy * spread) / 2, (dy + dx * spread) / 2
    begin_rad, end_rad = gap[BEGIN], gap[END]
    if begin_rad == -math.pi and end_rad == math.pi:
        # the whole circle: it has no ends yet
        _set_end(gap, BEGIN, covers_rad + 2 * half_rad, leaves_x, leaves_y)
        _set_end(gap, END, covers_rad + TURN, enters_x, enters_y)
        return n
    enters_rad = begin_rad + (covers_rad - begin_rad) % TURN
    leaves_rad = enters_rad + 2 * half_rad
    if leaves_rad + NOISE_RAD < end_rad:
        _copy(gap, gaps[n])
        _set_end(gaps[n], BEGIN, leaves_rad, leaves_x, leaves_y)
        n += 1
    if enters_rad < end_rad:
        _set_end(gap, END, enters_rad, enters_x, enters_y)
    # the end of what the disc covers may come round to the gap's begin
    if leaves_rad - TURN > begin_rad:
        _set_end(gap, BEGIN, leaves_rad - TURN, leaves_x, leaves_y)
    if gap[BEGIN] + NOISE_RAD >= gap[END]:
        n -= 1
        _copy(gaps[n], gap)
    return n


@helper
def _set_end(gap: FloatArray, end: int, direction_rad: float, x: float, y: float) -> None:
    """Let a gap begin (`BEGIN`) or end (`END`) in a direction, at (x, y) from the node."""
    gap[end] = direction_rad
    gap[BEGIN_AT + 2 * end] = x
    gap[BEGIN_AT + 2 * end + 1] = y


@helper
def _copy(gap: FloatArray, to: FloatArray) -> None:
    """Copy a gap; number by number, since assigning arrays takes longer to compile."""
    for column in range(gap.size):
        to[column] = gap[column]


@helper
def _append_arcs(
    arcs: FloatArray, n: int, gap: FloatArray, x: float, y: float, radius: float
) -> int:
    """Append a gap in the circle about (x, y) to n arcs, as two if over half a circle; see `_put`.

    Returns how many there are then.
    """
    begin_x, begin_y = x + gap[BEGIN_AT], y + gap[BEGIN_AT + 1]
    end_x, end_y = x + gap[END_AT], y + gap[END_AT + 1]
    span_rad = gap[END] - gap[BEGIN]
    if span_rad <= math.pi:
        return _put(arcs, n, (x, y, begin_x, begin_y, end_x, end_y, span_rad))
    middle_rad = gap[BEGIN] + span_rad / 2
    middle_x, middle_y = x + radius * math.cos(middle_rad), y + radius * math.sin(middle_rad)
    n = _put(arcs, n, (x, y, begin_x, begin_y, middle_x, middle_y, span_rad / 2))
    return _put(arcs, n, (x, y, middle_x, middle_y, end_x, end_y, span_rad / 2))


@helper
def _put(arcs: FloatArray, n: int, arc: tuple[float, ...]) -> int:
    """Write an arc as number n, if there is room for it; the next number."""
    if n < arcs.shape[0]:
        for column in range(7):
            arcs[n, column] = arc[column]
    return n + 1


@helper
def _spread(dx: float, dy: float, radius: float) -> float:
    """Tangent of half the angle over which the disc at (dx, dy) covers the circle at (0, 0).

    0 when they touch, below 0 when they do not meet or are the same.
    """
    square = dx * dx + dy * dy
    if square == 0:
        return -1.0
    excess = 4 * radius * radius / square - 1
    if abs(excess) <= TIE:
        return 0.0
    return math.sqrt(excess) if excess > 0 else -1.0


@kernel("int64(const int64[:], const int64[:], bool[:], int64[:], int64[:], int64[:], int64[:])")
def _simple_loops(
    successors: IntArray,
    labels: IntArray,
    walked: BoolArray,
    place: IntArray,
    way: IntArray,
    order: IntArray,
    loops: IntArray,
) -> int:
    """Write the arcs loop after loop, and where each loop begins; no loop has a label twice.

    Walks along the arcs and keeps the way since the start. Where the walk comes to a point that
    is on the way already, the way since then is a loop and is taken off.

    Args:
        successors: The arc that follows on each of n arcs.
        labels: The point that each begins at, as a number.
        walked: Shape (n,), False.
        place: -1 for each point.
        way: Room for n arcs.
        order: Room for n arcs.
        loops: Room for n + 1 begins; the last one is where the last loop ends.

    Returns:
        How many loops there are.
    """
    n_loops = n_ordered = 0
    loops[0] = 0
    for start in range(successors.size):
        length = 0
        arc = start
        while not walked[arc]:
            walked[arc] = True
            place[labels[arc]] = length
            way[length] = arc
            length += 1
            arc = successors[arc]
            since = place[labels[arc]]
            if since >= 0:
                for k in range(since, length):
                    order[n_ordered] = way[k]
                    place[labels[way[k]]] = -1
                    n_ordered += 1
                n_loops += 1
                loops[n_loops] = n_ordered
                length = since
    return n_loops
