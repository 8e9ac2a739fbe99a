"""Solids as triangles: what stands in a band of heights, for bodies that are no stack of prisms.

The plan of what stands between two heights is the union of the triangles' parts between them,
seen from above, and of one section, which holds wherever the body goes right through. No number of
sections alone would see a plate that lies between two of them.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt
import shapely
import trimesh
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry
from trimesh.intersections import mesh_plane

from satAOI_adapters.ifc_read.prisms import View
from satAOI_geo.plan import FloatArray, polygons_in

DEFLECTION_MM: Final = 0.5
"""Farthest that the mesher is asked to stay from a curved surface."""

GROWTH_MM: Final = 1.25
"""How much a body with curved faces is grown: 2.5 times the deflection.

The mesher keeps to the deflection along edges, yet its triangles were measured to miss spheres
of 0.1 to 4 m by up to 2.1 times as much.
"""

SLIVER_MM2: Final = 1e-3
"""Triangles smaller than this in plan are upright faces; the section stands for them."""

WELD_MM: Final = 1e-4
"""Ends of section lines this close are one point."""

NEARLY_LEVEL: Final = 0.99
"""Cosine of the slope up to which a face is floor: 8°, steeper than any fall to a drain."""

LEVEL_MM: Final = 0.01
"""A triangle whose corners differ less in height is level."""

N_SECTIONS: Final = 3
"""Sections taken through a mesh with holes in its surface; one does for a closed one."""


@dataclass(frozen=True, slots=True)
class Mesh:
    """Triangles of a body in the plan's axes.

    Attributes:
        corners_mm: Shape (n, 3).
        triangles: Indices of corners, shape (m, 3).
        growth_mm: How far the body may reach beyond its triangles.
    """

    corners_mm: FloatArray
    triangles: npt.NDArray[np.int64]
    growth_mm: float

    def heights_mm(self) -> tuple[float, float]:
        """Least and greatest height."""
        return float(self.corners_mm[:, 2].min()), float(self.corners_mm[:, 2].max())

    def in_band(self, view: View) -> list[Polygon | LineString]:
        """The plan of all that stands between the view's heights.

        Faces that do not close around anything stay as lines of zero width.
        """
        cut = _between(self, view.low_mm, view.high_mm)
        if not len(cut.triangles):
            return []
        faces = list(_plan_triangles(cut.corners_mm[cut.triangles]))
        lines: list[LineString] = []
        for level_mm in _levels_mm(cut, 1 if _is_closed(self) else N_SECTIONS):
            closed, loose = _section(cut, level_mm)
            faces.extend(closed)
            lines.extend(loose)
        solid = _grown(shapely.union_all(faces), self.growth_mm)
        open_lines = _grown(shapely.union_all(lines).difference(solid), self.growth_mm)
        return [*polygons_in([solid, open_lines]), *_lines_in(open_lines)]

    def level_faces(self) -> list[tuple[float, BaseGeometry]]:
        """Faces that look up: height and plan of each level one, and of all with a slight fall.

        They lie within the true faces: curved edges are pulled in by the growth.
        """
        corners_mm = self.corners_mm[self.triangles]
        normals = np.cross(corners_mm[:, 1] - corners_mm[:, 0], corners_mm[:, 2] - corners_mm[:, 0])
        upward = normals[:, 2] > NEARLY_LEVEL * np.linalg.norm(normals, axis=1)
        corners_mm = corners_mm[upward]
        heights_mm = np.round(corners_mm[:, :, 2].mean(axis=1))
        falling = np.ptp(corners_mm[:, :, 2], axis=1) > LEVEL_MM
        if falling.any():
            heights_mm[falling] = heights_mm[falling].mean()
        faces = []
        for height_mm in np.unique(heights_mm):
            at_height = heights_mm == height_mm
            face = shapely.union_all(_plan_triangles(corners_mm[at_height]))
            exact_mm = float(corners_mm[at_height, :, 2].mean())
            faces.append((exact_mm, _grown(face, -self.growth_mm)))
        return faces


def _trimesh(mesh: Mesh) -> trimesh.Trimesh:
    return trimesh.Trimesh(mesh.corners_mm, mesh.triangles, process=False, validate=False)


def _between(mesh: Mesh, low_mm: float, high_mm: float) -> Mesh:
    """The triangles' parts between two heights."""
    part = _trimesh(mesh)
    for height_mm, upward in ((low_mm, 1.0), (high_mm, -1.0)):
        if len(part.faces):
            part = part.slice_plane((0.0, 0.0, height_mm), (0.0, 0.0, upward))
    return Mesh(np.asarray(part.vertices), np.asarray(part.faces), mesh.growth_mm)


