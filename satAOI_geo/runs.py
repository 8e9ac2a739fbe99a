"""States gathered into runs, and runs joined into components.

A run is a stretch of nodes in one row at one pose through which the disc can step. The 6·10⁸
states of a hall make some 10⁶ runs; connectivity is union-find over these.
"""

from dataclasses import dataclass
from typing import Final, TypeAlias

import numpy as np
import numpy.typing as npt

from satAOI_geo.intervals import set_bits
from satAOI_geo.kernels import filled, helper, kernel
from satAOI_geo.lattice import WORD_BITS, Words
from satAOI_geo.nodes import Nodes, n_bits
from satAOI_geo.plan import BoolArray, IntArray

Int32Array: TypeAlias = npt.NDArray[np.int32]

N_RUNS_A_ROW: Final = 8
"""Runs that there is room for at first in each row."""

NOWHERE: Final = np.empty(0, dtype=np.int64)
"""No steps."""


@dataclass(frozen=True, slots=True)
class Runs:
    """All runs, ordered by pose, row and column.

    Attributes:
        first: Shape (n_directions, n_swings, n_rows + 1): the runs of row iy at a pose are those
            from first[a1, swing, iy] up to, not including, first[a1, swing, iy + 1].
        begin: Shape (n_runs,), first column of each run.
        end: Shape (n_runs,), last column of each run.
    """

    first: IntArray
    begin: Int32Array
    end: Int32Array

    @classmethod
    def joined(cls, parts: list["SliceRuns"], shape: tuple[int, int, int]) -> "Runs":
        """The runs of all rows, given part by part, with (n_directions, n_swings, n_rows)."""
        n_directions, n_swings, n_rows = shape
        offsets = np.cumsum([0, *(part.begin.size for part in parts)])
        starts = np.concatenate(
            [part.first[:-1] + offset for part, offset in zip(parts, offsets[:-1], strict=True)]
        ).reshape(-1, n_rows)
        # each pose ends where the next one begins
        stops = np.append(starts[1:, 0], offsets[-1])
        return cls(
            np.column_stack((starts, stops)).reshape(n_directions, n_swings, n_rows + 1),
            np.concatenate([part.begin for part in parts]),
            np.concatenate([part.end for part in parts]),
        )

    def rows(self) -> Int32Array:
        """Row of each run, shape (n_runs,)."""
        n_directions, n_swings, n_ends = self.first.shape
        rows = np.tile(np.arange(n_ends - 1, dtype=np.int32), n_directions * n_swings)
        return np.repeat(rows, np.diff(self.first, axis=2).ravel())

    def n_states(self, n_rows: int) -> int:
        """How many nodes the runs of the first n_rows rows hold at all poses."""
        before = np.concatenate(([0], np.cumsum(self.end.astype(np.int64) - self.begin + 1)))
        return int((before[self.first[..., n_rows]] - before[self.first[..., 0]]).sum())

    def holding(self, iy: int, ix: int) -> IntArray:
        """The run that holds each pose at a node, or -1; shape (n_directions, n_swings)."""
        found = np.empty(self.first.shape[:2], dtype=np.int64)
        _holding(self.first, self.begin, self.end, iy, ix, found)
        return found


@dataclass(frozen=True, slots=True)
class SliceRuns:
    """The runs of some rows, those of one pose or of several: `first` has shape (n_rows + 1,)."""

    first: IntArray
    begin: Int32Array
    end: Int32Array

    @classmethod
    def of(cls, free: Words, barred: IntArray) -> "SliceRuns":
        """The runs of rows of free nodes.

        Args:
            free: Shape (n_rows, n_words).
            barred: Shape (n,), the nodes from which the disc may not step to the right, as numbers
                of their bits among all of these words, ascending.
        """
        first = np.empty(len(free) + 1, dtype=np.int64)
        # of what there is room for only what is written to takes memory
        room = np.empty((N_RUNS_A_ROW * len(free), 2), dtype=np.int32)
        begin, end = filled(lambda runs: _gather(free, barred, first, runs), room).T
        return cls(first, begin, end)


