"""Three halls for gas insulated switchgear (GIS), 10 450 × 19 190 mm.

Bays stand in lines of equal pitch. A bay leaves in the floor a pair of channels that it is bolted
to, a round hole for its power cable between them, and anchor plates beside them. Control cables
rise through slots along a wall. Parts and holes measure 160 to 2000 mm; obstacle areas are those
of the halls in SatAOI, arXiv 2505.04871, table 1: 7.00, 14.96 and 25.84 m². In each hall the sump
is as large as it takes to meet the figure.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import pen
from ezdxf.document import Drawing
from ezdxf.layouts import BaseLayout
from pen import Layer, Point

WIDTH_MM: Final = 10_450.0
HEIGHT_MM: Final = 19_190.0
MIDDLE_MM: Final = HEIGHT_MM / 2
WALL_MM: Final = 240.0
GATE_MM: Final = 3600.0
DOOR_MM: Final = 1200.0
COLUMN_MM: Final = (300.0, 400.0)
FRAMES_MM: Final = (6480.0, 12_710.0)
"""y of the frames; their columns stand out from both long walls."""

LAYERS: Final = (
    Layer("FLOOR", 8),
    Layer("WALL", 7),
    Layer("COLUMN", 3),
    Layer("EMBEDDED", 5),
    Layer("HOLE", 1),
    Layer("HOLE-SYMB", 9),
    Layer("GRID", 252, "DASHDOT"),
    Layer("DIMS", 252),
    Layer("TEXT", 7),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Bay:
    """What one bay of switchgear leaves in the floor.

    Attributes:
        channel_mm: Length and width of each of its two channels, which lie along x.
        gauge_mm: Between the channels' middle lines.
        hole_mm: Diameter of the cable's hole between the channels.
        plate_mm: Side of the anchor plates, one off the end of each channel; 0 for none.
        plate_x_mm: From the bay's middle to the plates' middle.
    """

    channel_mm: tuple[float, float]
    gauge_mm: float
    hole_mm: float
    plate_mm: float = 0.0
    plate_x_mm: float = 0.0


def simple() -> Drawing:
    """One line of bays, one of anchor plates, and a partition that cuts the hall in two."""
    doc = _hall("GIS HALL - SIMPLE")
    msp = doc.modelspace()
    pen.rectangle(msp, "WALL", (6500.0, 0.0), (6620.0, HEIGHT_MM))
    _define_bay(doc, Bay(channel_mm=(1200.0, 160.0), gauge_mm=800.0, hole_mm=400.0))
    rows_mm = _rows(5, 3000.0)
    for y_mm in rows_mm:
        pen.place(msp, "0", "BAY", (3400.0, y_mm))
    _plate_array(doc, (8517.0, 2105.0), n_rows=6, pitch_mm=2996.0)
    for y_mm in (3000.0, 9595.0, 16_190.0, 17_690.0):
        _slot(msp, (275.0, y_mm), 250.0, 1000.0)
    _sump(msp, (5600.0, 1000.0), 359.0, 359.0)
    _dimension_pitch(msp, rows_mm)
    return doc


def medium() -> Drawing:
    """Two lines of bays that face each other across an aisle with a row of cabinets."""
    doc = _hall("GIS HALL - MEDIUM")
    msp = doc.modelspace()
    bay = Bay(
        channel_mm=(1500.0, 160.0), gauge_mm=880.0, hole_mm=450.0, plate_mm=200.0, plate_x_mm=930.0
    )
    _define_bay(doc, bay)
    rows_mm = _rows(7, 2400.0)
    for y_mm in rows_mm:
        pen.place(msp, "0", "BAY", (2750.0, y_mm))
        pen.place(msp, "0", "BAY", (7650.0, y_mm), mirror=True)
        pen.slotted(msp, "HOLE", (5203.0, y_mm), 200.0, 800.0)
    for y_mm in _rows(9, 2000.0):
        _slot(msp, (275.0, y_mm), 250.0, 900.0)
    for y_mm in _rows(6, 3200.0):
        _round_hole(msp, (9950.0, y_mm), 500.0)
    _sump(msp, (5200.0, 18_500.0), 365.0, 412.0)
    _dimension_pitch(msp, rows_mm)
    return doc


def complex_() -> Drawing:
    """Two dense lines of bays, cabinets between them, shafts at both ends, holes along the walls.

    Between the channels of a bay there are 720 mm, so the disc (700 mm) just enters; between two
    bays 920 mm, so the vehicle does too.
    """
    doc = _hall("GIS HALL - COMPLEX")
    msp = doc.modelspace()
    bay = Bay(
        channel_mm=(1800.0, 180.0), gauge_mm=900.0, hole_mm=500.0, plate_mm=250.0, plate_x_mm=1080.0
    )
    _define_bay(doc, bay)
    rows_mm = _rows(8, 2000.0)
    for y_mm in rows_mm:
        pen.place(msp, "0", "BAY", (2703.0, y_mm), mirror=True)
        pen.place(msp, "0", "BAY", (7550.0, y_mm))
        pen.slotted(msp, "HOLE", (5125.0, y_mm), 250.0, 1000.0)
    for y_mm in _rows(9, 2000.0):
        _slot(msp, (300.0, y_mm), 300.0, 1200.0)
        _round_hole(msp, (10_000.0, y_mm), 600.0)
    for y_mm in (700.0, 18_490.0):
        _slot(msp, (5125.0, y_mm), 2000.0, 500.0)
    _sump(msp, (8700.0, 18_700.0), 410.0, 422.0)
    _dimension_pitch(msp, rows_mm)
    return doc


def _hall(title: str) -> Drawing:
    """The hall without switchgear: floor, walls, columns, axes, dimensions, title."""
    doc = pen.new_drawing(pen.MM, LAYERS, dimension_height=200.0)
    msp = doc.modelspace()
    pen.rectangle(msp, "FLOOR", (0.0, 0.0), (WIDTH_MM, HEIGHT_MM))
    _walls(msp)
    _frames(doc)
    pen.dimension(msp, "DIMS", (0.0, 0.0), (WIDTH_MM, 0.0), offset=-1600.0)
    pen.dimension(msp, "DIMS", (WIDTH_MM, 0.0), (WIDTH_MM, HEIGHT_MM), offset=-1600.0)
    pen.text(msp, "TEXT", title, (0.0, -2900.0), 450.0)
    pen.text(msp, "TEXT", "Embedded parts and holes  1:100  mm", (0.0, -3500.0), 250.0)
    return doc


def _walls(msp: BaseLayout) -> None:
    """Walls around the floor: a gate for the switchgear below, a door on the right."""
    left_gate_mm = (WIDTH_MM - GATE_MM) / 2
    right_gate_mm = (WIDTH_MM + GATE_MM) / 2
    right_mm, top_mm = WIDTH_MM + WALL_MM, HEIGHT_MM + WALL_MM
    door_mm = 15_000.0
    pen.rectangle(msp, "WALL", (-WALL_MM, -WALL_MM), (0.0, top_mm))
    pen.rectangle(msp, "WALL", (0.0, HEIGHT_MM), (right_mm, top_mm))
    pen.rectangle(msp, "WALL", (0.0, -WALL_MM), (left_gate_mm, 0.0))
    pen.rectangle(msp, "WALL", (right_gate_mm, -WALL_MM), (right_mm, 0.0))
    pen.rectangle(msp, "WALL", (WIDTH_MM, 0.0), (right_mm, door_mm))
    pen.rectangle(msp, "WALL", (WIDTH_MM, door_mm + DOOR_MM), (right_mm, HEIGHT_MM))


def _frames(doc: Drawing) -> None:
    """Columns as instances of a block drawn on layer 0, and the frames' axes."""
    block = doc.blocks.new("COLUMN-300X400")
    pen.centred(block, "0", (0.0, 0.0), *COLUMN_MM)
    msp = doc.modelspace()
    inset_mm = COLUMN_MM[0] / 2
    for number, y_mm in enumerate(FRAMES_MM, start=1):
        pen.place(msp, "COLUMN", "COLUMN-300X400", (inset_mm, y_mm))
        pen.place(msp, "COLUMN", "COLUMN-300X400", (WIDTH_MM - inset_mm, y_mm))
        pen.lines(msp, "GRID", [((-2600.0, y_mm), (WIDTH_MM + 900.0, y_mm))])
        pen.circle(msp, "GRID", (-3000.0, y_mm), 800.0)
        pen.text(msp, "TEXT", str(number), (-3110.0, y_mm - 175.0), 350.0)


