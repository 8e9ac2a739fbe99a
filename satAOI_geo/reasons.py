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
from typing import Final, NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry import Point, Polygon

from satAOI_geo.aoi import Aoi, outlines_of
from satAOI_geo.freespace import run_threads
from satAOI_geo.memory import give_back
from satAOI_geo.nodes import Nodes
from satAOI_geo.plan import FloorPlan, Obstacle, Region, as_region, polygons_in
from satAOI_geo.reach import EVERYTHING
from satAOI_geo.runs import roots, unite
from satAOI_geo.search import Search
from satAOI_geo.tiles import Indexed, Tile, clipped, cuts, region_of

APART_MM: Final = 0.05
"""By how much outlines that run along each other are set apart before they are overlaid. Lines a
rounding apart cross hundreds of times; what divides one reason from another may move by as much."""

NARROW_CELLS: Final = 2
"""Between the disc and a wall the lattice leaves strips of up to a cell, askew to it 1.4 cells."""


RegionT = TypeVar("RegionT", Polygon, Region)


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
        region: Its shape in the plan's frame.
        reason: Why it is not reached.
        label_mm: A point inside it, for its label.
        narrow: Whether it gathers the strips narrower than `NARROW_CELLS`, which the lattice does
            not resolve; its region then has many parts.
        blocker: The obstacle nearest to the label where one is in the way, else None.
    """

    region: Region
    reason: Reason
    label_mm: tuple[float, float]
    narrow: bool
    blocker: Obstacle | None

    @property
    def area_mm2(self) -> float:
        """Area of the patch."""
        return float(self.region.area)


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
    blockers = _Blockers(found.plan)
    whole = _Regions(found.plan.free_region(), Indexed(aoi.outlines), Indexed(upper.outlines))
    pieces: list[_Piece] = []
    narrow: list[Patch] = []
    row_cuts = cuts(found.lattice.n_rows)
    for number, cut in enumerate(row_cuts, start=1):
        row = _TileRow.of(found, cut, whole)
        for of_tile, strips in run_threads(row.left_over, len(row.tiles)):
            pieces += of_tile
            if strips.area > 0:
                narrow.append(blockers.patch(strips, Reason.DISC, narrow=True))
        if progress is not None:
            progress(number / len(row_cuts))
        if len(row_cuts) > 1:
            give_back()
    patches = [blockers.patch(region, reason) for reason, region in _joined(pieces)]
    return (*sorted(patches, key=_largest_first), *sorted(narrow, key=_largest_first))


class _Piece(NamedTuple):
    """A piece of a patch, and whether it ends at a seam of its tile."""

    reason: Reason
    region: Polygon
    at_seam: bool


class _Regions(NamedTuple):
    """The free floor, the area of interest, and the area disc-connected with the start."""

    free: Region
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
        """What is left over in a tile: pieces of patches, and strips with crumbs."""
        tile, step_mm = self.tiles[k], self.found.lattice.step_mm
        free = clipped(self.whole.free, tile.around_mm)
        rest = as_region(free.difference(self.whole.aoi.within(tile.around_mm)))
        broad, strips = _opened(rest, NARROW_CELLS * step_mm)
        broad, strips = clipped(broad, tile.bounds_mm), clipped(strips, tile.bounds_mm)
        if broad.is_empty:
            return [], strips
        wider = self._fitted(tile) | {Reason.PATH: self.whole.upper.within(tile.around_mm)}
        pieces = list(_by_reason(polygons_in([broad]), wider, step_mm))
        large = [
            _Piece(reason, _compact(piece), tile.ends(piece))
            for reason, piece in pieces
            if piece.area >= step_mm**2
        ]
        crumbs = [piece for _, piece in pieces if piece.area < step_mm**2]
        return large, _compact(shapely.union_all([strips, *crumbs]) if crumbs else strips)

    def _fitted(self, tile: Tile) -> dict[Reason, Region]:
        """What the disc covers near a tile from the nodes that fit."""
        lattice, disc_mm = self.found.lattice, self.found.robot.disc_radius_mm
        _, columns = tile.nodes(lattice, disc_mm)
        window = lattice.window(self.rows, columns)
        return {
            reason: region_of(outlines_of(nodes.window(EVERYTHING, columns), window, disc_mm))
            for reason, nodes in self.fitting.items()
        }


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


def _compact(region: RegionT) -> RegionT:
    """The same region in less than half the memory: what overlays make keeps room for more."""
    copy: RegionT = shapely.from_wkb(shapely.to_wkb(region))
    return copy


def _opened(region: Region, width_mm: float) -> tuple[Region, Region]:
    """A region's parts broader than a width, and all the rest of it."""
    shrunk = region.buffer(-width_mm / 2, join_style="mitre")
    grown = shrunk.buffer(width_mm / 2 + APART_MM, join_style="mitre")
    return as_region(region.intersection(grown)), as_region(region.difference(grown))


