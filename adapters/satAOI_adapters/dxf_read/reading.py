"""From a drawing to a floor plan: survey, obstacles, floor, frame."""

from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final

import numpy as np
import shapely
from shapely.geometry import LineString, box

from satAOI_adapters.collector import collector_at_rest
from satAOI_adapters.dxf_read.corner import from_corner
from satAOI_adapters.dxf_read.curves import Point
from satAOI_adapters.dxf_read.dashed import without_dashed
from satAOI_adapters.dxf_read.doors import (
    partition_findings,
    partitions,
    spans,
)
from satAOI_adapters.dxf_read.features import Feature
from satAOI_adapters.dxf_read.fills import fills_alone
from satAOI_adapters.dxf_read.floor import Floor, floor_of
from satAOI_adapters.dxf_read.floor_layers import outer_edges
from satAOI_adapters.dxf_read.glazing import between_rooms, with_marked_doors
from satAOI_adapters.dxf_read.left_out_doors import left_out_doors
from satAOI_adapters.dxf_read.marks import marks_of
from satAOI_adapters.dxf_read.nameless import with_nameless_walls
from satAOI_adapters.dxf_read.obstacles import Standing, solids, walls
from satAOI_adapters.dxf_read.openings import Still, shut, with_openings
from satAOI_adapters.dxf_read.options import ReadOptions
from satAOI_adapters.dxf_read.plans import Drawn, chosen, clusters, rough_lines, within
from satAOI_adapters.dxf_read.shapes import middle_line
from satAOI_adapters.dxf_read.start_marks import start_of
from satAOI_adapters.dxf_read.strays import Box
from satAOI_adapters.dxf_read.survey import Survey, survey
from satAOI_adapters.dxf_read.swings import parted, swings
from satAOI_adapters.dxf_read.terms import Terms
from satAOI_adapters.dxf_read.thresholds import without_thresholds
from satAOI_adapters.dxf_read.trenches import trenches
from satAOI_adapters.dxf_read.unclassified import LEFT_OUT, ROOM, unclassified
from satAOI_adapters.dxf_read.units import hold_size
from satAOI_adapters.dxf_read.windows import window_findings, windows
from satAOI_adapters.meanings import KINDS, Meaning
from satAOI_geo.errors import InputError
from satAOI_geo.plan import (
    Finding,
    FloorPlan,
    Frame,
    Kind,
    Obstacle,
    Region,
)

SOLID_KINDS: Final = (Kind.COLUMN, Kind.HOLE, Kind.EMBEDDED, Kind.EQUIPMENT)
"""Kinds whose closed outlines are solid however wide they are."""


ON_EDGE_MM: Final = 1e-3
"""An obstacle this close to the floor reaches it."""


def read(path: Path, options: ReadOptions) -> FloorPlan:
    """The floor plan in a DXF file.

    Raises:
        InputError: If an option or the layer file is wrong.
        DrawingError: If the drawing cannot be used as it is.
        LimitError: If it asks for more than `limits` allows.
    """
    with collector_at_rest():
        return plan_of(survey(path, options), options)


def plan_of(drawing: Survey, options: ReadOptions) -> FloorPlan:
    """The floor plan in a drawing that has been surveyed; errors as for `read`."""
    if drawing.fault is not None:
        raise drawing.fault
    _refuse_nowhere(options.region, drawing.box)
    frame = drawing.frame()
    start_mm, start_findings = start_of(drawing, frame, options)
    everything = drawing.drawn(frame, (*KINDS, Meaning.FLOOR, Meaning.DOOR, None))
    chosen_part, choice = _chosen(everything, options, start_mm, frame)
    hold_size(drawing.unit, _size_mm(chosen_part, options, frame), drawing.path.name)
    marks = marks_of(drawing.expansion.placed, frame)
    named, of_marks = with_marked_doors(_with_doors(chosen_part), marks, frame)
    terms = Terms(
        frame,
        options.close_gaps_mm,
        drawing.is_named,
        _region_mm(options, frame),
        drawing.given_layers(Meaning.FLOOR),
    )
    drawn, of_nameless = with_nameless_walls(named, drawing.dashed, terms)
    standing = _standing(drawn, terms, drawing)
    sills = spans(drawn[Meaning.DOOR], [o.region() for o in standing.obstacles])
    floor = floor_of(drawn[Meaning.FLOOR], standing.obstacles, sills, terms)
    between = trenches(drawn, standing.obstacles, floor.region, terms)
    others = unclassified(
        [*drawn[None], *floor.others], floor.region, standing.obstacles, drawing.dashed, frame
    )
    plan = FloorPlan(
        floor=floor.region,
        obstacles=_on(floor.region, (*standing.obstacles, *between.obstacles, *others.obstacles)),
        findings=(
            *drawing.findings,
            *choice,
            *of_nameless,
            *standing.findings,
            *left_out_doors(drawing.seen, standing.obstacles, terms),
            *of_marks,
            *between_rooms(drawn, floor.region, standing.obstacles, frame),
            *floor.findings,
            *between.findings,
            *_news(others, floor),
            *start_findings,
        ),
        floor_source=floor.source,
        frame=frame,
        source=drawing.source(),
        start_mm=start_mm,
    )
    return from_corner(plan)


