"""Runs against the stretches of nodes one counts by hand."""

from itertools import pairwise

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from satAOI_geo.lattice import Lattice
from satAOI_geo.nodes import Nodes
from satAOI_geo.plan import BoolArray
from satAOI_geo.runs import paint
from tests.slices import SHAPES, listed, runs_of, slices, stretches


def lattice_of(shape: tuple[int, int]) -> Lattice:
    return Lattice((0.0, 0.0), 10.0, *shape, 4, (0,))


@given(SHAPES.flatmap(slices))
def test_runs_are_the_stretches_the_disc_can_step_through(
    drawn: tuple[BoolArray, BoolArray],
) -> None:
    assert listed(runs_of(drawn)) == stretches(*drawn)


@given(SHAPES.flatmap(lambda shape: st.tuples(slices(shape), slices(shape))))
def test_a_state_is_in_the_run_that_covers_it(
    drawn: tuple[tuple[BoolArray, BoolArray], tuple[BoolArray, BoolArray]],
) -> None:
    runs = runs_of(*drawn)
    n_first = len(stretches(*drawn[0]))
    for swing, (free, _) in enumerate(drawn):
        for iy, ix in np.ndindex(free.shape):
            run = runs.holding(iy, ix)[0, swing]
            assert (run < 0) == (not free[iy, ix])
            if run >= 0:
                row, begin, end = listed(runs)[run]
                assert row == iy
                assert begin <= ix <= end
                assert (run >= n_first) == (swing == 1)


@given(SHAPES.flatmap(slices), st.integers(0, 2**32 - 1))
def test_painted_stretches_cover_their_nodes(drawn: tuple[BoolArray, BoolArray], seed: int) -> None:
    runs = runs_of(drawn)
    lattice = lattice_of(drawn[0].shape)
    chosen = np.flatnonzero(np.random.default_rng(seed).random(runs.begin.size) < 0.5)
    words = lattice.no_nodes()
    paint(words, runs.rows()[chosen], runs.begin[chosen], runs.end[chosen])
    expected = np.zeros(lattice.shape, dtype=bool)
    for run in chosen:
        iy, begin, end = listed(runs)[run]
        expected[iy, begin : end + 1] = True
    assert np.array_equal(Nodes(words, lattice.n_columns).as_array(), expected)


@given(SHAPES.flatmap(slices))
def test_runs_of_a_row_do_not_overlap_and_come_in_order(drawn: tuple[BoolArray, BoolArray]) -> None:
    for (row, _, end), (next_row, begin, _) in pairwise(listed(runs_of(drawn))):
        assert (row, end) < (next_row, begin)
