"""Drawings damaged at random give a plan or one line that says what is wrong, nothing else."""

import io
import random
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final

from ezdxf.document import Drawing

from satAOI_adapters.dxf_read import ReadOptions, read
from satAOI_geo.errors import SatAoiError
from satAOI_geo.plan import FloorPlan
from tests.drawings import drawing

N_CASES: Final = 200

STRANGE: Final = (
    "nan", "inf", "1e400", "1e308", "-1e17", "0", "-1", "1,5", "", "abc", "1e-320",
    "99999999999999999999", "LINE", "INSERT", "ENDSEC", "EOF", "墙", "\x00", "0x1F", "FFFFFFFF",
)  # fmt: skip
"""Values that are too large, too small, of another type, or mean something elsewhere."""

Lines = list[str]


def without_some(lines: Lines, dice: random.Random) -> Lines:
    start = dice.randrange(len(lines))
    return lines[:start] + lines[start + dice.randint(1, 6) :]


def with_some_twice(lines: Lines, dice: random.Random) -> Lines:
    start = dice.randrange(len(lines))
    end = start + dice.randint(1, 60)
    return lines[:end] + lines[start:]


def with_strange_values(lines: Lines, dice: random.Random) -> Lines:
    changed = list(lines)
    for _ in range(dice.randint(1, 4)):
        # every second line is a value, and most of what is drawn stands near the end
        place = min(len(lines) - 1, 2 * dice.randrange(len(lines) // 2) + 1)
        changed[place] = dice.choice(STRANGE)
    return changed


def with_values_swapped(lines: Lines, dice: random.Random) -> Lines:
    changed = list(lines)
    one, other = (2 * dice.randrange(len(lines) // 2) + 1 for _ in range(2))
    changed[one], changed[other] = changed[other], changed[one]
    return changed


def cut_short(lines: Lines, dice: random.Random) -> Lines:
    """The beginning, with an end mark as if that were all."""
    return [*lines[: dice.randrange(10, len(lines))], "  0", "EOF"]


DAMAGES: Final[Sequence[Callable[[Lines, random.Random], Lines]]] = (
    without_some,
    with_some_twice,
    with_strange_values,
    with_values_swapped,
    cut_short,
)


def with_everything() -> Drawing:
    """A floor, and on it an entity of each type that is read."""
    document = drawing()
    space = document.modelspace()
    block = document.blocks.new("STUD")
    block.add_circle((0, 0), 150)
    document.blocks.new("PAIR").add_blockref("STUD", (200, 0), dxfattribs={"xscale": -1})
    for place in ((1000, 1000), (3000, 1000)):
        space.add_blockref("PAIR", place, dxfattribs={"layer": "COLUMN", "rotation": 30})
    wall = {"layer": "WALL"}
    space.add_line((500, 5000), (4000, 5000), dxfattribs=wall)
    space.add_line((500, 5200), (4000, 5200), dxfattribs=wall)
    space.add_arc((6000, 5000), 900, 0, 120, dxfattribs=wall)
    space.add_lwpolyline(
        [(500, 7000, 0.4), (1500, 7000, 0), (1500, 8000, -1)], "xyb", dxfattribs=wall
    )
    space.add_polyline2d([(2500, 7000), (3500, 7000)], dxfattribs=wall).dxf.default_start_width = 50
    space.add_mline([(4000, 7000), (5000, 7000), (5000, 8000)], dxfattribs=wall)
    space.add_ellipse((7000, 2000), (400, 0), 0.5, dxfattribs={"layer": "HOLE"})
    space.add_spline([(6000, 7000), (6500, 7500), (7500, 7000)], dxfattribs=wall)
    space.add_solid([(8000, 1000), (8300, 1000), (8000, 1300), (8300, 1300)], dxfattribs=wall)
    hatch = space.add_hatch(dxfattribs={"layer": "COLUMN"})
    edges = hatch.paths.add_edge_path()
    edges.add_arc((8000, 8000), 300, 0, 180)
    edges.add_line((7700, 8000), (8300, 8000))
    space.add_text("hall", height=200)
    return document


def lines_of(document: Drawing) -> tuple[Lines, Lines]:
    """The text of a drawing: what comes before its blocks, and the rest."""
    stream = io.StringIO()
    document.write(stream)
    lines = stream.getvalue().splitlines()
    place = lines.index("BLOCKS")
    return lines[:place], lines[place:]


def outcome_of(path: Path) -> FloorPlan | str:
    """The plan, or the message of the one sort of error that may be raised."""
    try:
        return read(path, ReadOptions())
    except SatAoiError as error:
        return str(error)


def test_damaged_drawing_is_a_plan_or_one_line(tmp_path: Path) -> None:
    head, body = lines_of(with_everything())
    path = tmp_path / "plan.dxf"
    plans = []
    for seed in range(N_CASES):
        dice = random.Random(seed)
        damage = DAMAGES[seed % len(DAMAGES)]
        # most of what can go wrong stands in blocks and entities
        damaged = damage(head, dice) + body if seed % 7 == 0 else head + damage(body, dice)
        path.write_text("\n".join(damaged) + "\n", encoding="utf-8")
        outcome = outcome_of(path)
        if isinstance(outcome, str):
            assert "\n" not in outcome, f"seed {seed}"
            continue
        plans.append(outcome)
        assert outcome.floor.is_valid, f"seed {seed}"
        assert outcome.floor.area > 0, f"seed {seed}"
    assert 0 < len(plans) < N_CASES
