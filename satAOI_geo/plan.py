"""The floor plan: a floor, what stands on it, and what the reader had to say.

A plan lives in its own frame of millimetres, near the origin, y up. `Frame` is the one door
between it and the drawing it came from.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Final, TypeAlias, TypeVar

import numpy as np
import numpy.typing as npt
import shapely
import shapely.affinity
from shapely.geometry import LineString, MultiPolygon, Point, Polygon, box
from shapely.geometry.base import BaseGeometry

FloatArray: TypeAlias = npt.NDArray[np.float64]
BoolArray: TypeAlias = npt.NDArray[np.bool_]
IntArray: TypeAlias = npt.NDArray[np.int64]
Int32Array: TypeAlias = npt.NDArray[np.int32]
Region: TypeAlias = Polygon | MultiPolygon
AnyGeometry = TypeVar("AnyGeometry", bound=BaseGeometry)

CONTACT_MM: Final = 1e-4
"""Sets closer than this are in contact.

Walls and lattice both sit on round millimetres, so a distance of exactly the disc's radius is the
rule. A tenth of a micrometre is far above the rounding of georeferenced coordinates (1e-6 mm) and
far below any drawing's precision, so every route through the code, and every shifted, turned or
re-exported copy of a drawing, decides such a tie the same way.
"""

CIRCLE_SEGMENTS: Final = 720
"""Corners of the polygon that stands for a circle in areas and pictures, not in contact tests."""


class Kind(StrEnum):
    """What an obstacle is. Every kind stops every part of the robot."""

    WALL = "wall"
    COLUMN = "column"
    HOLE = "hole"
    EMBEDDED = "embedded"
    EQUIPMENT = "equipment"
    UNCLASSIFIED = "unclassified"


@dataclass(frozen=True, slots=True)
class Circle:
    """A full circle with its inside, kept as a circle so that distances to it are exact."""

    x_mm: float
    y_mm: float
    radius_mm: float

    def polygon(self) -> Polygon:
        """A regular polygon of the circle's area, for areas and pictures."""
        step_rad = 2 * math.pi / CIRCLE_SEGMENTS
        # a regular n-gon has the area of its circumcircle times sin(2π/n) / (2π/n)
        corner_mm = self.radius_mm * math.sqrt(step_rad / math.sin(step_rad))
        angles_rad = np.arange(CIRCLE_SEGMENTS) * step_rad
        return Polygon(
            np.column_stack(
                (
                    self.x_mm + corner_mm * np.cos(angles_rad),
                    self.y_mm + corner_mm * np.sin(angles_rad),
                )
            )
        )


Shape: TypeAlias = Polygon | LineString | Circle


def geometry_of(shape: Shape) -> Polygon | LineString:
    """A shape as shapely sees it; a circle as a polygon of the same area."""
    return shape.polygon() if isinstance(shape, Circle) else shape


def core_of(shape: Shape) -> Polygon | LineString | Point:
    """What a shape reaches out from by `radius_mm_of`: the centre of a circle, else the shape."""
    return Point(shape.x_mm, shape.y_mm) if isinstance(shape, Circle) else shape


def radius_mm_of(shape: Shape) -> float:
    """How far a shape reaches beyond its core."""
    return shape.radius_mm if isinstance(shape, Circle) else 0.0


@dataclass(frozen=True, slots=True)
class Obstacle:
    """One thing the robot must not touch: a closed set in the plan's frame.

    Attributes:
        shape: A polygon with its inside (holes in it are free), an open chain of zero width,
            or a full circle.
        kind: What it is.
        layer: Layer (DXF) or class (IFC) it was drawn on.
        handle: Handle (DXF) or GlobalId (IFC); several obstacles may share one.
    """

    shape: Shape
    kind: Kind
    layer: str = ""
    handle: str = ""

    def region(self) -> BaseGeometry:
        """The shape as shapely sees it; a circle as a polygon of the same area."""
        return geometry_of(self.shape)

    def label(self) -> str:
        """The obstacle as a person can find it in the drawing."""
        return f"{self.kind} {self.handle} on layer '{self.layer}'"


