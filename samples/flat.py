"""One flat of 11 × 8 m, drawn the way offices draw: layers after the US National CAD Standard.

    8.0 ┌─────────────┬──┬───────┬─────────────┐
        │  bedroom 2  │bath      │   kitchen   │
        │             │          │             │
    4.4 ├────  ───────┼───  ─────┼───        ──┤
        │  bedroom 1  │                        ↔ entrance
        │             ↕        living       ╭──┘
        │             │          ●        ╭╯
    0.0 └─────────────┴────────────────────╯
        0            4.4      6.3             11.0

Outer walls are solid hatches with outlines, one of them curved; inner walls are pairs of lines,
open where they meet. There is no layer for the floor: it has to be inferred from the walls.
Lengths are in mm.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import Final

import pen
from ezdxf.document import Drawing
from ezdxf.enums import TextEntityAlignment
from ezdxf.layouts import BaseLayout
from pen import QUARTER_CIRCLE, Layer, Point

LAYERS: Final = (
    Layer("A-WALL", 7),
    Layer("A-FLOR-PATT", 254),
    Layer("A-COLS", 3),
    Layer("A-DOOR", 30),
    Layer("A-GLAZ", 4),
    Layer("A-FURN", 9),
    Layer("A-FLOR-OPEN", 1),
    Layer("A-FLOR-SYMB", 9),
    Layer("A-ANNO-DIMS", 252),
    Layer("A-ANNO-TEXT", 7),
    Layer("A-ANNO-TTLB", 7),
)

OUTER_WALLS: Final = (
    # lower left corner, between the windows of the two bedrooms
    ((1500, 0), (1500, 240), (240, 240), (240, 5400), (0, 5400), (0, 0)),
    ((3000, 0), (5600, 0), (5600, 240), (3000, 240)),
    ((11_000, 3900), (11_000, 8000), (9400, 8000), (9400, 7760), (10_760, 7760), (10_760, 3900)),
    ((5400, 7760), (7600, 7760), (7600, 8000), (5400, 8000)),
    ((4800, 7760), (4800, 8000), (0, 8000), (0, 6900), (240, 6900), (240, 7760)),
)

CURVE_CENTRE: Final = (8500, 2500)
CURVE_RADII: Final = (2500, 2260)
"""Outer and inner radius of the wall around the lower right corner."""

CURVED_WALL: Final = (
    (7600, 0),
    (8500, 0, QUARTER_CIRCLE),
    (11_000, 2500),
    (11_000, 2900),
    (10_760, 2900),
    (10_760, 2500, -QUARTER_CIRCLE),
    (8500, 240),
    (7600, 240),
)

WINDOWS: Final = (
    ((1500, 0), (3000, 240)),
    ((5600, 0), (7600, 240)),
    ((0, 5400), (240, 6900)),
    ((4800, 7760), (5400, 8000)),
    ((7600, 7760), (9400, 8000)),
)
"""Opposite corners of each window."""

INNER_WALLS: Final = (
    # along y = 4400 to 4520, from left to right between its openings
    ((240, 4400), (1500, 4400), (1500, 4520), (240, 4520)),
    ((4400, 4400), (2400, 4400), (2400, 4520), (3900, 4520)),
    ((4520, 4400), (5000, 4400), (5000, 4520), (4020, 4520)),
    ((5700, 4520), (5700, 4400), (7500, 4400), (7500, 4520), (6420, 4520)),
    ((10_760, 4400), (9300, 4400), (9300, 4520), (10_760, 4520)),
    # between bedroom 1 and the living room, below and above the door
    ((4400, 240), (4400, 3000), (4520, 3000), (4520, 240)),
    ((4400, 4400), (4400, 4000), (4520, 4000), (4520, 4400)),
    # beside the bath
    ((3900, 4520), (3900, 7760)),
    ((4020, 4520), (4020, 7760)),
    ((5700, 4520), (6300, 4520), (6300, 7760)),
    ((6420, 4520), (6420, 7760)),
)
"""Faces of the inner walls, each a chain that is drawn as single lines."""

LABELS: Final = (
    ("BEDROOM 1", (2300, 1100)),
    ("BEDROOM 2", (1300, 6400)),
    ("BATH", (5150, 6100)),
    ("KITCHEN", (7600, 6200)),
    ("LIVING", (6300, 2100)),
)


def flat() -> Drawing:
    """The flat with its furniture, dimensions and title."""
    doc = pen.new_drawing(pen.MM, LAYERS, dimension_height=160)
    msp = doc.modelspace()
    for wall in OUTER_WALLS:
        pen.solid(msp, "A-WALL", wall)
        pen.outline(msp, "A-WALL", wall)
    _curved_wall(msp)
    for chain in INNER_WALLS:
        pen.lines(msp, "A-WALL", pairwise(chain))
    for corner, opposite in WINDOWS:
        _window(msp, corner, opposite)
    _tiles(msp)
    _columns(doc)
    _openings(msp)
    _doors(doc)
    _furniture(doc)
    _annotation(msp)
    return doc


def _curved_wall(msp: BaseLayout) -> None:
    """The wall around the corner: a solid hatch, its outline single lines and arcs."""
    pen.solid(msp, "A-WALL", CURVED_WALL)
    before, after = CURVED_WALL[:2], CURVED_WALL[2:6]
    ends = [(x, y) for x, y, *_ in (*CURVED_WALL[6:], *before)]
    pen.lines(msp, "A-WALL", pairwise(ends))
    pen.lines(msp, "A-WALL", pairwise([(x, y) for x, y, *_ in after]))
    for radius in CURVE_RADII:
        msp.add_arc(CURVE_CENTRE, radius, 270, 360, dxfattribs={"layer": "A-WALL"})


def _tiles(msp: BaseLayout) -> None:
    """Tiles of 300 mm on the bath's floor."""
    tiles = msp.add_hatch(pen.BY_LAYER, dxfattribs={"layer": "A-FLOR-PATT"})
    # the pattern's own distance is 3.175 mm
    tiles.set_pattern_fill("NET", scale=300 / 3.175)
    bath = ((4020, 4520), (6300, 4520), (6300, 7760), (4020, 7760))
    tiles.paths.add_polyline_path(bath, is_closed=True)


