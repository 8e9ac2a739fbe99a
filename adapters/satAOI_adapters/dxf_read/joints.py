"""Joints of tiles among walls, told by their pattern where no layer is named.

Equal rectangles lie side by side so that one of them has others on all four sides. Were these
lines walls, no door would lead to the one in the middle: they are joints of a floor. A joint has
a tile on either side; at walls and columns tiles are cut, and lines of those that are narrower than
a wall may be stay.

    ┌───┐┌───┐┌───┐
    │   ││   ││   │
    └───┘└───┘└───┘
    ┌───┐┌───┐┌──
    │   ││ x ││       x  a tile that has others around it
    └───┘└───┘└──
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import shapely

from satAOI_adapters.dxf_read.curves import Line
from satAOI_adapters.dxf_read.features import Feature
from satAOI_adapters.dxf_read.linework import WALL_MM
from satAOI_adapters.dxf_read.meaning import Seen
from satAOI_adapters.dxf_read.shapes import GeometryArray, is_thin
from satAOI_adapters.meanings import Meaning, Verdict
from satAOI_geo.plan import BoolArray, Finding, FloatArray

MANY: Final = 20
"""Fewest equal rectangles that are tiles."""

JOINT_MM: Final = 30.0
"""Widest joint; the faces of a wall are farther apart."""

EQUAL_MM: Final = 1.0
"""Sides of tiles that differ less are equal."""

GRID_MM: Final = 0.01
"""Lines this close to each other are one where they are cut into faces."""

CORNERS: Final = 5
"""Corners of a closed rectangle, the first again at the end."""

SAMPLES: Final = (np.arange(8) + 0.5) / 8
"""Where along a line it is asked what lies beside it, as shares of its length."""

MOSTLY: Final = 0.75
"""Share of these places at which a joint has a tile on either side."""


@dataclass(frozen=True, slots=True)
class _Rectangles:
    """Rectangles and their sides.

    Attributes:
        shapes: Shape (n,).
        corners_mm: In order, the first again at the end, shape (n, 5, 2).
        sizes_mm: The shorter and the longer side, shape (n, 2).
    """

    shapes: GeometryArray
    corners_mm: FloatArray
    sizes_mm: FloatArray

    def only(self, which: BoolArray) -> "_Rectangles":
        """Some of them."""
        return _Rectangles(self.shapes[which], self.corners_mm[which], self.sizes_mm[which])


def with_tiles(
    near: Sequence[tuple[Seen, Feature]], mm_per_unit: float
) -> tuple[list[tuple[Seen, Feature]], tuple[Finding, ...]]:
    """What is drawn, with joints of tiles left out of the walls.

    Args:
        near: Entities that are all taken as walls, with what they draw in drawing units.
        mm_per_unit: Millimetres in a drawing unit.
    """
    ends, owners = _straight([feature for _, feature in near])
    if len(ends) < MANY:
        return list(near), ()
    # near the origin, where doubles have digits to spare
    ends_mm = (ends - ends[0, 0]) * mm_per_unit
    tiles = _tiles(_faces(shapely.linestrings(ends_mm)))
    if not len(tiles):
        return list(near), ()
    n_pieces = np.bincount(owners, minlength=len(near))
    n_joints = np.bincount(owners, _are_joints(ends_mm, tiles), minlength=len(near))
    as_joint = Verdict(Meaning.IGNORE)
    told = {
        id(entity): replace(entity, verdict=as_joint)
        for k, (entity, feature) in enumerate(near)
        if 0 < n_pieces[k] == n_joints[k] and _is_of_lines(feature)
    }
    return (
        [(told.get(id(entity), entity), feature) for entity, feature in near],
        _findings([entity for entity, _ in near if id(entity) in told]),
    )


def _straight(drawn: Sequence[Feature]) -> tuple[FloatArray, FloatArray]:
    """Ends of all straight pieces, shape (n, 2, 2), and the number of the feature of each."""
    pieces = [
        ((piece.start, piece.end), owner)
        for owner, feature in enumerate(drawn)
        for path in feature.paths
        for piece in path.pieces
        if isinstance(piece, Line)
    ]
    if not pieces:
        return np.empty((0, 2, 2)), np.empty(0, dtype=np.int64)
    ends, owners = zip(*pieces, strict=True)
    return np.array(ends), np.array(owners)


def _is_of_lines(feature: Feature) -> bool:
    """Whether nothing but straight lines without width is drawn."""
    return (
        not feature.is_area and not feature.width_mm and all(p.is_straight for p in feature.paths)
    )


def _faces(lines: GeometryArray) -> GeometryArray:
    """What lines enclose, wherever they cross, without the corners between straight sides."""
    noded = shapely.union_all(lines, grid_size=GRID_MM)
    return np.asarray(shapely.simplify(shapely.get_parts(shapely.polygonize([noded])), GRID_MM))


def _rectangles(faces: GeometryArray) -> _Rectangles:
    """The rectangles among faces."""
    has_four = shapely.get_num_coordinates(faces) == CORNERS
    shapes = faces[has_four & (shapely.get_num_interior_rings(faces) == 0)]
    corners_mm = shapely.get_coordinates(shapes).reshape(-1, CORNERS, 2)
    sides_mm = _lengths(np.diff(corners_mm, axis=1))
    diagonals_mm = _lengths(corners_mm[:, (2, 3)] - corners_mm[:, (0, 1)])
    # opposite sides are equal, and so are the diagonals
    uneven_mm = np.abs(sides_mm[:, :2] - sides_mm[:, 2:]).max(axis=1, initial=0.0)
    skew_mm = np.abs(diagonals_mm[:, 0] - diagonals_mm[:, 1])
    found = _Rectangles(shapes, corners_mm, np.sort(sides_mm[:, :2], axis=1))
    return found.only((uneven_mm <= EQUAL_MM) & (skew_mm <= EQUAL_MM))


def _lengths(vectors: FloatArray) -> FloatArray:
    """Lengths of vectors, shape (..., 2): shape (...)."""
    return np.hypot(vectors[..., 0], vectors[..., 1])


def _tiles(faces: GeometryArray) -> GeometryArray:
    """The tiles among faces, those that walls or columns cut with them; none on most plans."""
    found = _rectangles(faces)
    if len(found.shapes) < MANY:
        return np.array([], dtype=object)
    sizes_mm, counts = np.unique(np.round(found.sizes_mm), axis=0, return_counts=True)
    size_mm = sizes_mm[np.argmax(counts)]
    whole = found.only((np.abs(found.sizes_mm - size_mm) <= EQUAL_MM).all(axis=1))
    has_others = _has_others(whole)
    if len(whole.shapes) < MANY or not has_others.all(axis=1).any():
        return np.array([], dtype=object)
    tiles = whole.shapes[has_others.any(axis=1)]
    smaller = faces[shapely.area(faces) < (1 - EQUAL_MM / size_mm[0]) * size_mm.prod()]
    beside, _ = shapely.STRtree(tiles).query(smaller, predicate="dwithin", distance=JOINT_MM)
    cut = [face for face in smaller[np.unique(beside)] if not is_thin(face, WALL_MM)]
    return np.array([*tiles, *cut], dtype=object)


def _has_others(tiles: _Rectangles) -> BoolArray:
    """Which sides of rectangles have another rectangle beside their middle, shape (n, 4)."""
    middles = (tiles.corners_mm[:, :-1] + tiles.corners_mm[:, 1:]) / 2
    spots = shapely.points(middles.reshape(-1, 2))
    spot, tile = shapely.STRtree(tiles.shapes).query(spots, predicate="dwithin", distance=JOINT_MM)
    others = np.bincount(spot[spot // 4 != tile], minlength=len(spots))
    return np.asarray(others.reshape(-1, 4) > 0)


def _are_joints(ends_mm: FloatArray, tiles: GeometryArray) -> BoolArray:
    """Which lines have a tile on either side along most of their length."""
    along = ends_mm[:, 1] - ends_mm[:, 0]
    spots = ends_mm[:, :1] + SAMPLES[:, np.newaxis] * along[:, np.newaxis]
    across = np.column_stack((-along[:, 1], along[:, 0])) / np.hypot(*along.T)[:, np.newaxis]
    tree = shapely.STRtree(tiles)
    on_either = np.ones(spots.shape[:2], dtype=bool)
    for side in (JOINT_MM, -JOINT_MM):
        beside = shapely.points(spots + side * across[:, np.newaxis])
        inside, _ = tree.query(beside.ravel(), predicate="within")
        is_in = np.isin(np.arange(beside.size), inside)
        on_either &= is_in.reshape(beside.shape)
    return np.asarray(on_either.mean(axis=1) >= MOSTLY)


def _findings(joints: Sequence[Seen]) -> tuple[Finding, ...]:
    layers = sorted({entity.placed.layer for entity in joints})
    return tuple(
        Finding(
            "tile-joints",
            f"{sum(entity.placed.layer == layer for entity in joints)} lines on layer '{layer}' "
            "part equal rectangles that lie side by side: they are taken as joints of tiles and "
            "left out",
            "say what the layer is in a file for --layers if they stop the robot",
            layer=layer,
        )
        for layer in layers
    )