@dataclass(frozen=True, slots=True)
class Meeting:
    """The runs of two rows of poses that a move could lead between, row by row.

    Attributes:
        first_a: Shape (n_rows + 1,), for each row where it starts the first of its runs.
        first_b: The same for the row that it ends at.
        begin: First column of all runs.
        end: Last column of all runs.
    """

    first_a: IntArray
    first_b: IntArray
    begin: Int32Array
    end: Int32Array

    @classmethod
    def of(cls, runs: Runs, pose: tuple[int, int], to_pose: tuple[int, int]) -> "Meeting":
        """The runs of a pose, (a1, swing), and those of another at the same nodes."""
        return cls(runs.first[pose], runs.first[to_pose], runs.begin, runs.end)

    @classmethod
    def upwards(cls, runs: Runs, pose: tuple[int, int]) -> "Meeting":
        """The runs of a pose, (a1, swing), and those of the row above it; none above the last."""
        first = runs.first[pose]
        return cls(first, np.append(first[1:], first[-1]), runs.begin, runs.end)

    def links(self, allowed: Words) -> Int32Array:
        """The pairs of runs that a move leads between, given the nodes it may start from.

        Returns:
            Shape (n, 3): a run, the run it leads to, and the column of a node where it does.
        """
        first_a, first_b = self.first_a, self.first_b
        # two sorted rows of runs overlap in fewer pairs than there are runs in both
        found = np.empty((first_a[-1] - first_a[0] + first_b[-1] - first_b[0], 3), dtype=np.int32)
        return found[: _links(allowed, first_a, first_b, self.begin, self.end, found)]

    def rows_apart(self, parents: Int32Array, allowed: Words) -> BoolArray | None:
        """The rows in which a move could join two components of the forest `parents`, if any.

        It may start from no other nodes than the allowed ones.
        """
        rows = np.empty(self.first_a.size - 1, dtype=np.bool_)
        n = _compare(parents, allowed, self.first_a, self.first_b, self.begin, self.end, rows)
        return rows if n else None

    def join(self, parents: Int32Array, allowed: Words, rows: BoolArray) -> None:
        """Join the runs that a move leads between in some rows, given where it may start from."""
        first_a, first_b = self.first_a[np.newaxis], self.first_b[np.newaxis]
        _join(parents, allowed, first_a, first_b, self.begin, self.end, rows)


def rows_of(nodes: Nodes) -> SliceRuns:
    """The stretches of a set's nodes, row by row."""
    return SliceRuns.of(nodes.words, NOWHERE)


def unite(parents: Int32Array, pairs: Int32Array) -> None:
    """Join pairs, the first two columns of (n, 2 or 3), in the forest `parents`, shape (m,)."""
    _unite(parents, pairs)


def unite_poses(
    parents: Int32Array,
    runs: Runs,
    poses: tuple[int, slice],
    to_poses: tuple[int, slice],
    allowed: Words,
    rows: BoolArray,
) -> None:
    """Join the runs that moves lead between from some poses of a direction to as many of another.

    Args:
        parents: The forest, shape (n_runs,).
        runs: All runs.
        poses: A direction and some of its swings.
        to_poses: A direction and, for each of these, the swing that the move leads to.
        allowed: The nodes that all these moves may start from.
        rows: Shape (n_rows,), the rows to do it in.
    """
    first_a, first_b = runs.first[poses], runs.first[to_poses]
    _join(parents, allowed, first_a, first_b, runs.begin, runs.end, rows)


def unite_upwards(parents: Int32Array, runs: Runs, a1: int, barred: IntArray, n_bits: int) -> None:
    """Join the runs of a direction's poses that steps from row to row lead between.

    Args:
        parents: The forest, shape (n_runs,). Only what belongs to these runs is read and changed.
        runs: All runs.
        a1: The direction.
        barred: Shape (n,), the nodes from which the disc may not step up, as numbers of their bits
            among those of all swings and rows, ascending.
        n_bits: How many bits a row has.
    """
    _unite_upwards(parents, runs.first[a1], runs.begin, runs.end, barred, n_bits)


def numbered(parents: Int32Array) -> tuple[Int32Array, int]:
    """The component of each member of a forest, in the order of their roots; how many there are."""
    labels = np.empty_like(parents)
    return labels, _number(parents, labels)


def roots(parents: Int32Array) -> Int32Array:
    """The lowest member of each one's component, shape (m,); `parents` becomes the answer."""
    _flatten(parents)
    return parents


def paint(words: Words, row: Int32Array, begin: Int32Array, end: Int32Array) -> None:
    """Set the bits of stretches of rows, shape (n,) each, from begin to end, both included."""
    _paint(words, row, begin, end)


