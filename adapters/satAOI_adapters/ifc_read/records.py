"""What passes between the reader and the process that does the geometry: lines of JSON.

JSON rather than pickles, so that whatever a hostile model does to that process, its words stay
words.
"""

from dataclasses import dataclass
from typing import Annotated, Literal, TypeAlias

import shapely
from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

from satAOI_adapters.ifc_read.options import IfcOptions
from satAOI_geo.plan import Circle, Finding, Kind, Obstacle, Region, Shape, as_region

ShapeCode: TypeAlias = str | tuple[float, float, float]
"""A polygon or chain as hexadecimal WKB, a circle as x, y, radius: no digit is lost in either."""


class Record(BaseModel):
    """A message: frozen, and no key that the schema does not know."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class Request(Record):
    """What to read.

    Attributes:
        path: The model.
        parsed: Where it is parsed: the model itself, or a copy as in `parsable`.
        options: What the user chose.
        file_mb: Size of the file.
        memory_mb: Most address space that the process may take.
        bad_ids: Entities that hold numbers which are none.
        raw_names: Whether names hold bytes that no encoding is declared for.
        skip: GlobalIds of elements that ended an earlier run.
        only_inspect: Whether storeys are enough.
    """

    path: str
    parsed: str
    options: IfcOptions
    file_mb: float
    memory_mb: int
    bad_ids: frozenset[int] = frozenset()
    raw_names: bool = False
    skip: frozenset[str] = frozenset()
    only_inspect: bool = False


class Begun(Record):
    """An element is about to be read; if nothing follows, it ended the process."""

    type: Literal["begun"] = "begun"
    handle: str
    layer: str
    share: float


class Failed(Record):
    """The model cannot be used: an exception of `satAOI_geo.errors` by name."""

    type: Literal["failed"] = "failed"
    error: str
    message: str
    layer: str = ""
    handle: str = ""


class ObstacleRecord(Record):
    """An obstacle."""

    shape: ShapeCode
    kind: Kind
    layer: str
    handle: str

    @classmethod
    def of(cls, obstacle: Obstacle) -> "ObstacleRecord":
        """The record of an obstacle."""
        return cls(
            shape=encoded(obstacle.shape),
            kind=obstacle.kind,
            layer=obstacle.layer,
            handle=obstacle.handle,
        )

    def obstacle(self) -> Obstacle:
        """The obstacle that was recorded."""
        return Obstacle(decoded(self.shape), self.kind, self.layer, self.handle)


@dataclass(frozen=True, slots=True)
class Storey:
    """A storey, with the height of its floor.

    Attributes:
        number: From 1, the lowest storey first.
        name: As in the model; may be empty.
        handle: GlobalId.
        elevation_mm: Height of the floor in the model.
        attribute_mm: Its attribute Elevation, or None; only informative.
        counts: Elements by class of `model.COUNTED`.
    """

    number: int
    name: str
    handle: str
    elevation_mm: float
    attribute_mm: float | None
    counts: dict[str, int]


class ModelRecord(Record):
    """The model as a whole.

    Attributes:
        schema_name: For example IFC4.
        unit: Key of `units.MM_PER_UNIT`.
        mm_per_unit: Millimetres in that unit.
        storeys: Lowest first.
        classes: Number of products of each class.
        findings: What was odd about it.
    """

    schema_name: str
    unit: str
    mm_per_unit: float
    storeys: list[Storey]
    classes: dict[str, int]
    findings: list[Finding]


class Inspected(Record):
    """The answer to a request to inspect."""

    type: Literal["inspected"] = "inspected"
    model: ModelRecord


class Read(Record):
    """The answer to a request to read.

    Attributes:
        model: The model as a whole.
        storey: GlobalId of the storey, or an empty string.
        origin_mm: What was subtracted from all coordinates.
        floor: Hexadecimal WKB.
        floor_source: As in `FloorPlan`.
        height_mm: Of the floor, in the model.
        obstacles: What stands on it.
        findings: What was guessed, repaired or left out, the model's findings first.
    """

    type: Literal["read"] = "read"
    model: ModelRecord
    storey: str
    origin_mm: tuple[float, float]
    floor: str
    floor_source: str
    height_mm: float
    obstacles: list[ObstacleRecord]
    findings: list[Finding]

    def region(self) -> Region:
        """The floor."""
        return as_region(shapely.from_wkb(self.floor))


Answer: TypeAlias = Annotated[Begun | Failed | Inspected | Read, Field(discriminator="type")]

ANSWER: TypeAdapter[Answer] = TypeAdapter(Answer)
"""Parses one line of the geometry process."""


def encoded(shape: Shape) -> ShapeCode:
    """A shape as text or numbers."""
    if isinstance(shape, Circle):
        return shape.x_mm, shape.y_mm, shape.radius_mm
    return str(shapely.to_wkb(shape, hex=True))


def decoded(code: ShapeCode) -> Shape:
    """The shape that was encoded."""
    if isinstance(code, str):
        shape: Shape = shapely.from_wkb(code)
        return shape
    return Circle(*code)


def encoded_region(region: Region) -> str:
    """A floor as text."""
    return str(shapely.to_wkb(region, hex=True))
