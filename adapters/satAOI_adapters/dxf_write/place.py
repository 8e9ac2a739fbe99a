"""Where the floor lies in the drawing, and where beside it there is room for a note."""

import contextlib
import math
from collections.abc import Iterable, Iterator
from typing import TypeAlias

import numpy as np
import shapely
from ezdxf import bbox
from ezdxf.document import Drawing
from ezdxf.entities import AttDef, Dimension, DXFGraphic, Insert, Line, LWPolyline, Polyline
from ezdxf.fonts.fonts import MONOSPACE
from ezdxf.layouts import BlockLayout, Modelspace
from ezdxf.math import Vec3

from satAOI_geo.plan import FloatArray, FloorPlan

Bounds: TypeAlias = tuple[float, float, float, float]
"""Left, bottom, right, top in drawing units."""


def floor_bounds(plan: FloorPlan) -> Bounds:
    """The floor's bounds along the drawing's axes."""
    corners = plan.frame.to_drawing(shapely.get_coordinates(plan.floor))
    (left, bottom), (right, top) = corners.min(axis=0), corners.max(axis=0)
    return float(left), float(bottom), float(right), float(top)


def text_height(plan: Bounds) -> float:
    """Letters that can be read when the plan fills a sheet, in drawing units."""
    width, height = plan[2] - plan[0], plan[3] - plan[1]
    return max(math.sqrt(width * height) / 60, max(width, height) / 150)


def corners_of(bounds: Bounds) -> FloatArray:
    """The corners of a rectangle, closed, shape (5, 2)."""
    left, bottom, right, top = bounds
    return np.array([(left, bottom), (right, bottom), (right, top), (left, top), (left, bottom)])


def free_place(plan: Bounds, size: tuple[float, float], *, gap: float, taken: FloatArray) -> Bounds:
    """A rectangle clear of everything: right of the plan, left of it, below or above.

    The first of the four that lies no farther off than the plan is long, else the nearest.

    Args:
        plan: Bounds of the plan.
        size: Width and height of the rectangle.
        gap: Room to keep around it.
        taken: Bounds of what is drawn already, shape (n, 4).
    """
    left, bottom, right, top = plan
    width, height = size
    lows, highs = taken[:, :2], taken[:, 2:]
    beside = (lows[:, 1] < top + gap) & (highs[:, 1] > top - height - gap)
    along = (lows[:, 0] < left + width + gap) & (highs[:, 0] > left - gap)
    to_right = _first_gap(right, width, gap, lows[beside, 0], highs[beside, 0])
    to_left = -_first_gap(-left, width, gap, -highs[beside, 0], -lows[beside, 0])
    below = -_first_gap(-bottom, height, gap, -highs[along, 1], -lows[along, 1])
    above = _first_gap(top, height, gap, lows[along, 1], highs[along, 1])
    places = (
        (to_right - right, (to_right, top - height, to_right + width, top)),
        (left - to_left, (to_left - width, top - height, to_left, top)),
        (bottom - below, (left, below - height, left + width, below)),
        (above - top, (left, above, left + width, above + height)),
    )
    near = max(right - left, top - bottom)
    return min(places, key=lambda place: max(place[0], near))[1]


def entity_bounds(space: Modelspace) -> FloatArray:
    """Bounds of what is drawn, shape (n, 4): of each entity, of a polyline each piece.

    Letters count as wide as they are high, whatever fonts this machine has.
    """
    with _letters_of_one_width(space.doc):
        return _Measure().bounds(space)


