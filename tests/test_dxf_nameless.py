"""Walls and windows on a layer whose name says nothing, beside walls that are named."""

import math
from pathlib import Path

import pytest
from ezdxf import transform
from ezdxf.document import Drawing
from ezdxf.layouts import BaseLayout
from ezdxf.math import Matrix44

from satAOI_geo.plan import Finding, FloorPlan
from tests.drawings import drawing, plan_of

Lines = list[tuple[float, float, float, float]]

OUTER: Lines = [(0, 0, 8000, 0), (8000, 0, 8000, 5000), (8000, 5000, 0, 5000), (0, 5000, 0, 0)]
INNER: Lines = [
    (250, 250, 7750, 250),
    (7750, 250, 7750, 4750),
    (7750, 4750, 250, 4750),
    (250, 4750, 250, 250),
]
"""The faces of the outer walls of a flat."""

PARTITION: Lines = [
    (4000, 250, 4000, 2000),
    (4120, 250, 4120, 2000),
    (4000, 2000, 4120, 2000),
    (4000, 2900, 4000, 4750),
    (4120, 2900, 4120, 4750),
    (4000, 2900, 4120, 2900),
]
"""One of 120 mm across it, with an opening of 900 mm."""

PARTITION_MM2 = 120 * (4500 - 900)
ROOM_MM2 = 7500 * 4500


def flat(nameless: Lines, *, walls: Lines = OUTER + INNER) -> Drawing:
    """Outer walls on their layer, and lines on another one."""
    document = drawing(floor=False)
    add(document.modelspace(), walls, "A-WALL")
    add(document.modelspace(), nameless, "XYZ")
    return document


def add(space: BaseLayout, lines: Lines, layer: str) -> None:
    for x0, y0, x1, y1 in lines:
        space.add_line((x0, y0), (x1, y1), dxfattribs={"layer": layer})


def free_mm2(plan: FloorPlan) -> float:
    """The floor that nothing stands on."""
    return float(plan.floor.difference(plan.obstacle_region()).area)


def said(plan: FloorPlan, code: str) -> list[Finding]:
    return [finding for finding in plan.findings if finding.code == code]


def test_partition_whose_ends_lie_on_walls_is_a_wall_and_is_said(tmp_path: Path) -> None:
    plan = plan_of(flat(PARTITION), tmp_path)
    assert free_mm2(plan) == pytest.approx(ROOM_MM2 - PARTITION_MM2, rel=1e-9)
    (finding,) = said(plan, "walls-by-look")
    assert finding.message.startswith("6 lines on layer 'XYZ' that run in pairs and end at walls")
    assert finding.handle
    assert finding.at_mm == pytest.approx((4000, 250))
    assert not said(plan, "unclassified-left-out")


def test_partition_at_which_the_outer_wall_is_trimmed_is_a_wall(tmp_path: Path) -> None:
    trimmed = [
        (250, 250, 4000, 250),
        (4120, 250, 7750, 250),
        (7750, 250, 7750, 4750),
        (7750, 4750, 4120, 4750),
        (4000, 4750, 250, 4750),
        (250, 4750, 250, 250),
    ]
    plan = plan_of(flat(PARTITION, walls=OUTER + trimmed), tmp_path)
    assert free_mm2(plan) == pytest.approx(ROOM_MM2 - PARTITION_MM2, rel=1e-9)


@pytest.mark.parametrize("turn_deg", [90.0, 37.0])
@pytest.mark.parametrize("x_scale", [1.0, -1.0])
def test_turned_and_mirrored_it_is_one_too(turn_deg: float, x_scale: float, tmp_path: Path) -> None:
    document = flat(PARTITION[::-1])
    matrix = Matrix44.scale(x_scale, 1, 1) @ Matrix44.z_rotate(math.radians(turn_deg))
    transform.inplace(document.modelspace(), matrix)
    plan = plan_of(document, tmp_path)
    assert free_mm2(plan) == pytest.approx(ROOM_MM2 - PARTITION_MM2, rel=1e-6)


