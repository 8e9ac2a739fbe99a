"""Random slices of free nodes, and their runs."""

import numpy as np
from hypothesis import strategies as st

from satAOI_geo.lattice import Words
from satAOI_geo.nodes import Nodes
from satAOI_geo.plan import BoolArray, IntArray
from satAOI_geo.runs import Runs, SliceRuns

Stretch = tuple[int, int, int]
"""Row, first and last column."""

SHAPES = st.tuples(st.integers(1, 4), st.sampled_from([1, 2, 63, 64, 65, 127, 128, 130, 200]))


def bits(nodes: BoolArray) -> Words:
    """Nodes as bits."""
    return Nodes.of(nodes).words


def barred(free: BoolArray, right: BoolArray) -> IntArray:
    """The free nodes from which no step leads to the right, numbered as their bits are."""
    iy, ix = np.nonzero(free & ~right)
    return iy * 64 * bits(free).shape[1] + ix


@st.composite
def slices(draw: st.DrawFn, shape: tuple[int, int]) -> tuple[BoolArray, BoolArray]:
    """Free nodes, and those among them from which the disc may step to the right."""
    noise = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    free = noise.random(shape) < draw(st.sampled_from([0.1, 0.5, 0.9, 0.99, 1.0]))
    right = free & (noise.random(shape) < draw(st.sampled_from([0.3, 0.9, 1.0])))
    right[:, :-1] &= free[:, 1:]
    right[:, -1] = False
    return free, right


def stretches(free: BoolArray, right: BoolArray) -> list[Stretch]:
    """The runs, a node at a time."""
    found: list[Stretch] = []
    for iy, row in enumerate(free):
        for ix in np.flatnonzero(row).tolist():
            if found and found[-1][0] == iy and found[-1][2] == ix - 1 and right[iy, ix - 1]:
                found[-1] = (iy, found[-1][1], ix)
            else:
                found.append((iy, ix, ix))
    return found


def runs_of(*drawn: tuple[BoolArray, BoolArray]) -> Runs:
    """The runs of one direction whose swings are these slices."""
    parts = [SliceRuns.of(bits(free), barred(free, right)) for free, right in drawn]
    return Runs.joined(parts, (1, len(parts), len(drawn[0][0])))


def listed(runs: Runs) -> list[Stretch]:
    return list(zip(runs.rows().tolist(), runs.begin.tolist(), runs.end.tolist(), strict=True))


TWO_SLICES = SHAPES.flatmap(lambda shape: st.tuples(slices(shape), slices(shape)))
