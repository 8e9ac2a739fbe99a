"""Where the robot is set down: as the user says, or as the drawing marks it."""

from itertools import chain
from typing import Final

from ezdxf.entities import Circle as CircleEntity
from ezdxf.entities import DXFEntity, DXFGraphic, Insert
from ezdxf.entities import Point as PointEntity
from ezdxf.math import Vec3

from satAOI_adapters.dxf_read.curves import Point
from satAOI_adapters.dxf_read.expand import space_of
from satAOI_adapters.dxf_read.options import ReadOptions
from satAOI_adapters.dxf_read.placement import rounded_spot
from satAOI_adapters.dxf_read.survey import Survey
from satAOI_adapters.wording import are, counted
from satAOI_geo.plan import Finding, Frame

START_LAYER: Final = "SATAOI-START"
"""A POINT, CIRCLE or INSERT on this layer marks the disc's centre at the start."""


def start_of(
    drawing: Survey, frame: Frame, options: ReadOptions
) -> tuple[Point | None, tuple[Finding, ...]]:
    """The start that the user gives or the drawing marks, and what is to be said about it."""
    if options.start is not None:
        return rounded_spot(*frame.to_local_mm(options.start).tolist()), ()
    marks, n_others = _marks(drawing)
    if not marks:
        return None, (_unread_marks(n_others),) if n_others else ()
    start_mm = rounded_spot(*frame.to_local_mm(marks[0]).tolist())
    if len(marks) == 1:
        return start_mm, ()
    return start_mm, (
        Finding(
            "start-ambiguous",
            f"{len(marks)} marks on layer {START_LAYER}: the first one is used",
            "leave one, or give --start",
            layer=START_LAYER,
        ),
    )


def _unread_marks(count: int) -> Finding:
    return Finding(
        "start-unread",
        f"{counted(count, 'entity', 'entities')} on layer {START_LAYER} {are(count)} no mark: the "
        "start is chosen as if there were none",
        "draw a point, a circle or a block reference there, or give --start",
        layer=START_LAYER,
    )


def _marks(drawing: Survey) -> tuple[list[Point], int]:
    """Where the start is marked, in drawing units, and how many other entities are on that layer.

    A mark may be a block reference, whose place counts and not what is in it; and the whole plan
    may be in one, with the mark.
    """
    space, _ = space_of(drawing.document)
    on_top = [
        entity
        for entity in space
        if isinstance(entity, DXFGraphic) and entity.dxf.layer.upper() == START_LAYER
    ]
    references = {str(entity.dxf.handle) for entity in on_top if isinstance(entity, Insert)}
    places = [_places(entity) for entity in on_top]
    places += [
        [(place.x, place.y) for place in placed.matrix.transform_vertices(_places(placed.entity))]
        for placed in drawing.expansion.placed
        if placed.blocks and placed.layer.upper() == START_LAYER and placed.handle not in references
    ]
    return list(chain.from_iterable(places)), sum(not place for place in places)


def _places(entity: DXFEntity) -> list[Point]:
    """Where a mark is, in the units of the drawing or of the block it is in."""
    if isinstance(entity, PointEntity):
        place = entity.dxf.location
    elif isinstance(entity, CircleEntity):
        place = entity.ocs().to_wcs(entity.dxf.center)
    elif isinstance(entity, Insert):
        place = entity.ocs().to_wcs(entity.dxf.insert)
    else:
        return []
    return [(Vec3(place).x, Vec3(place).y)]
