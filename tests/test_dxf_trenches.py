"""Trenches drawn open: solid between their lines, and a hall is never one."""

import math
import random
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest
from ezdxf import transform
from ezdxf.document import Drawing
from ezdxf.math import Matrix44

from satAOI_geo.plan import Finding, FloorPlan, Kind
from tests.drawings import codes, drawing, plan_of, rectangle

Corners = Sequence[tuple[float, float]]

HALL_MM2 = 20_000.0 * 10_000.0
"""The hall inside its walls."""


def hall(*lines: Corners, layer: str = "TRENCH") -> Drawing:
    """A hall of 20 × 10 m between walls 200 mm thick, and open polylines in it."""
    document = drawing(floor=False)
    rectangle(document.modelspace(), 0, 0, 20_000, 10_000, layer="WALL")
    rectangle(document.modelspace(), -200, -200, 20_200, 10_200, layer="WALL")
    for line in lines:
        document.modelspace().add_lwpolyline(line, dxfattribs={"layer": layer})
    return document


def across(*heights: float, left: float = 0.0, right: float = 20_000.0) -> list[Corners]:
    """Lines from wall to wall at some heights."""
    return [((left, y), (right, y)) for y in heights]


def free_mm2(plan: FloorPlan) -> float:
    return float(plan.free_region().area)


def told(plan: FloorPlan, code: str) -> Finding:
    """The one finding of a code."""
    (finding,) = [finding for finding in plan.findings if finding.code == code]
    return finding


@pytest.mark.parametrize("width_mm", [300.0, 1200.0, 1500.0])
def test_trench_of_two_lines_from_wall_to_wall_is_solid_and_said(
    width_mm: float, tmp_path: Path
) -> None:
    plan = plan_of(hall(*across(4000, 4000 + width_mm)), tmp_path)
    assert free_mm2(plan) == HALL_MM2 - 20_000 * width_mm
    finding = told(plan, "trench-filled")
    assert (finding.layer, bool(finding.handle)) == ("TRENCH", True)
    assert finding.at_mm == pytest.approx((10_000, 4000 + width_mm / 2), abs=1.0)
    assert "lines-open" not in codes(plan)


def test_space_wider_than_any_trench_is_floor_and_its_lines_are_said(tmp_path: Path) -> None:
    plan = plan_of(hall(*across(3000, 6500)), tmp_path)
    assert free_mm2(plan) == HALL_MM2
    finding = told(plan, "lines-open")
    assert "2 open lines" in finding.message
    assert finding.handle


@pytest.mark.parametrize(("left", "right"), [(0.8, 19_999.2), (-100.0, 20_100.0)])
def test_trench_may_end_just_short_of_its_walls_or_in_them(
    left: float, right: float, tmp_path: Path
) -> None:
    plan = plan_of(hall(*across(4000, 5200, left=left, right=right)), tmp_path)
    assert free_mm2(plan) == pytest.approx(HALL_MM2 - 20_000 * 1200, abs=5.0)


def test_trench_may_end_at_the_edge_of_the_floor(tmp_path: Path) -> None:
    document = drawing()
    for y in (4000, 5200):
        document.modelspace().add_line((0, y), (10_000, y), dxfattribs={"layer": "TRENCH"})
    assert free_mm2(plan_of(document, tmp_path)) == 10_000 * (10_000 - 1200)


def test_trench_that_ends_in_the_hall_is_floor_and_said(tmp_path: Path) -> None:
    plan = plan_of(hall(*across(4000, 5200, right=8000)), tmp_path)
    assert free_mm2(plan) == HALL_MM2
    assert "lines-open" in codes(plan)


def test_between_two_trenches_lies_floor(tmp_path: Path) -> None:
    plan = plan_of(hall(*across(1000, 2000, 4000, 5000)), tmp_path)
    assert free_mm2(plan) == HALL_MM2 - 2 * 20_000 * 1000


def test_kerbs_of_a_trench_and_what_is_between_them_are_solid(tmp_path: Path) -> None:
    plan = plan_of(hall(*across(4000, 4150, 5350, 5500)), tmp_path)
    assert free_mm2(plan) == HALL_MM2 - 20_000 * 1500


def test_between_two_gutters_farther_apart_than_kerbs_lies_floor(tmp_path: Path) -> None:
    plan = plan_of(hall(*across(4000, 4200, 6200, 6400)), tmp_path)
    assert free_mm2(plan) == HALL_MM2 - 2 * 20_000 * 200


def test_corner_of_the_hall_behind_a_trench_is_floor(tmp_path: Path) -> None:
    inner = [(2000.0, 0.0), (2000.0, 2000.0), (0.0, 2000.0)]
    outer = [(3000.0, 0.0), (3000.0, 3000.0), (0.0, 3000.0)]
    plan = plan_of(hall(inner, outer), tmp_path)
    assert free_mm2(plan) == HALL_MM2 - (3000**2 - 2000**2)


def test_pit_that_two_lines_cut_off_a_corner_is_solid(tmp_path: Path) -> None:
    plan = plan_of(hall([(2000, 0), (2000, 1500), (0, 1500)], layer="PIT"), tmp_path)
    assert free_mm2(plan) == HALL_MM2 - 2000 * 1500


def test_strip_between_a_line_and_a_wall_is_floor(tmp_path: Path) -> None:
    plan = plan_of(hall(*across(2000)), tmp_path)
    assert free_mm2(plan) == HALL_MM2
    assert "lines-open" in codes(plan)


