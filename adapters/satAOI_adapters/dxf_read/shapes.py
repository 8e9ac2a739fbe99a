"""Paths as shapes: each polygon holds what it stands for, or lies in it, as its use asks.

An obstacle's polygon contains the true obstacle and exceeds it by at most `curves.SAGITTA_MM`;
a floor's polygon lies inside the true floor and falls short of it by as much. A line without
width stays one; a curve without width becomes a sliver, at most twice that wide, that holds it.
"""

import math
from collections.abc import Iterable, Sequence
from typing import Final, TypeAlias, TypeVar

import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from satAOI_adapters.dxf_read.curves import SAGITTA_MM, Arc, Line, Path, Point, Spline
from satAOI_adapters.dxf_read.placement import LOCAL_DIGITS
from satAOI_geo.plan import Circle, FloatArray, Region, Shape, as_region, polygons_in

GeometryArray: TypeAlias = npt.NDArray[np.object_]
GeometryT = TypeVar("GeometryT", bound=BaseGeometry | GeometryArray)

SAME_MM = 10.0**-LOCAL_DIGITS
"""The grid of coordinates: what is this close is one."""

TIE_MM: Final = 1e-3
"""A length this close to a limit is at it: round measures of turned drawings miss by a rounding."""


def circle_of(path: Path) -> Circle | None:
    """The circle that a closed path draws, in one arc or in several; None for anything else."""
    first, *rest = path.pieces
    if not isinstance(first, Arc) or not first.is_round or not path.closed:
        return None
    radius_mm = math.hypot(*first.u)
    total_rad = first.sweep_rad
    for piece in rest:
        if (
            not isinstance(piece, Arc)
            or not piece.is_round
            or piece.turns_left != first.turns_left
            or math.dist(piece.centre, first.centre) > SAME_MM
            or abs(math.hypot(*piece.u) - radius_mm) > SAME_MM
        ):
            return None
        total_rad += piece.sweep_rad
    # each arc's centre is known to SAME_MM, each end's direction to that over the radius
    if abs(total_rad - math.tau) > 4 * SAME_MM / radius_mm + 1e-9:
        return None
    return Circle(
        round(first.centre[0], LOCAL_DIGITS),
        round(first.centre[1], LOCAL_DIGITS),
        round(radius_mm, LOCAL_DIGITS),
    )


def solid(path: Path) -> list[Polygon]:
    """Polygons that contain what a closed path encloses."""
    direct = _one_sided(path, outside=True)
    if direct is not None:
        return [direct]
    return polygons_in([shapely.union_all([by_chords(path), *slivers(path)])])


def is_wide(path: Path, width_mm: float) -> bool:
    """Whether a disc of this diameter surely fits into what a closed path encloses."""
    x_mm, y_mm = zip(*path.rough(), strict=True)
    if min(max(x_mm) - min(x_mm), max(y_mm) - min(y_mm)) <= width_mm:
        return False
    return not is_thin(by_chords(path), width_mm + 4 * SAGITTA_MM)


def is_thin(region: BaseGeometry, width_mm: float) -> bool:
    """Whether no disc of this diameter fits into a region."""
    width_mm += TIE_MM
    left, bottom, right, top = region.bounds
    # false for the bounds of nothing, which are not numbers
    if right - left <= width_mm or top - bottom <= width_mm:
        return True
    inside = region.point_on_surface()
    if region.boundary.distance(inside) > width_mm / 2:
        return False
    return bool(region.buffer(-width_mm / 2).is_empty)


def room(path: Path) -> list[Polygon]:
    """Polygons that lie in what a closed path encloses."""
    direct = _one_sided(path, outside=False)
    if direct is not None:
        return [direct]
    return polygons_in([by_chords(path).difference(shapely.union_all(slivers(path)))])


def even_odd(paths: Sequence[Path], *, outside: bool = True) -> list[Polygon | Circle]:
    """What outlines fill when each one inside another turns filled into empty and back.

    Args:
        paths: Closed outlines.
        outside: Whether the result contains what is filled, or lies in it.
    """
    if len(paths) == 1 and outside and (circle := circle_of(paths[0])):
        return [circle]
    rough = [by_chords(path) for path in paths]
    filled: BaseGeometry = Polygon()
    for path, own in zip(paths, rough, strict=True):
        if own.is_empty:
            continue
        depth = sum(other.contains(own) for other in rough if other is not own)
        grown = solid(path) if (depth % 2 == 0) == outside else room(path)
        filled = filled.symmetric_difference(shapely.union_all(grown))
    return list(polygons_in([filled]))


def traces(path: Path) -> list[LineString | Polygon]:
    """A path without width: chains of straight lines, and slivers that hold the curves."""
    found: list[LineString | Polygon] = []
    chain: list[Point] = []
    for piece in path.pieces:
        thin = [] if isinstance(piece, Line) else _sliver(piece)
        # a curve that is flat, seen from its edge, is drawn by its corners
        corners = [piece.end] if isinstance(piece, Line) else [] if thin else piece.chords()[1:]
        if corners:
            chain = chain or [piece.start]
            chain.extend(corners)
        else:
            found.extend(_chain(chain))
            chain = []
            found.extend(thin)
    found.extend(_chain(chain))
    return found


