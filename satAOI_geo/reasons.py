"""Why a patch of free floor is not reached.

Nested sets of disc centres, each a part of the one before, cover nested areas:

    the disc fits ⊇ disc and arm fit in some direction ⊇ some pose is free
                  ⊇ disc-connected with the start ⊇ pose-connected with the start

What lies between two of them has one reason, and all of them together are the free floor that the
area of interest leaves over.
"""

import itertools
from collections import defaultdict
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import StrEnum
from functools import reduce
from typing import Final, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry import Point, Polygon
from shapely.geometry.base import BaseGeometry

from satAOI_geo.aoi import Aoi, outlines_of
from satAOI_geo.forest import roots, unite
from satAOI_geo.memory import give_back
from satAOI_geo.nodes import Nodes
from satAOI_geo.plan import (
    CONTACT_MM,
    FloorPlan,
    IntArray,
    Obstacle,
    Region,
    as_region,
    polygons_in,
)
from satAOI_geo.reach import EVERYTHING
from satAOI_geo.search import Search
from satAOI_geo.threads import run_threads
from satAOI_geo.tiles import FreeFloor, Indexed, Tile, clipped, cuts, region_of

APART_MM: Final = 0.05
"""By how much outlines that run along each other are set apart before they are overlaid. Lines a
rounding apart cross hundreds of times; what divides one reason from another may move by as much."""

NARROW_CELLS: Final = 2
"""Between the disc and a wall the lattice leaves strips of up to a cell, askew to it 1.4 cells."""

Geometries: TypeAlias = npt.NDArray[np.object_]


class Reason(StrEnum):
    """Why the disc does not cover a patch, in the order in which they are asked."""

    DISC = "disc"
    ARM = "arm"
    VEHICLE = "vehicle"
    ZONE = "zone"
    PATH = "path"


SENTENCES: Final = {
    Reason.DISC: "too narrow for the troweling disc",
    Reason.ARM: "the disc fits, but the arm behind it finds no room in any direction",
    Reason.VEHICLE: "disc and arm fit, but the vehicle finds no room in any position",
    Reason.ZONE: "the robot fits there, but no chain of positions leads there from the start",
    Reason.PATH: "the robot fits there, but cannot drive there from the start",
}


@dataclass(frozen=True, slots=True)
class Patch:
    """A connected piece of free floor that is not reached, or all strips of it.

    Attributes:
        wkb: Its shape as well-known binary, two thirds of what polygons take: a large floor has
            tens of thousands of patches.
        area_mm2: Its area.
        reason: Why it is not reached.
        label_mm: A point inside it, for its label.
        narrow: Whether it gathers the strips narrower than `NARROW_CELLS`, which the lattice does
            not resolve; its region then has many parts.
        blocker: The obstacle nearest to the label where one is in the way, else None.
    """

    wkb: bytes
    area_mm2: float
    reason: Reason
    label_mm: tuple[float, float]
    narrow: bool
    blocker: Obstacle | None

    @property
    def region(self) -> Region:
        """Its shape in the plan's frame, made anew each time."""
        made: Region = shapely.from_wkb(self.wkb)
        return made


def unreached(
    found: Search, aoi: Aoi, upper: Aoi, progress: Callable[[float], None] | None = None
) -> tuple[Patch, ...]:
    """The patches of free floor that the area of interest leaves over, largest first.

    The floor is gone through in tiles; patches are joined where they meet at a seam.

    Args:
        found: The search that led to the area.
        aoi: The area of interest.
        upper: The area that is disc-connected with the start.
        progress: Called with the share of the floor that is done.

    Returns:
        Patches whose areas and the area of interest add up to the free floor. Strips narrower
        than `NARROW_CELLS`, which finer steps of the disc would cover in part, and crumbs smaller
        than a cell are gathered in one patch a tile, after the others.
    """
    obstacles = [obstacle.region() for obstacle in found.plan.obstacles]
    blockers = _Blockers(found.plan, obstacles)
    free = FreeFloor(found.plan.floor, obstacles)
    own = Indexed(aoi.outlines)
    whole = _Regions(free, own, own if upper is aoi else Indexed(upper.outlines))
    patches: list[Patch] = []
    narrow: list[Patch] = []
    unfinished: list[_Piece] = []
    row_cuts = cuts(found.lattice.n_rows)
    for number, cut in enumerate(row_cuts, start=1):
        row = _TileRow.of(found, cut, whole)
        for pieces, strips in run_threads(row.left_over, len(row.tiles)):
            patches += [blockers.patch(one) for one in pieces if not one.at_seam]
            unfinished += [one for one in pieces if one.at_seam]
            if strips.area > 0:
                narrow.append(blockers.patch(_Piece(Reason.DISC, strips), narrow=True))
        joined = _joined(unfinished, row.tiles[0].bounds_mm[-1])
        patches += [blockers.patch(one) for one in joined if not one.at_seam]
        unfinished = [one for one in joined if one.at_seam]
        if progress is not None:
            progress(number / len(row_cuts))
        if len(row_cuts) > 1:
            give_back()
    return (*sorted(patches, key=_largest_first), *sorted(narrow, key=_largest_first))


