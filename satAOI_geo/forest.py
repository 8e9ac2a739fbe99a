"""Union-find: members joined into components.

A forest is an array, `parents`: each member points at one of its component that is no higher, a
root at itself. So the root of a component is its lowest member, however it came about.
"""

import numpy as np

from satAOI_geo.kernels import helper, kernel
from satAOI_geo.plan import Int32Array


def unite(parents: Int32Array, pairs: Int32Array) -> None:
    """Join pairs, the first two columns of (n, 2 or 3), in the forest `parents`, shape (m,)."""
    _unite(parents, pairs)


def numbered(parents: Int32Array) -> tuple[Int32Array, int]:
    """The component of each member of a forest, in the order of their roots; how many there are."""
    labels = np.empty_like(parents)
    return labels, _number(parents, labels)


def roots(parents: Int32Array) -> Int32Array:
    """The lowest member of each one's component, shape (m,); `parents` becomes the answer."""
    _flatten(parents)
    return parents


@kernel("void(int32[:], const int32[:, :])")
def _unite(parents: Int32Array, pairs: Int32Array) -> None:
    """Join pair by pair."""
    for k in range(pairs.shape[0]):
        unite_two(parents, pairs[k, 0], pairs[k, 1])


@helper
def unite_two(parents: Int32Array, a: int, b: int) -> None:
    """Hang the higher of two roots below the lower."""
    root_a, root_b = root(parents, a), root(parents, b)
    if root_a < root_b:
        parents[root_b] = root_a
    else:
        parents[root_a] = root_b


@helper
def root(parents: Int32Array, member: int) -> int:
    """The root of a member, halving the path on the way."""
    while parents[member] != member:
        parents[member] = parents[parents[member]]
        member = parents[member]
    return member


@kernel("int64(const int32[:], int32[:])")
def _number(parents: Int32Array, labels: Int32Array) -> int:
    """Write the number of each one's component; how many there are. Parents come first."""
    n = 0
    for member in range(parents.size):
        if parents[member] == member:
            labels[member] = n
            n += 1
        else:
            labels[member] = labels[parents[member]]
    return n


@kernel("void(int32[:])")
def _flatten(parents: Int32Array) -> None:
    """Make every member point at its root; roots are the lowest of their component."""
    for member in range(parents.size):
        parents[member] = parents[parents[member]]
