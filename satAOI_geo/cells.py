"""The union of equal discs on lattice nodes: the cells it covers.

A cell is covered where its centre, which is a node, is. Coordinates are lattice units here: node
[iy, ix] lies at (ix, iy), and the discs have the radius ρ = R / step.
"""

import math

import numpy as np

from satAOI_geo.kernels import helper, kernel
from satAOI_geo.lattice import Words
from satAOI_geo.nodes import Nodes, lowest_bit, set_bits
from satAOI_geo.plan import IntArray

TIE = 1e-12
"""Share of a squared radius within which a squared distance counts as equal to it: far more than
the rounding of R and the step, and less than sets two whole numbers apart up to ρ = 500 000."""


def covered_cells(reached: Nodes, radius: float) -> Nodes:
    """The nodes within a radius, in steps, of a reached node, at exactly the radius included.

    What would lie beyond the lattice is cut off.
    """
    square = radius * radius * (1 + TIE)
    rows = np.arange(math.floor(math.sqrt(square)) + 1)
    half_widths = np.floor(np.sqrt(square - rows * rows)).astype(np.int64)
    covered = np.zeros_like(reached.words)
    _cover(reached.words, half_widths, covered, reached.n_columns)
    return Nodes(covered, reached.n_columns)


@kernel("void(const uint64[:, :], const int64[:], uint64[:, :], int64)")
def _cover(reached: Words, half_widths: IntArray, covered: Words, n_columns: int) -> None:
    """Set the cells that lie within half_widths[d] columns of a reached node d rows away.

    What a node covers in rows below its own the node below it covers, too, if it is reached: it
    is nearer. So only nodes above unreached ones are looked at for these, and likewise upwards.
    """
    n_rows = reached.shape[0]
    for iy in range(n_rows):
        for word in range(reached.shape[1]):
            bits = reached[iy, word]
            if bits:
                below = reached[iy - 1, word] if iy > 0 else np.uint64(0)
                above = reached[iy + 1, word] if iy + 1 < n_rows else np.uint64(0)
                _cover_rows(covered, iy, iy + 1, 1, word, bits, half_widths, n_columns)
                _cover_rows(covered, iy, -1, -1, word, bits & ~below, half_widths, n_columns)
                _cover_rows(covered, iy, n_rows, 1, word, bits & ~above, half_widths, n_columns)


@helper
def _cover_rows(
    covered: Words,
    iy: int,
    stop: int,
    step: int,
    word: int,
    bits: np.uint64,
    half_widths: IntArray,
    n_columns: int,
) -> None:
    """Set the cells about the nodes of one word of row iy, in this row and in those after it.

    Args:
        covered: The cells.
        iy: A row.
        stop: The row before which to end.
        step: 1 for the rows above, -1 for those below.
        word: Number of the word.
        bits: The word.
        half_widths: See `_cover`.
        n_columns: Columns of the lattice.
    """
    n_rows = min(abs(stop - iy), half_widths.size)
    while bits:
        low = lowest_bit(bits)
        begin = 64 * word + low
        end = begin + lowest_bit(~(bits >> np.uint64(low))) - 1
        for away in range(n_rows):
            width = half_widths[away]
            left, right = max(0, begin - width), min(n_columns - 1, end + width)
            set_bits(covered[iy + step * away], left, right)
        # the carry of the sum runs through the stretch
        bits &= bits + (np.uint64(1) << np.uint64(low))
