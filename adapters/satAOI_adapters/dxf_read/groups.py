"""Things joined by pairs into groups, and points that lie near each other.

Scipy has both, and takes longer to load than most drawings to read.
"""

from collections.abc import Sequence

import numpy as np
import shapely
from shapely.geometry import Point as Spot

from satAOI_adapters.dxf_read.curves import Point
from satAOI_geo.plan import FloatArray, IntArray


def linked(pairs: IntArray, n: int) -> IntArray:
    """The number of the group that each of n things is in, linked by pairs, shape (pairs, 2).

    Groups are numbered in the order of their first member.
    """
    # the least member found so far stands for a group
    least = np.arange(n)
    while True:
        one, other = least[pairs[:, 0]], least[pairs[:, 1]]
        if (one == other).all():
            break
        np.minimum.at(least, np.maximum(one, other), np.minimum(one, other))
        while not (least[least] == least).all():
            least = least[least]
    return np.unique(least, return_inverse=True)[1]


class Spots:
    """Points of which those near a place are found quickly, shape (n, 2)."""

    def __init__(self, points: Sequence[Point] | FloatArray) -> None:
        self._points = shapely.points(np.reshape(points, (-1, 2)))
        self._tree = shapely.STRtree(self._points)

    def near(self, place: Point, within: float) -> list[int]:
        """Numbers of the points no farther away from a place, ascending."""
        found = self._tree.query(Spot(place), predicate="dwithin", distance=within)
        return sorted(found.tolist())

    def pairs(self, within: float) -> IntArray:
        """Numbers of points no farther away from each other, the lesser first, shape (pairs, 2)."""
        one, other = self._tree.query(self._points, predicate="dwithin", distance=within)
        pairs = np.column_stack((one, other))[one < other]
        return np.asarray(pairs[np.lexsort(pairs.T[::-1])])