def _rows(n_rows: int, pitch_mm: float) -> list[float]:
    """The y of equally pitched rows, in the middle of the hall."""
    return [MIDDLE_MM + (row - (n_rows - 1) / 2) * pitch_mm for row in range(n_rows)]


def _define_bay(doc: Drawing, bay: Bay) -> None:
    """The bay as a block, its plates as a block within the block."""
    block = doc.blocks.new("BAY")
    for y_mm in (-bay.gauge_mm / 2, bay.gauge_mm / 2):
        pen.centred(block, "EMBEDDED", (0.0, y_mm), *bay.channel_mm)
    _round_hole(block, (0.0, 0.0), bay.hole_mm)
    if bay.plate_mm:
        _define_plate(doc, bay.plate_mm)
        for y_mm in (-bay.gauge_mm / 2, bay.gauge_mm / 2):
            pen.place(block, "EMBEDDED", "PLATE", (bay.plate_x_mm, y_mm), turn_deg=90.0)


def _define_plate(doc: Drawing, side_mm: float) -> None:
    pen.centred(doc.blocks.new("PLATE"), "0", (0.0, 0.0), side_mm, side_mm)


def _plate_array(doc: Drawing, first: Point, *, n_rows: int, pitch_mm: float) -> None:
    """A column of anchor plates as one array insert."""
    _define_plate(doc, 300.0)
    plates = pen.place(doc.modelspace(), "EMBEDDED", "PLATE", first)
    plates.dxf.row_count = n_rows
    plates.dxf.row_spacing = pitch_mm


