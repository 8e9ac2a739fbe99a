"""Time how a storey of more than 500 walls is read: `python -m benchmarks.storey [--runs N]`.

Rooms of 3 × 3 m in rows and columns, with a doorway and a door in each wall between two of them.
Every fourth wall is a faceted solid, which is cut from its mesh; the others are extrusions, which
are read exactly. The figures go to stdout, medians of several runs: seconds on the clock and of all
cores together.
"""

import argparse
import itertools
import sys
import tempfile
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Final, TypeAlias

from ifcopenshell import entity_instance

from benchmarks.clock import timed
from satAOI_adapters import inspect_plan, read_plan
from tests.ifc_models import Pen

COLUMNS: Final = 16
ROWS: Final = 15
ROOM_MM: Final = 3000.0
WALL_MM: Final = 150.0
STOREY_MM: Final = 2600.0
DOOR_MM: Final = (1000.0, 2100.0)
"""Width and height."""

FACETED: Final = 4
"""One of so many walls is a faceted solid."""

FACES: Final = ((3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
"""Of a box, by its corners: bottom, top and sides, each counter-clockwise from outside."""

Point: TypeAlias = tuple[float, float, float]
Box: TypeAlias = tuple[Point, Point]
"""Least and greatest corner."""


def main() -> None:
    """Write the storey and time how it is read."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=3)
    n_runs = parser.parse_args().runs
    pen = storey_of_rooms()
    with tempfile.TemporaryDirectory() as folder:
        path = pen.save(Path(folder))
        n_walls, n_obstacles = len(pen.model.by_type("IfcWall")), len(read_plan(path).obstacles)
        sys.stdout.write(f"{n_walls} walls, {n_obstacles} obstacles\n")
        for name, job in (("read", read_plan), ("inspect", inspect_plan)):
            median = timed(partial(job, path), n_runs)
            sys.stdout.write(f"{name:<10} {median.clock_s:8.3f} s {median.cores_s:8.3f} s\n")


def storey_of_rooms() -> Pen:
    """A model of one storey with all its walls and doors."""
    pen = Pen()
    elements = [pen.slab(COLUMNS * ROOM_MM, ROWS * ROOM_MM)]
    for number, (wall, doorway) in enumerate(walls()):
        built = (
            pen.product("IfcWall", faceted(pen, wall), kind="Brep")
            if number % FACETED == 0
            else pen.product("IfcWall", pen.box(*wall))
        )
        elements.append(built)
        if doorway is not None:
            pen.void(built, pen.box(*doorway))
            elements.append(pen.product("IfcDoor", pen.box(*doorway)))
    pen.contain(pen.storey(), *elements)
    return pen


def walls() -> Iterator[tuple[Box, Box | None]]:
    """Each wall, and the doorway in it unless it is an outer one."""
    door_mm, lintel_mm = DOOR_MM
    # a little thicker than the wall, as most programs write openings
    through_mm = 1.2 * WALL_MM
    for n_lines, n_rooms, shape in ((COLUMNS, ROWS, along_y), (ROWS, COLUMNS, along_x)):
        for line, room in itertools.product(range(n_lines + 1), range(n_rooms)):
            on_mm, from_mm = line * ROOM_MM, room * ROOM_MM
            wall = shape(on_mm, from_mm, (WALL_MM, ROOM_MM, STOREY_MM))
            doorway = shape(on_mm, from_mm + door_mm, (through_mm, door_mm, lintel_mm))
            yield wall, doorway if 0 < line < n_lines else None


def along_y(x_mm: float, y_mm: float, size_mm: Point) -> Box:
    """A box on the floor on a line x from y on; its thickness, length and height."""
    thickness_mm, length_mm, height_mm = size_mm
    half_mm = thickness_mm / 2
    return (x_mm - half_mm, y_mm, 0.0), (x_mm + half_mm, y_mm + length_mm, height_mm)


def along_x(y_mm: float, x_mm: float, size_mm: Point) -> Box:
    """The same along x."""
    (y0_mm, x0_mm, z0_mm), (y1_mm, x1_mm, z1_mm) = along_y(y_mm, x_mm, size_mm)
    return (x0_mm, y0_mm, z0_mm), (x1_mm, y1_mm, z1_mm)


def faceted(pen: Pen, box: Box) -> entity_instance:
    """A box by its faces."""
    (left, bottom, low), (right, top, high) = box
    ring = ((left, bottom), (right, bottom), (right, top), (left, top))
    return pen.brep([(x, y, z) for z in (low, high) for x, y in ring], FACES)


if __name__ == "__main__":
    main()
