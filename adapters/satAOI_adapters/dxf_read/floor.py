"""The floor: as drawn on its layer, or inferred from the walls around it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

import shapely
from shapely.geometry import LineString, Polygon, box
from shapely.geometry.base import BaseGeometry

from satAOI_adapters.dxf_read.enclosure import OPENING_MM, Enclosed, enclosed
from satAOI_adapters.dxf_read.features import Feature
from satAOI_adapters.dxf_read.floor_layers import (
    Shown,
    middle,
    only_lines,
    open_outline,
    said,
    shown_by,
)
from satAOI_adapters.dxf_read.linework import WALL_MM
from satAOI_adapters.dxf_read.options import CLOSE_GAPS_MM
from satAOI_adapters.dxf_read.shapes import TIE_MM, is_thin, tidy
from satAOI_adapters.dxf_read.terms import Terms
from satAOI_adapters.layers import without_xref_prefix
from satAOI_adapters.wording import are, counted
from satAOI_geo.errors import EmptyPlanError
from satAOI_geo.plan import Finding, Kind, Obstacle, Region, polygons_in

BOUNDING: Final = frozenset({Kind.WALL, Kind.COLUMN})
"""Obstacles that an inferred floor reaches out to; a machine outdoors does not bound it."""


PLAIN: Final = "FLOOR"
"""A layer of this name shows the floor, however little it shows; findings ask for it."""

MOST: Final = 2 / 3
"""A layer that shows less of what walls enclose may show the finish of some rooms."""

ROOM_MM: Final = 1000.0
"""What walls enclose and no layer shows is said where it is wider than this."""

FEW: Final = 0.02
"""Fewer of the walls may lie beside the floor in silence."""

MIDST_MM: Final = 150.0
"""An edge farther from walls than this lies in the midst of the floor."""


@dataclass(frozen=True, slots=True)
class Floor:
    """The floor and how it is known.

    Attributes:
        region: In the plan's frame.
        source: `layer` or `inferred`.
        findings: What is to be said about it.
        others: What floor layers show that is not the floor, but things on it.
    """

    region: Region
    source: str
    findings: tuple[Finding, ...] = ()
    others: tuple[Feature, ...] = ()


def floor_of(
    drawn: Sequence[Feature],
    obstacles: Sequence[Obstacle],
    sills: Sequence[LineString],
    terms: Terms,
) -> Floor:
    """The floor of a plan.

    Args:
        drawn: What is on floor layers.
        obstacles: What bounds the floor where no layer does.
        sills: Lines across openings, which close them.
        terms: The terms of the reading.

    Raises:
        DrawingError: If the outline on a floor layer is not closed and no walls enclose a floor.
        EmptyPlanError: If there is nothing on a floor layer and nothing is enclosed by walls.
    """
    bounds = [o.region() for o in obstacles if o.kind in BOUNDING]
    shown = shown_by(drawn, obstacles, terms) if drawn else None
    if shown is not None and _is_all(shown.region, bounds):
        floor = _as_shown(shown)
    else:
        within = enclosed([*bounds, *sills], with_gates=terms.is_named)
        floor = (
            _inferred(within, obstacles, terms)
            if shown is None
            else _shown(shown, within, bounds, terms)
        )
    if terms.region_mm is None:
        return floor
    region = tidy(floor.region.intersection(box(*terms.region_mm)))
    return replace(floor, region=region)


def _is_all(region: Region, bounds: Sequence[BaseGeometry]) -> bool:
    """Whether one outline leaves out no room: of the walls' hull no more than the walls."""
    if not bounds or region.is_empty or not isinstance(region, Polygon):
        return False
    rest = shapely.union_all(bounds).convex_hull.difference(region)
    return rest.is_empty or is_thin(rest, WALL_MM)


def _as_shown(shown: Shown) -> Floor:
    return Floor(shown.region, "layer", (*shown.cut_out, *shown.findings))


