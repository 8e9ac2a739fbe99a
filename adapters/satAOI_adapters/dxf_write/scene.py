"""What is drawn over the plan: fill and outline of the area, the start, and what was read."""

from typing import Final

from ezdxf.document import Drawing
from ezdxf.entities import DXFGraphic
from ezdxf.layouts import Modelspace

from satAOI_adapters.dxf_write.layers import (
    AOI,
    AOI_TRANSPARENCY,
    EDGE,
    KIND_COLOURS,
    OBSTACLE,
    START,
)
from satAOI_adapters.dxf_write.metadata import attach
from satAOI_adapters.dxf_write.pen import Pen
from satAOI_geo.pipeline import Result
from satAOI_geo.plan import polygons_in
from satAOI_geo.units import MM2_PER_M2

SORT_WHEN_DRAWN: Final = 16 | 32
"""Bits of the header variable $SORTENTS: keep the redraw order on the screen and on paper."""


def draw_area(space: Modelspace, result: Result) -> list[DXFGraphic]:
    """Draw each connected part as one hatch and its loops; the hatches are returned.

    Two parts in one hatch would be read by some programs as one part with a hole beside it.
    """
    fill_pen = Pen(space, result.plan.frame, AOI.name)
    edge_pen = Pen(space, result.plan.frame, EDGE.name)
    hatches: list[DXFGraphic] = []
    for number, outline in enumerate(result.aoi.outlines, start=1):
        facts = {
            "part": number,
            "area_m2": outline.area_mm2() / MM2_PER_M2,
            "connectivity": result.settings.connectivity,
            "robot": result.robot.name,
        }
        hatch = fill_pen.fill(outline)
        hatch.transparency = AOI_TRANSPARENCY
        # one reader swallows the entity after a hatch without extended data
        attach(hatch, facts)
        hatches.append(hatch)
        for loop in (outline.exterior, *outline.holes):
            attach(edge_pen.loop(loop), {"part": number})
    return hatches


def draw_start(space: Modelspace, result: Result) -> None:
    """Draw the disc at the start, with a cross and a point at its centre."""
    lattice, pen = result.lattice, Pen(space, result.plan.frame, START.name)
    iy, ix = result.search.start.node
    x_mm, y_mm = lattice.x_mm(ix), lattice.y_mm(iy)
    radius_mm = result.robot.disc_radius_mm
    pen.circle((x_mm, y_mm), radius_mm)
    pen.point((x_mm, y_mm))
    arm_mm = 1.25 * radius_mm
    pen.chain([(x_mm - arm_mm, y_mm), (x_mm + arm_mm, y_mm)])
    pen.chain([(x_mm, y_mm - arm_mm), (x_mm, y_mm + arm_mm)])


def draw_plan(space: Modelspace, result: Result) -> None:
    """Draw the floor's edge and the obstacles as they were read, coloured by kind."""
    plan = result.plan
    floor_pen = Pen(space, plan.frame, OBSTACLE.name)
    for polygon in polygons_in([plan.floor]):
        for entity in floor_pen.shape(polygon):
            attach(entity, {"kind": "floor", "source": plan.floor_source})
    for obstacle in plan.obstacles:
        pen = Pen(space, plan.frame, OBSTACLE.name, KIND_COLOURS[obstacle.kind])
        facts = {
            "kind": obstacle.kind.value,
            "layer": obstacle.layer,
            "handle": obstacle.handle,
        }
        for entity in pen.shape(obstacle.shape):
            attach(entity, facts)


def send_to_back(document: Drawing, hatches: list[DXFGraphic]) -> None:
    """Put hatches below everything else, for programs that keep either of the two orders.

    Some draw entities in the order of the file and know no transparency, others by a table of
    handles. The table deals the handles in use out again in the new order, as those programs do.
    """
    space = document.modelspace()
    behind = {hatch.dxf.handle for hatch in hatches}
    redrawn = [e.dxf.handle for e in space.entities_in_redraw_order()]
    wanted = [*sorted(behind, key=_as_number), *(h for h in redrawn if h not in behind)]
    dealt = zip(wanted, sorted(wanted, key=_as_number), strict=True)
    space.set_redraw_order([(own, sort) for own, sort in dealt if own != sort])
    entities = space.entity_space.entities
    entities[:] = [*hatches, *(e for e in entities if e.dxf.handle not in behind)]
    document.header["$SORTENTS"] = document.header.get("$SORTENTS", 0) | SORT_WHEN_DRAWN


def _as_number(handle: str) -> int:
    return int(handle, 16)
