"""Outlines drawn piece by piece: open lines of one layer that, end to end, close in themselves.

At each of its corners exactly two lines meet; a mesh, a grid or a comb of lines is no outline.
"""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import shapely
from shapely.geometry import LineString, Polygon

from satAOI_adapters.dxf_read.curves import Path
from satAOI_adapters.dxf_read.features import Feature
from satAOI_adapters.dxf_read.groups import Spots, linked
from satAOI_adapters.dxf_read.options import CLOSE_GAPS_MM
from satAOI_adapters.dxf_read.shapes import rounded, slivers
from satAOI_geo.plan import FloatArray, polygons_in

ENDS_AT_CORNER: Final = 2
"""Line ends that meet at a corner of an outline."""


@dataclass(frozen=True, slots=True)
class Loop:
    """An outline of several features.

    Attributes:
        shape: Contains what it encloses.
        features: What draws it.
    """

    shape: Polygon
    features: tuple[Feature, ...]


def loops(features: Sequence[Feature]) -> list[Loop]:
    """The outlines that open lines without width draw, layer by layer."""
    by_layer: defaultdict[str, defaultdict[object, list[tuple[Path, Feature]]]]
    by_layer = defaultdict(lambda: defaultdict(list))
    for feature in features:
        if feature.is_area or feature.width_mm:
            continue
        for path in feature.paths:
            if not path.closed:
                by_layer[feature.placed.layer][_line(path)].append((path, feature))
    return [loop for lines in by_layer.values() for loop in _of_layer(list(lines.values()))]


def _line(path: Path) -> object:
    """What a straight line and its copies have in common, whichever way they are drawn."""
    if len(path.pieces) > 1 or not path.is_straight:
        return id(path)
    return tuple(sorted(tuple(np.round(end, 3)) for end in (path.start, path.end)))


def _of_layer(copies: Sequence[Sequence[tuple[Path, Feature]]]) -> list[Loop]:
    """The outlines of one layer, of lines with their copies."""
    lines = [same[0] for same in copies]
    ends = np.array([end for path, _ in lines for end in (path.start, path.end)])
    pairs = Spots(ends).pairs(CLOSE_GAPS_MM)
    corner = linked(pairs, len(ends))
    # the ends of a line are linked through the line
    group = linked(np.vstack((pairs, np.arange(len(ends)).reshape(-1, 2))), len(ends))
    is_odd = np.bincount(corner)[corner] != ENDS_AT_CORNER
    is_outline = np.bincount(group, is_odd) == 0
    wanted = np.flatnonzero(is_outline[group[::2]])
    order = wanted[np.argsort(group[::2][wanted], kind="stable")]
    starts = 1 + np.flatnonzero(np.diff(group[::2][order]))
    _, first = np.unique(corner, return_index=True)
    met = ends[first][corner].reshape(-1, 2, 2)
    return [
        Loop(shape, tuple(feature for i in members for _, feature in copies[i]))
        for members in (part.tolist() for part in np.split(order, starts))
        if members
        for shape in _inside([lines[i][0] for i in members], met[members])
    ]


def _inside(paths: Sequence[Path], ends: FloatArray) -> list[Polygon]:
    """A polygon that contains what one outline encloses; none if it crosses itself.

    Args:
        paths: What draws it.
        ends: The corners that their starts and ends are led to, shape (n, 2, 2).
    """
    chains = [
        shapely.remove_repeated_points(LineString([start, *path.chords(), end]))
        for path, (start, end) in zip(paths, ends.tolist(), strict=True)
    ]
    faces = polygons_in(shapely.polygonize(chains).geoms)
    curves = [sliver for path in paths for sliver in slivers(path)]
    # chords fall short of the curves they stand for
    return rounded(polygons_in([shapely.union_all([*faces, *curves])])) if len(faces) == 1 else []
