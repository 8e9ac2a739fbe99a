"""Dashed lines among walls show what lies above the cut or under the floor."""

from pathlib import Path

import pytest
from ezdxf.document import Drawing
from ezdxf.math import Vec2

from tests.drawings import codes, drawing, plan_of, rectangle, standing

DASHES, POINTS = [0.375, 0.25, -0.125], [2.0, 1.25, -0.25, 0.25, -0.25]


def with_lines(linetype: str = "BYLAYER", *, layer_linetype: str = "Continuous") -> Drawing:
    """Three walls as closed outlines and a line of a linetype on one layer."""
    document = drawing()
    document.linetypes.add("HIDDEN", DASHES)
    document.linetypes.add("CENTER", POINTS)
    document.layers.add("S-WALL-UP", linetype=layer_linetype)
    for y in (1000, 2000, 3000):
        rectangle(document.modelspace(), 0, y, 10_000, y + 200, layer="WALL")
    document.modelspace().add_line(
        (0, 6000), (10_000, 6000), dxfattribs={"layer": "S-WALL-UP", "linetype": linetype}
    )
    return document


@pytest.mark.parametrize("linetype", ["HIDDEN", "CENTER"])
@pytest.mark.parametrize("of", ["linetype", "layer_linetype"])
def test_dashed_line_among_walls_is_left_out_and_said(
    linetype: str, of: str, tmp_path: Path
) -> None:
    plan = plan_of(with_lines(**{of: linetype}), tmp_path)
    assert standing(plan, "S-WALL-UP") == []
    assert len(standing(plan, "WALL")) == 3
    (said,) = [finding for finding in plan.findings if finding.code == "dashed"]
    assert (said.layer, said.at_mm) == ("S-WALL-UP", (0.0, 6000.0))
    assert said.handle


def test_layer_0_of_a_block_is_as_dashed_as_the_layer_it_is_seen_on(tmp_path: Path) -> None:
    document = with_lines(layer_linetype="HIDDEN")
    document.blocks.new("B1").add_line((0, 7000), (10_000, 7000))
    document.modelspace().add_blockref("B1", (0, 0), {"layer": "S-WALL-UP"})
    assert standing(plan_of(document, tmp_path), "S-WALL-UP") == []


@pytest.mark.parametrize("linetype", ["BYLAYER", "Continuous", "not in the drawing"])
def test_line_that_is_not_dashed_is_a_wall(linetype: str, tmp_path: Path) -> None:
    plan = plan_of(with_lines(linetype), tmp_path)
    assert len(standing(plan, "S-WALL-UP")) == 1
    assert "dashed" not in codes(plan)


def test_fence_with_signs_between_its_dashes_is_a_wall(tmp_path: Path) -> None:
    document = with_lines("FENCE")
    pattern = 'A,.25,-.1,["X",STANDARD,S=.1,U=0.0,X=-0.1,Y=-.05],-.25'
    document.linetypes.add("FENCE", pattern, length=1.45)
    assert len(standing(plan_of(document, tmp_path), "S-WALL-UP")) == 1


def test_where_most_walls_are_dashed_they_are_walls(tmp_path: Path) -> None:
    document = with_lines("HIDDEN")
    for wall in document.modelspace().query("LWPOLYLINE[layer=='WALL']"):
        wall.dxf.linetype = "HIDDEN"
    plan = plan_of(document, tmp_path)
    assert len(standing(plan, "S-WALL-UP")) == 1
    assert len(standing(plan, "WALL")) == 3


def test_dashed_lines_on_a_layer_that_the_user_names_are_walls(tmp_path: Path) -> None:
    own = tmp_path / "own.toml"
    own.write_text('[layers]\nwall = ["S-WALL-UP"]\n', encoding="utf-8")
    plan = plan_of(with_lines("HIDDEN"), tmp_path, layers=own)
    assert len(standing(plan, "S-WALL-UP")) == 1


def test_dashed_swing_among_walls_is_still_a_door(tmp_path: Path) -> None:
    document = with_lines()
    space = document.modelspace()
    space.add_arc((4000, 3200), 900, 0, 90, dxfattribs={"layer": "WALL", "linetype": "HIDDEN"})
    space.add_line(Vec2(4000, 3200), Vec2(4000, 4100), dxfattribs={"layer": "WALL"})
    plan = plan_of(document, tmp_path)
    assert "door-among-walls" in codes(plan)
    assert max(obstacle.region().bounds[3] for obstacle in standing(plan, "WALL")) == 3200


def test_fill_and_wide_line_are_walls_whatever_their_linetype(tmp_path: Path) -> None:
    document = with_lines()
    on = {"layer": "WALL", "linetype": "HIDDEN"}
    document.modelspace().add_solid([(0, 8000), (500, 8000), (0, 8200), (500, 8200)], on)
    document.modelspace().add_lwpolyline(
        [(0, 9000), (500, 9000)], dxfattribs=on | {"const_width": 200}
    )
    assert len(standing(plan_of(document, tmp_path), "WALL")) == 5


@pytest.mark.parametrize("of", ["linetype", "layer_linetype"])
def test_dashed_panel_of_an_overhead_door_is_no_wall(of: str, tmp_path: Path) -> None:
    linetypes = {"linetype": "BYLAYER", "layer_linetype": "Continuous", of: "HIDDEN"}
    document = with_lines()
    document.layers.add("DOOR", linetype=linetypes["layer_linetype"])
    corners = [Vec2(2000, 6500), Vec2(5000, 6500), Vec2(5000, 9000), Vec2(2000, 9000)]
    for start, end in zip(corners, [*corners[1:], corners[0]], strict=True):
        on = {"layer": "DOOR", "linetype": linetypes["linetype"]}
        document.modelspace().add_line(start, end, dxfattribs=on)
    plan = plan_of(document, tmp_path)
    assert standing(plan, "DOOR") == []
    assert "wall-on-door-layer" not in codes(plan)
