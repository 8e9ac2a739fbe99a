"""Runs that moves lead between: told, compared by their components, and joined."""

from dataclasses import dataclass

import numpy as np

from satAOI_geo.forest import root, unite_two
from satAOI_geo.kernels import helper, kernel
from satAOI_geo.lattice import Words
from satAOI_geo.nodes import lowest_bit
from satAOI_geo.plan import BoolArray, Int32Array, IntArray
from satAOI_geo.runs import Runs


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
                    if root(parents, a) == root(parents, b):
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
                        unite_two(parents, a, b)
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
                    unite_two(parents, a, b)
                if end[a] < end[b]:
                    a += 1
                else:
                    b += 1


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
