"""Sets of nodes as bits: what goes in comes out, and neighbours are where they are said to be."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from satAOI_geo.lattice import WORD_BITS
from satAOI_geo.nodes import Nodes, from_above, from_below, from_left, from_right
from satAOI_geo.plan import BoolArray


@st.composite
def drawn(draw: st.DrawFn) -> BoolArray:
    shape = draw(st.integers(1, 5)), draw(st.integers(1, 200))
    return np.random.default_rng(draw(st.integers(0, 2**32 - 1))).random(shape) < 0.5


@given(drawn())
def test_bits_come_back_as_the_nodes_they_were(chosen: BoolArray) -> None:
    nodes = Nodes.of(chosen)
    assert nodes.shape == chosen.shape
    assert np.array_equal(nodes.as_array(), chosen)
    # bits beyond the last column do not count
    assert nodes.count() == chosen.sum()


@pytest.mark.parametrize("n_columns", [1, 63, 64, 65, 127, 128, 129])
def test_a_node_is_the_bit_it_is_said_to_be(n_columns: int) -> None:
    for ix in range(n_columns):
        chosen = np.zeros((2, n_columns), dtype=np.bool_)
        chosen[1, ix] = True
        nodes = Nodes.of(chosen)
        assert int(nodes.words[1, ix // WORD_BITS]) == 1 << ix % WORD_BITS
        assert nodes.has(1, ix)
        assert not nodes.has(0, ix)


@given(drawn())
def test_neighbours_are_those_of_the_array(chosen: BoolArray) -> None:
    around = np.pad(chosen, 1)
    words = Nodes.of(chosen).words
    for moved, neighbours in (
        (from_right, around[1:-1, 2:]),
        (from_left, around[1:-1, :-2]),
        (from_above, around[2:, 1:-1]),
        (from_below, around[:-2, 1:-1]),
    ):
        found = Nodes(moved(words), chosen.shape[1]).as_array()
        assert np.array_equal(found, neighbours)