def test_last_bay_under_covers_ends_at_the_wall(tmp_path: Path) -> None:
    covers = [((x, 4000.0), (x, 4800.0)) for x in range(500, 19_600, 500)]
    plan = plan_of(hall(*across(4000, 4800), *covers), tmp_path)
    assert free_mm2(plan) == HALL_MM2 - 20_000 * 800


def test_curved_trench_is_solid(tmp_path: Path) -> None:
    document = hall()
    for radius_mm in (6000, 7000):
        on = {"layer": "TRENCH"}
        document.modelspace().add_arc((10_000, 0), radius_mm, 0, 180, dxfattribs=on)
    plan = plan_of(document, tmp_path)
    half_ring_mm2 = math.pi * (7000**2 - 6000**2) / 2
    assert free_mm2(plan) == pytest.approx(HALL_MM2 - half_ring_mm2, rel=1e-5)
    assert "lines-open" not in codes(plan)


@pytest.mark.parametrize("width_mm", [1000.0, 1400.0])
def test_trench_between_lines_with_a_width_is_solid(width_mm: float, tmp_path: Path) -> None:
    document = hall()
    for line in across(4000, 4000 + width_mm):
        on = {"layer": "TRENCH", "const_width": 20}
        document.modelspace().add_lwpolyline(line, dxfattribs=on)
    plan = plan_of(document, tmp_path)
    assert free_mm2(plan) == HALL_MM2 - 20_000 * (10 + width_mm + 10)


def test_trench_that_crosses_two_floors_is_solid_on_both(tmp_path: Path) -> None:
    document = drawing()
    rectangle(document.modelspace(), 20_000, 0, 30_000, 10_000, layer="FLOOR")
    for y in (4500, 5500):
        document.modelspace().add_line((-100, y), (30_100, y), dxfattribs={"layer": "TRENCH"})
    plan = plan_of(document, tmp_path)
    assert free_mm2(plan) == 2 * 10_000 * (10_000 - 1000)
    assert "lines-open" not in codes(plan)


def test_steps_from_wall_to_wall_are_solid(tmp_path: Path) -> None:
    document = hall(*across(*range(2000, 4801, 280)), layer="STAIR")
    assert free_mm2(plan_of(document, tmp_path)) == HALL_MM2 - 20_000 * 2800


def test_embedded_rails_are_solid_and_between_them_lies_floor(tmp_path: Path) -> None:
    document = hall(*across(4000, 4100, 5500, 5600), layer="EMBEDDED")
    assert free_mm2(plan_of(document, tmp_path)) == HALL_MM2 - 2 * 20_000 * 100


@pytest.mark.parametrize("layer", ["COLUMN", "HOLE", "EMBEDDED", "EQUIPMENT"])
def test_open_line_that_encloses_nothing_is_said_with_its_ends(layer: str, tmp_path: Path) -> None:
    plan = plan_of(hall([(5000, 5000), (7000, 5000)], layer=layer), tmp_path)
    finding = told(plan, "lines-open")
    assert "(5000.0, 5000.0)" in finding.message
    assert "(7000.0, 5000.0)" in finding.message
    assert (finding.layer, bool(finding.handle)) == (layer, True)
    assert Kind(layer.lower()) in finding.message


def test_line_inside_a_solid_is_not_said(tmp_path: Path) -> None:
    document = hall([(5000, 5000), (6000, 6000)], layer="HOLE")
    rectangle(document.modelspace(), 5000, 5000, 6000, 6000, layer="HOLE")
    assert "lines-open" not in codes(plan_of(document, tmp_path))


def turned(document: Drawing) -> None:
    transform.inplace(document.modelspace(), Matrix44.z_rotate(math.radians(30)))


def mirrored(document: Drawing) -> None:
    transform.inplace(document.modelspace(), Matrix44.scale(-1, 1, 1))


def shuffled(document: Drawing) -> None:
    random.Random(1).shuffle(document.modelspace().entity_space.entities)


@pytest.mark.parametrize("change", [turned, mirrored, shuffled])
def test_trenches_are_the_same_however_the_plan_lies(
    change: Callable[[Drawing], None], tmp_path: Path
) -> None:
    document = hall(*across(1000, 2000, 4000, 4150, 5150, 5300), [(15_000, 10_000), (15_000, 9000)])
    expected_mm2 = free_mm2(plan_of(document, tmp_path))
    assert expected_mm2 == HALL_MM2 - 20_000 * (1000 + 1300)
    change(document)
    assert free_mm2(plan_of(document, tmp_path)) == pytest.approx(expected_mm2, rel=1e-9)


def test_lines_of_a_trench_that_go_on_a_little_beyond_it_are_not_said_to_enclose_nothing(
    tmp_path: Path,
) -> None:
    document = hall(((0, 4000), (5280, 4000)), ((0, 5000), (5280, 5000)))
    document.modelspace().add_line((5000, 3800), (5000, 5200), dxfattribs={"layer": "TRENCH"})
    plan = plan_of(document, tmp_path)
    assert free_mm2(plan) == HALL_MM2 - 5000 * 1000
    assert told(plan, "trench-filled").message.startswith("1 space between")
    assert "lines-open" not in codes(plan)


def test_line_of_which_most_bounds_nothing_is_said(tmp_path: Path) -> None:
    document = hall(((0, 4000), (12_000, 4000)), ((0, 5000), (5000, 5000)))
    document.modelspace().add_line((5000, 4000), (5000, 5000), dxfattribs={"layer": "TRENCH"})
    plan = plan_of(document, tmp_path)
    assert free_mm2(plan) == HALL_MM2 - 5000 * 1000
    assert told(plan, "lines-open").message.startswith("1 open line on layer 'TRENCH'")