def _chosen(
    drawn: Drawn, options: ReadOptions, start_mm: Point | None, frame: Frame
) -> tuple[Drawn, tuple[Finding, ...]]:
    """What belongs to the plan that is read, and what is to be said about the rest."""
    region_mm = _region_mm(options, frame)
    if region_mm is not None:
        kept, n_left_out = within(drawn, box(*region_mm))
        return kept, _left_out(n_left_out, "the region")
    cluster, findings = chosen(clusters(drawn), options.plan, start_mm, frame)
    if cluster is None:
        return drawn, findings
    kept, n_left_out = within(drawn, cluster.hull)
    return kept, (*findings, *_left_out(n_left_out, "the plan"))


def _size_mm(drawn: Drawn, options: ReadOptions, frame: Frame) -> tuple[float, float] | None:
    """Width and height of the region, or of what layers name as standing in a plan or its floor."""
    named = [feature for meaning in (*KINDS, Meaning.FLOOR) for feature in drawn[meaning]]
    region_mm = _region_mm(options, frame)
    if not named and region_mm is None:
        return None
    left, bottom, right, top = region_mm or shapely.total_bounds(rough_lines(named))
    return float(right - left), float(top - bottom)


def _region_mm(options: ReadOptions, frame: Frame) -> tuple[float, float, float, float] | None:
    """The part that the user wants read, in the plan's frame."""
    if options.region is None:
        return None
    corners = frame.to_local_mm(np.reshape(options.region, (2, 2)))
    (left, bottom), (right, top) = np.min(corners, axis=0), np.max(corners, axis=0)
    if not (left < right and bottom < top):
        raise InputError("the region has no area; give left,bottom,right,top in drawing units")
    return float(left), float(bottom), float(right), float(top)


def _refuse_nowhere(region: Box | None, drawn: Box | None) -> None:
    """Refuse a region with nothing of the drawing in it, both in drawing units.

    Raises:
        InputError: If that is so.
    """
    if region is None or drawn is None or box(*region).intersects(box(*drawn)):
        return
    left, bottom, right, top = (f"{value:.12g}" for value in drawn)
    raise InputError(
        f"nothing of the drawing lies in the region: it is drawn from ({left}, {bottom}) to "
        f"({right}, {top}) in drawing units; give another --region"
    )


def _left_out(counts: Counter[Meaning | None], what: str) -> tuple[Finding, ...]:
    if not counts.total():
        return ()
    of_kinds = ", ".join(f"{counts[meaning]} {meaning}" for meaning in KINDS if counts[meaning])
    return (
        Finding(
            "left-out",
            f"{counts.total()} entities outside {what} are left out"
            + (f", of obstacles {of_kinds}" if of_kinds else ""),
            "choose another part with --plan N or --region if they belong to the floor",
        ),
    )


def _with_doors(drawn: Drawn) -> Drawn:
    """What is drawn, with doors on nameless layers among the doors."""
    rest, doors = parted(drawn[None], swings(drawn[None]))
    return {**drawn, None: rest, Meaning.DOOR: [*drawn[Meaning.DOOR], *doors]}


