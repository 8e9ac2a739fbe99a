"""States gathered into runs, and runs joined into components.

A run is a stretch of nodes in one row at one pose through which the disc can step. The 6·10⁸
states of a hall make some 10⁶ runs; connectivity is union-find over these.
"""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from satAOI_geo.intervals import set_bits
from satAOI_geo.kernels import helper, kernel
from satAOI_geo.lattice import Lattice, Words
from satAOI_geo.nodes import Nodes, from_right, n_bits
from satAOI_geo.plan import BoolArray, IntArray

Int32Array: TypeAlias = npt.NDArray[np.int32]


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
        of_rows = [
            part.first[:-1] + offset for part, offset in zip(parts, offsets[:-1], strict=True)
        ]
        first = np.concatenate([*of_rows, offsets[-1:]])
        # each pose ends where the next one begins
        places = n_rows * np.arange(n_directions * n_swings)[:, np.newaxis] + np.arange(n_rows + 1)
        return cls(
            first[places].reshape(n_directions, n_swings, n_rows + 1),
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

    def lowest_states(self, labels: Int32Array, n_sets: int, lattice: Lattice) -> IntArray:
        """For each set of runs, numbered by `labels`, a number that puts sets in order.

        It is that of the set's first state by row, pose and column, and the same however a lattice
        is cut into bands.
        """
        lowest = np.full(n_sets, np.iinfo(np.int64).max)
        _lowest_states(self.first, self.begin, labels, lattice.first_row, lattice.n_columns, lowest)
        return lowest

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
    def of(cls, free: Words, right: Words) -> "SliceRuns":
        """The runs from free nodes and the steps to the right among them, (n_rows, n_words)."""
        first = np.zeros(free.shape[0] + 1, dtype=np.int64)
        _count_runs(free, right, first)
        np.cumsum(first, out=first)
        begin = np.empty(first[-1], dtype=np.int32)
        end = np.empty(first[-1], dtype=np.int32)
        _fill_runs(free, right, first, begin, end)
        return cls(first, begin, end)


@dataclass(frozen=True, slots=True)
class Meeting:
    """The runs of two rows of poses that a move could lead between, row by row.

    Attributes:
        first_a: Shape (n_rows + 1,), for each row where it starts the first of its runs.
        first_b: The same for the row that it ends at.
        end: Last column of all runs.
    """

    first_a: IntArray
    first_b: IntArray
    end: Int32Array

    @classmethod
    def of(cls, runs: Runs, pose: tuple[int, int], to_pose: tuple[int, int]) -> "Meeting":
        """The runs of a pose, (a1, swing), and those of another at the same nodes."""
        return cls(runs.first[pose], runs.first[to_pose], runs.end)

    @classmethod
    def upwards(cls, runs: Runs, pose: tuple[int, int]) -> "Meeting":
        """The runs of a pose, (a1, swing), and those of the row above it; none above the last."""
        first = runs.first[pose]
        return cls(first, np.append(first[1:], first[-1]), runs.end)

    def links(self, allowed: Words) -> Int32Array:
        """The pairs of runs that a move leads between, given the nodes it may start from.

        Returns:
            Shape (n, 3): a run, the run it leads to, and the column of a node where it does.
        """
        first_a, first_b = self.first_a, self.first_b
        # two sorted rows of runs overlap in fewer pairs than there are runs in both
        found = np.empty((first_a[-1] - first_a[0] + first_b[-1] - first_b[0], 3), dtype=np.int32)
        return found[: _links(allowed, first_a, first_b, self.end, found)]

    def rows_apart(self, parents: Int32Array, ends: tuple[Words, Words, Words]) -> BoolArray:
        """The rows in which a move could join two components of the forest `parents`.

        It can be made at most at the nodes in all three sets `ends`, where both its ends are free.
        """
        apart = np.empty(self.first_a.size - 1, dtype=np.bool_)
        _rows_apart(parents, *ends, self.first_a, self.first_b, self.end, apart)
        return apart


def rows_of(nodes: Nodes) -> SliceRuns:
    """The stretches of a set's nodes, row by row."""
    return SliceRuns.of(nodes.words, nodes.words & from_right(nodes.words))


def unite(parents: Int32Array, pairs: Int32Array) -> None:
    """Join pairs, the first two columns of (n, 2 or 3), in the forest `parents`, shape (m,)."""
    _unite(parents, pairs)


def unite_upwards(parents: Int32Array, runs: Runs, a1: int, allowed: Words) -> None:
    """Join the runs of a direction's poses that steps from row to row lead between.

    Args:
        parents: The forest, shape (n_runs,). Only what belongs to these runs is read and changed.
        runs: All runs.
        a1: The direction.
        allowed: Shape (n_swings, n_rows, n_words), the nodes from which the disc may step up.
    """
    _unite_upwards(parents, allowed, runs.first[a1], runs.end)


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


@kernel("void(const uint64[:, :], const uint64[:, :], int64[:])")
def _count_runs(free: Words, right: Words, first: IntArray) -> None:
    """Write how many runs begin in row iy to first[iy + 1]."""
    for iy in range(free.shape[0]):
        carry = np.uint64(0)
        n = 0
        for word in range(free.shape[1]):
            stepped = right[iy, word]
            n += n_bits(free[iy, word] & ~(stepped << np.uint64(1) | carry))
            carry = stepped >> np.uint64(63)
        first[iy + 1] = n


@kernel("void(const uint64[:, :], const uint64[:, :], const int64[:], int32[:], int32[:])")
def _fill_runs(
    free: Words, right: Words, first: IntArray, begin: Int32Array, end: Int32Array
) -> None:
    """Write first and last column of every run."""
    for iy in range(free.shape[0]):
        carry = np.uint64(0)
        n_begun = n_ended = first[iy]
        for word in range(free.shape[1]):
            stepped = right[iy, word]
            begins = free[iy, word] & ~(stepped << np.uint64(1) | carry)
            ends = free[iy, word] & ~stepped
            carry = stepped >> np.uint64(63)
            while begins:
                begin[n_begun] = word * 64 + lowest_bit(begins)
                begins &= begins - np.uint64(1)
                n_begun += 1
            while ends:
                end[n_ended] = word * 64 + lowest_bit(ends)
                ends &= ends - np.uint64(1)
                n_ended += 1


@kernel("int64(const uint64[:, :], const int64[:], const int64[:], const int32[:], int32[:, :])")
def _links(
    allowed: Words, first_a: IntArray, first_b: IntArray, end: Int32Array, found: Int32Array
) -> int:
    """Write every two runs that an allowed move leads between; how many there are."""
    n = 0
    for iy in range(allowed.shape[0]):
        a, b = first_a[iy], first_b[iy]
        ix = _next_bit(allowed[iy], 0)
        while ix >= 0:
            while end[a] < ix:
                a += 1
            while end[b] < ix:
                b += 1
            # one by one: assigning a tuple takes three seconds longer to compile
            found[n, 0] = a
            found[n, 1] = b
            found[n, 2] = ix
            n += 1
            # one allowed move links the two runs: the next that matters lies beyond either's end
            ix = _next_bit(allowed[iy], min(end[a], end[b]) + 1)
    return n


@kernel(
    "void(const int32[:], const uint64[:, :], const uint64[:, :], const uint64[:, :], "
    "const int64[:], const int64[:], const int32[:], bool[:])"
)
def _rows_apart(
    parents: Int32Array,
    free: Words,
    to_free: Words,
    between: Words,
    first_a: IntArray,
    first_b: IntArray,
    end: Int32Array,
    apart: BoolArray,
) -> None:
    """Write for each row whether two runs that meet at a node of three sets have different roots.

    It reads the forest only, which others may be changing: a root that is out of date makes two
    runs look apart that no longer are, never the other way round.
    """
    for iy in range(free.shape[0]):
        apart[iy] = False
        a, b = first_a[iy], first_b[iy]
        ix = _next_common_bit(free[iy], to_free[iy], between[iy], 0)
        while ix >= 0:
            while end[a] < ix:
                a += 1
            while end[b] < ix:
                b += 1
            if _found(parents, a) != _found(parents, b):
                apart[iy] = True
                break
            ix = _next_common_bit(free[iy], to_free[iy], between[iy], min(end[a], end[b]) + 1)


@helper
def _found(parents: Int32Array, run: int) -> int:
    """The root of a run, nothing changed on the way."""
    while parents[run] != run:
        run = parents[run]
    return run


@kernel("void(int32[:], const uint64[:, :, :], const int64[:, :], const int32[:])")
def _unite_upwards(parents: Int32Array, allowed: Words, first: IntArray, end: Int32Array) -> None:
    """Join every two runs that an allowed step up leads between; see `_links`."""
    for swing in range(allowed.shape[0]):
        for iy in range(allowed.shape[1] - 1):
            row = allowed[swing, iy]
            a, b = first[swing, iy], first[swing, iy + 1]
            ix = _next_bit(row, 0)
            while ix >= 0:
                while end[a] < ix:
                    a += 1
                while end[b] < ix:
                    b += 1
                _unite_two(parents, a, b)
                ix = _next_bit(row, min(end[a], end[b]) + 1)


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


@kernel("void(const int64[:, :, :], const int32[:], const int32[:], int64, int64, int64[:])")
def _lowest_states(
    first: IntArray,
    begin: Int32Array,
    labels: Int32Array,
    first_row: int,
    n_columns: int,
    lowest: IntArray,
) -> None:
    """Write the numbers of the first states of sets; see `Runs.lowest_states`.

    Args:
        first: Shape (n_directions, n_swings, n_rows + 1), see `Runs`.
        begin: First column of each run.
        labels: Its set.
        first_row: Of the whole lattice.
        n_columns: Of the lattice.
        lowest: The number of each set, at first beyond all numbers.
    """
    n_directions, n_swings, n_ends = first.shape
    for a1 in range(n_directions):
        for swing in range(n_swings):
            for iy in range(n_ends - 1):
                line = ((first_row + iy) * n_directions + a1) * n_swings + swing
                for run in range(first[a1, swing, iy], first[a1, swing, iy + 1]):
                    number = line * n_columns + begin[run]
                    lowest[labels[run]] = min(lowest[labels[run]], number)


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
    return _next_common_bit(row, row, row, begin)


@helper
def _next_common_bit(a: Words, b: Words, c: Words, begin: int) -> int:
    """The first bit from `begin` on that is set in three rows of words, or -1."""
    word = begin >> 6
    if word >= a.size:
        return -1
    bits = a[word] & b[word] & c[word]
    bits = bits >> np.uint64(begin & 63) << np.uint64(begin & 63)
    while not bits:
        word += 1
        if word == a.size:
            return -1
        bits = a[word] & b[word] & c[word]
    return word * 64 + lowest_bit(bits)


@helper
def lowest_bit(bits: np.uint64) -> int:
    """Number of the lowest set bit: how many lie below it."""
    return n_bits((bits & (~bits + np.uint64(1))) - np.uint64(1))