def test_outer_walls_are_told_by_partitions_that_are_named(tmp_path: Path) -> None:
    document = drawing(floor=False)
    add(document.modelspace(), PARTITION, "A-WALL")
    add(document.modelspace(), OUTER + INNER, "XYZ")
    plan = plan_of(document, tmp_path)
    assert free_mm2(plan) == pytest.approx(ROOM_MM2 - PARTITION_MM2, rel=1e-9)


def test_partition_that_meets_another_is_a_wall_as_well(tmp_path: Path) -> None:
    second: Lines = [(4120, 3500, 6000, 3500), (4120, 3620, 6000, 3620), (6000, 3500, 6000, 3620)]
    plan = plan_of(flat(PARTITION + second), tmp_path)
    area_mm2 = PARTITION_MM2 + 120 * (6000 - 4120)
    assert free_mm2(plan) == pytest.approx(ROOM_MM2 - area_mm2, rel=1e-9)


JOINTS: Lines = [(250, y, 7750, y) for y in range(550, 4700, 300)]
TREADS: Lines = [(x, 250, x, 1250) for x in range(1000, 3500, 280)]
SHELF: Lines = [(1000, 2000, 4000, 2000), (1000, 2300, 4000, 2300)]
SINGLE: Lines = [(3000, 250, 3000, 4750)]


@pytest.mark.parametrize(
    "lines", [JOINTS, TREADS, SHELF, SINGLE], ids=["joints", "treads", "shelf", "single"]
)
def test_lines_that_are_no_pair_from_wall_to_wall_are_left_out(
    lines: Lines, tmp_path: Path
) -> None:
    plan = plan_of(flat(lines), tmp_path)
    assert free_mm2(plan) == pytest.approx(ROOM_MM2, rel=1e-9)
    assert said(plan, "unclassified-left-out")
    assert not said(plan, "walls-by-look")


def opening(n_lines: int) -> Drawing:
    """An opening of 1.5 m in the lower wall, and lines across it, the faces of the wall first."""
    walls = [
        (0, 0, 1000, 0),
        (2500, 0, 8000, 0),
        *OUTER[1:],
        (250, 250, 1000, 250),
        (2500, 250, 7750, 250),
        *INNER[1:],
        (1000, 0, 1000, 250),
        (2500, 0, 2500, 250),
    ]
    across: Lines = [(1000, y, 2500, y) for y in (0, 250, 125, 150)[:n_lines]]
    return flat(across, walls=walls)


@pytest.mark.parametrize("n_lines", [3, 4])
def test_three_lines_or_more_from_jamb_to_jamb_are_a_window(n_lines: int, tmp_path: Path) -> None:
    plan = plan_of(opening(n_lines), tmp_path)
    assert free_mm2(plan) == pytest.approx(ROOM_MM2, rel=1e-9)
    (finding,) = said(plan, "window-by-look")
    assert finding.message.startswith(f"{n_lines} lines on layer 'XYZ' that run abreast")


@pytest.mark.parametrize("n_lines", [1, 2])
def test_one_or_two_may_be_a_threshold_and_are_left_out(n_lines: int, tmp_path: Path) -> None:
    plan = plan_of(opening(n_lines), tmp_path)
    assert free_mm2(plan) == pytest.approx(ROOM_MM2 + 1500 * 250, rel=1e-9)
    assert said(plan, "unclassified-left-out")


def test_pattern_of_a_wall_is_no_window(tmp_path: Path) -> None:
    pattern: Lines = [(x, 0, x, 250) for x in range(2000, 2301, 60)]
    plan = plan_of(flat(pattern), tmp_path)
    assert free_mm2(plan) == pytest.approx(ROOM_MM2, rel=1e-9)
    assert not said(plan, "window-by-look")


def test_dashed_pairs_are_beams_and_left_out(tmp_path: Path) -> None:
    document = flat(PARTITION)
    document.linetypes.add("HIDDEN", [9.525, 6.35, -3.175])
    for line in document.modelspace().query("LINE[layer=='XYZ']"):
        line.dxf.linetype = "HIDDEN"
    plan = plan_of(document, tmp_path)
    assert free_mm2(plan) == pytest.approx(ROOM_MM2, rel=1e-9)
