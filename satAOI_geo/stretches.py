"""The nodes of connected sets, set by set, as stretches of rows.

The states of a set stand at its nodes in dozens of poses each. Where it is only asked which nodes
a set has, as for the floor that it trowels, a few stretches a row answer it.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from satAOI_geo.lattice import WORD_BITS
from satAOI_geo.nodes import Nodes
from satAOI_geo.plan import IntArray
from satAOI_geo.runs import Int32Array, paint


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

    def boxes(self) -> npt.NDArray[np.int64]:
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