@dataclass(frozen=True, slots=True)
class Finding:
    """Something skipped, guessed, repaired or cut on the way from the drawing to the plan.

    Attributes:
        code: Short name of the sort of finding, in kebab-case.
        message: What was found and what was done about it.
        remedy: What the user can do.
        layer: Layer concerned, or an empty string.
        handle: Handle or GlobalId concerned, or an empty string.
        at_mm: Where, in the drawing's axes in millimetres, or None.
    """

    code: str
    message: str
    remedy: str = ""
    layer: str = ""
    handle: str = ""
    at_mm: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True)
class Frame:
    """Where the plan's millimetres lie in the drawing.

    drawing = (origin + turned by turn(local)) / mm_per_unit. The origin keeps large coordinates
    out of the arithmetic; the turn lays the lattice along the walls.

    Attributes:
        origin_mm: The plan's origin in the drawing's axes, in millimetres.
        turn_rad: Direction of the plan's x axis in the drawing.
        mm_per_unit: Millimetres in one drawing unit.
    """

    origin_mm: tuple[float, float] = (0.0, 0.0)
    turn_rad: float = 0.0
    mm_per_unit: float = 1.0

    def to_drawing_mm(self, points_mm: npt.ArrayLike) -> FloatArray:
        """Points of the plan, shape (..., 2), in the drawing's axes, still in millimetres."""
        local_mm = np.asarray(points_mm, dtype=np.float64)
        cos, sin = math.cos(self.turn_rad), math.sin(self.turn_rad)
        x_mm = local_mm[..., 0] * cos - local_mm[..., 1] * sin + self.origin_mm[0]
        y_mm = local_mm[..., 0] * sin + local_mm[..., 1] * cos + self.origin_mm[1]
        return np.stack((x_mm, y_mm), axis=-1)

    def to_drawing(self, points_mm: npt.ArrayLike) -> FloatArray:
        """Points of the plan, shape (..., 2), in drawing units."""
        return self.to_drawing_mm(points_mm) / self.mm_per_unit

    def to_local_mm(self, points: npt.ArrayLike) -> FloatArray:
        """Points in drawing units, shape (..., 2), in the plan's frame."""
        drawing_mm = np.asarray(points, dtype=np.float64) * self.mm_per_unit
        cos, sin = math.cos(self.turn_rad), math.sin(self.turn_rad)
        x_mm, y_mm = (
            drawing_mm[..., 0] - self.origin_mm[0],
            drawing_mm[..., 1] - self.origin_mm[1],
        )
        return np.stack((x_mm * cos + y_mm * sin, y_mm * cos - x_mm * sin), axis=-1)


@dataclass(frozen=True, slots=True)
class Source:
    """The file a plan came from.

    Attributes:
        path: As the user gave it.
        sha256: Hexadecimal digest of its bytes.
        format: `dxf`, `ifc`, or `memory` for a plan made in Python.
        unit: Key of `units.MM_PER_UNIT`.
        unit_source: How the unit is known: `option`, `header`, `estimate` or `given`.
        encoding: Of the names in a drawing that is text (DXF), by its name in Python; the header
            may claim another.
        storey: GlobalId of the storey (IFC), or an empty string.
        height_mm: Height of the floor in the model (IFC); a drawing has none and lies at 0.
    """

    path: str = ""
    sha256: str = ""
    format: str = "memory"
    unit: str = "mm"
    unit_source: str = "given"
    encoding: str = ""
    storey: str = ""
    height_mm: float = 0.0


