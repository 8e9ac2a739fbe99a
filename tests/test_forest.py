"""Components against labels lowered until nothing changes."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from satAOI_geo.forest import roots, unite


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
