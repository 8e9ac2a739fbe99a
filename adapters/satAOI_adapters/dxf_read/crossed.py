"""The sign for an opening in the floor: a rectangle with both its diagonals."""

import math
from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np
import shapely
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from satAOI_adapters.dxf_read.curves import Line
from satAOI_adapters.dxf_read.features import Feature
from satAOI_adapters.dxf_read.groups import Spots
from satAOI_adapters.dxf_read.loops import Loop
from satAOI_adapters.dxf_read.options import CLOSE_GAPS_MM
from satAOI_adapters.dxf_read.plans import rough_lines
from satAOI_adapters.dxf_read.rooms import ALONG_MM, NEARLY, share_along
from satAOI_adapters.dxf_read.shapes import is_thin, rounded

LEAST_MM: Final = 3 * ALONG_MM
"""Of anything narrower, a line near one side is near the other, too."""

MOST_HALVING: Final = 3
"""Lines that may halve a diagonal: the other one, and each once more, drawn a hair beside."""


OBLIQUE: Final = (math.cos(1), math.sin(1))
"""A direction that lines of drawings are hardly ever in."""


def crossed(
    crossing: Sequence[Feature], drawn: Sequence[Feature], walls: Sequence[BaseGeometry]
) -> list[Loop]:
    """Rectangles that are crossed by their diagonals, each with the lines that cross it.

    Two lines of one length that halve each other are the diagonals of a rectangle. Its sides must
    be drawn, too, or walls be along them: crosses alone mark anything.

    Args:
        crossing: What the diagonals may be among.
        drawn: What the sides may be among.
        walls: What else may be along the sides.
    """
    lines = [feature for feature in crossing if _is_line(feature)]
    if not lines:
        return []
    edges = np.array([*walls, *rough_lines(drawn)], dtype=object)
    owners = [0] * len(walls) + [id(feature) for feature in drawn]
    tree = shapely.STRtree(edges)
    found = []
    for rectangle, diagonals in _halved(lines):
        own = {id(line) for line in diagonals}
        rim = rectangle.exterior
        near = tree.query(rim, predicate="dwithin", distance=ALONG_MM)
        if share_along(rim, [edges[i] for i in near if owners[i] not in own]) >= NEARLY:
            found.append(Loop(rectangle, diagonals))
    return found


def _is_line(feature: Feature) -> bool:
    """Whether a feature is a single straight line without width."""
    if feature.is_area or feature.width_mm or len(feature.paths) != 1:
        return False
    pieces = feature.paths[0].pieces
    return len(pieces) == 1 and isinstance(pieces[0], Line)


def _halved(lines: Sequence[Feature]) -> Iterator[tuple[Polygon, tuple[Feature, ...]]]:
    """The rectangles whose diagonals are among some lines, less the narrow ones.

    Diagonals may be drawn twice; where many lines halve each other they are the spokes of a star.
    """
    drawn = [sorted((line.paths[0].start, line.paths[0].end)) for line in lines]
    ends, owners = np.unique(np.array(drawn), axis=0, return_inverse=True)
    copies: list[list[Feature]] = [[] for _ in ends]
    for owner, line in zip(owners.tolist(), lines, strict=True):
        copies[owner].append(line)
    lengths_mm = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    middles = ends.mean(axis=1)
    # the tree is flat: first the middles are told apart along one direction only, then along both
    pairs = Spots(np.column_stack((middles @ OBLIQUE, lengths_mm))).pairs(CLOSE_GAPS_MM)
    apart_mm = np.hypot(*(middles[pairs[:, 0]] - middles[pairs[:, 1]]).T)
    pairs = pairs[apart_mm <= CLOSE_GAPS_MM]
    n_halving = np.bincount(pairs.ravel(), minlength=len(ends))
    for i, j in pairs[(n_halving[pairs] <= MOST_HALVING).all(axis=1)].tolist():
        corners = (ends[i, 0], ends[j, 0], ends[i, 1], ends[j, 1])
        for rectangle in rounded([Polygon(corners)]):
            if not is_thin(rectangle, LEAST_MM):
                yield rectangle, (*copies[i], *copies[j])
