"""The figures of a run as data: one versioned schema."""

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field


class Section(BaseModel):
    """A group of figures: frozen, and no key that the schema does not know."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class InputFigures(Section):
    """The file that was read."""

    path: str
    sha256: str
    format: str
    unit: str
    unit_source: str


class RobotFigures(Section):
    """The robot's measures; lengths in mm, angles in degrees as in the robot's file."""

    name: str
    vehicle_length_mm: float
    vehicle_width_mm: float
    pivot_offset_mm: float
    arm_length_mm: float
    disc_radius_mm: float
    swing_min_deg: float
    swing_max_deg: float
    clearance_mm: float


class LatticeFigures(Section):
    """The lattice; the origin in the drawing's axes, shape [rows, columns]."""

    step_mm: float
    origin_mm: tuple[float, float]
    shape: tuple[int, int]
    n_directions: int
    n_swings: int


class FloorFigures(Section):
    """The floor and what stands on it."""

    area_m2: float
    source: str
    obstacle_area_m2: float
    obstacle_percent: float
    free_area_m2: float
    n_obstacles: int


class StartFigures(Section):
    """Where the robot is set down; xy in the drawing's axes, node [row, column]."""

    xy_mm: tuple[float, float]
    node: tuple[int, int]
    source: Literal["option", "drawing", "largest"]


class FreeFigures(Section):
    """Nodes where some pose is free."""

    n_nodes: int


class ConnectedFigures(Section):
    """A connected set of nodes and the area its discs cover."""

    n_nodes: int
    area_m2: float
    raster_area_m2: float


class AoiFigures(Section):
    """The area of interest."""

    connectivity: Literal["disc", "pose"]
    area_m2: float
    raster_area_m2: float
    percent_of_free: float
    n_parts: int


class FindingFigures(Section):
    """A finding; the position in the drawing's axes."""

    code: str
    message: str
    remedy: str
    layer: str
    handle: str
    at_mm: tuple[float, float] | None


class Report(Section):
    """All figures of a run."""

    model_config = ConfigDict(frozen=True, extra="forbid", populate_by_name=True)

    schema_name: Literal["sataoi-report/1"] = Field("sataoi-report/1", alias="schema")
    input: InputFigures
    robot: RobotFigures
    lattice: LatticeFigures
    floor: FloorFigures
    start: StartFigures
    free: FreeFigures
    disc_connected: ConnectedFigures
    aoi: AoiFigures
    findings: list[FindingFigures]
    timing_s: dict[str, float]