@kernel("int64(const uint64[:, :], const int64[:], int64[:], int32[:, :])")
def _gather(free: Words, barred: IntArray, first: IntArray, runs: Int32Array) -> int:
    """Write first and last column of every run, and which is the first of each row; how many.

    Args:
        free: See `SliceRuns.of`, as is the next one.
        barred: Steps to the right.
        first: Room for the runs' numbers, one more than there are rows.
        runs: Room for two columns a run.
    """
    n_rows, n_words = free.shape
    n_begun = n_ended = step = 0
    next_barred = barred[0] if barred.size else n_rows * n_words * WORD_BITS
    for iy in range(n_rows):
        first[iy] = n_begun
        before = np.uint64(0)
        bits = free[iy, 0]
        for word in range(n_words):
            after = free[iy, word + 1] if word + 1 < n_words else np.uint64(0)
            stepped = bits & (bits >> np.uint64(1) | after << np.uint64(63))
            while next_barred < (iy * n_words + word + 1) * WORD_BITS:
                stepped &= ~(np.uint64(1) << np.uint64(next_barred & 63))
                step += 1
                next_barred = barred[step] if step < barred.size else n_rows * n_words * WORD_BITS
            begins = bits & ~(stepped << np.uint64(1) | before)
            ends = bits & ~stepped
            before = stepped >> np.uint64(63)
            bits = after
            while begins:
                if n_begun < len(runs):
                    runs[n_begun, 0] = word * WORD_BITS + lowest_bit(begins)
                begins &= begins - np.uint64(1)
                n_begun += 1
            while ends:
                if n_ended < len(runs):
                    runs[n_ended, 1] = word * WORD_BITS + lowest_bit(ends)
                ends &= ends - np.uint64(1)
                n_ended += 1
    first[n_rows] = n_begun
    return n_begun


@kernel(
    "int64(const uint64[:, :], const int64[:], const int64[:], const int32[:], const int32[:], "
    "int32[:, :])"
)
def _links(
    allowed: Words,
    first_a: IntArray,
    first_b: IntArray,
    begin: Int32Array,
    end: Int32Array,
    found: Int32Array,
) -> int:
    """Write every two runs that an allowed move leads between; how many there are."""
    n = 0
    for iy in range(allowed.shape[0]):
        a, b = first_a[iy], first_b[iy]
        while a < first_a[iy + 1] and b < first_b[iy + 1]:
            ix = _next_bit(allowed[iy], max(begin[a], begin[b]))
            if 0 <= ix <= min(end[a], end[b]):
                # one by one: assigning a tuple takes three seconds longer to compile
                found[n, 0] = a
                found[n, 1] = b
                found[n, 2] = ix
                n += 1
            if end[a] < end[b]:
                a += 1
            else:
                b += 1
    return n


@kernel(
    "int64(int32[:], const uint64[:, :], const int64[:], const int64[:], const int32[:], "
    "const int32[:], bool[:])"
)
def _compare(
    parents: Int32Array,
    allowed: Words,
    first_a: IntArray,
    first_b: IntArray,
    begin: Int32Array,
    end: Int32Array,
    rows: BoolArray,
) -> int:
    """Find the rows with runs of different roots that an allowed move leads between; how many.

    This takes no lock, though others may be changing the forest: a root that is out of date makes
    two runs look apart that no longer are, never the other way round, and to halve a path changes
    no root.

    Args:
        parents: The forest.
        allowed: The nodes that the move may start from.
        first_a: See `Meeting`, as are the next three.
        first_b: Of the runs that it leads to.
        begin: Of all runs.
        end: Of all runs.
        rows: Room for whether a row is one of them.
    """
    n = 0
    # the last two parents that were found to have one root, as most neighbouring runs have them
    known_a = known_b = np.int32(-1)
    for iy in range(allowed.shape[0]):
        rows[iy] = False
        a, b = first_a[iy], first_b[iy]
        a_stop, b_stop = first_a[iy + 1], first_b[iy + 1]
        while a < a_stop and b < b_stop:
            parent_a, parent_b = parents[a], parents[b]
            if parent_a != parent_b and (parent_a != known_a or parent_b != known_b):
                ix, last_ix = max(begin[a], begin[b]), min(end[a], end[b])
                if ix <= last_ix:
                    if _root(parents, a) == _root(parents, b):
                        known_a, known_b = parent_a, parent_b
                    elif 0 <= _next_bit(allowed[iy], ix) <= last_ix:
                        rows[iy] = True
                        n += 1
                        break
            # no branch, which the processor would take wrongly half of the time
            a_ends, b_ends = end[a] <= end[b], end[b] <= end[a]
            a += int(a_ends)
            b += int(b_ends)
    return n


@kernel(
    "void(int32[:], const uint64[:, :], const int64[:, :], const int64[:, :], const int32[:], "
    "const int32[:], const bool[:])"
)
def _join(
    parents: Int32Array,
    allowed: Words,
    first_a: IntArray,
    first_b: IntArray,
    begin: Int32Array,
    end: Int32Array,
    rows: BoolArray,
) -> None:
    """Join every two runs that an allowed move leads between, pose after pose.

    Args:
        parents: The forest.
        allowed: The nodes that the moves may start from.
        first_a: Shape (n_poses, n_rows + 1), for each pose see `Meeting`.
        first_b: The same of the poses that the moves lead to.
        begin: Of all runs.
        end: Of all runs.
        rows: The rows to do it in.
    """
    for pose in range(first_a.shape[0]):
        for iy in range(allowed.shape[0]):
            if rows[iy]:
                a, b = first_a[pose, iy], first_b[pose, iy]
                while a < first_a[pose, iy + 1] and b < first_b[pose, iy + 1]:
                    ix, last_ix = max(begin[a], begin[b]), min(end[a], end[b])
                    if (
                        ix <= last_ix
                        and parents[a] != parents[b]
                        and 0 <= _next_bit(allowed[iy], ix) <= last_ix
                    ):
                        _unite_two(parents, a, b)
                    if end[a] < end[b]:
                        a += 1
                    else:
                        b += 1


