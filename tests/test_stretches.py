"""The nodes of sets of runs, as stretches of rows."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from satAOI_geo.nodes import Nodes
from satAOI_geo.plan import BoolArray
from satAOI_geo.runs import Runs, SliceRuns, rows_of
from satAOI_geo.stretches import Stretches, merged, of_runs

N_ROWS = 3


def drawn_runs(rng: np.random.Generator, n_columns: int, n_poses: int) -> Runs:
    """Runs of random nodes."""
    slices = [rows_of(Nodes.of(rng.random((N_ROWS, n_columns)) < 0.6)) for _ in range(n_poses)]
    return Runs.joined(slices, (1, n_poses, N_ROWS))


@given(
    st.integers(0, 2**32 - 1),
    st.sampled_from([1, 5, 63, 64, 65, 128, 200]),
    st.integers(1, 5),
    st.integers(1, 4),
)
def test_the_stretches_of_runs_are_those_of_sorting_and_merging_them(
    seed: int, n_columns: int, n_poses: int, n_sets: int
) -> None:
    rng = np.random.default_rng(seed)
    runs = drawn_runs(rng, n_columns, n_poses)
    labels = rng.integers(0, n_sets, runs.begin.size).astype(np.int32)
    expected = merged(labels, runs.rows(), runs.begin, runs.end)
    found, states = of_runs(runs, labels, n_sets)
    for each, column in zip(found, expected, strict=True):
        assert each.dtype == column.dtype
        assert np.array_equal(each, column)
    pose = np.searchsorted(runs.first[0, :, -1], np.arange(labels.size), side="right")
    of_all = list(zip(runs.rows().tolist(), pose.tolist(), runs.begin.tolist(), strict=True))
    for label in np.unique(labels).tolist():
        first = min(of_all[run] for run in np.flatnonzero(labels == label).tolist())
        assert tuple(states[label].tolist()) == first


def test_runs_that_meet_or_overlap_are_one_stretch_in_their_set_only() -> None:
    def pose(begin: int, end: int) -> SliceRuns:
        first, column = np.array([0, 1]), np.array([begin], dtype=np.int32)
        return SliceRuns(first, column, np.array([end], dtype=np.int32))

    poses = [pose(10, 20), pose(21, 63), pose(65, 70), pose(15, 30)]
    runs = Runs.joined(poses, (1, 4, 1))
    labels = np.array([1, 1, 1, 0], dtype=np.int32)
    stretches = np.column_stack(of_runs(runs, labels, 2)[0])
    assert stretches.tolist() == [[0, 0, 15, 30], [1, 0, 10, 63], [1, 0, 65, 70]]


@pytest.mark.parametrize("n_poses", [1, 3])
def test_no_runs_have_no_stretches(n_poses: int) -> None:
    none = rows_of(Nodes.of(np.zeros((N_ROWS, 70), dtype=np.bool_)))
    found, states = of_runs(
        Runs.joined([none] * n_poses, (1, n_poses, N_ROWS)), np.empty(0, dtype=np.int32), 0
    )
    assert [column.size for column in found] == [0, 0, 0, 0]
    assert states.shape == (0, 3)


def stretches_of(sets: list[BoolArray]) -> Stretches:
    """The stretches of some sets, given as rasters."""
    parts = []
    for label, nodes in enumerate(sets):
        rows = rows_of(Nodes.of(nodes))
        parts.append((np.full(rows.begin.size, label), rows.rows(), rows.begin, rows.end))
    columns = (np.concatenate(part).astype(np.int32) for part in zip(*parts, strict=True))
    return Stretches.of(*columns, n_sets=len(sets))


def middle_of_largest_square(nodes: BoolArray) -> tuple[int, int]:
    """The first node that the most rings of nodes are around, looked at one by one."""

    def n_rings(iy: int, ix: int) -> int:
        most = min(iy, ix, nodes.shape[0] - 1 - iy, nodes.shape[1] - 1 - ix)
        squares = (nodes[iy - k : iy + k + 1, ix - k : ix + k + 1] for k in range(most + 1))
        return sum(itertools.takewhile(bool, (bool(square.all()) for square in squares)))

    places = [(iy, ix) for iy, ix in np.argwhere(nodes).tolist()]
    return max(places, key=lambda place: n_rings(*place))


@given(st.integers(0, 2**32 - 1), st.sampled_from([0.1, 0.6, 0.9, 0.98, 1.0]))
def test_deepest_node_is_the_first_with_the_most_rings_of_nodes_around_it(
    seed: int, share: float
) -> None:
    rng = np.random.default_rng(seed)
    shape = rng.integers(1, 20, 2)
    sets = [rng.random(shape) < share for _ in range(3)]
    for nodes in sets:
        nodes[tuple(rng.integers(0, shape))] = True
    labels = np.array([2, 0, 1])
    deepest = stretches_of(sets).deepest(labels, int(shape[1]))
    assert [tuple(place) for place in deepest.tolist()] == [
        middle_of_largest_square(sets[label]) for label in labels
    ]