def _shown(shown: Shown, within: Enclosed, bounds: Sequence[BaseGeometry], terms: Terms) -> Floor:
    """The floor that layers show, or what walls enclose where these layers show something else."""
    if within.region.is_empty:
        if shown.region.is_empty:
            raise open_outline(shown, terms)
        if is_thin(shown.region, WALL_MM):
            raise only_lines(shown)
        return _as_shown(shown)
    holes = shapely.union_all(shown.holes)
    free = within.region.difference(shapely.union_all([*bounds, holes]))
    covers_most = shown.region.intersection(free).area >= MOST * free.area
    if covers_most or _is_meant(shown, free, terms):
        floor = _with_doorways(shown, free, terms)
        return replace(floor, findings=(*floor.findings, *_in_part(shown, free, terms)))
    return Floor(
        tidy(within.region.difference(holes)),
        "inferred",
        (_finish(shown, free, terms), *shown.cut_out, *_of_openings(within, terms)),
        others=shown.features,
    )


def _is_meant(shown: Shown, free: BaseGeometry, terms: Terms) -> bool:
    """Whether layers that show a part of what walls enclose show where the floor ends.

    They do where their name leaves no doubt, and where an outline has an edge in the midst of the
    floor. What ends at walls and doors is the finish of some rooms; so is a pattern, and what is
    small is something on the floor.
    """
    names = {feature.placed.layer for feature in shown.features}
    if not shown.region.is_empty and not terms.given_floors.isdisjoint(names):
        return True
    if PLAIN in {without_xref_prefix(name).upper() for name in names}:
        return not is_thin(shown.region, WALL_MM)
    if all(feature.is_area for feature in shown.features) or is_thin(shown.region, OPENING_MM):
        return False
    edges = shapely.line_merge(shown.region.boundary.intersection(free.buffer(-MIDST_MM)))
    return bool(shapely.length(shapely.get_parts(edges)).max(initial=0.0) > OPENING_MM)


def _with_doorways(shown: Shown, free: BaseGeometry, terms: Terms) -> Floor:
    """The floor that layers show, with the doorways between the rooms that they show one by one."""
    rooms = shapely.STRtree(polygons_in([shown.region]))
    if len(rooms.geometries) < 2:
        return _as_shown(shown)
    gaps = polygons_in([free.difference(shown.region)])
    joints = [
        gap
        for gap in gaps
        if is_thin(gap, WALL_MM)
        and rooms.query(gap, predicate="dwithin", distance=CLOSE_GAPS_MM).size > 1
    ]
    if not joints:
        return _as_shown(shown)
    floor = _as_shown(shown)
    return replace(
        floor,
        region=tidy(shapely.union_all([floor.region, *joints])),
        findings=(*floor.findings, _joined_rooms(joints, shown, terms)),
    )


def _inferred(within: Enclosed, obstacles: Sequence[Obstacle], terms: Terms) -> Floor:
    if not within.region.is_empty:
        closed_mm = OPENING_MM if within.opening is None else within.opening.length
        finding = Finding(
            "floor-inferred",
            "no layer shows the floor: it is what the walls enclose, "
            f"{within.region.area / 1e6:.2f} m² with them, openings of up to "
            f"{max(OPENING_MM, round(closed_mm, -1)) / 1000:g} m closed",
            "draw its outline on a layer FLOOR",
        )
        return Floor(within.region, "inferred", (finding, *_of_openings(within, terms)))
    if terms.region_mm is not None:
        return Floor(box(*terms.region_mm), "inferred", (_of_region(),))
    if not terms.is_named:
        raise EmptyPlanError(
            "no layer shows the floor, and the lines enclose nothing with openings of up to "
            f"{OPENING_MM / 1000:g} m closed; draw the floor's outline on a layer FLOOR, or name "
            "its layer in a file for --layers, or give the part to read with --region"
        )
    return _guessed([o.region() for o in obstacles])


