"""Doors without a swing on the layer of doors and windows: what marks beside them tell."""

import math
from pathlib import Path

import pytest
from ezdxf import transform
from ezdxf.document import Drawing
from ezdxf.enums import TextEntityAlignment
from ezdxf.math import Matrix44

from satAOI_geo.plan import FloorPlan
from tests.drawings import M, codes, drawing, plan_of, rectangle, standing

ON_WINDOWS = {"layer": "WINDOW"}


def shutter(width_mm: float = 4000, *, above: float = 4000) -> Drawing:
    """A wall 200 mm thick across the floor, and two lines across the opening in it.

    A mark of a window, far from it, tells that the drawing marks its openings.
    """
    document = drawing()
    space = document.modelspace()
    says(document, "C1515", (9000, 9000))
    rectangle(space, 0, above, 3000, above + 200, layer="WALL")
    rectangle(space, 3000 + width_mm, above, 10_000, above + 200, layer="WALL")
    for y in (above, above + 200):
        space.add_line((3000, y), (3000 + width_mm, y), dxfattribs=ON_WINDOWS)
    return document


def says(document: Drawing, text: str, at: tuple[float, float] = (4500, 4500)) -> None:
    document.modelspace().add_text(text, height=300, dxfattribs={"layer": "TEXT", "insert": at})


def is_shut(plan: FloorPlan) -> bool:
    return bool(standing(plan, "WINDOW"))


@pytest.mark.parametrize("text", ["JLM4045", "jlm4021a", "M4021", "FM甲4021", "TLM4024", "MLC4024"])
def test_text_of_a_door_beside_an_opening_of_its_width_opens_it_and_is_said(
    text: str, tmp_path: Path
) -> None:
    document = shutter()
    says(document, text)
    plan = plan_of(document, tmp_path)
    assert not is_shut(plan)
    assert plan.obstacle_region().area == 6000 * 200
    (said,) = [finding for finding in plan.findings if finding.code == "door-by-mark"]
    assert text in said.message
    assert said.at_mm == (5000.0, 4100.0)
    assert said.layer == "WINDOW"
    assert said.handle


@pytest.mark.parametrize("text", ["C4021", "TLC4024", "MQ4045", "M0921", "M1", "ROOM 4021"])
def test_text_of_a_window_or_of_another_width_leaves_it_shut_and_the_window_is_said(
    text: str, tmp_path: Path
) -> None:
    document = shutter()
    says(document, text)
    plan = plan_of(document, tmp_path)
    assert is_shut(plan)
    assert "door-by-mark" not in codes(plan)
    (said,) = [finding for finding in plan.findings if finding.code == "window-between-rooms"]
    assert said.at_mm == (5000.0, 4100.0)


def test_text_more_than_a_metre_away_leaves_it_shut(tmp_path: Path) -> None:
    document = shutter()
    says(document, "JLM4045", (4500, 5300))
    assert is_shut(plan_of(document, tmp_path))


def test_text_nearer_to_another_opening_leaves_it_shut(tmp_path: Path) -> None:
    document = shutter()
    # a door swings in the next wall
    document.modelspace().add_arc((3000, 5000), 900, 0, 90, dxfattribs=ON_WINDOWS)
    document.modelspace().add_line((3000, 5000), (3000, 5900), dxfattribs=ON_WINDOWS)
    says(document, "M4021", (3500, 4950))
    assert is_shut(plan_of(document, tmp_path))


@pytest.mark.parametrize(("text", "leaves_at"), [("M1021", [3000]), ("M2021", [3000, 5000])])
@pytest.mark.parametrize("turn_deg", [0.0, 143.0])
def test_text_of_a_door_that_swings_leaves_the_window_beside_it_shut(
    text: str, leaves_at: list[float], turn_deg: float, tmp_path: Path
) -> None:
    width_mm = int(text[1:3]) * 100
    document = drawing()
    space = document.modelspace()
    says(document, "C1515", (9000, 9000))
    window_at = 3000 + width_mm + 500
    for x0, x1 in ((0, 3000), (window_at - 500, window_at), (window_at + width_mm, 10_000)):
        rectangle(space, x0, 4000, x1, 4200, layer="WALL")
    for y in (4000, 4200):
        space.add_line((window_at, y), (window_at + width_mm, y), dxfattribs=ON_WINDOWS)
    for hinge in leaves_at:
        turn = (0, 90) if hinge == 3000 else (90, 180)
        space.add_arc((hinge, 4100), 1000, *turn, dxfattribs=ON_WINDOWS)
        space.add_line((hinge, 4100), (hinge, 5100), dxfattribs=ON_WINDOWS)
    says(document, text, (window_at - 200, 4400))
    transform.inplace(space, Matrix44.z_rotate(math.radians(turn_deg)))
    plan = plan_of(document, tmp_path)
    assert is_shut(plan)
    assert "door-by-mark" not in codes(plan)


