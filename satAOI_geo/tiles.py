"""A floor cut into tiles, so that polygons are overlaid piece by piece.

What an overlay of polygons takes grows with all of their corners: time a little more than in
proportion, and memory by a kilobyte a corner. The tiles are the same whatever the memory.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, TypeAlias

import numpy as np
import shapely
from shapely.geometry import MultiPoint, MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from satAOI_geo.aoi import Loop, Outline
from satAOI_geo.lattice import Lattice
from satAOI_geo.plan import FloatArray, Region, as_region, polygons_in

TILE_CELLS: Final = 2048
"""Side of a tile: 20 m at a step of 10 mm, which most floors of flats and halls fit into."""

MARGIN_CELLS: Final = 16
"""By how much more than the tile is looked at: what is asked of a place depends on no more."""

SAGITTA_MM: Final = 0.03
"""How far the polygons may leave the arcs of the area of interest: far less than a drawing can
show, and less than `reasons.APART_MM` sets nested areas apart."""

Bounds: TypeAlias = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Tile:
    """A rectangle of cells.

    Attributes:
        rows: Of the lattice.
        columns: Of the lattice.
        bounds_mm: Left, bottom, right and top. At the edge of the floor a tile reaches a cell
            beyond it, so that only what ends at a seam touches them.
        around_mm: The same with a margin.
    """

    rows: slice
    columns: slice
    bounds_mm: Bounds
    around_mm: Bounds

    @classmethod
    def row(cls, lattice: Lattice, rows: slice) -> list["Tile"]:
        """The tiles over some rows of a lattice, from left to right."""
        return [cls.of(lattice, rows, columns) for columns in cuts(lattice.n_columns)]

    @classmethod
    def of(cls, lattice: Lattice, rows: slice, columns: slice) -> "Tile":
        """The tile over some rows and columns of a lattice."""
        step_mm, (x_mm, y_mm) = lattice.step_mm, lattice.origin_mm
        left, right = _sides(columns, lattice.n_columns)
        bottom, top = _sides(rows, lattice.n_rows)
        bounds_mm = (
            x_mm + left * step_mm,
            y_mm + bottom * step_mm,
            x_mm + right * step_mm,
            y_mm + top * step_mm,
        )
        return cls(rows, columns, bounds_mm, _grown(bounds_mm, MARGIN_CELLS * step_mm))

    def nodes(self, lattice: Lattice, disc_mm: float) -> tuple[slice, slice]:
        """Rows and columns of all nodes from which a disc comes near."""
        return lattice.around(self.rows, self.columns, disc_mm + MARGIN_CELLS * lattice.step_mm)

    def ends(self, region: Region) -> bool:
        """Whether a region cut to this tile reaches a seam."""
        left, bottom, right, top = region.bounds
        own = self.bounds_mm
        return bool(left <= own[0] or bottom <= own[1] or right >= own[2] or top >= own[3])


def cuts(n_cells: int) -> list[slice]:
    """Rows or columns of the tiles of a lattice that has so many."""
    return [slice(k, min(k + TILE_CELLS, n_cells)) for k in range(0, n_cells, TILE_CELLS)]


def _grown(bounds_mm: Bounds, by_mm: float) -> Bounds:
    """A rectangle and what is beside it."""
    left, bottom, right, top = bounds_mm
    return left - by_mm, bottom - by_mm, right + by_mm, top + by_mm


def clipped(region: Region, bounds_mm: Bounds) -> Region:
    """The part of a region in a rectangle; it costs as much as the region is long.

    GEOS has a quicker way, `clip_by_rect`, which now and then leaves a hole out.
    """
    window = shapely.box(*bounds_mm)
    return region if window.covers(region) else as_region(region.intersection(window))


class FreeFloor:
    """The floor less the obstacles, of which a part costs no more than the obstacles near it.

    Args:
        floor: The floor.
        obstacles: What stands on it: polygons, which may overlap, and lines, which take no floor.
    """

    def __init__(self, floor: Region, obstacles: Sequence[BaseGeometry]) -> None:
        self._floor = floor
        self._solids = np.array(polygons_in(obstacles), dtype=object)
        self._tree = shapely.STRtree(self._solids)

    def within(self, bounds_mm: Bounds) -> Region:
        """The part in a rectangle."""
        near = self._solids[np.sort(self._tree.query(shapely.box(*bounds_mm)))]
        # most obstacles stand alone and need no overlay
        taken = shapely.disjoint_subset_union_all(near)
        return as_region(clipped(self._floor, bounds_mm).difference(taken))


class Indexed:
    """An area of which the part in a rectangle costs no more than what is near, and its shells.

    Its holes, which have most of the corners of a large floor, are polygons only where asked for.

    Args:
        outlines: The connected parts of the area.
    """

    def __init__(self, outlines: Sequence[Outline]) -> None:
        self._outlines = outlines
        self._shells = [Polygon(_corners_mm(outline.exterior)) for outline in outlines]
        self._shell_tree = shapely.STRtree(self._shells)
        # the discs around a hole reach into it: it lies between its vertices
        self._hole_trees = [
            shapely.STRtree([MultiPoint(hole.vertices[:, :2]).envelope for hole in outline.holes])
            for outline in outlines
        ]

    def within(self, bounds_mm: Bounds) -> Region:
        """The part in a rectangle."""
        window = shapely.box(*bounds_mm)
        parts = []
        for k in np.sort(self._shell_tree.query(window)).tolist():
            shell, near = self._shells[k], np.sort(self._hole_trees[k].query(window)).tolist()
            holes = [_corners_mm(self._outlines[k].holes[hole]) for hole in near]
            if window.covers(shell):
                parts.append(Polygon(shell.exterior, holes))
            else:
                parts.append((shell & window) - MultiPolygon([(hole, []) for hole in holes]))
        return _together(polygons_in(parts))


def region_of(outlines: Sequence[Outline]) -> Region:
    """The area in some outlines as polygons of its own size."""
    return _together([outline.equal_area_polygon(SAGITTA_MM) for outline in outlines])


def _corners_mm(loop: Loop) -> FloatArray:
    """Corners of a polygon of a loop's own area, shape (n, 2)."""
    return loop.equal_area_points_mm(SAGITTA_MM)


def _together(parts: list[Polygon]) -> Region:
    """Parts that touch each other; they may overlap by a rounding once their arcs are polygons."""
    together = MultiPolygon(parts)
    return together if together.is_valid else as_region(shapely.union_all(parts))


def _sides(cells: slice, n_cells: int) -> tuple[int, int]:
    """Where a tile begins and ends along one axis, in cells; a cell farther at the floor's edge."""
    begin, end = cells.start, cells.stop
    return begin - (begin == 0), end + (end == n_cells)
