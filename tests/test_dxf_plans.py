"""Several plans in one drawing, and what lies beside, under or behind them."""

import math
from itertools import pairwise
from pathlib import Path

import ezdxf
import pytest
from ezdxf import transform
from ezdxf.document import Drawing
from ezdxf.layouts import Modelspace
from ezdxf.math import Matrix44, Vec2

from satAOI_geo.errors import DrawingError, InputError
from tests.drawings import MM, codes, drawing, plan_of, rectangle, standing


def sheet() -> Drawing:
    """A plan with doors and a column, a section beside it, and a title block."""
    document = ezdxf.new("R2010")
    document.header["$INSUNITS"] = MM
    space = document.modelspace()
    rectangle(space, 0, 0, 8000, 6000, layer="WALL")
    rectangle(space, 200, 200, 7800, 5800, layer="WALL")
    rectangle(space, 4000, 3000, 4300, 3300, layer="COLUMN")
    space.add_arc((200, 3000), 900, 0, 90, dxfattribs={"layer": "DOOR"})
    # a section is drawn with walls, too
    rectangle(space, 20_000, 0, 28_000, 3000, layer="WALL")
    rectangle(space, 20_200, 0, 27_800, 2800, layer="WALL")
    rectangle(space, -1000, -3000, 40_000, 10_000, layer="XYZ")
    return document


def test_likeliest_plan_is_read_and_the_choice_is_said(tmp_path: Path) -> None:
    plan = plan_of(sheet(), tmp_path)
    assert plan.frame.origin_mm == (0.0, 0.0)
    assert plan.floor.area == 8000 * 6000
    assert "several-plans" in codes(plan)
    assert standing(plan, "XYZ") == []


def test_plans_far_from_the_origin_are_told_with_all_their_digits(tmp_path: Path) -> None:
    document = sheet()
    for entity in document.modelspace():
        entity.translate(3_456_789_000, 5_432_109_000, 0)
    (said,) = [f.message for f in plan_of(document, tmp_path).findings if f.code == "several-plans"]
    assert "from (3456789000, 5432109000) to (3456797000, 5432115000)" in said


def test_what_is_left_out_is_told_by_its_kind(tmp_path: Path) -> None:
    (said,) = [f.message for f in plan_of(sheet(), tmp_path).findings if f.code == "left-out"]
    # the section's two outlines, and the frame
    assert said == "3 entities outside the plan are left out, of obstacles 2 wall"


@pytest.mark.parametrize("places", [(0, 20_000), (20_000, 0)])
def test_of_two_equal_plans_the_leftmost_is_read(places: tuple[int, int], tmp_path: Path) -> None:
    document = drawing(floor=False)
    for x in places:
        rectangle(document.modelspace(), x, 0, x + 8000, 6000, layer="WALL")
    assert plan_of(document, tmp_path).frame.origin_mm == (0.0, 0.0)


def test_facade_on_a_layer_that_nobody_knows_holds_one_plan_together(tmp_path: Path) -> None:
    document = drawing(floor=False)
    space = document.modelspace()
    for x in (0, 12_000):
        # a core, walls all around
        rectangle(space, x, 0, x + 3000, 3000, layer="WALL")
        rectangle(space, x + 200, 200, x + 2800, 2800, layer="WALL")
    for x in (3000, 7500):
        rectangle(space, x, 0, x + 4500, 200, layer="XYZ")
        rectangle(space, x, 2800, x + 4500, 3000, layer="XYZ")
    plan = plan_of(document, tmp_path)
    assert plan.floor.area == 2 * 3000 * 3000
    assert not {"several-plans", "left-out"} & set(codes(plan))


def test_plan_is_chosen_by_number(tmp_path: Path) -> None:
    assert plan_of(sheet(), tmp_path, plan=1).frame.origin_mm == (0.0, 0.0)
    assert plan_of(sheet(), tmp_path, plan=2).frame.origin_mm == (20_000.0, 0.0)


