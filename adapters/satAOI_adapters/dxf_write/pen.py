"""Shapes of the plan as entities of model space, in drawing units."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import accumulate
from typing import Final

import numpy as np
import numpy.typing as npt
from ezdxf.entities import DXFGraphic, Hatch
from ezdxf.entities.lwpolyline import LWPolylinePoints
from ezdxf.layouts import Modelspace
from ezdxf.lldxf.const import (
    BOUNDARY_PATH_EXTERNAL,
    BOUNDARY_PATH_OUTERMOST,
)
from ezdxf.lldxf.types import DXFTag
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
    begins, bulges = vertices[:, :2], vertices[:, 2]
    ends = np.concatenate((begins[1:], begins[:1]))
    lengths = np.where(bulges == 0, np.hypot(*(ends - begins).T), 0.0)
    longest = int(lengths.argmax())
    if lengths[longest] == 0:
        return vertices
    middle = (*((begins[longest] + ends[longest]) / 2), 0.0)
    return np.concatenate(([middle], vertices[longest + 1 :], vertices[: longest + 1]))


def outline_of(polygon: Polygon) -> Outline:
    """A polygon as an outline of straight lines."""
    exterior, *holes = (
        Loop(_straight(np.array(ring.coords)[:-1, :2]))
        for ring in (polygon.exterior, *polygon.interiors)
    )
    return Outline(exterior, tuple(holes))


def _straight(points: FloatArray) -> FloatArray:
    """Points, shape (n, 2), as vertices without bulges, shape (n, 3)."""
    return np.column_stack((points, np.zeros(len(points))))


class _Points(LWPolylinePoints):
    """The points of a polyline, made and written faster than by the library's own means.

    These would take most of the time of a drawing: they parse a point format for each vertex and
    pack each into an array to take it apart again.
    """

    @classmethod
    def from_vertices(cls, vertices: FloatArray) -> "_Points":
        """Vertices with bulges, shape (n, 3), as points without a width."""
        points = cls()
        points.values = np.zeros((len(vertices), cls.VERTEX_SIZE))
        points.values[:, :2], points.values[:, -1] = vertices[:, :2], vertices[:, 2]
        return points

    def dxftags(self) -> Iterator[DXFTag]:
        """Group codes and values in one piece; a bulge of 0 need not be said."""
        yield _Together(
            self.VERTEX_CODE,
            "".join(
                f" 10\n{x}\n 20\n{y}\n 42\n{bulge}\n" if bulge else f" 10\n{x}\n 20\n{y}\n"
                for x, y, _, _, bulge in self.values.tolist()
            ),
        )


class _Together(DXFTag):
    """Many tags in a row that are written as one; the value is their text."""

    def dxfstr(self) -> str:
        """The tags as they stand in the file."""
        return str(self.value)


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
        return self._polylines([_straight(points_mm)], close=False)[0]

    def ring(self, points_mm: npt.ArrayLike) -> DXFGraphic:
        """A closed polyline of straight lines; the last point repeats the first, as in shapely."""
        points_mm = np.asarray(points_mm, dtype=np.float64)[:-1, :2]
        return self._polylines([_straight(points_mm)], close=True)[0]

    def loop(self, loop: Loop) -> DXFGraphic:
        """A closed polyline with true arcs."""
        return self.loops([loop])[0]

    def loops(self, loops: Sequence[Loop]) -> list[DXFGraphic]:
        """Closed polylines with true arcs."""
        return self._polylines([loop.vertices for loop in loops], close=True)

    def fill(self, outline: Outline) -> Hatch:
        """A solid hatch of one connected part with its holes, bounded by true arcs."""
        hatch = self.space.add_hatch(color=self.colour, dxfattribs=self._attributes())
        exterior, *holes = self._in_drawing(
            [loop.vertices for loop in (outline.exterior, *outline.holes)]
        )
        for vertices, flags in (
            (exterior, BOUNDARY_PATH_EXTERNAL),
            *((hole, BOUNDARY_PATH_OUTERMOST) for hole in holes),
        ):
            # plain numbers, which the library takes one by one
            points = begun_on_a_straight(vertices).tolist()
            hatch.paths.add_polyline_path(points, flags=flags)
        return hatch

    def _polylines(self, chains: Sequence[FloatArray], *, close: bool) -> list[DXFGraphic]:
        """Polylines of vertices with bulges, each of shape (n, 3), in millimetres."""
        attributes = self._attributes()
        polylines: list[DXFGraphic] = []
        for vertices in self._in_drawing(chains):
            polyline = self.space.add_lwpolyline([], close=close, dxfattribs=attributes)
            polyline.lwpoints = _Points.from_vertices(vertices)
            polylines.append(polyline)
        return polylines

    def _in_drawing(self, chains: Sequence[FloatArray]) -> list[FloatArray]:
        """Vertices, each of shape (n, 3), in drawing units; a similarity leaves bulges as they are.

        All are turned at once: they may be many, most of them of a few vertices.
        """
        vertices = np.concatenate((np.empty((0, 3)), *chains))
        vertices[:, :2] = self.frame.to_drawing(vertices[:, :2])
        ends = accumulate(map(len, chains))
        return [vertices[end - len(chain) : end] for end, chain in zip(ends, chains, strict=True)]

    def _attributes(self) -> dict[str, str | int]:
        return {"layer": self.layer, "color": self.colour}