def test_one_text_alone_may_name_a_machine_and_two_are_marks(tmp_path: Path) -> None:
    document = shutter()
    document.modelspace().query("TEXT").first.destroy()
    says(document, "M4021")
    alone = plan_of(document, tmp_path)
    assert is_shut(alone)
    assert "window-between-rooms" in codes(alone)
    says(document, "M0921", (9000, 9000))
    assert not is_shut(plan_of(document, tmp_path))


def test_text_written_twice_in_one_place_is_one(tmp_path: Path) -> None:
    document = shutter()
    document.modelspace().query("TEXT").first.destroy()
    says(document, "M4021")
    says(document, "M4021")
    assert is_shut(plan_of(document, tmp_path))


def test_window_with_a_text_of_its_own_stays_shut_beside_that_of_a_door(tmp_path: Path) -> None:
    document = shutter()
    says(document, "JLM4045")
    says(document, "C4015", (5500, 4500))
    assert is_shut(plan_of(document, tmp_path))


@pytest.mark.parametrize("kind", ["mtext", "centred", "in a block"])
def test_text_is_read_however_it_is_written(kind: str, tmp_path: Path) -> None:
    document = shutter()
    space = document.modelspace()
    if kind == "mtext":
        space.add_mtext("{\\fArial;JLM4045}", {"insert": (4500, 4500), "layer": "TEXT"})
    elif kind == "centred":
        text = space.add_text("JLM4045", height=300)
        text.set_placement((5000, 4500), align=TextEntityAlignment.MIDDLE_CENTER)
        text.dxf.insert = (0, 0)
    else:
        document.blocks.new("MARK").add_text("JLM4045", height=300)
        space.add_blockref("MARK", (4500, 4500))
    assert not is_shut(plan_of(document, tmp_path))


@pytest.mark.parametrize("turn_deg", [90.0, 37.0])
@pytest.mark.parametrize("x_scale", [1.0, -1.0])
def test_turned_and_mirrored_and_in_metres_it_is_the_same_door(
    turn_deg: float, x_scale: float, tmp_path: Path
) -> None:
    document = shutter()
    says(document, "JLM4045")
    document.header["$INSUNITS"] = M
    scale = Matrix44.scale(x_scale / 1000, 1 / 1000, 1)
    matrix = scale @ Matrix44.z_rotate(math.radians(turn_deg))
    transform.inplace(document.modelspace(), matrix)
    assert not is_shut(plan_of(document, tmp_path))


def test_two_leaves_that_slide_past_each_other_are_one_door_as_wide_as_both(
    tmp_path: Path,
) -> None:
    document = drawing()
    space = document.modelspace()
    says(document, "C1515", (9000, 9000))
    rectangle(space, 0, 4000, 3000, 4200, layer="WALL")
    rectangle(space, 5400, 4000, 10_000, 4200, layer="WALL")
    rectangle(space, 3000, 4060, 4300, 4100, layer="WINDOW")
    rectangle(space, 4100, 4100, 5400, 4140, layer="WINDOW")
    shut = plan_of(document, tmp_path)
    assert is_shut(shut)
    assert "window-between-rooms" in codes(shut)
    says(document, "TLM2424", (3500, 4400))
    assert not is_shut(plan_of(document, tmp_path))


def test_shutter_in_the_outer_wall_still_bounds_the_floor(tmp_path: Path) -> None:
    document = drawing(floor=False)
    space = document.modelspace()
    says(document, "C1515", (9000, 9000))
    # the faces of the walls of a hall of 10 × 8 m, open for 4 m at the bottom
    outer = [(3000, 0), (0, 0), (0, 8000), (10_000, 8000), (10_000, 0), (7000, 0)]
    inner = [(7000, 200), (9800, 200), (9800, 7800), (200, 7800), (200, 200), (3000, 200)]
    space.add_lwpolyline([*outer, *inner], close=True, dxfattribs={"layer": "WALL"})
    for y in (0, 200):
        space.add_line((3000, y), (7000, y), dxfattribs=ON_WINDOWS)
    says(document, "JLM4045", (4500, 500))
    plan = plan_of(document, tmp_path)
    assert not is_shut(plan)
    assert plan.floor.area == 10_000 * 8000


def test_window_in_an_outer_wall_needs_no_word(tmp_path: Path) -> None:
    plan = plan_of(shutter(above=9800), tmp_path)
    assert is_shut(plan)
    assert "window-between-rooms" not in codes(plan)