def test_plan_is_chosen_by_the_start(tmp_path: Path) -> None:
    plan = plan_of(sheet(), tmp_path, start=(24_000.0, 1500.0))
    assert plan.frame.origin_mm == (20_000.0, 0.0)


def test_plan_is_chosen_by_a_region(tmp_path: Path) -> None:
    plan = plan_of(sheet(), tmp_path, region=(19_000.0, -500.0, 29_000.0, 4000.0))
    assert plan.frame.origin_mm == (20_000.0, 0.0)
    assert plan.floor.area == 8000 * 3000


def test_region_around_no_floor_is_the_floor(tmp_path: Path) -> None:
    document = ezdxf.new("R2010")
    document.header["$INSUNITS"] = MM
    rectangle(document.modelspace(), 1000, 1000, 1500, 1500, layer="EQUIPMENT")
    plan = plan_of(document, tmp_path, region=(0.0, 0.0, 4000.0, 3000.0))
    assert plan.floor.area == 4000 * 3000
    assert "floor-region" in codes(plan)


def test_number_without_a_plan_is_refused_with_the_plans(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no plan 3; the drawing holds 2: 1 from \(0, 0\)"):
        plan_of(sheet(), tmp_path, plan=3)


def test_region_without_area_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no area"):
        plan_of(sheet(), tmp_path, region=(0.0, 0.0, 0.0, 5.0))


def test_columns_far_apart_in_one_hall_stay_together(tmp_path: Path) -> None:
    document = drawing()
    for x in (1000, 9000):
        for y in (1000, 9000):
            rectangle(document.modelspace(), x, y, x + 300, y + 300, layer="COLUMN")
    plan = plan_of(document, tmp_path)
    assert len(standing(plan, "COLUMN")) == 4
    assert "several-plans" not in codes(plan)


def test_layout_is_read_where_model_space_is_empty(tmp_path: Path) -> None:
    document = ezdxf.new("R2010")
    document.header["$INSUNITS"] = MM
    layout = document.layouts.new("Ground floor")
    corners = [(0, 0), (5000, 0), (5000, 4000), (0, 4000)]
    layout.add_lwpolyline(corners, close=True, dxfattribs={"layer": "FLOOR"})
    plan = plan_of(document, tmp_path)
    assert plan.floor.area == 5000 * 4000
    assert "paper-space" in codes(plan)


def with_foreign(kind: str, layer: str) -> str:
    """A drawing with an object of another program that carries no picture of itself."""
    import io

    stream = io.StringIO()
    document = drawing()
    document.modelspace().add_point((1, 1), dxfattribs={"layer": "MARKER"})
    document.write(stream)
    text = stream.getvalue()
    end = text.index("POINT\n", text.index("ENTITIES"))
    start = text.rindex("  0\n", 0, end)
    stop = text.index("  0\n", end)
    point = text[start:stop]
    foreign = f"  0\n{kind}\n  5\nFEED\n100\nAcDbEntity\n  8\n{layer}\n100\nForeignPart\n"
    return text.replace(point, foreign)


@pytest.mark.parametrize(
    ("kind", "layer"), [("TCH_WALL", "XYZ"), ("TCH_SPACE", "WALL"), ("ACAD_PROXY_ENTITY", "柱")]
)
def test_foreign_object_that_may_stop_the_robot_is_refused(
    kind: str, layer: str, tmp_path: Path
) -> None:
    path = tmp_path / "plan.dxf"
    path.write_text(with_foreign(kind, layer), encoding="utf-8")
    from satAOI_adapters.dxf_read import ReadOptions, read

    with pytest.raises(DrawingError, match="T3") as caught:
        read(path, ReadOptions())
    assert f"1 {kind} on layer '{layer}'" in str(caught.value)


def test_foreign_object_elsewhere_is_said(tmp_path: Path) -> None:
    path = tmp_path / "plan.dxf"
    path.write_text(with_foreign("TCH_TEXT", "XYZ"), encoding="utf-8")
    from satAOI_adapters.dxf_read import ReadOptions, read

    assert "entity-unread" in codes(read(path, ReadOptions()))


def with_xref() -> Drawing:
    document = drawing()
    document.add_xref_def(filename="..\\shared\\base.dwg", name="base")
    document.modelspace().add_blockref("base", (2000, 1000), {"layer": "XREF-LAYER"})
    return document


def test_missing_external_reference_is_refused_with_its_file(tmp_path: Path) -> None:
    with pytest.raises(DrawingError, match=r"base\.dwg.*--xref-dir"):
        plan_of(with_xref(), tmp_path)


def test_external_reference_is_read_from_the_folder_given(tmp_path: Path) -> None:
    folder = tmp_path / "shared"
    folder.mkdir()
    base = ezdxf.new("R2010")
    rectangle(base.modelspace(), 0, 0, 300, 400, layer="COLUMN")
    base.saveas(folder / "Base.dxf")
    plan = plan_of(with_xref(), tmp_path, xref_dir=folder)
    (column,) = standing(plan, "base|COLUMN")
    assert column.region().bounds == (2000, 1000, 2300, 1400)


def test_external_reference_that_the_layer_file_ignores_may_be_missing(tmp_path: Path) -> None:
    layers = tmp_path / "office.toml"
    layers.write_text('[blocks]\nignore = ["base"]\n', encoding="utf-8")
    plan = plan_of(with_xref(), tmp_path, layers=layers)
    assert "xref-missing" in codes(plan)


def test_folder_of_references_must_exist(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="nowhere"):
        plan_of(with_xref(), tmp_path, xref_dir=tmp_path / "nowhere")


def rectangle_of_lines(space: Modelspace, bounds: tuple[float, float, float, float]) -> None:
    """A rectangle as four lines on layer 0."""
    left, bottom, right, top = bounds
    corners = [(left, bottom), (right, bottom), (right, top), (left, top)]
    for start, end in pairwise([*corners, corners[0]]):
        space.add_line(start, end, dxfattribs={"layer": "0"})


def flat_on_layer_0(*, with_door: bool = True, open_deg: float = 90.0) -> Drawing:
    """A room of 6 × 4 m inside walls 200 mm thick, with a shaft and a door in its lower wall."""
    document = drawing(floor=False)
    space = document.modelspace()
    corners = [(2000, 0), (-200, 0), (-200, 4400), (6200, 4400), (6200, 0), (2900, 0), (2900, 200)]
    corners += [(6000, 200), (6000, 4200), (0, 4200), (0, 200), (2000, 200)]
    for start, end in pairwise([*corners, corners[0]]):
        space.add_line(start, end, dxfattribs={"layer": "0"})
    if with_door:
        space.add_arc((2000, 200), 900, 0, open_deg, dxfattribs={"layer": "0"})
        tip = Vec2(2000, 200) + Vec2.from_deg_angle(open_deg, 900)
        space.add_line((2000, 200), tip, dxfattribs={"layer": "0"})
    return document


@pytest.mark.parametrize("open_deg", [30.0, 90.0])
@pytest.mark.parametrize("margin_mm", [0.0, 500.0])
def test_frame_and_title_block_among_the_walls_are_left_out_and_said(
    margin_mm: float, open_deg: float, tmp_path: Path
) -> None:
    bare = plan_of(flat_on_layer_0(open_deg=open_deg), tmp_path)
    document = flat_on_layer_0(open_deg=open_deg)
    space = document.modelspace()
    rectangle_of_lines(space, (-5000, -6000, 16_000, 9000))
    if margin_mm:
        left, bottom, right, top = -5000, -6000, 16_000, 9000
        outer = (left - margin_mm, bottom - margin_mm, right + margin_mm, top + margin_mm)
        rectangle_of_lines(space, outer)
    space.add_line((9000, -6000), (9000, -4000), dxfattribs={"layer": "0"})
    space.add_line((9000, -4000), (16_000, -4000), dxfattribs={"layer": "0"})
    framed = plan_of(document, tmp_path)
    assert "frame" in codes(framed)
    assert framed.floor.equals(bare.floor)
    assert [o.shape for o in framed.obstacles] == [o.shape for o in bare.obstacles]


def test_plans_in_one_frame_are_told_apart(tmp_path: Path) -> None:
    document = flat_on_layer_0()
    space = document.modelspace()
    for entity in list(space):
        twin = entity.copy()
        twin.translate(12_000, 0, 0)
        space.add_entity(twin)
    rectangle_of_lines(space, (-5000, -6000, 25_000, 9000))
    assert {"frame", "several-plans"} <= set(codes(plan_of(document, tmp_path)))


@pytest.mark.parametrize("what", ["no door", "a wall joined", "a wall near", "two faces"])
def test_rectangle_that_may_be_a_wall_is_no_frame(what: str, tmp_path: Path) -> None:
    document = flat_on_layer_0(with_door=what != "no door")
    space = document.modelspace()
    rectangle_of_lines(space, (-5000, -6000, 16_000, 9000))
    if what == "a wall joined":
        space.add_line((-5000, 2000), (-200, 2000), dxfattribs={"layer": "0"})
    elif what == "a wall near":
        space.add_line((10_000, 8500), (12_000, 8500), dxfattribs={"layer": "0"})
    elif what == "two faces":
        rectangle_of_lines(space, (-5240, -6240, 16_240, 9240))
    plan = plan_of(document, tmp_path)
    assert "frame" not in codes(plan)
    assert plan.floor.area >= 21_000 * 15_000


def in_a_frame(document: Drawing, *, margin_mm: float, around: str) -> None:
    """Draw a rectangle, or two, around a flat, perhaps with a title block in its corner."""
    space = document.modelspace()
    left, bottom, right, top = -2200, -2000, 8200, 6400
    rectangle_of_lines(space, (left, bottom, right, top))
    if margin_mm:
        outer = (left - margin_mm, bottom - margin_mm, right + margin_mm, top + margin_mm)
        rectangle_of_lines(space, outer)
    if around == "frame with title block":
        space.add_line((4000, bottom), (4000, bottom + 1000), dxfattribs={"layer": "0"})
        space.add_line((4000, bottom + 1000), (right, bottom + 1000), dxfattribs={"layer": "0"})


@pytest.mark.parametrize("turn_deg", [0.0, 30.0])
@pytest.mark.parametrize("margin_mm", [0.0, 300.0, 500.0])
@pytest.mark.parametrize("around", ["frame", "frame with title block"])
def test_frame_around_walls_that_enclose_rooms_needs_no_door_to_be_left_out(
    around: str, margin_mm: float, turn_deg: float, tmp_path: Path
) -> None:
    document = flat_on_layer_0(with_door=False)
    in_a_frame(document, margin_mm=margin_mm, around=around)
    transform.inplace(document.modelspace(), Matrix44.z_rotate(math.radians(turn_deg)))
    plan = plan_of(document, tmp_path)
    assert plan.floor.area == pytest.approx(6400 * 4400)
    (said,) = [finding for finding in plan.findings if finding.code == "frame"]
    whole_m2 = (10.4 + 2 * margin_mm / 1000) * (8.4 + 2 * margin_mm / 1000)
    assert f"encloses {whole_m2:.2f} m², the walls in it 28.16 m²" in said.message
    assert said.layer == "0"
    assert said.at_mm is not None


@pytest.mark.parametrize(
    ("what", "sign"),
    [
        ("a hall with a core", "spans only 30% of it"),
        ("columns", "3 closed things stand between it and the walls"),
        ("walls of single lines", "do not run side by side"),
        ("a second face", "as far away, 200 mm, as the faces of walls"),
    ],
)
def test_rectangle_around_rooms_that_may_be_a_wall_is_one_and_both_areas_are_said(
    what: str, sign: str, tmp_path: Path
) -> None:
    document = flat_on_layer_0(with_door=False)
    space = document.modelspace()
    if what == "walls of single lines":
        space.delete_all_entities()
        corners = [(-200, 0), (6200, 0), (6200, 4400), (1400, 4400), (1400, 4000), (-200, 4000)]
        for start, end in pairwise([*corners, corners[0]]):
            space.add_line(start, end, dxfattribs={"layer": "0"})
    if what == "a hall with a core":
        rectangle_of_lines(space, (-5000, -6000, 16_000, 9000))
    else:
        margin_mm = 200.0 if what == "a second face" else 0.0
        in_a_frame(document, margin_mm=margin_mm, around="wall")
    if what == "columns":
        for x in (-1000, 3000, 7000):
            rectangle(space, x, 5200, x + 300, 5500, layer="0")
    plan = plan_of(document, tmp_path)
    assert plan.floor.area >= 10_400 * 8400
    (said,) = [finding for finding in plan.findings if finding.code == "frame-or-wall"]
    assert sign in said.message
    enclosed_m2 = 27.52 if what == "walls of single lines" else 28.16
    areas = f"it encloses {plan.floor.area / 1e6:.2f} m², the walls in it {enclosed_m2} m²"
    assert areas in said.message
    assert "--region" in said.remedy


@pytest.mark.parametrize("known", ["layer", "floor"])
def test_rectangle_is_no_frame_where_its_layer_or_a_floor_says_so(
    known: str, tmp_path: Path
) -> None:
    document = flat_on_layer_0(with_door=False)
    in_a_frame(document, margin_mm=0, around="wall")
    if known == "layer":
        for entity in document.modelspace():
            entity.dxf.layer = "WALL"
    else:
        rectangle(document.modelspace(), -2200, -2000, 8200, 6400, layer="FLOOR")
    plan = plan_of(document, tmp_path)
    assert plan.floor.area == 10_400 * 8400
    assert "frame" not in codes(plan)


def test_walls_told_by_their_look_may_have_a_frame_around_them(tmp_path: Path) -> None:
    document = flat_on_layer_0(with_door=False)
    in_a_frame(document, margin_mm=0, around="frame")
    # a column in the room tells that there must be walls
    rectangle(document.modelspace(), 3000, 2000, 3300, 2300, layer="COLUMN")
    plan = plan_of(document, tmp_path)
    assert {"walls-by-look", "frame"} <= set(codes(plan))
    assert plan.floor.area == 6400 * 4400


@pytest.mark.parametrize("core", [False, True])
@pytest.mark.parametrize("with_door", [False, True])
def test_frame_is_told_from_the_walls_of_a_rectangular_building_in_it(
    *, with_door: bool, core: bool, tmp_path: Path
) -> None:
    document = flat_on_layer_0(with_door=with_door)
    space = document.modelspace()
    # the flat is a core in a building of two outlines, or joined to it by a wall
    rectangle(space, -3000, -3000, 9000, 7000, layer="0")
    rectangle(space, -2800, -2800, 8800, 6800, layer="0")
    if not core:
        space.add_line((6200, 2000), (8800, 2000), dxfattribs={"layer": "0"})
        space.add_line((6200, 2100), (8800, 2100), dxfattribs={"layer": "0"})
    rectangle_of_lines(space, (-6000, -6000, 12_000, 9000))
    plan = plan_of(document, tmp_path)
    assert plan.floor.area == 12_000 * 10_000
    assert "frame" in codes(plan)


def test_rectangle_around_tanks_is_a_wall(tmp_path: Path) -> None:
    document = drawing(floor=False)
    space = document.modelspace()
    for distance_mm in (0, 300):
        bounds = (distance_mm, distance_mm, 30_000 - distance_mm, 18_000 - distance_mm)
        rectangle_of_lines(space, bounds)
    for x in (7000, 15_000, 23_000):
        for radius_mm in (3000, 2800):
            space.add_circle((x, 9000), radius_mm, dxfattribs={"layer": "0"})
    plan = plan_of(document, tmp_path)
    assert plan.floor.area == 30_000 * 18_000
    (said,) = [finding for finding in plan.findings if finding.code == "frame-or-wall"]
    assert "3 closed things without an opening" in said.message
