"""Two rooms of 4 × 4 m with an opening between them: does the robot get through?"""

from typing import Final

import pen
from ezdxf.document import Drawing
from pen import Layer

SIDE_MM: Final = 4000.0
PARTITION_MM: Final = 200.0
WALL_MM: Final = 240.0
FAR_MM: Final = 2 * SIDE_MM + PARTITION_MM

LAYERS: Final = (
    Layer("FLOOR", 8),
    Layer("WALL", 7),
    Layer("DIMS", 252),
    Layer("TEXT", 7),
    Layer("SATAOI-START", 6),
)


def two_rooms(opening_mm: float, *, units: int) -> Drawing:
    """Two rooms side by side; the wall between them has an opening in its middle.

    The floor is one outline that runs through the opening. The start is marked in the left room.
    """
    unit_mm = {pen.MM: 1.0, pen.METRE: 1000.0}[units]

    def at(x_mm: float, y_mm: float) -> pen.Point:
        return x_mm / unit_mm, y_mm / unit_mm

    decimals = 0 if units == pen.MM else 3
    doc = pen.new_drawing(units, LAYERS, dimension_height=150.0 / unit_mm, decimals=decimals)
    msp = doc.modelspace()
    low_mm, high_mm = (SIDE_MM - opening_mm) / 2, (SIDE_MM + opening_mm) / 2
    right_mm = SIDE_MM + PARTITION_MM
    floor_mm = [
        (0.0, 0.0),
        (SIDE_MM, 0.0),
        (SIDE_MM, low_mm),
        (right_mm, low_mm),
        (right_mm, 0.0),
        (FAR_MM, 0.0),
        (FAR_MM, SIDE_MM),
        (right_mm, SIDE_MM),
        (right_mm, high_mm),
        (SIDE_MM, high_mm),
        (SIDE_MM, SIDE_MM),
        (0.0, SIDE_MM),
    ]
    pen.outline(msp, "FLOOR", [at(x_mm, y_mm) for x_mm, y_mm in floor_mm])
    walls_mm = [
        (-WALL_MM, -WALL_MM, FAR_MM + WALL_MM, 0.0),
        (-WALL_MM, SIDE_MM, FAR_MM + WALL_MM, SIDE_MM + WALL_MM),
        (-WALL_MM, 0.0, 0.0, SIDE_MM),
        (FAR_MM, 0.0, FAR_MM + WALL_MM, SIDE_MM),
        (SIDE_MM, 0.0, right_mm, low_mm),
        (SIDE_MM, high_mm, right_mm, SIDE_MM),
    ]
    for left_mm, bottom_mm, right_end_mm, top_mm in walls_mm:
        pen.rectangle(msp, "WALL", at(left_mm, bottom_mm), at(right_end_mm, top_mm))
    msp.add_point(at(SIDE_MM / 2, SIDE_MM / 2), dxfattribs={"layer": "SATAOI-START"})
    pen.dimension(msp, "DIMS", at(right_mm, high_mm), at(right_mm, low_mm), offset=600.0 / unit_mm)
    title = f"TWO ROOMS - OPENING {opening_mm:.0f}"
    pen.text(msp, "TEXT", title, at(0.0, -900.0), 300.0 / unit_mm)
    return doc
