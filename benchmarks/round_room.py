"""Draw a hall with curved walls: `python -m benchmarks.round_room OUT.dxf`.

Two quarter walls of radius 6 and 10 m stand free in a hall of 24 by 16 m, each of four arcs: two
faces and two of plaster. Such walls are bands with thousands of short sides.
"""

import argparse
from pathlib import Path
from typing import Final

import ezdxf

RADII_M: Final = (6.0, 10.0)
FACES_M: Final = (0.0, 0.015, 0.185, 0.2)
"""Of a wall, from its inner face out."""


def main() -> None:
    """Write the drawing."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    document = ezdxf.new("R2010", units=ezdxf.units.M)
    document.layers.add("A-WALL")
    space, on_walls = document.modelspace(), {"layer": "A-WALL"}
    for left, bottom, right, top in ((0, 0, 24, 16), (-0.3, -0.3, 24.3, 16.3)):
        corners = [(left, bottom), (right, bottom), (right, top), (left, top)]
        space.add_lwpolyline(corners, close=True, dxfattribs=on_walls)
    for radius_m in RADII_M:
        for face_m in FACES_M:
            space.add_arc((6.0, 3.0), radius_m + face_m, 0, 90, dxfattribs=on_walls)
        near, far = radius_m + FACES_M[0], radius_m + FACES_M[-1]
        space.add_line((6.0 + near, 3.0), (6.0 + far, 3.0), dxfattribs=on_walls)
        space.add_line((6.0, 3.0 + near), (6.0, 3.0 + far), dxfattribs=on_walls)
    document.saveas(parser.parse_args().out)


if __name__ == "__main__":
    main()