def _standing(drawn: Drawn, terms: Terms, drawing: Survey) -> Standing:
    """The obstacles of all kinds that layers name."""
    by_kind: dict[Kind, list[Feature]] = {kind: [] for kind in Kind}
    for meaning, kind in KINDS.items():
        by_kind[kind].extend(drawn[meaning])
    parts = [solids(by_kind[kind], kind, terms) for kind in SOLID_KINDS]
    columns = parts[SOLID_KINDS.index(Kind.COLUMN)].obstacles
    parts.append(_walls(by_kind[Kind.WALL], drawn, columns, terms, drawing))
    known = [obstacle for part in parts for obstacle in part.obstacles]
    parts.append(fills_alone(drawing, drawn, known, terms))
    return Standing(
        tuple(obstacle for part in parts for obstacle in part.obstacles),
        tuple(finding for part in parts for finding in part.findings),
    )


def _walls(
    on_walls: Sequence[Feature],
    drawn: Drawn,
    columns: Sequence[Obstacle],
    terms: Terms,
    drawing: Survey,
) -> Standing:
    """The walls: what is drawn on their layers and on those of doors, open where doors are."""
    doors_on_walls = swings(on_walls)
    drawn_as_walls, _ = parted(on_walls, doors_on_walls)
    drawn_as_walls, of_dashes = without_dashed(drawn_as_walls, drawing.dashed, terms.frame)
    faces = _lines(drawn_as_walls)
    # panels of overhead doors are drawn dashed, walls and windows are not
    in_lines = [f for f in drawn[Meaning.DOOR] if id(f.placed) not in drawing.dashed]
    on_door_layers = partitions(in_lines, faces, drawing.door_blocks)
    glazed = windows(in_lines, faces, drawing.door_blocks)
    # a drawing with layers for windows has none on those of its doors
    are_doors = drawing.has(Meaning.WINDOW)
    panes = [] if are_doors else [pane for window in glazed for pane in window]
    edges = outer_edges(drawn[Meaning.FLOOR])
    doors_on_layers = swings(drawn[Meaning.DOOR])
    doors = [*doors_on_walls, *doors_on_layers]
    of_doors = [*_lines(drawn[Meaning.DOOR]), *(span.line for door in doors for span in shut(door))]
    whole = walls([*drawn_as_walls, *on_door_layers, *panes], columns, edges, of_doors, terms)
    rest, _ = parted(drawn[Meaning.DOOR], doors_on_layers)
    walls_too = {id(feature.placed) for feature in (*on_door_layers, *panes)}
    still = Still.of([feature for feature in rest if id(feature.placed) not in walls_too])
    standing = without_thresholds(
        with_openings(whole, doors, drawing.masks_of_doors(terms.frame), still, terms), doors, terms
    )
    return Standing(
        standing.obstacles,
        (
            *standing.findings,
            *partition_findings(on_door_layers),
            *window_findings(glazed, terms, are_doors=are_doors),
            *_doors_among_walls(len(doors_on_walls)),
            *of_dashes,
        ),
    )


def _doors_among_walls(count: int) -> tuple[Finding, ...]:
    if not count:
        return ()
    return (
        Finding(
            "door-among-walls",
            f"{count} doors, each an arc with a leaf, are drawn among walls and windows: arcs and "
            "leaves are left out",
            "draw doors on a layer of their own",
        ),
    )


def _lines(drawn: Sequence[Feature]) -> list[LineString]:
    return [middle_line(path) for feature in drawn for path in feature.paths]


def _news(others: Standing, floor: Floor) -> Iterator[Finding]:
    """The findings about nameless shapes, but those that the floor's say already.

    Where floor layers are not believed, that is said; their lines, patterns and outlines of rooms
    need no second word, what stops the robot does.
    """
    layers = {feature.placed.layer for feature in floor.others}
    for finding in others.findings:
        if finding.layer not in layers or finding.code not in (ROOM, LEFT_OUT):
            yield finding


def _on(floor: Region, obstacles: Sequence[Obstacle]) -> tuple[Obstacle, ...]:
    """The obstacles that reach the floor; beyond it everything is closed to the robot anyway."""
    shapely.prepare(floor)
    near = shapely.dwithin(floor, [obstacle.region() for obstacle in obstacles], ON_EDGE_MM)
    return tuple(obstacle for obstacle, is_near in zip(obstacles, near, strict=True) if is_near)
