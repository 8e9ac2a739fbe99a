"""Things joined by pairs into groups, and points that lie near each other.

What scipy needs for this is loaded here and only when it is asked for: a drawing of closed shapes
alone is read without it, a quarter of a second earlier.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from satAOI_geo.plan import FloatArray, IntArray

if TYPE_CHECKING:
    from scipy.spatial import cKDTree


def linked(pairs: IntArray, n: int) -> IntArray:
    """The number of the group that each of n things is in, linked by pairs, shape (pairs, 2)."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    links = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(n, n))
    _, group = connected_components(links, directed=False)
    return np.asarray(group, dtype=np.int64)


def tree_of(points: Sequence[tuple[float, ...]] | FloatArray) -> "cKDTree":
    """A tree of points in which those near a place are found quickly."""
    from scipy.spatial import cKDTree

    return cKDTree(points)
