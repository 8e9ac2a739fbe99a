"""Shapes of the plan as entities of model space, in drawing units."""

from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt
from ezdxf.entities import DXFGraphic, Hatch
from ezdxf.layouts import Modelspace
from ezdxf.lldxf.const import (
    BOUNDARY_PATH_EXTERNAL,
    BOUNDARY_PATH_OUTERMOST,
)
from shapely.geometry import LineString, Polygon

from satAOI_geo.aoi import Loop, Outline
from satAOI_geo.plan import Circle, FloatArray, Frame, Shape

BYLAYER: Final = 256
"""The colour index that means: as the layer."""


def begun_on_a_straight(vertices: FloatArray) -> FloatArray:
    """The same loop, shape (n, 3), begun in the middle of its longest straight piece.

    LibreCAD 2.2 takes a loop for closed as soon as it comes back to the pixel it began in. Begun
    where vertices crowd, it ends too early, and what follows joins the next loop: a wedge of the
    fill is missing. A loop of arcs alone stays as it is.
    """
    begins, ends = vertices[:, :2], np.roll(vertices[:, :2], -1, axis=0)
    lengths = np.where(vertices[:, 2] == 0, np.hypot(*(ends - begins).T), 0.0)
    longest = int(lengths.argmax())
    if lengths[longest] == 0:
        return vertices
    middle = (*((begins[longest] + ends[longest]) / 2), 0.0)
    return np.vstack((middle, np.roll(vertices, -longest - 1, axis=0)))


def outline_of(polygon: Polygon) -> Outline:
    """A polygon as an outline of straight lines."""
    exterior, *holes = (
        np.insert(np.array(ring.coords)[:-1, :2], 2, 0.0, axis=1)
        for ring in (polygon.exterior, *polygon.interiors)
    )
    return Outline(Loop(exterior), tuple(map(Loop, holes)))


@dataclass(frozen=True, slots=True)
class Pen:
    """Draws on one layer in one colour.

    Attributes:
        space: Where to draw.
        frame: Turns the plan's millimetres into drawing units.
        layer: Of everything that is drawn.
        colour: AutoCAD colour index.
    """

    space: Modelspace
    frame: Frame
    layer: str
    colour: int = BYLAYER

    def shape(self, shape: Shape) -> list[DXFGraphic]:
        """A circle as a circle, a chain as a polyline, a polygon as a polyline a ring."""
        if isinstance(shape, Circle):
            return [self.circle((shape.x_mm, shape.y_mm), shape.radius_mm)]
        if isinstance(shape, LineString):
            return [self.chain(shape.coords)]
        return [self.ring(ring.coords) for ring in (shape.exterior, *shape.interiors)]

    def circle(self, centre_mm: npt.ArrayLike, radius_mm: float) -> DXFGraphic:
        """A full circle."""
        centre = self.frame.to_drawing(centre_mm)
        return self.space.add_circle(
            centre, radius_mm / self.frame.mm_per_unit, dxfattribs=self._attributes()
        )

    def chain(self, points_mm: npt.ArrayLike) -> DXFGraphic:
        """An open polyline, or a closed one when it ends where it begins."""
        points_mm = np.asarray(points_mm, dtype=np.float64)[:, :2]
        if len(points_mm) > 3 and np.array_equal(points_mm[0], points_mm[-1]):
            return self.ring(points_mm)
        return self.space.add_lwpolyline(
            self.frame.to_drawing(points_mm), dxfattribs=self._attributes()
        )

    def ring(self, points_mm: npt.ArrayLike) -> DXFGraphic:
        """A closed polyline of straight lines; the last point repeats the first, as in shapely."""
        points_mm = np.asarray(points_mm, dtype=np.float64)[:-1, :2]
        return self.space.add_lwpolyline(
            self.frame.to_drawing(points_mm), close=True, dxfattribs=self._attributes()
        )

    def loop(self, loop: Loop) -> DXFGraphic:
        """A closed polyline with true arcs."""
        return self.space.add_lwpolyline(
            self._with_bulges(loop), format="xyb", close=True, dxfattribs=self._attributes()
        )

    def fill(self, outline: Outline) -> Hatch:
        """A solid hatch of one connected part with its holes, bounded by true arcs."""
        hatch = self.space.add_hatch(color=self.colour, dxfattribs=self._attributes())
        for loop, flags in (
            (outline.exterior, BOUNDARY_PATH_EXTERNAL),
            *((hole, BOUNDARY_PATH_OUTERMOST) for hole in outline.holes),
        ):
            vertices = begun_on_a_straight(self._with_bulges(loop))
            hatch.paths.add_polyline_path(vertices, flags=flags)
        return hatch

    def _with_bulges(self, loop: Loop) -> FloatArray:
        """Vertices in drawing units, shape (n, 3); a similarity leaves the bulges as they are."""
        return np.column_stack((self.frame.to_drawing(loop.vertices[:, :2]), loop.vertices[:, 2]))

    def _attributes(self) -> dict[str, str | int]:
        return {"layer": self.layer, "color": self.colour}
