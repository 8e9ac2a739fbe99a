"""The union of equal discs on lattice nodes: the cells it covers and the arcs that bound it.

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
from typing import TypeAlias

import numba
import numpy as np
import numpy.typing as npt
import scipy.sparse
from scipy.spatial import cKDTree

from satAOI_geo.plan import BoolArray, FloatArray

IntArray: TypeAlias = npt.NDArray[np.int64]

TIE = 1e-12
"""Share of ρ² within which a squared distance counts as equal to it. R and the step carry errors
of 1e-16 each; integers apart by less than 1e-12 of their size are equal up to ρ = 10⁶."""

WELD = 1e-7
"""Ends of arcs this close, in steps, are one point: a nanometre at a step of 10 mm. Rounding moves
an end by 1e-13, and by 2e-9 where two discs all but touch."""

TURN = 2 * math.pi


def covered_cells(reached: BoolArray, radius: float) -> BoolArray:
    """The nodes within a radius of a reached node, at exactly the radius included.

    Args:
        reached: Shape (n_rows, n_columns).
        radius: In steps.

    Returns:
        Shape (n_rows, n_columns); what would lie beyond the lattice is cut off.
    """
    square = radius * radius * (1 + TIE)
    rows = np.arange(math.floor(math.sqrt(square)) + 1)
    half_widths = np.floor(np.sqrt(square - rows * rows)).astype(np.int64)
    covered = np.zeros(reached.shape, dtype=np.bool_)
    _cover(reached, half_widths, covered)
    return covered


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


def boundary(reached: BoolArray, radius: float) -> Arcs:
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
    iy, ix = np.nonzero(_exposed(reached) if 2 * radius * radius > 1 + TIE else reached)
    side = max(8, math.ceil(radius / 2))
    n_buckets = (reached.shape[0] // side + 1, reached.shape[1] // side + 1)
    bucket = iy // side * n_buckets[1] + ix // side
    counts = np.bincount(bucket, minlength=n_buckets[0] * n_buckets[1])
    first = np.concatenate(([0], np.cumsum(counts)))
    order = np.argsort(bucket, kind="stable")
    table = _uncovered(reached, iy[order], ix[order], first, n_buckets, side, radius)
    return _linked(table[:, :2].astype(np.int64), table[:, 2:4], table[:, 4:6], table[:, 6])


def _exposed(reached: BoolArray) -> BoolArray:
    """The reached nodes with a 4-neighbour that is not reached."""
    around = np.pad(reached, 1)
    inner = around[2:, 1:-1] & around[:-2, 1:-1] & around[1:-1, 2:] & around[1:-1, :-2]
    return reached & ~inner


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
    order, loops = _simple_loops(successors, begin_labels, len(points))
    return Arcs(nodes[order], points[begin_labels[order]], spans_rad[order], loops)


def _welded(ends: FloatArray) -> tuple[FloatArray, IntArray]:
    """The distinct points among the ends of arcs, and the number of each end's point."""
    pairs = cKDTree(ends, balanced_tree=False).query_pairs(WELD, output_type="ndarray")
    graph = scipy.sparse.coo_array(
        (np.ones(len(pairs), dtype=np.bool_), (pairs[:, 0], pairs[:, 1])),
        shape=(len(ends), len(ends)),
    )
    _, labels = scipy.sparse.csgraph.connected_components(graph, directed=False)
    _, representatives = np.unique(labels, return_index=True)
    return ends[representatives], labels


@numba.njit(nogil=True, cache=True)
def _cover(reached, half_widths, covered):  # type: ignore[no-untyped-def]
    """Set the cells that lie within half_widths[d] columns of a reached node d rows away.

    Runs of reached nodes, widened, count +1 where they begin and -1 past their end; what the
    running sum has above 0 is covered.
    """
    n_rows, n_columns = reached.shape
    first, begin, end = _runs(reached)
    steps = np.empty(n_columns + 1, dtype=np.int64)
    for iy in range(n_rows):
        steps[:] = 0
        for row in range(max(0, iy - half_widths.size + 1), min(n_rows, iy + half_widths.size)):
            width = half_widths[abs(row - iy)]
            for run in range(first[row], first[row + 1]):
                steps[max(0, begin[run] - width)] += 1
                steps[min(n_columns, end[run] + width)] -= 1
        n_over = 0
        for ix in range(n_columns):
            n_over += steps[ix]
            covered[iy, ix] = n_over > 0