@dataclass(frozen=True, slots=True)
class FloorPlan:
    """A floor and what stands on it.

    Everything outside the floor is an obstacle too. Obstacles may overlap each other and may
    reach beyond the floor.

    Attributes:
        floor: The floor in the plan's frame, closed; holes in it are outside.
        obstacles: What stands on it.
        findings: What the reader skipped, guessed or repaired.
        floor_source: `layer` (DXF); `slab`, `space` or `support` (IFC); `inferred`; or `given`
            for a plan made in Python.
        frame: Where the plan lies in its drawing.
        source: The file it came from.
        start_mm: Disc centre marked in the drawing as the start, in the plan's frame.
    """

    floor: Region
    obstacles: tuple[Obstacle, ...] = ()
    findings: tuple[Finding, ...] = ()
    floor_source: str = "given"
    frame: Frame = field(default_factory=Frame)
    source: Source = field(default_factory=Source)
    start_mm: tuple[float, float] | None = None

    def outside(self, margin_mm: float) -> Region:
        """What is not floor, out to a margin around the floor's bounds, as a closed set."""
        left, bottom, right, top = self.floor.bounds
        around = box(left - margin_mm, bottom - margin_mm, right + margin_mm, top + margin_mm)
        return as_region(around.difference(self.floor))

    def turned(self, turn_rad: float) -> "FloorPlan":
        """The same plan seen in axes turned by an angle, counter-clockwise about its origin."""
        if turn_rad == 0.0:
            return self
        frame = replace(self.frame, turn_rad=self.frame.turn_rad + turn_rad)
        return replace(
            self,
            floor=as_region(_seen_in(self.floor, turn_rad)),
            obstacles=tuple(
                replace(o, shape=_shape_seen_in(o.shape, turn_rad)) for o in self.obstacles
            ),
            frame=frame,
            start_mm=None if self.start_mm is None else _point_seen_in(self.start_mm, turn_rad),
        )

    def obstacle_region(self) -> Region:
        """The part of the floor that polygons and circles occupy, overlaps counted once."""
        solids = [o.region() for o in self.obstacles if not isinstance(o.shape, LineString)]
        return as_region(shapely.union_all(solids).intersection(self.floor))

    def obstacle_area_mm2(self) -> float:
        """Area of the obstacle region; most obstacles stand alone inside and need no overlay."""
        solids = np.array(polygons_in([o.region() for o in self.obstacles]), dtype=object)
        touching, _ = shapely.STRtree(solids).query(solids, predicate="intersects")
        is_alone = np.bincount(touching, minlength=solids.size) == 1
        shapely.prepare(self.floor)
        is_inside = is_alone & shapely.covers(self.floor, solids)
        others = shapely.union_all(solids[~is_inside]).intersection(self.floor)
        return float(shapely.area(solids[is_inside]).sum() + others.area)

    def free_region(self) -> Region:
        """The floor less the obstacles: the ceiling of any area of interest."""
        return as_region(self.floor.difference(self.obstacle_region()))


def as_region(geometry: BaseGeometry) -> Region:
    """The polygons in a geometry; points and lines, which have no area, are left out."""
    if isinstance(geometry, Polygon | MultiPolygon):
        return geometry
    return MultiPolygon(polygons_in(getattr(geometry, "geoms", ())))


def polygons_in(geometries: Sequence[BaseGeometry]) -> list[Polygon]:
    """All polygons with an inside in a sequence of geometries, collections opened, in order."""
    found: list[Polygon] = []
    for geometry in geometries:
        if isinstance(geometry, Polygon):
            found.extend([] if geometry.is_empty else [geometry])
        else:
            found.extend(polygons_in(getattr(geometry, "geoms", ())))
    return found


def _seen_in(geometry: AnyGeometry, turn_rad: float) -> AnyGeometry:
    """A geometry in axes turned about the origin."""
    seen: AnyGeometry = shapely.affinity.rotate(
        geometry, -turn_rad, origin=(0.0, 0.0), use_radians=True
    )
    return seen


def _point_seen_in(point_mm: tuple[float, float], turn_rad: float) -> tuple[float, float]:
    """A point in axes turned about the origin."""
    x_mm, y_mm = Frame(turn_rad=turn_rad).to_local_mm(point_mm).tolist()
    return x_mm, y_mm


def _shape_seen_in(shape: Shape, turn_rad: float) -> Shape:
    """A shape in axes turned about the origin."""
    if isinstance(shape, Circle):
        x_mm, y_mm = _point_seen_in((shape.x_mm, shape.y_mm), turn_rad)
        return replace(shape, x_mm=x_mm, y_mm=y_mm)
    return _seen_in(shape, turn_rad)
