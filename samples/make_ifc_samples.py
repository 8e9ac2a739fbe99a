"""Write the samples that are building models: `python samples/make_ifc_samples.py [FOLDER]`.

They are the plans of the drawings of the same name, so that both can be compared. The same
version of ifcopenshell writes the same bytes on every run.
"""

import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Final

import flat
import rooms
from ifc_pen import Model, Point
from ifcopenshell import entity_instance

SLAB: Final = 200.0
STOREY: Final = 2600.0
DOOR: Final = 2100.0
SILL: Final = 900.0
LEAF: Final = 40.0
"""Thickness of slabs; heights of walls, doors and sills; thickness of a door's leaf."""


def two_rooms(opening: float, *, schema: str, unit: str) -> Model:
    """Two rooms of 4 × 4 m; the wall between them has an opening in its middle."""
    model = Model(schema, unit, f"Two rooms, opening {opening:.0f}")
    side, wall, far = rooms.SIDE_MM, rooms.WALL_MM, rooms.FAR_MM
    model.add("IfcSlab", "Floor", model.box((0, 0), (far, side), -SLAB, 0))
    outer = {
        "south": ((-wall, -wall), (far + wall, 0)),
        "north": ((-wall, side), (far + wall, side + wall)),
        "west": ((-wall, 0), (0, side)),
        "east": ((far, 0), (far + wall, side)),
    }
    for name, (corner, opposite) in outer.items():
        model.add("IfcWall", f"Wall {name}", model.box(corner, opposite, 0, STOREY))
    right = side + rooms.PARTITION_MM
    partition = model.add("IfcWall", "Partition", model.box((side, 0), (right, side), 0, STOREY))
    low, high = (side - opening) / 2, (side + opening) / 2
    # openings reach a little beyond the wall's faces, as most programs write them
    through = model.box((side - 50, low), (right + 50, high), 0, DOOR)
    model.open(partition, "Opening", through)
    return model


BUILDING: Final = (
    (0, 0),
    (8500, 0, flat.QUARTER_CIRCLE),
    (11_000, 2500),
    (11_000, 8000),
    (0, 8000),
)

INNER_WALLS: Final = (
    # corner, opposite corner, and the openings of doors as spans along the wall
    ((240, 4400), (7500, 4520), ((1500, 2400), (5000, 5700))),
    ((9300, 4400), (10_760, 4520), ()),
    ((4400, 240), (4520, 4400), ((3000, 4000),)),
    ((3900, 4520), (4020, 7760), ()),
    ((6300, 4520), (6420, 7760), ()),
)

ENTRANCE: Final = ((10_760, 2900), (11_000, 3900))
BEDS: Final = ((300, 2200), (2200, 5700))


def flat_model(*, schema: str, unit: str) -> Model:
    """The flat with its doors, windows and beds, which are not in the way, and a roof above."""
    model = Model(schema, unit, "Flat 3B")
    slab = model.add("IfcSlab", "Floor", model.prism(BUILDING, -SLAB, 0))
    model.open(slab, "Shaft", model.box((4120, 7260), (4620, 7660), -2 * SLAB, SLAB))
    model.open(slab, "Riser", model.cylinder((10_500, 7500), 200, -2 * SLAB, SLAB))
    model.add("IfcSlab", "Roof", model.prism(BUILDING, STOREY, STOREY + SLAB))
    for number, outline in enumerate((*flat.OUTER_WALLS, flat.CURVED_WALL)):
        model.add("IfcWall", f"Outer wall {number}", model.prism(outline, 0, STOREY))
    for number, (corner, opposite) in enumerate(flat.WINDOWS):
        model.add("IfcWall", f"Spandrel {number}", model.box(corner, opposite, 0, SILL))
        model.add("IfcWindow", f"Window {number}", model.box(corner, opposite, SILL, DOOR))
        model.add("IfcWall", f"Lintel {number}", model.box(corner, opposite, DOOR, STOREY))
    for number, (corner, opposite, doors) in enumerate(INNER_WALLS):
        wall = model.add("IfcWall", f"Inner wall {number}", model.box(corner, opposite, 0, STOREY))
        for span in doors:
            _door(model, wall, (corner, opposite), span)
    _entrance(model)
    _columns(model)
    furniture = "IfcFurnishingElement" if schema == "IFC2X3" else "IfcFurniture"
    for x, y in BEDS:
        model.add(furniture, "Bed", model.box((x, y), (x + 1600, y + 2000), 0, 500))
    return model


def _door(model: Model, wall: entity_instance, sides: tuple[Point, Point], span: Point) -> None:
    """An opening across a wall between two opposite corners, and the leaf in it."""
    (left, bottom), (right, top) = sides
    start, end = span
    if right - left > top - bottom:
        opening = model.box((start, bottom - 50), (end, top + 50), 0, DOOR)
        leaf = model.box((start, bottom), (end, bottom + LEAF), 0, DOOR)
    else:
        opening = model.box((left - 50, start), (right + 50, end), 0, DOOR)
        leaf = model.box((left, start), (left + LEAF, end), 0, DOOR)
    model.open(wall, "Doorway", opening)
    model.add("IfcDoor", f"Door {end - start:.0f}", leaf)


def _entrance(model: Model) -> None:
    (_, bottom), (right, top) = ENTRANCE
    model.add("IfcWall", "Lintel of the entrance", model.box(*ENTRANCE, DOOR, STOREY))
    leaf = model.box((right - LEAF, bottom), (right, top), 0, DOOR)
    model.add("IfcDoor", "Entrance", leaf)


def _columns(model: Model) -> None:
    for x, y in ((3960, 4460), (6360, 4460)):
        solid = model.box((x - 150, y - 150), (x + 150, y + 150), 0, STOREY)
        model.add("IfcColumn", "Square column", solid)
    model.add("IfcColumn", "Round column", model.cylinder((8200, 2600), 350, 0, STOREY))


SAMPLES: Final[dict[str, Callable[..., Model]]] = {
    "two_rooms_760": partial(two_rooms, 760.0),
    "two_rooms_900": partial(two_rooms, 900.0),
    "flat": flat_model,
}
"""Plans by the name of the drawing they are the model of."""

WRITTEN: Final = {
    "two_rooms_900": {"schema": "IFC4X3", "unit": "m"},
    "flat": {"schema": "IFC4", "unit": "mm"},
}
"""Those that lie in this folder, with schema and unit."""


def main(folder: Path) -> None:
    """Write the samples into a folder."""
    for name, variant in WRITTEN.items():
        path = folder / f"{name}.ifc"
        path.write_text(SAMPLES[name](**variant).text(), encoding="ascii", newline="\n")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
