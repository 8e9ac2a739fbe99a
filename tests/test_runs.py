"""Runs against the stretches of nodes one counts by hand, links against every single move."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from satAOI_geo.lattice import Lattice, Words
from satAOI_geo.nodes import Nodes
from satAOI_geo.plan import BoolArray, IntArray
from satAOI_geo.runs import Meeting, Runs, SliceRuns, paint, roots, unite

Stretch = tuple[int, int, int]
"""Row, first and last column."""

SHAPES = st.tuples(st.integers(1, 4), st.sampled_from([1, 2, 63, 64, 65, 127, 128, 130, 200]))


def lattice_of(shape: tuple[int, int]) -> Lattice:
    return Lattice((0.0, 0.0), 10.0, *shape, 4, (0,))


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


TWO_SLICES = SHAPES.flatmap(lambda shape: st.tuples(slices(shape), slices(shape)))


@pytest.mark.parametrize("rows_up", [0, 1])
@given(TWO_SLICES, st.integers(0, 2**32 - 1), st.sampled_from([0.02, 0.5, 1.0]))
def test_links_join_the_runs_that_single_moves_join(
    rows_up: int,
    drawn: tuple[tuple[BoolArray, BoolArray], tuple[BoolArray, BoolArray]],
    seed: int,
    share: float,
) -> None:
    runs = runs_of(*drawn)
    to_swing = 1 - rows_up
    meeting = Meeting.upwards(runs, (0, 0)) if rows_up else Meeting.of(runs, (0, 0), (0, 1))
    free, to_free = drawn[0][0], drawn[to_swing][0]
    allowed = free & (np.random.default_rng(seed).random(free.shape) < share)
    allowed[: free.shape[0] - rows_up] &= to_free[rows_up:]
    allowed[free.shape[0] - rows_up :] = False
    found = meeting.links(bits(allowed)).tolist()

    expected = {
        (runs.holding(iy, ix)[0, 0], runs.holding(iy + rows_up, ix)[0, to_swing])
        for iy, ix in np.argwhere(allowed).tolist()
    }
    assert {(one, other) for one, other, _ in found} == expected
    assert len(found) == len(expected)
    for one, _, ix in found:
        assert allowed[runs.rows()[one], ix]


@given(TWO_SLICES, st.integers(0, 2**32 - 1), st.sampled_from([0.0, 0.5, 0.9, 1.0]))
def test_runs_are_apart_in_the_rows_in_which_some_link_would_join_two_components(
    drawn: tuple[tuple[BoolArray, BoolArray], tuple[BoolArray, BoolArray]],
    seed: int,
    share: float,
) -> None:
    runs = runs_of(*drawn)
    meeting = Meeting.of(runs, (0, 0), (0, 1))
    noise = np.random.default_rng(seed)
    # a move may start from nodes in both runs only
    allowed = bits(noise.random(drawn[0][0].shape) < noise.choice([0.02, 0.9]))
    links = meeting.links(allowed)
    parents = np.arange(runs.begin.size, dtype=np.int32)
    unite(parents, links[noise.random(len(links)) < share])
    root = roots(parents.copy())
    apart = meeting.rows_apart(parents, allowed)
    expected = {runs.rows()[a] for a, b, _ in links.tolist() if root[a] != root[b]}
    assert (set() if apart is None else set(np.flatnonzero(apart).tolist())) == expected

    some = noise.random(len(drawn[0][0])) < share
    joined, within = parents.copy(), some[runs.rows()[links[:, 0]]]
    meeting.join(joined, allowed, some)
    unite(parents, links[within])
    assert roots(joined).tolist() == roots(parents).tolist()
    if share == 1.0:
        assert meeting.rows_apart(joined, allowed) is None


@given(st.integers(1, 60), st.lists(st.tuples(st.integers(0, 59), st.integers(0, 59)), max_size=80))
def test_united_runs_share_the_lowest_of_them(n_runs: int, drawn: list[tuple[int, int]]) -> None:
    pairs = [(a % n_runs, b % n_runs) for a, b in drawn]
    parents = np.arange(n_runs, dtype=np.int32)
    for half in (pairs[::2], pairs[1::2]):
        unite(parents, np.array([(a, b, 0) for a, b in half], dtype=np.int32).reshape(-1, 3))
    assert roots(parents).tolist() == lowest_of_component(n_runs, pairs)


def lowest_of_component(n_runs: int, pairs: list[tuple[int, int]]) -> list[int]:
    """Lower the label of either end of a pair to the other's until nothing changes."""
    label = list(range(n_runs))
    changed = True
    while changed:
        changed = False
        for a, b in pairs:
            low = min(label[a], label[b])
            changed |= label[a] != low or label[b] != low
            label[a] = label[b] = low
    return label


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