def _window(msp: BaseLayout, corner: Point, opposite: Point) -> None:
    """Both faces of the wall and a pane in the middle."""
    (left, bottom), (right, top) = corner, opposite
    pen.rectangle(msp, "A-GLAZ", corner, opposite)
    if right - left > top - bottom:
        middle = (bottom + top) / 2
        pen.lines(msp, "A-GLAZ", [((left, middle), (right, middle))])
    else:
        middle = (left + right) / 2
        pen.lines(msp, "A-GLAZ", [((middle, bottom), (middle, top))])


def _columns(doc: Drawing) -> None:
    """A square column where inner walls meet and a round one that stands free."""
    square, round_ = doc.blocks.new("COL-300"), doc.blocks.new("COL-R350")
    corners = ((-150, -150), (150, -150), (150, 150), (-150, 150))
    pen.outline(square, "0", corners)
    pen.solid(square, "0", corners)
    pen.circle(round_, "0", (0, 0), 350)
    msp = doc.modelspace()
    for at in ((3960, 4460), (6360, 4460)):
        pen.place(msp, "A-COLS", "COL-300", at)
    pen.place(msp, "A-COLS", "COL-R350", (8200, 2600))


def _openings(msp: BaseLayout) -> None:
    """A shaft beside the bath's wall and a riser in the kitchen."""
    pen.rectangle(msp, "A-FLOR-OPEN", (4120, 7260), (4620, 7660))
    pen.lines(msp, "A-FLOR-SYMB", [((4120, 7260), (4620, 7660)), ((4120, 7660), (4620, 7260))])
    pen.circle(msp, "A-FLOR-OPEN", (10_500, 7500), 200)


def _doors(doc: Drawing) -> None:
    """Leaf and swing as one block a width; hinge at the block's origin, closed along x."""
    msp = doc.modelspace()
    doors = (
        (700, (5000, 4520), 0, False),
        (900, (2400, 4520), 0, True),
        (1000, (4400, 3000), 90, False),
        (1000, (10_760, 3900), 270, True),
    )
    for width, hinge, turn_deg, mirror in doors:
        name = f"DOOR-{width}"
        if name not in doc.blocks:
            _define_door(doc.blocks.new(name), width)
        pen.place(msp, "A-DOOR", name, hinge, turn_deg=turn_deg, mirror=mirror)


def _define_door(block: BaseLayout, width: float) -> None:
    pen.lines(block, "0", [((0, 0), (0, width))])
    block.add_arc((0, 0), width, 0, 90, dxfattribs={"layer": "0"})


def _furniture(doc: Drawing) -> None:
    """Beds, a sofa, a table with four chairs, a counter: not there yet when the floor is laid."""
    bed, table = doc.blocks.new("BED"), doc.blocks.new("TABLE")
    pen.rectangle(bed, "0", (0, 0), (1600, 2000))
    for left in (100, 850):
        pen.rectangle(bed, "0", (left, 1550), (left + 650, 1900))
    pen.rectangle(table, "0", (0, 0), (1400, 800))
    for x, y in ((350, -250), (1050, -250), (350, 1050), (1050, 1050)):
        pen.circle(table, "0", (x, y), 400)
    msp = doc.modelspace()
    pen.place(msp, "A-FURN", "BED", (300, 2200))
    pen.place(msp, "A-FURN", "BED", (2200, 5700))
    pen.place(msp, "A-FURN", "TABLE", (8700, 5200))
    sofa = ((4700, 400), (5500, 400), (5500, 2600), (4700, 2600))
    pen.outline(msp, "A-FURN", sofa)
    pen.lines(msp, "A-FURN", [((4950, 400), (4950, 2600))])
    pen.rectangle(msp, "A-FURN", (6480, 7100), (9900, 7700))


def _annotation(msp: BaseLayout) -> None:
    """Room names, two chains of dimensions, and the sheet's frame with its title."""
    for label, at in LABELS:
        words = msp.add_text(label, height=180, dxfattribs={"layer": "A-ANNO-TEXT"})
        words.set_placement(at, align=TextEntityAlignment.MIDDLE_CENTER)
    along_x = [(x, 8000) for x in (0, 3960, 6360, 11_000)]
    along_y = [(0, y) for y in (0, 4460, 8000)]
    _dimension_chain(msp, along_x, offset=700)
    _dimension_chain(msp, along_y, offset=700)
    _dimension_chain(msp, [along_x[0], along_x[-1]], offset=1300)
    pen.rectangle(msp, "A-ANNO-TTLB", (-2400, -2600), (12_600, 10_200))
    pen.rectangle(msp, "A-ANNO-TTLB", (7600, -2600), (12_600, -1400))
    pen.text(msp, "A-ANNO-TTLB", "FLAT 3B - FLOOR PLAN", (7800, -1950), 250)
    pen.text(msp, "A-ANNO-TTLB", "1:50  mm", (7800, -2400), 180)


def _dimension_chain(msp: BaseLayout, points: Sequence[Point], *, offset: float) -> None:
    for start, end in pairwise(points):
        pen.dimension(msp, "A-ANNO-DIMS", start, end, offset=offset)