class _Piece(NamedTuple):
    """A piece of a patch, and whether it ends at a seam where another one may follow."""

    reason: Reason
    region: Region
    at_seam: bool = False


class _Regions(NamedTuple):
    """The free floor, the area of interest, and the area disc-connected with the start."""

    free: FreeFloor
    aoi: Indexed
    upper: Indexed


@dataclass(frozen=True, slots=True)
class _TileRow:
    """A row of tiles, and what is needed to tell what is left over in each.

    Attributes:
        found: The search.
        whole: Regions of the whole floor.
        tiles: From left to right.
        rows: Of the lattice, all whose discs come near these tiles.
        fitting: See `_fitting_nodes`, of these rows.
    """

    found: Search
    whole: _Regions
    tiles: list[Tile]
    rows: slice
    fitting: dict[Reason, Nodes]

    @classmethod
    def of(cls, found: Search, cut: slice, whole: _Regions) -> "_TileRow":
        """The tiles over some rows of the lattice."""
        tiles = Tile.row(found.lattice, cut)
        rows, _ = tiles[0].nodes(found.lattice, found.robot.disc_radius_mm)
        return cls(found, whole, tiles, rows, _fitting_nodes(found, rows))

    def left_over(self, k: int) -> tuple[list[_Piece], Region]:
        """What is left over in a tile: pieces, and strips with crumbs."""
        tile, cell_mm = self.tiles[k], self.found.lattice.step_mm
        free, aoi = (region.within(tile.around_mm) for region in (self.whole.free, self.whole.aoi))
        broad, strips = _opened(as_region(free.difference(aoi)), NARROW_CELLS * cell_mm)
        broad, strips = clipped(broad, tile.bounds_mm), clipped(strips, tile.bounds_mm)
        if broad.is_empty:
            return [], strips
        shared_out = _by_reason(broad, self.wider(tile), cell_mm)
        pieces = [
            _Piece(reason, _compact(region), tile.ends(region))
            for reason, region in shared_out
            if region.area >= cell_mm**2
        ]
        crumbs = [region for _, region in shared_out if region.area < cell_mm**2]
        return pieces, as_region(shapely.disjoint_subset_union_all([strips, *crumbs]))

    def wider(self, tile: Tile) -> dict[Reason, Region]:
        """For each reason but the first what holds all that is left over for it and later ones.

        These areas are `APART_MM` smaller than they are, each by so much more than the one before.
        """
        lattice, disc_mm = self.found.lattice, self.found.robot.disc_radius_mm
        _, columns = tile.nodes(lattice, disc_mm)
        window = lattice.window(self.rows, columns)
        fitting = [nodes.window(EVERYTHING, columns) for nodes in self.fitting.values()]

        def troweled(k: int) -> Region:
            return region_of(outlines_of(fitting[k], window, disc_mm - (k + 1) * APART_MM))

        # a tile of its own has the cores for itself; several share them anyway
        each = run_threads if len(self.tiles) == 1 else _in_turn
        wider = dict(zip(self.fitting, each(troweled, len(fitting)), strict=True))
        upper = self.whole.upper.within(tile.around_mm)
        apart_mm = (1 + len(wider)) * APART_MM
        return wider | {Reason.PATH: as_region(upper.buffer(-apart_mm, join_style="mitre"))}


def _in_turn(job: Callable[[int], Region], n_jobs: int) -> list[Region]:
    """The answers of jobs 0 .. n_jobs - 1."""
    return [job(k) for k in range(n_jobs)]


def _fitting_nodes(found: Search, rows: slice) -> dict[Reason, Nodes]:
    """Nodes of some rows at which the disc, the disc and the arm, or any pose touches nothing.

    What the disc covers from them holds what is left over for the reason each stands at, and for
    all that come after it.
    """
    engine, lattice = found.engine.band(rows), found.lattice
    capsules = (~engine.blocked(found.robot.capsule(arm)) for arm in lattice.directions())
    return {
        Reason.ARM: Nodes(~engine.blocked(found.robot.disc()), lattice.n_columns),
        Reason.VEHICLE: Nodes(reduce(np.bitwise_or, capsules), lattice.n_columns),
        Reason.ZONE: Nodes(found.free.words[rows], lattice.n_columns),
    }


def _compact(region: Polygon) -> Polygon:
    """The same region in less than half the memory: what overlays make keeps room for more."""
    copy: Polygon = shapely.from_wkb(shapely.to_wkb(region))
    return copy


def _opened(region: Region, width_mm: float) -> tuple[Region, Region]:
    """A region's parts broader than a width, and all the rest of it."""
    shrunk = region.buffer(-width_mm / 2, join_style="mitre")
    grown = shrunk.buffer(width_mm / 2 + APART_MM, join_style="mitre")
    return as_region(region.intersection(grown)), as_region(region.difference(grown))