def _is_closed(mesh: Mesh) -> bool:
    """Whether every edge belongs to two triangles, so that the surface bounds a solid."""
    edges = mesh.triangles[:, ((0, 1), (1, 2), (2, 0))].reshape(-1, 2)
    _, counts = np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)
    return bool((counts == 2).all())


def _levels_mm(mesh: Mesh, n_levels: int) -> list[float]:
    """Heights half-way between neighbouring corners, spread from the lowest to the highest."""
    heights_mm = np.unique(np.round(mesh.corners_mm[:, 2], 3))
    between_mm = (heights_mm[1:] + heights_mm[:-1]) / 2
    if not len(between_mm):
        return []
    chosen = np.linspace(0, len(between_mm) - 1, n_levels).round().astype(int)
    return [float(between_mm[i]) for i in np.unique(chosen)]


def _section(mesh: Mesh, level_mm: float) -> tuple[list[Polygon], list[LineString]]:
    """Faces and left-over lines of the section at a height."""
    whole = _trimesh(mesh)
    # trimesh publishes types for a part of its functions
    lines_mm, faces = mesh_plane(  # type: ignore[no-untyped-call]
        whole, (0.0, 0.0, 1.0), (0.0, 0.0, level_mm), return_faces=True
    )
    ends_mm = np.round(lines_mm[:, :, :2] / WELD_MM) * WELD_MM
    real = (ends_mm[:, 0] != ends_mm[:, 1]).any(axis=1)
    directed_mm = _solid_on_the_left(ends_mm[real], whole.face_normals[faces][real])
    noded = shapely.union_all(shapely.linestrings(directed_mm))
    cells, cuts, dangles, _ = shapely.polygonize_full([noded])
    solid = [cell for cell in cells.geoms if _is_solid(cell, directed_mm)]
    return solid, [*cuts.geoms, *dangles.geoms]


def _plan_triangles(corners_mm: FloatArray) -> npt.NDArray[np.object_]:
    """Triangles of shape (m, 3, 3) seen from above, those seen edge-on left out."""
    plan_mm = corners_mm[:, :, :2]
    sides_mm = plan_mm[:, 1:] - plan_mm[:, :1]
    area_mm2 = (
        np.abs(sides_mm[:, 0, 0] * sides_mm[:, 1, 1] - sides_mm[:, 0, 1] * sides_mm[:, 1, 0]) / 2
    )
    return np.asarray(shapely.polygons(plan_mm[area_mm2 > SLIVER_MM2]))


def _solid_on_the_left(ends_mm: FloatArray, normals: FloatArray) -> FloatArray:
    """Section lines, shape (n, 2, 2), turned so that the normals point to their right."""
    along_mm = ends_mm[:, 1] - ends_mm[:, 0]
    points_left = along_mm[:, 0] * normals[:, 1] - along_mm[:, 1] * normals[:, 0] > 0
    return np.where(points_left[:, None, None], ends_mm[:, ::-1], ends_mm)


def _is_solid(cell: Polygon, lines_mm: FloatArray) -> bool:
    """Whether a ray from inside a cell crosses lines that enclose it.

    The lines' turns about the point are counted with sign, so that bodies may overlap, and
    without, so that faces may look either way.
    """
    point = cell.representative_point()
    start_mm, end_mm = lines_mm[:, 0], lines_mm[:, 1]
    up = (start_mm[:, 1] <= point.y) & (end_mm[:, 1] > point.y)
    down = (start_mm[:, 1] > point.y) & (end_mm[:, 1] <= point.y)
    rise_mm = np.where(up | down, end_mm[:, 1] - start_mm[:, 1], 1.0)
    share = (point.y - start_mm[:, 1]) / rise_mm
    right = start_mm[:, 0] + share * (end_mm[:, 0] - start_mm[:, 0]) > point.x
    n_up, n_down = int(np.sum(up & right)), int(np.sum(down & right))
    return n_up != n_down or (n_up + n_down) % 2 == 1


def _grown(region: BaseGeometry, growth_mm: float) -> BaseGeometry:
    if not growth_mm or region.is_empty:
        return region
    return region.buffer(growth_mm, join_style="mitre")


def _lines_in(geometry: BaseGeometry) -> list[LineString]:
    if isinstance(geometry, LineString):
        return [] if geometry.is_empty else [geometry]
    return [line for part in getattr(geometry, "geoms", ()) for line in _lines_in(part)]
