"""What is drawn over the plan: the area, what it leaves, the start, and what was read."""

import math
from itertools import chain, islice
from typing import Final

from ezdxf.entities import DXFGraphic
from ezdxf.layouts import Modelspace
from ezdxf.lldxf.const import MTEXT_MIDDLE_CENTER

from satAOI_adapters.arcs import outlines_with_arcs
from satAOI_adapters.dxf_write.layers import (
    AOI,
    EDGE,
    KIND_COLOURS,
    LABEL_COLOUR,
    OBSTACLE,
    START,
    TEXT_STYLE,
    TRANSPARENCY,
    UNREACHED,
    UPPER,
    ZONE,
    Style,
)
from satAOI_adapters.dxf_write.metadata import Facts, attach
from satAOI_adapters.dxf_write.pen import Pen
from satAOI_geo.aoi import Outline
from satAOI_geo.pipeline import Result
from satAOI_geo.plan import polygons_in
from satAOI_geo.reasons import Patch, Reason
from satAOI_geo.units import MM2_PER_M2

LABELLED_MM2: Final = 10_000.0
"""Patches below this have no label: it would read 0.00 m² or hardly more."""

LETTERS_ACROSS: Final = 9
"""Letters for which a patch must have room side by side."""

SORT_WHEN_DRAWN: Final = 16 | 32
"""Bits of the header variable $SORTENTS: keep the redraw order on the screen and on paper."""


def draw_area(space: Modelspace, result: Result) -> list[DXFGraphic]:
    """Draw each connected part as one hatch and its loops; the hatches are returned.

    Two parts in one hatch would be read by some programs as one part with a hole beside it.
    """
    edge_pen = Pen(space, result.plan.frame, EDGE.name)
    hatches: list[DXFGraphic] = []
    for number, outline in enumerate(result.aoi.outlines, start=1):
        facts = {
            "part": number,
            "area_m2": outline.area_mm2() / MM2_PER_M2,
            "connectivity": result.settings.connectivity,
            "robot": result.robot.name,
        }
        hatches.append(_filled(space, result, AOI, outline, facts))
        for edge in edge_pen.loops([outline.exterior, *outline.holes]):
            attach(edge, {"part": number})
    return hatches


def draw_unreached(space: Modelspace, result: Result, letter: float) -> list[DXFGraphic]:
    """Fill and label the free floor that is not reached; the hatches are returned.

    Strips narrower and specks smaller than a lattice cell are left to the report.

    Args:
        space: Where to draw.
        result: The area of interest and the patches beside it.
        letter: Greatest height of a label, in drawing units.
    """
    shown = [
        patch
        for patch in result.patches
        if not patch.narrow and patch.area_mm2 >= result.lattice.step_mm**2
    ]
    polygons = [polygons_in([patch.region]) for patch in shown]
    outlines = iter(outlines_with_arcs(list(chain.from_iterable(polygons))))
    hatches: list[DXFGraphic] = []
    for patch, own in zip(shown, polygons, strict=True):
        facts = {
            "area_m2": patch.area_mm2 / MM2_PER_M2,
            "reason": patch.reason.value,
            "blocker": patch.blocker.handle if patch.blocker else "",
        }
        style = UPPER if patch.reason is Reason.PATH else UNREACHED
        hatches += [
            _filled(space, result, style, outline, facts) for outline in islice(outlines, len(own))
        ]
        if patch.area_mm2 >= LABELLED_MM2:
            _label(space, result, patch, letter)
    return hatches


def draw_zones(space: Modelspace, result: Result) -> None:
    """Draw the outline of what each set-down can trowel."""
    pen = Pen(space, result.plan.frame, ZONE.name)
    loops = [
        (figures, loop)
        for zone, figures in zip(result.zones, result.report.zones, strict=True)
        for outline in zone.outlines
        for loop in (outline.exterior, *outline.holes)
    ]
    edges = pen.loops([loop for _, loop in loops])
    for (figures, _), edge in zip(loops, edges, strict=True):
        attach(edge, {"zone": figures.number, "area_m2": figures.area_m2})


def draw_start(space: Modelspace, result: Result) -> None:
    """Draw the disc at the start, a circle and a cross: read again, the circle marks the start."""
    lattice, pen = result.lattice, Pen(space, result.plan.frame, START.name)
    iy, ix = result.search.start.node
    x_mm, y_mm = lattice.x_mm(ix), lattice.y_mm(iy)
    radius_mm = result.robot.disc_radius_mm
    pen.circle((x_mm, y_mm), radius_mm)
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


def send_to_back(space: Modelspace, hatches: list[DXFGraphic]) -> None:
    """Put hatches below everything else, the first of them lowest.

    Some draw entities in the order of the file and know no transparency, others by a table of
    handles. The table deals the handles in use out again in the new order, as those programs do.
    """
    behind = {hatch.dxf.handle for hatch in hatches}
    redrawn = [e.dxf.handle for e in space.entities_in_redraw_order()]
    wanted = [*sorted(behind, key=_as_number), *(h for h in redrawn if h not in behind)]
    dealt = zip(wanted, sorted(wanted, key=_as_number), strict=True)
    space.set_redraw_order([(own, sort) for own, sort in dealt if own != sort])
    entities = space.entity_space.entities
    entities[:] = [*hatches, *(e for e in entities if e.dxf.handle not in behind)]
    header = space.doc.header
    header["$SORTENTS"] = header.get("$SORTENTS", 0) | SORT_WHEN_DRAWN


def _filled(
    space: Modelspace, result: Result, style: Style, outline: Outline, facts: Facts
) -> DXFGraphic:
    """A hatch on a layer that says what it stands for."""
    hatch = Pen(space, result.plan.frame, style.name).fill(outline)
    hatch.transparency = TRANSPARENCY
    # one reader swallows the entity after a hatch without extended data
    attach(hatch, facts)
    return hatch


def _label(space: Modelspace, result: Result, patch: Patch, letter: float) -> None:
    """Write area and reason into a patch, no larger than it has room for."""
    frame = result.plan.frame
    room = math.sqrt(patch.area_mm2) / frame.mm_per_unit / LETTERS_ACROSS
    space.add_mtext(
        f"{patch.area_mm2 / MM2_PER_M2:.2f} m²\\P{patch.reason.value}",
        dxfattribs={
            "layer": UNREACHED.name,
            "style": TEXT_STYLE,
            "color": LABEL_COLOUR,
            "char_height": min(letter, room),
            "attachment_point": MTEXT_MIDDLE_CENTER,
            "insert": tuple(frame.to_drawing(patch.label_mm)),
        },
    )


def _as_number(handle: str) -> int:
    return int(handle, 16)