def _by_reason(
    broad: Region, wider: dict[Reason, Region], cell_mm: float
) -> list[tuple[Reason, Polygon]]:
    """The pieces of what is left over, by their reasons.

    Outlines of nested areas run along each other, a rounding apart: pieces narrower than a cell
    go to the reason that most of their part has.

    Args:
        broad: What is left over. All parts of it are overlaid together: an overlay of one with
            all that is near it would cost the whole length of that.
        wider: See `_TileRow.wider`.
        cell_mm: Side of a cell.
    """
    shares = [polygons_in([share]) for share in _shares(broad, wider)]
    pieces = np.array(list(itertools.chain.from_iterable(shares)), dtype=object)
    own = np.repeat(np.arange(len(shares)), [len(share) for share in shares])
    orders = _most_of_part(pieces, own, polygons_in([broad]))
    asked = np.flatnonzero((own != orders) & (shapely.area(pieces) >= cell_mm**2))
    stays = asked[~shapely.is_empty(shapely.buffer(pieces[asked], -cell_mm / 2))]
    orders[stays] = own[stays]
    return [
        (reason, region)
        for order, reason in enumerate(Reason)
        for region in polygons_in([put_together(pieces[orders == order])])
    ]


def _shares(left_over: Region, wider: dict[Reason, Region]) -> Iterator[Region]:
    """What is left over for each reason, in their order."""
    for reason in list(Reason)[1:]:
        yield as_region(left_over.difference(wider[reason]))
        left_over = as_region(left_over.intersection(wider[reason]))
    yield left_over


def _most_of_part(pieces: Geometries, orders: IntArray, parts: list[Polygon]) -> IntArray:
    """For each piece the order that most of its part has; of a sliver in no part its own."""
    tree = shapely.STRtree(parts)
    held, part = tree.query(shapely.point_on_surface(pieces), predicate="intersects")
    share_mm2 = np.zeros((len(parts), len(Reason)))
    np.add.at(share_mm2, (part, orders[held]), shapely.area(pieces[held]))
    most = orders.copy()
    most[held] = share_mm2.argmax(axis=1)[part]
    return most


def put_together(pieces: Geometries) -> BaseGeometry:
    """The union of pieces that were cut out of one region and share the corners of their seams."""
    try:
        return shapely.coverage_union_all(pieces)
    except shapely.GEOSException:
        # a later cut has set a corner on the seam of an earlier one
        return shapely.union_all(pieces)


def _joined(pieces: list[_Piece], top_mm: float) -> list[_Piece]:
    """Pieces, those of a reason that meet made one; more may follow above the top."""
    return [
        _Piece(reason, region, region.bounds[-1] >= top_mm)
        for reason in Reason
        for region in _unions([piece.region for piece in pieces if piece.reason is reason])
    ]


def _unions(regions: list[Region]) -> Iterator[Polygon]:
    """Polygons, those that meet made one; a union of all at once would take gigabytes."""
    members = np.array(regions, dtype=object)
    pairs = shapely.STRtree(members).query(members, predicate="intersects").T
    parents = np.arange(len(regions), dtype=np.int32)
    unite(parents, pairs.astype(np.int32))
    groups: defaultdict[int, list[Region]] = defaultdict(list)
    for region, group in zip(regions, roots(parents).tolist(), strict=True):
        groups[group].append(region)
    for group in groups.values():
        yield from map(_compact, polygons_in([shapely.union_all(group)]))


def _largest_first(patch: Patch) -> tuple[float, tuple[float, float]]:
    """Sorting key of a patch: of its size to the square millimetre, then from the left.

    Rounding alone tells the sizes of the two corners of a room apart.
    """
    return -round(patch.area_mm2), patch.label_mm


class _Blockers:
    """Finds the obstacle that stands in the way of a patch.

    Args:
        plan: The plan.
        regions: Of its obstacles.
    """

    def __init__(self, plan: FloorPlan, regions: list[BaseGeometry]) -> None:
        self._obstacles = plan.obstacles
        self._tree = shapely.STRtree(regions)
        self._edge = plan.floor.boundary

    def patch(self, piece: _Piece, *, narrow: bool = False) -> Patch:
        """A patch with its label and, for what is too tight, what it is tight against."""
        reason, region, _ = piece
        label = max(polygons_in([region]), key=lambda p: p.area).representative_point()
        in_the_way = None if reason in (Reason.PATH, Reason.ZONE) else self._nearest(label)
        wkb: bytes = shapely.to_wkb(region)
        return Patch(wkb, region.area, reason, (label.x, label.y), narrow, in_the_way)

    def _nearest(self, point: Point) -> Obstacle | None:
        """The nearest obstacle, or None where the edge of the floor is nearer.

        Of several as near, but for `CONTACT_MM`, the first; an obstacle rather than the edge.
        """
        if not self._obstacles:
            return None
        _, (distance_mm,) = self._tree.query_nearest(point, return_distance=True, all_matches=False)
        if self._edge.distance(point) < distance_mm - CONTACT_MM:
            return None
        within_mm = distance_mm + CONTACT_MM
        as_near = self._tree.query(point, predicate="dwithin", distance=within_mm)
        return self._obstacles[int(as_near.min())]