def band(path: Path, width_mm: float) -> list[Polygon]:
    """Polygons that contain a line of some width, mitred at its corners as in CAD programs."""
    reach_mm = width_mm / 2 + (0.0 if path.is_straight else SAGITTA_MM)
    middle = LineString(path.chords())
    caps = "square" if path.closed else "flat"
    drawn = shapely.buffer(middle, reach_mm, cap_style=caps, join_style="mitre", mitre_limit=5.0)
    return rounded(polygons_in([drawn]))


def slivers(path: Path) -> list[Polygon]:
    """Slivers that hold the curves of a path."""
    return [
        sliver for piece in path.pieces if not isinstance(piece, Line) for sliver in _sliver(piece)
    ]


def middle_line(path: Path) -> LineString:
    """A path by its chords: for topology, not for contact."""
    return LineString(_round(path.chords()))


def middle_lines(paths: Iterable[Path]) -> GeometryArray:
    """Paths by their chords, as `middle_line` has each of them."""
    chains = [path.chords() for path in paths]
    if not chains:
        return np.array([], dtype=object)
    owners = np.repeat(np.arange(len(chains)), [len(chain) for chain in chains])
    return np.asarray(shapely.linestrings(_round(np.concatenate(chains)), indices=owners))


def rounded(polygons: Iterable[Polygon]) -> list[Polygon]:
    """Polygons with corners to `placement.LOCAL_DIGITS`, still valid: hairs may fall off."""
    exact = np.array(list(polygons), dtype=object)
    neat = _round_corners(exact)
    found: list[Polygon] = []
    for drawn, polygon, is_valid in zip(exact, neat, shapely.is_valid(neat), strict=True):
        found.extend([polygon] if is_valid else polygons_in([tidy(drawn)]))
    return found


def tidy(region: BaseGeometry) -> Region:
    """A region on the grid of `placement.LOCAL_DIGITS`, valid there."""
    return as_region(_round_corners(shapely.set_precision(region, SAME_MM)))


def _round_corners(region: GeometryT) -> GeometryT:
    """A geometry, or each of an array of them, with corners to `placement.LOCAL_DIGITS`."""
    neat: GeometryT = shapely.transform(region, lambda xy: np.round(xy, LOCAL_DIGITS) + 0.0)
    return neat


def shapes_of(path: Path) -> list[Shape]:
    """A closed path as a solid obstacle, an open one as an obstacle without width."""
    if path.closed:
        circle = circle_of(path)
        if circle is not None:
            return [circle]
        polygons = solid(path)
        if polygons:
            return list(polygons)
    return list(traces(path))


def _one_sided(path: Path, *, outside: bool) -> Polygon | None:
    """The polygon of a closed path on the wanted side; None if it crosses itself."""
    points = path.chords() if path.is_straight else _corners(path, outside=outside)
    if len(points) < 4:
        return None
    polygon = Polygon(_round(points))
    return polygon if polygon.is_valid and polygon.area else None


def _corners(path: Path, *, outside: bool) -> list[Point]:
    """The corners of a closed path, each curve in it taken on the wanted side."""
    goes_left = _signed_area(path.chords()) > 0
    points = [path.start]
    for piece in path.pieces:
        if isinstance(piece, Line):
            points.append(piece.end)
        elif isinstance(piece, Spline):
            points.extend(piece.beside(left=goes_left != outside))
        elif (piece.turns_left == goes_left) == outside:
            points.extend(piece.tangents()[1:])
        else:
            points.extend(piece.chords()[1:])
    return points


def by_chords(path: Path) -> BaseGeometry:
    """What a closed path encloses, by its chords; empty where it encloses nothing."""
    points = path.chords()
    if len(points) < 4:
        return Polygon()
    made = shapely.make_valid(Polygon(_round(points)))
    return shapely.union_all(polygons_in([made]))


def _sliver(piece: Arc | Spline) -> list[Polygon]:
    """Polygons that together hold a curve without width; none for a curve that is flat."""
    if isinstance(piece, Arc):
        around = Polygon(_round([*piece.tangents(), *reversed(piece.inner()[1:-1])]))
        return [around] if around.is_valid and around.area else _cut_sliver(piece)
    points = piece.hulls()
    owners = np.repeat(np.arange(len(points)), points.shape[1])
    hulls = shapely.convex_hull(shapely.multipoints(points.reshape(-1, 2), indices=owners))
    # hulls of straight pieces are lines: give them the width that a curve's hull has at most
    is_line = shapely.get_dimensions(hulls) < 2
    hulls[is_line] = shapely.buffer(hulls[is_line], SAGITTA_MM / 2)
    return rounded(polygons_in([shapely.union_all(hulls)]))


def _cut_sliver(piece: Arc) -> list[Polygon]:
    """The slivers of an arc's sides one by one, where the whole one touches itself."""
    tangents, inner = piece.tangents(), piece.inner()
    quads = [
        Polygon(_round((tangents[i], tangents[i + 1], inner[i + 1], inner[i])))
        for i in range(len(tangents) - 1)
    ]
    return polygons_in([shapely.union_all([quad for quad in quads if quad.is_valid and quad.area])])


def _chain(points: Sequence[Point]) -> list[LineString]:
    return [LineString(_round(points))] if len(points) > 1 else []


def _round(points: Sequence[Point] | FloatArray) -> FloatArray:
    return np.asarray(np.round(points, LOCAL_DIGITS) + 0.0, dtype=np.float64)


def _signed_area(points: Sequence[Point]) -> float:
    x, y = np.asarray(points).T
    x, y = x - x[0], y - y[0]
    return float(x[:-1] @ y[1:] - x[1:] @ y[:-1]) / 2
