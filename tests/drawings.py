"""Small DXF drawings made for a test, and what is asked of the plans read from them."""

from collections.abc import Callable
from pathlib import Path

import ezdxf
from ezdxf.document import Drawing
from ezdxf.layouts import BaseLayout, Modelspace

from satAOI_adapters.dxf_read import ReadOptions, read
from satAOI_geo.plan import FloorPlan, Obstacle

MM, CM, M, INCH = 4, 5, 6, 1

Draw = Callable[[Modelspace], None]


def drawing(*, unit: int = MM, floor: bool = True) -> Drawing:
    """An empty drawing, or one with a floor of 10 × 10 m (were its unit a millimetre)."""
    document = ezdxf.new("R2010")
    document.header["$INSUNITS"] = unit
    if floor:
        rectangle(document.modelspace(), 0, 0, 10_000, 10_000, layer="FLOOR")
    return document


def rectangle(space: BaseLayout, x0: float, y0: float, x1: float, y1: float, *, layer: str) -> None:
    """A closed polyline along the axes."""
    corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
    space.add_lwpolyline(corners, close=True, dxfattribs={"layer": layer})


def plan_of(document: Drawing, folder: Path, **options: object) -> FloorPlan:
    """The plan read from a drawing."""
    path = folder / "plan.dxf"
    document.saveas(path)
    return read(path, ReadOptions(**options))  # type: ignore[arg-type]


def standing(plan: FloorPlan, layer: str) -> list[Obstacle]:
    """The obstacles of a plan that come from one layer."""
    return [obstacle for obstacle in plan.obstacles if obstacle.layer == layer]


def codes(plan: FloorPlan) -> list[str]:
    """The codes of a plan's findings."""
    return [finding.code for finding in plan.findings]
