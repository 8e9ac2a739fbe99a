"""States gathered into runs.

A run is a stretch of nodes in one row at one pose through which the disc can step. The 6·10⁸
states of a hall make some 10⁶ runs; what is connected is asked of these.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from satAOI_geo.kernels import filled, kernel
from satAOI_geo.lattice import WORD_BITS, Words
from satAOI_geo.nodes import Nodes, lowest_bit, set_bits
from satAOI_geo.plan import Int32Array, IntArray

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

    def rows(self) -> IntArray:
        """Row of each run, shape (n_runs,)."""
        return np.repeat(np.arange(self.first.size - 1), np.diff(self.first))


def rows_of(nodes: Nodes) -> SliceRuns:
    """The stretches of a set's nodes, row by row."""
    return SliceRuns.of(nodes.words, NOWHERE)


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
