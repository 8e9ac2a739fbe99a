"""The nodes of connected sets, set by set, as stretches of rows.

The states of a set stand at its nodes in dozens of poses each. Where it is only asked which nodes
a set has, as for the floor that it trowels, a few stretches a row answer it.
"""

from dataclasses import dataclass
from functools import reduce

import numpy as np

from satAOI_geo.kernels import helper, kernel
from satAOI_geo.lattice import WORD_BITS, Words
from satAOI_geo.nodes import Nodes, lowest_bit, set_bits
from satAOI_geo.plan import Int32Array, IntArray
from satAOI_geo.runs import Runs, paint
from satAOI_geo.threads import n_cores, run_threads


@dataclass(frozen=True, slots=True)
class Stretches:
    """The nodes of sets numbered 0 .. n - 1.

    Attributes:
        first: Shape (n + 1,): the stretches of a set are those from first[label] up to, not
            including, first[label + 1], by row and column.
        row: Shape (m,).
        begin: Shape (m,), first column of each stretch.
        end: Shape (m,), last column of each stretch.
    """

    first: IntArray
    row: Int32Array
    begin: Int32Array
    end: Int32Array

    @classmethod
    def of(
        cls, labels: Int32Array, row: Int32Array, begin: Int32Array, end: Int32Array, n_sets: int
    ) -> "Stretches":
        """The stretches of sets from some that may overlap, in any order; shape (m,) each."""
        labels, row, begin, end = merged(labels, row, begin, end)
        counts = np.bincount(labels, minlength=n_sets)
        return cls(np.concatenate(([0], np.cumsum(counts))).astype(np.int64), row, begin, end)

    def boxes(self) -> IntArray:
        """Least row, least column, greatest row, greatest column of each set, shape (n, 4)."""
        first, last = self.first[:-1], self.first[1:] - 1
        if not first.size:
            return np.empty((0, 4), dtype=np.int64)
        left = np.minimum.reduceat(self.begin, first)
        right = np.maximum.reduceat(self.end, first)
        return np.column_stack((self.row[first], left, self.row[last], right)).astype(np.int64)

    def count(self, label: int) -> int:
        """How many nodes a set has."""
        own = slice(self.first[label], self.first[label + 1])
        return int((self.end[own] - self.begin[own] + 1).sum())

    def nodes(self, label: int, rows: range, columns: range) -> Nodes:
        """The nodes of one set in a window of the lattice that holds all of it."""
        own = slice(self.first[label], self.first[label + 1])
        words = np.zeros((len(rows), -(-len(columns) // WORD_BITS)), dtype=np.uint64)
        left = columns.start
        paint(words, self.row[own] - rows.start, self.begin[own] - left, self.end[own] - left)
        return Nodes(words, len(columns))

    def deepest(self, labels: IntArray, n_columns: int) -> IntArray:
        """The first node that is in the middle of the largest square of nodes, of some sets each.

        Args:
            labels: The sets.
            n_columns: Columns of the lattice.

        Returns:
            Row and column of each node, shape (n, 2).
        """
        found = np.empty((labels.size, 2), dtype=np.int64)
        room = np.empty((2, n_columns + 1), dtype=np.int32)
        _deepest(self.first, self.row, self.begin, self.end, labels, room, found)
        return found


def merged(
    labels: Int32Array, row: Int32Array, begin: Int32Array, end: Int32Array
) -> tuple[Int32Array, Int32Array, Int32Array, Int32Array]:
    """Stretches in the order of set, row and column, those that meet made one; shape (m,) each."""
    # one number that puts set, row and column in order; lines are more than a step apart in it
    width = int(end.max(initial=0)) + 2
    n_rows = int(row.max(initial=0)) + 1
    line = labels.astype(np.int64) * n_rows + row
    begins, ends = line * width + begin, line * width + end
    order = np.argsort(begins)
    begins, reached = begins[order], np.maximum.accumulate(ends[order])
    is_first = np.ones(begins.size, dtype=np.bool_)
    is_first[1:] = begins[1:] > reached[:-1] + 1
    line, first_ix = np.divmod(begins[is_first], width)
    label, iy = np.divmod(line, n_rows)
    last_ix = reached[np.roll(is_first, -1)] % width
    return (
        label.astype(np.int32),
        iy.astype(np.int32),
        first_ix.astype(np.int32),
        last_ix.astype(np.int32),
    )


def of_runs(
    runs: Runs, labels: Int32Array, n_sets: int
) -> tuple[tuple[Int32Array, Int32Array, Int32Array, Int32Array], Int32Array]:
    """The nodes of sets of runs, numbered by `labels`, and their first states.

    There are a hundred runs for each stretch. To sort them takes longer than to paint them, which
    merges them, too; runs come row by row for each pose.

    Returns:
        What `merged` says of these runs; and row, pose, as a number among all, and column of each
        set's first state in this order, shape (n_sets, 3).
    """
    first = runs.first.reshape(-1, runs.first.shape[-1])
    n_a_row = np.diff(first, axis=1).sum(axis=0)
    n_at_once = min(n_sets, int(n_a_row.max(initial=0)))
    n_words = int(runs.end.max(initial=0)) // WORD_BITS + 1
    cuts = np.linspace(0, n_a_row.size, n_cores() + 1).astype(np.int64)

    def painted(part: int) -> tuple[Int32Array, Int32Array]:
        low, high = cuts[part], cuts[part + 1]
        nodes = np.zeros((n_at_once, n_words), dtype=np.uint64)
        place, met = np.full(n_sets, -1, dtype=np.int32), np.empty(n_at_once, dtype=np.int32)
        states = np.full((n_sets, 3), -1, dtype=np.int32)
        # of what there is room for only what is written to takes memory
        room = np.empty((n_a_row[low:high].sum(), 4), dtype=np.int32)
        n = _paint_sets(
            first, low, high, labels, runs.begin, runs.end, nodes, place, met, states, room
        )
        return room[:n], states

    stretches, states = zip(*run_threads(painted, cuts.size - 1), strict=True)
    together = np.concatenate(stretches)
    label, row, begin, end = together[np.argsort(together[:, 0], kind="stable")].T.copy()
    # rows ascend from part to part
    firsts = reduce(lambda low, high: np.where(low < 0, high, low), states)
    return (label, row, begin, end), firsts


@kernel(
    "int64(const int64[:, :], int64, int64, const int32[:], const int32[:], const int32[:], "
    "uint64[:, :], int32[:], int32[:], int32[:, :], int32[:, :])"
)
def _paint_sets(
    first: IntArray,
    low: int,
    high: int,
    labels: Int32Array,
    begin: Int32Array,
    end: Int32Array,
    nodes: Words,
    place: Int32Array,
    met: Int32Array,
    states: Int32Array,
    stretches: Int32Array,
) -> int:
    """Write the stretches of sets of runs, by row, set and column; sets as they are met in a row.

    Args:
        first: Shape (n_poses, n_rows + 1), see `Runs`.
        low: The first of the rows to do it in.
        high: The row before which to end.
        labels: The set of each run.
        begin: Its first column.
        end: Its last column.
        nodes: No nodes; a row of the lattice for each of the sets in one row.
        place: -1 for each set: which of these it has.
        met: Room for the sets in one row.
        states: -1; room for row, pose and column of each set's first state.
        stretches: Room for label, row, first and last column of each stretch.

    Returns:
        How many stretches there are.
    """
    n = 0
    for row in range(low, high):
        n_met = 0
        for pose in range(first.shape[0]):
            for run in range(first[pose, row], first[pose, row + 1]):
                label = labels[run]
                if place[label] < 0:
                    place[label] = n_met
                    met[n_met] = label
                    n_met += 1
                    if states[label, 0] < 0:
                        states[label, 0] = row
                        states[label, 1] = pose
                        states[label, 2] = begin[run]
                set_bits(nodes[place[label]], begin[run], end[run])
        for k in range(n_met):
            place[met[k]] = -1
            n = _take_off(nodes[k], met[k], row, stretches, n)
    return n


@helper
def _take_off(nodes: Words, label: int, row: int, stretches: Int32Array, n: int) -> int:
    """Append the stretches of some nodes in a row to n stretches, and clear them; how many then."""
    n_begun = n_ended = n
    carry = np.uint64(0)
    for word in range(nodes.size):
        bits = nodes[word]
        nodes[word] = np.uint64(0)
        before = bits << np.uint64(1) | carry
        carry = bits >> np.uint64(63)
        begins, stops = bits & ~before, before & ~bits
        while begins:
            stretches[n_begun, 0] = label
            stretches[n_begun, 1] = row
            stretches[n_begun, 2] = word * 64 + lowest_bit(begins)
            begins &= begins - np.uint64(1)
            n_begun += 1
        while stops:
            stretches[n_ended, 3] = word * 64 + lowest_bit(stops) - 1
            stops &= stops - np.uint64(1)
            n_ended += 1
    if carry:
        stretches[n_ended, 3] = nodes.size * 64 - 1
    return n_begun


@kernel(
    "void(const int64[:], const int32[:], const int32[:], const int32[:], const int64[:], "
    "int32[:, :], int64[:, :])"
)
def _deepest(
    first: IntArray,
    row: Int32Array,
    begin: Int32Array,
    end: Int32Array,
    labels: IntArray,
    room: Int32Array,
    found: IntArray,
) -> None:
    """Write row and column of the deepest node of each of some sets, see `Stretches.deepest`.

    The largest square whose upper right corner is a given node has a side one longer than the
    least of those of its left, lower and lower left neighbour. A node is the middle of a square of
    a side of 2d - 1 when one of that side, or longer, ends d - 1 rows and columns farther: the
    first of these nodes in the order of rows and columns belongs to the first such corner.

    Args:
        first: See `Stretches`, as are the next three.
        row: Of each stretch.
        begin: Of each stretch.
        end: Of each stretch.
        labels: The sets.
        room: For a row of squares and the row below, shape (2, n_columns + 1); column ix is at
            ix + 1.
        found: Shape (n, 2).
    """
    for k in range(labels.size):
        stretch, beyond = first[labels[k]], first[labels[k] + 1]
        left, right = _columns(begin, end, stretch, beyond)
        room[:, left : right + 2] = 0
        depth = 0
        iy = row[stretch]
        while stretch < beyond:
            below, here = room[(iy + 1) & 1], room[iy & 1]
            here[left : right + 2] = 0
            while stretch < beyond and row[stretch] == iy:
                for ix in range(begin[stretch], end[stretch] + 1):
                    side = min(here[ix], below[ix], below[ix + 1]) + 1
                    here[ix + 1] = side
                    if (side + 1) >> 1 > depth:
                        depth = (side + 1) >> 1
                        found[k, 0], found[k, 1] = iy - depth + 1, ix - depth + 1
                stretch += 1
            iy += 1


@helper
def _columns(begin: Int32Array, end: Int32Array, first: int, beyond: int) -> tuple[int, int]:
    """Least and greatest column of the stretches from first up to, not including, beyond."""
    left, right = begin[first], end[first]
    for stretch in range(first + 1, beyond):
        left, right = min(left, begin[stretch]), max(right, end[stretch])
    return left, right
