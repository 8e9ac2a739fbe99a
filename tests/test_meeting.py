"""Links between runs against every single move, and what is joined against the links."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from satAOI_geo.forest import roots, unite
from satAOI_geo.meeting import Meeting, unite_poses
from satAOI_geo.plan import BoolArray
from tests.slices import SHAPES, TWO_SLICES, bits, runs_of, slices


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


@given(SHAPES.flatmap(lambda shape: st.tuples(*[slices(shape)] * 4)), st.integers(0, 2**32 - 1))
def test_poses_joined_together_are_those_joined_one_by_one(
    drawn: tuple[tuple[BoolArray, BoolArray], ...], seed: int
) -> None:
    runs, noise = runs_of(*drawn), np.random.default_rng(seed)
    shape = drawn[0][0].shape
    allowed, some = bits(noise.random(shape) < 0.7), noise.random(shape[0]) < 0.5
    together, one_by_one = (np.arange(runs.begin.size, dtype=np.int32) for _ in range(2))
    unite_poses(together, runs, (0, slice(3)), (0, slice(1, 4)), allowed, some)
    for swing in range(3):
        Meeting.of(runs, (0, swing), (0, swing + 1)).join(one_by_one, allowed, some)
    assert roots(together).tolist() == roots(one_by_one).tolist()
