"""Results of small runs for the tests of the writers."""

from dataclasses import replace
from functools import cache
from hashlib import sha256
from pathlib import Path

import numpy as np
from shapely.geometry import LineString, Polygon, box

from satAOI_geo.aoi import Loop, Outline
from satAOI_geo.pipeline import Result, area_of_interest
from satAOI_geo.plan import Circle, FloorPlan, Frame, Kind, Obstacle, Source
from satAOI_geo.settings import Settings

QUARTER_BULGE = np.tan(np.pi / 8)


def furnished_room() -> FloorPlan:
    """
    ┌──────────────────────┐ 5000
    │ ┌─┐      /        ◎  │   one obstacle of each kind and of each shape: a ring-shaped
    │ └─┘     /     ┌─┐    │   polygon, a circle, a chain without width, rectangles
    │               └─┘    │
    │   ●                  │
    └──────────────────────┘
    0                   7000
    """
    ring = Polygon(
        box(5800, 3800, 6600, 4600).exterior, [box(6000, 4000, 6400, 4400).exterior.coords]
    )
    return FloorPlan(
        box(0, 0, 7000, 5000),
        (
            Obstacle(box(400, 3800, 1000, 4400), Kind.EQUIPMENT, "EQPM", "A1"),
            Obstacle(Circle(800, 900, 200), Kind.COLUMN, "COLS", "A2"),
            Obstacle(LineString([(2600, 3600), (3200, 4600)]), Kind.WALL, "WALL", "A3"),
            Obstacle(ring, Kind.HOLE, "HOLE", "A4"),
            Obstacle(box(4400, 2900, 4700, 3200), Kind.EMBEDDED, "EMBED", "A5"),
            Obstacle(box(5000, 0, 5200, 300), Kind.UNCLASSIFIED, "0", "A6"),
        ),
        start_mm=(3000.0, 1500.0),
    )


@cache
def furnished_result() -> Result:
    """The area of interest of the furnished room, in one part with holes.

    The lattice is coarse, so that scallops between neighbouring discs stay arcs.
    """
    return area_of_interest(furnished_room(), settings=Settings(step_mm=25.0, align_rad=0.0))


def two_parts() -> tuple[Outline, ...]:
    """A rounded rectangle with a round hole, and a disc: 2000 × 3000 and R = 350."""
    hole = Loop(np.array([(1000.0, 1500.0, -1.0), (1400.0, 1500.0, -1.0)]))
    disc = Loop(np.array([(5000.0, 1500.0, 1.0), (5700.0, 1500.0, 1.0)]))
    return Outline(rounded_rectangle(2000, 3000, 350), (hole,)), Outline(disc, ())


TWO_PARTS_MM2 = (2000 * 3000 - (4 - np.pi) * 350**2) - np.pi * 200**2 + np.pi * 350**2


def rounded_rectangle(width_mm: float, height_mm: float, radius_mm: float) -> Loop:
    """From the origin, counter-clockwise, its corners true quarter circles."""
    w, h, r = width_mm, height_mm, radius_mm
    corners = [(r, 0), (w - r, 0), (w, r), (w, h - r), (w - r, h), (r, h), (0, h - r), (0, r)]
    bulges = [0.0, QUARTER_BULGE] * 4
    return Loop(np.column_stack((np.array(corners, dtype=float), bulges)))


def with_parts(result: Result, outlines: tuple[Outline, ...]) -> Result:
    """The same result with another area, as far as a writer looks at it."""
    area_mm2 = sum(outline.area_mm2() for outline in outlines)
    aoi = replace(result.aoi, outlines=outlines, area_mm2=area_mm2)
    return replace(result, aoi=aoi)


def with_plan(result: Result, plan: FloorPlan) -> Result:
    """The same result with another plan, as far as a writer looks at it."""
    return replace(result, search=replace(result.search, plan=plan))


def on_drawing(result: Result, path: Path, unit: str, frame: Frame) -> Result:
    """The same result as if its plan had been read from a DXF file."""
    source = Source(str(path), sha256(path.read_bytes()).hexdigest(), "dxf", unit, "header")
    return with_plan(result, replace(result.plan, source=source, frame=frame))