def _of_openings(within: Enclosed, terms: Terms) -> Iterator[Finding]:
    """What is to be said about walls and openings in them, where some are unusual."""
    opening = within.opening
    if opening is not None and opening.length > OPENING_MM + TIE_MM:
        x_mm, y_mm = terms.place(opening.interpolate(0.5, normalized=True).coords[0])
        yield Finding(
            "wide-opening-closed",
            f"many walls would lie beside the floor: openings wider than {OPENING_MM / 1000:g} m "
            f"are closed, the widest of {opening.length / 1000:.2f} m at ({x_mm:.1f}, {y_mm:.1f}) "
            "mm",
            "draw a line across each opening on a layer GATE, or the floor's outline on a layer "
            "FLOOR",
            at_mm=(x_mm, y_mm),
        )
    if within.left_out > FEW:
        yield Finding(
            "walls-left-out",
            f"{within.left_out:.0%} of the walls lie beside the floor that the others enclose",
            "draw a line across openings wider than "
            f"{OPENING_MM / 1000:g} m on a layer GATE, or the floor's outline on a layer FLOOR",
        )


def _of_region() -> Finding:
    return Finding(
        "floor-region",
        "no layer shows the floor and the walls in the region do not enclose any: all of the "
        "region counts as floor",
        "draw the floor's outline on a layer FLOOR",
    )


def _guessed(regions: Sequence[BaseGeometry]) -> Floor:
    """The hull of all obstacles: better than nothing, and said."""
    hull = shapely.union_all(regions).convex_hull
    if not isinstance(hull, Polygon):
        raise EmptyPlanError(
            "the drawing holds no floor and nothing that could enclose one; draw the floor's "
            "outline on a layer FLOOR"
        )
    return Floor(
        tidy(hull),
        "inferred",
        (
            Finding(
                "floor-guessed",
                "no layer shows the floor and the walls do not enclose any: it is guessed as what "
                f"a taut string around all obstacles would hold, {hull.area / 1e6:.2f} m²; where "
                "it really ends is not known",
                "draw its outline on a layer FLOOR, or give the part to read with --region",
            ),
        ),
    )


def _shares(shown: Shown, free: BaseGeometry) -> str:
    covered_m2 = shown.region.intersection(free).area / 1e6
    return (
        f"{covered_m2:.2f} of the {free.area / 1e6:.2f} m² that walls enclose are shown on "
        f"{shown.layers}"
    )


def _in_part(shown: Shown, free: BaseGeometry, terms: Terms) -> Iterator[Finding]:
    rest = polygons_in([free.difference(shown.region)])
    rooms = [part for part in rest if not is_thin(part, ROOM_MM)]
    if rooms:
        yield said(
            "floor-in-part",
            f"{_shares(shown, free)}: the rest is taken as no floor",
            "draw the outline of all of it on a layer FLOOR if the robot is to trowel the rest, "
            "too",
            shown.first,
            terms.place(middle(max(rooms, key=lambda part: part.area))),
        )


def _finish(shown: Shown, free: BaseGeometry, terms: Terms) -> Finding:
    is_open = shown.region.is_empty and not shown.holes
    what = (
        f"nothing of the floor is shown on {shown.layers} but open lines, as of thresholds and "
        "steps"
        if is_open
        else f"{_shares(shown, free)}, as finishes of single rooms and edges of steps do"
    )
    return said(
        "floor-not-shown",
        f"{what}: the floor is taken as all that walls enclose",
        "draw the floor's outline on a layer FLOOR, or say in a file for --layers that the layer "
        "is the floor, if it ends there",
        shown.first,
        terms.place(shown.first.paths[0].start),
    )


def _joined_rooms(joints: Sequence[Polygon], shown: Shown, terms: Terms) -> Finding:
    return said(
        "doorways-joined",
        f"the floor is shown room by room on {shown.layers}: {counted(len(joints), 'doorway')} "
        f"between the rooms, {sum(joint.area for joint in joints) / 1e6:.2f} m² together, "
        f"{are(len(joints))} taken as floor",
        "draw the floor's outline on a layer FLOOR if the rooms are apart",
        shown.first,
        terms.place(middle(joints[0])),
    )