@kernel("void(int32[:], const int64[:, :], const int32[:], const int32[:], const int64[:], int64)")
def _unite_upwards(
    parents: Int32Array,
    first: IntArray,
    begin: Int32Array,
    end: Int32Array,
    barred: IntArray,
    n_bits_a_row: int,
) -> None:
    """Join every two runs that a step up leads between; see `unite_upwards`.

    A step is free between any two free nodes but for those that are barred.
    """
    n_swings, n_ends = first.shape
    step = 0
    for swing in range(n_swings):
        for iy in range(n_ends - 2):
            row = (swing * (n_ends - 1) + iy) * n_bits_a_row
            a, b = first[swing, iy], first[swing, iy + 1]
            a_stop, b_stop = b, first[swing, iy + 2]
            while a < a_stop and b < b_stop:
                ix, last_ix = max(begin[a], begin[b]), min(end[a], end[b])
                while step < barred.size and barred[step] < row + ix:
                    step += 1
                while step < barred.size and barred[step] == row + ix and ix <= last_ix:
                    step += 1
                    ix += 1
                if ix <= last_ix:
                    _unite_two(parents, a, b)
                if end[a] < end[b]:
                    a += 1
                else:
                    b += 1


@kernel("void(int32[:], const int32[:, :])")
def _unite(parents: Int32Array, pairs: Int32Array) -> None:
    """Join pair by pair."""
    for k in range(pairs.shape[0]):
        _unite_two(parents, pairs[k, 0], pairs[k, 1])


@helper
def _unite_two(parents: Int32Array, a: int, b: int) -> None:
    """Hang the higher of two roots below the lower."""
    root_a, root_b = _root(parents, a), _root(parents, b)
    if root_a < root_b:
        parents[root_b] = root_a
    else:
        parents[root_a] = root_b


@helper
def _root(parents: Int32Array, run: int) -> int:
    """The root of a run, halving the path on the way."""
    while parents[run] != run:
        parents[run] = parents[parents[run]]
        run = parents[run]
    return run


@kernel("int64(const int32[:], int32[:])")
def _number(parents: Int32Array, labels: Int32Array) -> int:
    """Write the number of each one's component; how many there are. Parents come first."""
    n = 0
    for run in range(parents.size):
        if parents[run] == run:
            labels[run] = n
            n += 1
        else:
            labels[run] = labels[parents[run]]
    return n


@kernel("void(int32[:])")
def _flatten(parents: Int32Array) -> None:
    """Make every run point at its root; roots are the lowest of their component."""
    for run in range(parents.size):
        parents[run] = parents[parents[run]]


@kernel("void(const int64[:, :, :], const int32[:], const int32[:], int64, int64, int64[:, :])")
def _holding(
    first: IntArray, begin: Int32Array, end: Int32Array, iy: int, ix: int, found: IntArray
) -> None:
    """Write the run that holds each pose at a node, or -1."""
    for a1 in range(found.shape[0]):
        for swing in range(found.shape[1]):
            # the first run that does not end before the column; bisected by hand, since numpy's
            # own takes a second to compile
            run, beyond = first[a1, swing, iy], first[a1, swing, iy + 1]
            last = beyond
            while run < beyond:
                middle = (run + beyond) // 2
                if end[middle] < ix:
                    run = middle + 1
                else:
                    beyond = middle
            found[a1, swing] = run if run < last and begin[run] <= ix else -1


@kernel("void(uint64[:, :], const int32[:], const int32[:], const int32[:])")
def _paint(words: Words, row: Int32Array, begin: Int32Array, end: Int32Array) -> None:
    """Set the bits of runs."""
    for run in range(row.size):
        set_bits(words[row[run]], begin[run], end[run])


@helper
def _next_bit(row: Words, begin: int) -> int:
    """The first set bit of a row of words from `begin` on, or -1."""
    word = begin >> 6
    if word >= row.size:
        return -1
    bits = row[word] >> np.uint64(begin & 63) << np.uint64(begin & 63)
    while not bits:
        word += 1
        if word == row.size:
            return -1
        bits = row[word]
    return word * 64 + lowest_bit(bits)


@helper
def lowest_bit(bits: np.uint64) -> int:
    """Number of the lowest set bit: how many lie below it."""
    return n_bits((bits & (~bits + np.uint64(1))) - np.uint64(1))