class _Measure:
    """Tells bounds; what a block holds is measured once, however often the block is inserted."""

    def __init__(self) -> None:
        self._corners: dict[str, list[Vec3]] = {}

    def bounds(self, entities: Iterable[DXFGraphic]) -> FloatArray:
        """Bounds of entities and their pieces, shape (n, 4)."""
        found = [np.empty((0, 4))]
        for entity in entities:
            # a damaged entity raises whatever comes to it; what cannot be measured is not drawn
            # either, and there is nothing to avoid
            with contextlib.suppress(Exception):
                found.append(self._of(entity))
        return np.concatenate(found)

    def _of(self, entity: DXFGraphic) -> FloatArray:
        """Bounds of an entity, shape (n, 4), n = 0 where it shows nothing.

        Polylines count in pieces: the box around a site boundary would leave no room at all.
        """
        if isinstance(entity, Line):
            return _of_pieces([entity.dxf.start, entity.dxf.end])
        if isinstance(entity, LWPolyline) and not entity.has_arc:
            corners = list(entity.vertices_in_wcs())
            return _of_pieces(corners + corners[:1] if entity.closed else corners)
        if isinstance(entity, Insert):
            return self._of_insert(entity)
        if isinstance(entity, LWPolyline | Polyline):
            return self.bounds(entity.virtual_entities())
        if isinstance(entity, Dimension):
            return _around(self.bounds(entity.virtual_entities()).reshape(-1, 2))
        boxes = bbox.multi_recursive([entity], fast=True)
        return _around(_flat(at for box in boxes for at in (box.extmin, box.extmax)))

    def _of_insert(self, insert: Insert) -> FloatArray:
        """A box around the block at each of its places, and one around each attribute.

        A block that stands askew is given the room of the box around it, askew.
        """
        found = []
        for copy in insert.multi_insert() if insert.mcount > 1 else [insert]:
            corners = copy.matrix44().transform_vertices(self._corners_of(copy.block()))
            found += [_around(_flat(corners)), self.bounds(copy.attribs)]
        return np.concatenate(found)

    def _corners_of(self, block: BlockLayout | None) -> list[Vec3]:
        """Corners of the box around what a block holds, in its own axes; none where it is empty."""
        if block is None:
            return []
        if block.name not in self._corners:
            # a damaged block may hold itself
            self._corners[block.name] = []
            # what takes the place of these is an attribute of the insert
            held = (entity for entity in block if not isinstance(entity, AttDef))
            box = _around(self.bounds(held).reshape(-1, 2))
            self._corners[block.name] = [Vec3(at) for bounds in box for at in corners_of(bounds)]
        return self._corners[block.name]


def _around(points: FloatArray) -> FloatArray:
    """The box around points, shape (1, 4); shape (0, 4) where there are none."""
    if not len(points):
        return np.empty((0, 4))
    return np.concatenate((points.min(axis=0), points.max(axis=0)))[np.newaxis]


def _flat(points: Iterable[Vec3]) -> FloatArray:
    """Points as seen from above, shape (n, 2)."""
    return np.array([(x, y) for x, y, _ in points], dtype=np.float64).reshape(-1, 2)


def _of_pieces(corners: Iterable[Vec3]) -> FloatArray:
    """Bounds of each straight piece from corner to corner, shape (n - 1, 4)."""
    points = _flat(corners)
    begins, ends = points[:-1], points[1:]
    return np.hstack((np.minimum(begins, ends), np.maximum(begins, ends)))


@contextlib.contextmanager
def _letters_of_one_width(document: Drawing) -> Iterator[None]:
    """While this lasts, texts are measured in no font of this machine, which is slow to load."""
    # shape files are no fonts of texts, and line types look for them by these names
    texts = [style for style in document.styles if not style.is_shape_file]
    before = [(style, style.dxf.get("font")) for style in texts]
    for style, _ in before:
        style.dxf.font = MONOSPACE
    try:
        yield
    finally:
        for style, font in before:
            if font is None:
                style.dxf.discard("font")
            else:
                style.dxf.font = font


def _first_gap(
    edge: float, length: float, gap: float, lows: FloatArray, highs: FloatArray
) -> float:
    """Least start, a gap beyond the edge or more, of a stretch clear of the intervals.

    Args:
        edge: Where the plan ends.
        length: Of the stretch.
        gap: To keep at both its ends.
        lows: Where the intervals begin, shape (n,).
        highs: Where they end, shape (n,).
    """
    start = edge + gap
    # in the order of their beginnings, each interval in the way pushes the stretch past its end
    for k in np.argsort(lows, kind="stable"):
        if lows[k] < start + length + gap and highs[k] > start - gap:
            start = float(highs[k]) + gap
    return start