@numba.njit(nogil=True, cache=True)
def _runs(reached):  # type: ignore[no-untyped-def]
    """Runs of reached nodes: those of row iy are first[iy]:first[iy + 1], each begin:end."""
    n_rows, n_columns = reached.shape
    first = np.zeros(n_rows + 1, dtype=np.int64)
    begin, end = [0 for _ in range(0)], [0 for _ in range(0)]
    for iy in range(n_rows):
        inside = False
        for ix in range(n_columns):
            if reached[iy, ix] != inside:
                (end if inside else begin).append(ix)
                inside = not inside
        if inside:
            end.append(n_columns)
        first[iy + 1] = len(begin)
    return first, np.array(begin), np.array(end)


@numba.njit(nogil=True, cache=True)
def _uncovered(reached, iy, ix, first, n_buckets, side, radius):  # type: ignore[no-untyped-def]
    """The arcs that no other disc covers, unordered.

    Args:
        reached: Shape (n_rows, n_columns).
        iy: Rows of the exposed nodes, bucket after bucket.
        ix: Their columns.
        first: Where each bucket of side × side nodes begins in iy and ix.
        n_buckets: Buckets in y and in x.
        side: Of a bucket, in steps.
        radius: ρ.

    Returns:
        Shape (n, 7): x and y of the node, of the arc's begin, of its end; its angle.
    """
    arcs = [(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0) for _ in range(0)]
    for k in range(iy.size):
        x, y = ix[k], iy[k]
        gaps = [(-math.pi, math.pi, 0, 0, 0, 0)]
        for dx, dy in ((1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1)):
            inside = 0 <= y + dy < reached.shape[0] and 0 <= x + dx < reached.shape[1]
            if inside and reached[y + dy, x + dx]:
                gaps = _cut(gaps, dx, dy, radius)
        for middle_x, middle_y, reach in _windows(gaps, radius):
            low, high = _clipped(y + middle_y, reach, side, n_buckets[0])
            left, right = _clipped(x + middle_x, reach, side, n_buckets[1])
            for row in range(low, high):
                begin, end = row * n_buckets[1] + left, row * n_buckets[1] + right
                for j in range(first[begin], first[end]):
                    dx, dy = ix[j] - x, iy[j] - y
                    if (dx - middle_x) ** 2 + (dy - middle_y) ** 2 <= reach * reach:
                        gaps = _cut(gaps, dx, dy, radius)
        for gap in gaps:
            _append_arcs(arcs, x, y, gap, radius)
    out = np.empty((len(arcs), 7))
    for k in range(len(arcs)):
        for column in range(7):
            out[k, column] = arcs[k][column]
    return out


@numba.njit(nogil=True, cache=True)
def _cut(gaps, dx, dy, radius):  # type: ignore[no-untyped-def]
    """The gaps in the cover of a circle, less what the open disc at (dx, dy) covers.

    A gap is (begin, end, opener's dx, dy, closer's dx, dy), angles in rad, begin < end; (0, 0)
    as opener and closer says that nothing covers the circle yet. A disc that only touches covers
    nothing and parts the gap it touches.
    """
    square = dx * dx + dy * dy
    reach = 4 * radius * radius
    if square == 0 or square > reach * (1 + TIE):
        return gaps
    half_rad = math.acos(math.sqrt(square / reach)) if square < reach * (1 - TIE) else 0.0
    covers_rad = math.atan2(dy, dx) - half_rad
    if not _meets(gaps, covers_rad, 2 * half_rad):
        return gaps
    kept = gaps[:0]
    for begin, end, opener_dx, opener_dy, closer_dx, closer_dy in gaps:
        enters = begin + (covers_rad - begin) % TURN
        leaves = enters + 2 * half_rad
        if opener_dx == 0 and opener_dy == 0:
            kept.append((leaves, enters + TURN, dx, dy, dx, dy))
            continue
        if enters < end and leaves < end:
            kept.append((leaves, end, dx, dy, closer_dx, closer_dy))
        # the end of the disc's interval may come round to the gap's begin
        if leaves - TURN > begin:
            begin, opener_dx, opener_dy = leaves - TURN, dx, dy
        if enters < end:
            end, closer_dx, closer_dy = enters, dx, dy
        if begin < end:
            kept.append((begin, end, opener_dx, opener_dy, closer_dx, closer_dy))
    return kept


