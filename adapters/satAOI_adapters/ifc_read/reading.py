"""From a file to a floor plan: checks, the geometry process, the plan's frame."""

import hashlib
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np
import shapely
from shapely.geometry import LineString
from shapely.geometry.base import BaseGeometry

from satAOI_adapters.ifc_read import text
from satAOI_adapters.ifc_read.options import IfcOptions
from satAOI_adapters.ifc_read.parsable import alias_findings, has_raw_names, parsable
from satAOI_adapters.ifc_read.process import answered
from satAOI_adapters.ifc_read.records import Inspected, ModelRecord, Read, Request, Storey
from satAOI_geo.plan import (
    Circle,
    Finding,
    FloatArray,
    FloorPlan,
    Frame,
    Obstacle,
    Source,
    as_region,
    polygons_in,
)
from satAOI_geo.progress import Progress

DIGITS: Final = 5
"""Decimals of a millimetre that are kept: georeferenced coordinates are noise beyond them."""

BYTES_PER_MB: Final = 1_000_000

BASE_MB: Final = 1000
"""Address space of the geometry process: its libraries take 360 MB of it."""

MB_PER_FILE_MB: Final = 50
"""More of it for each megabyte of the model, which itself takes about 20."""


@dataclass(frozen=True, slots=True)
class Inspection:
    """What a model holds, before anything is read.

    Attributes:
        source: The file.
        schema_name: For example IFC4.
        mm_per_unit: Millimetres in the model's unit of length.
        storeys: Lowest first, with heights and counts of walls, columns, slabs and openings.
        classes: Number of products of each class.
        findings: What is odd about it.
    """

    source: Source
    schema_name: str
    mm_per_unit: float
    storeys: tuple[Storey, ...]
    classes: dict[str, int]
    findings: tuple[Finding, ...]


def read(path: Path, options: IfcOptions, progress: Progress | None = None) -> FloorPlan:
    """A storey of a model as a floor plan.

    The plan's x and y are those of the model; a map conversion is not applied.

    Raises:
        InputError: If an option is wrong, or the storey has to be chosen.
        DrawingError: If the model cannot be used as it is.
        LimitError: If it takes more time or memory than allowed.
    """
    data = text.read_bytes(path)
    with parsable(path, data) as parsed:
        request = _request(path, parsed, data, options)
        answer = answered(request, Read, timeout_s=options.timeout_s, progress=progress)
    plan = plan_of(answer, _source(path, data, answer.model, options))
    return replace(plan, findings=(*alias_findings(data), *plan.findings))


def inspect(path: Path, options: IfcOptions) -> Inspection:
    """What a model holds: storeys with their heights, classes, unit.

    Raises:
        InputError: If the unit given is unknown.
        DrawingError: If the model cannot be used as it is.
    """
    data = text.read_bytes(path)
    with parsable(path, data) as parsed:
        request = _request(path, parsed, data, options, only_inspect=True)
        model = answered(request, Inspected, timeout_s=options.timeout_s).model
    return Inspection(
        source=_source(path, data, model, options),
        schema_name=model.schema_name,
        mm_per_unit=model.mm_per_unit,
        storeys=tuple(model.storeys),
        classes=model.classes,
        findings=(*alias_findings(data), *model.findings),
    )


def _request(
    path: Path, parsed: Path, data: bytes, options: IfcOptions, *, only_inspect: bool = False
) -> Request:
    file_mb = len(data) / BYTES_PER_MB
    memory_mb = options.memory_mb
    if memory_mb is None:
        memory_mb = math.ceil(BASE_MB + MB_PER_FILE_MB * file_mb)
    return Request(
        path=str(path),
        parsed=str(parsed),
        options=options,
        file_mb=file_mb,
        memory_mb=memory_mb,
        bad_ids=frozenset(text.ids_with_bad_numbers(data)),
        raw_names=has_raw_names(data),
        only_inspect=only_inspect,
    )


def _source(path: Path, data: bytes, model: ModelRecord, options: IfcOptions) -> Source:
    return Source(
        path=str(path),
        sha256=hashlib.sha256(data).hexdigest(),
        format="ifc",
        unit=model.unit,
        unit_source="header" if options.units is None else "option",
    )


def plan_of(answer: Read, source: Source) -> FloorPlan:
    """The plan in an answer: near the origin, and rounded to `DIGITS`."""
    floor = answer.region()
    left_mm, bottom_mm = (float(np.floor(corner_mm)) for corner_mm in floor.bounds[:2])
    shift_mm = np.array((-left_mm, -bottom_mm))
    frame = Frame(
        origin_mm=(answer.origin_mm[0] + left_mm, answer.origin_mm[1] + bottom_mm),
        mm_per_unit=answer.model.mm_per_unit,
    )
    obstacles = (record.obstacle() for record in answer.obstacles)
    return FloorPlan(
        floor=as_region(shapely.make_valid(_local(floor, shift_mm))),
        obstacles=tuple(o for obstacle in obstacles for o in _moved(obstacle, shift_mm)),
        findings=(*answer.model.findings, *answer.findings),
        floor_source=answer.floor_source,
        frame=frame,
        source=replace(source, storey=answer.storey, height_mm=answer.height_mm),
    )


def _moved(obstacle: Obstacle, shift_mm: FloatArray) -> Iterator[Obstacle]:
    """The obstacle in the plan's frame; in several parts where rounding pinches it off."""
    if isinstance(obstacle.shape, Circle):
        x_mm, y_mm = np.round(
            np.array((obstacle.shape.x_mm, obstacle.shape.y_mm)) + shift_mm, DIGITS
        )
        radius_mm = round(obstacle.shape.radius_mm, DIGITS)
        yield replace(obstacle, shape=Circle(float(x_mm), float(y_mm), radius_mm))
    elif isinstance(obstacle.shape, LineString):
        yield replace(obstacle, shape=_local(obstacle.shape, shift_mm))
    else:
        for part in polygons_in([shapely.make_valid(_local(obstacle.shape, shift_mm))]):
            yield replace(obstacle, shape=part)


def _local(geometry: BaseGeometry, shift_mm: FloatArray) -> BaseGeometry:
    return shapely.transform(geometry, lambda points: np.round(points + shift_mm, DIGITS))
