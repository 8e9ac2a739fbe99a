"""What walls enclose when the openings in them are closed: the floor of a plan that draws none.

Points along the walls are triangulated. From outside, the triangles are flooded over sides longer
than an opening; what stays dry is enclosed, and the sides at the water's edge close the openings.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry import LineString, MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from satAOI_adapters.dxf_read.groups import linked
from satAOI_adapters.dxf_read.linework import WALL_MM
from satAOI_adapters.dxf_read.placement import LOCAL_DIGITS
from satAOI_adapters.dxf_read.shapes import SAME_MM, TIE_MM, GeometryArray, is_thin, rounded, tidy
from satAOI_geo.plan import BoolArray, FloatArray, IntArray, Region, polygons_in

OPENING_MM: Final = 2500.0
"""Widest opening in the outer walls that does not let the floor leak out: a double door."""

OPENING_STEPS_MM: Final = (1000.0, 1500.0, 2000.0, OPENING_MM)
"""Openings are closed from narrow to wide, so that each is closed where it is narrowest."""

GATE_STEPS_MM: Final = (4000.0, 6000.0, 8000.0)
"""Gates of halls are so wide; closed where the walls lie beside what narrower openings leave."""

THICKEST_MM: Final = 2000.0
"""Walls of old buildings and of bunkers are hardly thicker."""

LEFT_OUT: Final = 1 / 4
"""Greatest share of the walls that may lie beside the floor: yards, sheds, a wall by itself."""

FAR_MM: Final = 4 * OPENING_MM
"""Around all walls there is this much space that is outside."""

SAMPLE_MM: Final = 100.0
"""Distance of the points that stand for a wall when openings are looked for."""

MAX_SAMPLES: Final = 200_000
"""Points for all walls together; long drawings get coarser ones."""

ON_LINE_MM: Final = 1e-3
"""A line this close to a wall runs along it."""

NEXT_TO_MM: Final = 0.01
"""What is this close to a wall is at it when openings are measured."""

CRUMB_MM2: Final = 1.0
"""Faces smaller than this lie between lines that mean to be one."""

DEEP: Final = 4.0
"""A space this many times as large as the square on its mouth is a passage, not a niche."""


@dataclass(frozen=True, slots=True)
class Enclosed:
    """What walls enclose.

    Attributes:
        region: Along the walls' outer faces, corner by corner, and straight across each opening at
            its narrowest place; empty where nothing is enclosed.
        opening: The widest opening that is closed, from side to side; None where there is none.
        left_out: Share of the walls, by points along them, that is at none of its rooms.
    """

    region: Region
    opening: LineString | None = None
    left_out: float = 1.0


@dataclass(frozen=True, slots=True)
class Mesh:
    """A Delaunay triangulation of points on the walls.

    Every way between two walls crosses a side of a triangle hardly longer than the way is wide,
    and sides along a wall are short: what cannot be reached over long sides is enclosed.

    Attributes:
        points: Shape (n, 2).
        neighbours: Triangle beyond each side, -1 for none, shape (triangles, 3).
        sides: Corners of each triangle's three sides, shape (triangles, 3, 2).
        areas_mm2: Of the triangles.
        centres: Their centroids, as points in a tree.
    """

    points: FloatArray
    neighbours: IntArray
    sides: IntArray
    areas_mm2: FloatArray
    centres: shapely.STRtree

    @classmethod
    def over(cls, points: FloatArray) -> "Mesh":
        """The triangulation of points that do not all lie on one line, and of four far away.

        Without these the outermost points would lie on the rim of the triangulation, where those
        in one line count or do not as roundings have it.
        """
        left, bottom = points.min(axis=0) - FAR_MM
        right, top = points.max(axis=0) + FAR_MM
        corners_mm = ((left, bottom), (right, bottom), (right, top), (left, top))
        cloud = shapely.multipoints(np.vstack((points, corners_mm)))
        triangles = shapely.get_parts(shapely.delaunay_triangles(cloud))
        drawn = shapely.get_coordinates(triangles).reshape(-1, 4, 2)[:, :3]
        # a complex number for a point: these are sorted several times faster
        places, corners = np.unique(drawn[..., 0] + 1j * drawn[..., 1], return_inverse=True)
        corners = corners.reshape(-1, 3)
        # side k lies opposite corner k
        sides = np.stack((corners[:, (1, 2)], corners[:, (2, 0)], corners[:, (0, 1)]), axis=1)
        return cls(
            np.column_stack((places.real, places.imag)),
            _on_the_other_side(sides),
            sides,
            shapely.area(triangles),
            shapely.STRtree(shapely.centroid(triangles)),
        )

    def outside(self, opening_mm: float) -> BoolArray:
        """The triangles that are reached from far away over sides longer than an opening."""
        start, end = self.points[self.sides[..., 0]], self.points[self.sides[..., 1]]
        lengths_mm = np.hypot(*np.moveaxis(end - start, -1, 0))
        # across an opening the nearest two samples may be offset by half their spacing
        widest_mm = np.hypot(opening_mm, SAMPLE_MM / 2)
        triangles, corners = np.nonzero(lengths_mm > widest_mm)
        # a side without a neighbour borders on the outside, which is node n
        n = len(self.sides)
        beyond = self.neighbours[triangles, corners]
        beyond = np.where(beyond < 0, n, beyond)
        group = linked(np.column_stack((triangles, beyond)), n + 1)
        return np.asarray(group[:n] == group[n])

    def rim(self, outside: BoolArray) -> GeometryArray:
        """The sides between triangles outside and inside, as lines."""
        beyond_is_outside = (self.neighbours < 0) | outside[self.neighbours]
        triangles, corners = np.nonzero(~outside[:, np.newaxis] & beyond_is_outside)
        return np.asarray(shapely.linestrings(self.points[self.sides[triangles, corners]]))

    def dry_share(self, faces: Sequence[Polygon], outside: BoolArray) -> npt.NDArray[np.float64]:
        """Which share of each face stays dry, judged by the triangles centred in it."""
        owners, triangles = self.centres.query(faces, predicate="contains")
        n = len(faces)
        total_mm2 = np.bincount(owners, self.areas_mm2[triangles], n)
        dry_mm2 = np.bincount(owners, (self.areas_mm2 * ~outside)[triangles], n)
        return np.divide(dry_mm2, total_mm2, out=np.zeros(n), where=total_mm2 > 0)


def _on_the_other_side(sides: IntArray) -> IntArray:
    """The triangle that has the same side, for each side of triangles; -1 where none has.

    Args:
        sides: Shape (triangles, 3, 2), the numbers of both ends.

    Returns:
        Shape (triangles, 3).
    """
    ends = np.sort(sides.reshape(-1, 2), axis=1)
    order = np.lexsort(ends.T)
    is_twice = (ends[order[1:]] == ends[order[:-1]]).all(axis=1)
    one, other = order[:-1][is_twice], order[1:][is_twice]
    beyond = np.full(len(ends), -1)
    beyond[one], beyond[other] = other // 3, one // 3
    return beyond.reshape(-1, 3)


def enclosed(bounds: Sequence[BaseGeometry], *, with_gates: bool = False) -> Enclosed:
    """What walls and lines enclose when openings of up to `OPENING_MM` are closed.

    Walls that enclose nothing are left out. Where these are many, wider openings may be closed, up
    to the first width that leaves few.

    Args:
        bounds: Polygons and lines that bound the floor.
        with_gates: Whether openings as wide as those of gates may be closed.
    """
    # Solids that overlap have one outline. Outlines of the same curve, divided in two ways, would
    # cross each other at every chord.
    filled = shapely.union_all([bound for bound in bounds if isinstance(bound, Polygon)])
    lines = [bound for bound in bounds if not isinstance(bound, Polygon)]
    walls = shapely.union_all([filled.boundary, *lines], grid_size=SAME_MM)
    if walls.is_empty:
        return Enclosed(MultiPolygon())
    samples = _samples(walls)
    if len(samples) < 3 or np.linalg.matrix_rank(samples - samples[0]) < 2:
        return Enclosed(MultiPolygon())
    mesh = Mesh.over(samples)
    found = _closed(mesh, walls, Polygon(), OPENING_STEPS_MM)
    least = _of(found, walls, filled, samples)
    if not with_gates or least.left_out <= LEFT_OUT:
        return least
    for gate_mm in GATE_STEPS_MM:
        found = _closed(mesh, walls, found, (gate_mm,))
        wider = _of(found, walls, filled, samples)
        if wider.left_out <= LEFT_OUT:
            return wider
    return least


def _closed(
    mesh: Mesh, walls: BaseGeometry, found: BaseGeometry, openings_mm: Sequence[float]
) -> BaseGeometry:
    """What is enclosed when openings are closed from narrow to wide, with what was found before."""
    flooded: BoolArray | None = None
    walls = _with_rim(walls, found)
    for opening_mm in openings_mm:
        outside = mesh.outside(opening_mm)
        if flooded is not None and (outside == flooded).all():
            # no opening lies between this width and the one before
            continue
        flooded = outside
        faces = _dry_faces(mesh, walls, found, outside)
        if faces:
            found = shapely.union_all([found, *faces])
            walls = _with_rim(walls, found)
    return found


def _with_rim(walls: BaseGeometry, found: BaseGeometry) -> BaseGeometry:
    """The walls and the rim of what they enclose; what lies within is settled."""
    if found.is_empty:
        return walls
    return shapely.union_all([*_beyond(found, shapely.get_parts(walls)), found.boundary])


def _of(
    found: BaseGeometry, walls: BaseGeometry, filled: BaseGeometry, samples: FloatArray
) -> Enclosed:
    """What is to be known about what walls enclose."""
    region, parts = _with_rooms(found, filled)
    if region.is_empty:
        return Enclosed(region)
    rooms = shapely.union_all(parts)
    shapely.prepare(rooms)
    points = shapely.points(samples)
    is_beside = ~shapely.dwithin(rooms, points, WALL_MM)
    is_beside[is_beside] = ~_on_thick_walls(points[is_beside], filled, rooms)
    return Enclosed(region, _widest_opening(region.boundary, walls), float(is_beside.mean()))


def _on_thick_walls(points: GeometryArray, filled: BaseGeometry, rooms: BaseGeometry) -> BoolArray:
    """Which points lie on the far face of a wall at a room that is thicker than most."""
    if not len(points):
        return np.zeros(0, dtype=np.bool_)
    core = filled.buffer(-WALL_MM / 2)
    shapely.prepare(core)
    # across a square corner it is as much farther as the square's diagonal is longer
    near_core, near_room = math.sqrt(2) * np.array((WALL_MM / 2, THICKEST_MM)) + TIE_MM
    is_thick = shapely.dwithin(core, points, near_core)
    return np.asarray(is_thick & shapely.dwithin(rooms, points, near_room))


def _widest_opening(rim: BaseGeometry, walls: BaseGeometry) -> LineString | None:
    """The longest part of a rim at which there is no wall."""
    lines = shapely.get_parts(walls)
    near = lines[shapely.STRtree(lines).query(rim, predicate="dwithin", distance=NEXT_TO_MM)]
    across = shapely.line_merge(rim.difference(shapely.union_all(near).buffer(NEXT_TO_MM)))
    openings = [part for part in shapely.get_parts(across) if part.length > SAMPLE_MM]
    return max(openings, key=lambda part: part.length, default=None)


def _samples(walls: BaseGeometry) -> FloatArray:
    """Points along the walls, corners included, each once."""
    spacing_mm = max(SAMPLE_MM, walls.length / MAX_SAMPLES)
    corners, owners = shapely.get_coordinates(shapely.get_parts(walls), return_index=True)
    goes_on = owners[1:] == owners[:-1]
    starts, ends = corners[:-1][goes_on], corners[1:][goes_on]
    # whole multiples of the spacing are common, and turned copies miss them by a rounding
    counts = np.ceil(np.hypot(*(ends - starts).T) / spacing_mm - 1e-6).astype(int)
    counts = np.maximum(counts, 1)
    first = np.repeat(np.cumsum(counts) - counts, counts)
    shares = ((np.arange(counts.sum()) - first) / np.repeat(counts, counts))[:, np.newaxis]
    between = np.repeat(starts, counts, axis=0) * (1 - shares)
    between += np.repeat(ends, counts, axis=0) * shares
    return np.unique(np.round(np.vstack((between, ends)), LOCAL_DIGITS), axis=0)


def _dry_faces(
    mesh: Mesh, walls: BaseGeometry, known: BaseGeometry, outside: BoolArray
) -> list[Polygon]:
    """The faces between walls that lie mostly in triangles which stay dry.

    Those within what is known to be enclosed already are of no interest.
    """
    rim = mesh.rim(outside)
    shapely.prepare(walls)
    middles = shapely.line_interpolate_point(rim, 0.5, normalized=True)
    seals = _beyond(known, rim[~shapely.dwithin(walls, middles, ON_LINE_MM)])
    # snapped to the grid, since samples lie on oblique walls only up to rounding
    noded = shapely.union_all([walls, *seals], grid_size=SAME_MM)
    cut = np.array(shapely.polygonize([noded]).geoms)
    faces = rounded(cut[shapely.area(cut) > CRUMB_MM2])
    if not faces:
        return []
    tree = shapely.STRtree(seals)
    dry = mesh.dry_share(faces, outside)
    return [
        face
        for face, share in zip(faces, dry, strict=True)
        if share > 0.5 and not _is_niche(face, tree)
    ]


def _beyond(known: BaseGeometry, lines: GeometryArray) -> GeometryArray:
    """The lines that do not lie wholly inside what is known."""
    shapely.prepare(known)
    return np.asarray(lines[~shapely.contains_properly(known, lines)])


def _is_niche(face: Polygon, seals: shapely.STRtree) -> bool:
    """Whether a face is a niche of the outside: neither wider than its mouth nor deep."""
    rim = face.boundary
    near = seals.geometries[seals.query(rim, predicate="dwithin", distance=ON_LINE_MM)]
    mouths_mm = [mouth.length for mouth in near if rim.distance(mouth.centroid) <= ON_LINE_MM]
    if not mouths_mm:
        return False
    widest_mm = max(mouths_mm)
    return face.area < DEEP * widest_mm**2 and is_thin(face, widest_mm)


def _with_rooms(found: BaseGeometry, filled: BaseGeometry) -> tuple[Region, list[Polygon]]:
    """Whole outlines around what is enclosed, and the rooms in them.

    Parts that are nothing but wall are left out.
    """
    parts: list[Polygon] = []
    rooms: list[Polygon] = []
    for part in polygons_in([found]):
        outline = Polygon(part.exterior)
        spaces = polygons_in([outline.difference(filled)])
        wide = [space for space in spaces if not is_thin(space, WALL_MM)]
        if wide:
            parts.append(outline)
            rooms.extend(wide)
    # in one order of corners, whatever the order in which the walls were drawn
    return tidy(shapely.normalize(shapely.union_all(parts))), rooms