@numba.njit(nogil=True, cache=True)
def _meets(gaps, covers_rad, width_rad):  # type: ignore[no-untyped-def]
    """Whether an interval of directions meets a gap: most do not, and need no new list."""
    for gap in gaps:
        enters = (covers_rad - gap[0]) % TURN
        if enters < gap[1] - gap[0] or enters + width_rad > TURN:
            return True
    return False


@numba.njit(nogil=True, cache=True)
def _windows(gaps, radius):  # type: ignore[no-untyped-def]
    """A disc (x, y, radius) for each gap, from the node: the nodes whose discs meet the gap.

    A disc meets a gap when its centre is within ρ of some point of it, so within
    ρ + 2ρ·sin(angle / 4) of its middle. For the gap of a straight wall that is little over ρ,
    and hardly any node that is not a neighbour comes so close.
    """
    windows = [(0.0, 0.0, 0.0) for _ in range(0)]
    for begin, end, _, _, _, _ in gaps:
        middle_rad = (begin + end) / 2
        reach = radius + 2 * radius * math.sin((end - begin) / 4)
        x, y = radius * math.cos(middle_rad), radius * math.sin(middle_rad)
        # at a touch the centre lies on the rim of this disc
        windows.append((x, y, reach * (1 + TIE)))
    return windows


@numba.njit(nogil=True, cache=True)
def _clipped(middle, reach, side, n_buckets):  # type: ignore[no-untyped-def]
    """The buckets, from the first up to, not including, the last, within reach of a coordinate."""
    first = max(0, math.floor(middle - reach) // side)
    return first, max(first, min(n_buckets, math.ceil(middle + reach) // side + 1))


@numba.njit(nogil=True, cache=True)
def _append_arcs(arcs, x, y, gap, radius):  # type: ignore[no-untyped-def]
    """Append a gap as an arc, or as two where it is more than half a circle."""
    begin, end, opener_dx, opener_dy, closer_dx, closer_dy = gap
    begin_x, begin_y = _crossing(opener_dx, opener_dy, 1, radius)
    end_x, end_y = _crossing(closer_dx, closer_dy, -1, radius)
    span = end - begin
    if span <= math.pi:
        arcs.append((x, y, x + begin_x, y + begin_y, x + end_x, y + end_y, span))
        return
    middle_rad = (begin + end) / 2
    middle_x, middle_y = x + radius * math.cos(middle_rad), y + radius * math.sin(middle_rad)
    arcs.append((x, y, x + begin_x, y + begin_y, middle_x, middle_y, span / 2))
    arcs.append((x, y, middle_x, middle_y, x + end_x, y + end_y, span / 2))


@numba.njit(nogil=True, cache=True)
def _crossing(dx, dy, side, radius):  # type: ignore[no-untyped-def]
    """Where the circle about (dx, dy) meets that about (0, 0): on its left for side 1, else -1.

    From the integers, not from the angle: so the crossings along a straight wall lie on a
    straight line to the last bit.
    """
    if dx == 0 and dy == 0:
        return -radius, 0.0
    across = side * math.sqrt(max(0.0, radius * radius / (dx * dx + dy * dy) - 0.25))
    return dx / 2 - dy * across, dy / 2 + dx * across


@numba.njit(nogil=True, cache=True)
def _simple_loops(successors, labels, n_labels):  # type: ignore[no-untyped-def]
    """The arcs loop after loop, and where each loop begins; no loop has a label twice.

    Walks along the arcs and keeps the way since the start. Where the walk comes to a point that
    is on the way already, the way since then is a loop and is taken off.
    """
    n = successors.size
    order, loops = [0 for _ in range(0)], [0]
    walked = np.zeros(n, dtype=np.bool_)
    place = np.full(n_labels, -1)
    way = np.empty(n, dtype=np.int64)
    for start in range(n):
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
                    order.append(way[k])
                    place[labels[way[k]]] = -1
                loops.append(len(order))
                length = since
    return np.array(order), np.array(loops)