def _by_reason(
    parts: list[Polygon], wider: dict[Reason, Region], step_mm: float
) -> Iterator[tuple[Reason, Polygon]]:
    """The pieces of parts of what is left over, by their reasons.

    Outlines of nested areas run along each other, a rounding apart: pieces narrower than a cell
    go to the reason that most of the part has.

    Args:
        parts: All are looked at together, which costs less than one by one.
        wider: For each reason but the first the area that holds what is left over for that
            reason and for all that come after it.
        step_mm: Side of a cell.
    """
    whole = np.array(parts, dtype=object)
    shares = _shares(whole, wider, step_mm)
    most = shapely.area(shares).argmax(axis=0)
    others = [
        (k, reason, piece)
        for (order, reason), k in itertools.product(enumerate(Reason), range(whole.size))
        if order != most[k]
        for piece in polygons_in([shares[order, k]])
        if piece.area >= step_mm**2
    ]
    shrunk = shapely.buffer([piece for _, _, piece in others], -step_mm / 2)
    elsewhere: dict[int, list[Polygon]] = {}
    for (k, reason, piece), is_narrow in zip(others, shapely.is_empty(shrunk), strict=True):
        if not is_narrow:
            elsewhere.setdefault(k, []).append(piece)
            yield reason, piece
    for k, pieces in elsewhere.items():
        whole[k] = whole[k].difference(shapely.union_all(pieces))
    for region, order in zip(whole, most.tolist(), strict=True):
        yield from ((list(Reason)[order], piece) for piece in polygons_in([region]))


def _shares(
    parts: npt.NDArray[np.object_], wider: dict[Reason, Region], step_mm: float
) -> npt.NDArray[np.object_]:
    """What of each part is left over for each reason, shape (n_reasons, n_parts)."""
    inside = parts.copy()
    # with room for the buffer; overlays of all that is near would cost its whole length
    around = shapely.box(*(shapely.bounds(parts) + np.array((-1.0, -1.0, 1.0, 1.0))).T)
    shares = np.full((len(Reason), parts.size), Polygon(), dtype=object)
    asked = np.arange(parts.size)
    for order, next_reason in enumerate(list(Reason)[1:]):
        near = shapely.intersection(wider[next_reason], around[asked])
        # each area holds the next: where one is met by rounding only, so are all after it
        near = shapely.buffer(near, -APART_MM * (order + 1))
        still = shapely.intersection(inside[asked], near)
        goes_on = shapely.area(still) >= step_mm**2
        shares[order, asked] = inside[asked]
        asked, still, near = asked[goes_on], still[goes_on], near[goes_on]
        shares[order, asked] = shapely.difference(inside[asked], near)
        inside[asked] = still
    shares[-1, asked] = inside[asked]
    return shares


def _joined(pieces: list[_Piece]) -> Iterator[tuple[Reason, Polygon]]:
    """The patches that pieces make once those of a reason are joined across the seams."""
    for reason in Reason:
        own = [piece for piece in pieces if piece.reason is reason]
        yield from ((reason, piece.region) for piece in own if not piece.at_seam)
        at_seams = [piece.region for piece in own if piece.at_seam]
        yield from ((reason, region) for region in _unions(at_seams))


def _unions(regions: list[Polygon]) -> Iterator[Polygon]:
    """Polygons, those that meet made one; a union of all at once would take gigabytes."""
    members = np.array(regions, dtype=object)
    pairs = shapely.STRtree(members).query(members, predicate="intersects").T
    parents = np.arange(len(regions), dtype=np.int32)
    unite(parents, pairs.astype(np.int32))
    groups: defaultdict[int, list[Polygon]] = defaultdict(list)
    for region, group in zip(regions, roots(parents).tolist(), strict=True):
        groups[group].append(region)
    for group in groups.values():
        yield from map(_compact, polygons_in([shapely.union_all(group)]))


def _largest_first(patch: Patch) -> tuple[float, tuple[float, float]]:
    """Sorting key of a patch."""
    return -patch.area_mm2, patch.label_mm


class _Blockers:
    """Finds the obstacle that stands in the way of a patch."""

    def __init__(self, plan: FloorPlan) -> None:
        self._obstacles = plan.obstacles
        self._tree = shapely.STRtree([o.region() for o in plan.obstacles])
        self._edge = plan.floor.boundary

    def patch(self, region: Region, reason: Reason, *, narrow: bool = False) -> Patch:
        """A patch with its label and, for what is too tight, what it is tight against."""
        label = max(polygons_in([region]), key=lambda p: p.area).representative_point()
        in_the_way = None if reason in (Reason.PATH, Reason.ZONE) else self._nearest(label)
        return Patch(region, reason, (label.x, label.y), narrow, in_the_way)

    def _nearest(self, point: Point) -> Obstacle | None:
        """The nearest obstacle, or None where the edge of the floor is nearer."""
        if not self._obstacles:
            return None
        index, distance_mm = self._tree.query_nearest(point, return_distance=True, all_matches=True)
        if self._edge.distance(point) < distance_mm[0]:
            return None
        return self._obstacles[int(index.min())]