def _round_hole(layout: BaseLayout, centre: Point, diameter_mm: float) -> None:
    """A round hole and the cross that marks it."""
    (x_mm, y_mm), reach_mm = centre, 0.6 * diameter_mm
    pen.circle(layout, "HOLE", centre, diameter_mm)
    across = ((x_mm - reach_mm, y_mm), (x_mm + reach_mm, y_mm))
    up = ((x_mm, y_mm - reach_mm), (x_mm, y_mm + reach_mm))
    pen.lines(layout, "HOLE-SYMB", [across, up])


def _slot(layout: BaseLayout, centre: Point, width_mm: float, height_mm: float) -> None:
    """A rectangular hole and the diagonal that marks it."""
    (x_mm, y_mm), side_mm, end_mm = centre, width_mm / 2, height_mm / 2
    pen.centred(layout, "HOLE", centre, width_mm, height_mm)
    diagonal = ((x_mm - side_mm, y_mm - end_mm), (x_mm + side_mm, y_mm + end_mm))
    pen.lines(layout, "HOLE-SYMB", [diagonal])


def _sump(layout: BaseLayout, centre: Point, width_mm: float, height_mm: float) -> None:
    """The sump, a hole whose size settles the hall's obstacle area."""
    _slot(layout, centre, width_mm, height_mm)
    label_at = (centre[0] + width_mm, centre[1] - 60.0)
    pen.text(layout, "TEXT", "SUMP", label_at, 120.0)


def _dimension_pitch(msp: BaseLayout, rows_mm: Sequence[float]) -> None:
    """The bays' pitch, as a chain of dimensions left of the hall."""
    chain_mm = (0.0, *rows_mm, HEIGHT_MM)
    for low_mm, high_mm in pairwise(chain_mm):
        pen.dimension(msp, "DIMS", (0.0, low_mm), (0.0, high_mm), offset=1200.0)
