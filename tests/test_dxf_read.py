"""What DXF entities become: exact where the format is, on the safe side where it is not."""

import math
from pathlib import Path

import ezdxf
import numpy as np
import pytest
import shapely
from ezdxf.document import Drawing
from ezdxf.math import Matrix44
from hypothesis import given
from hypothesis import strategies as st
from shapely.geometry import LineString, Polygon

from satAOI_adapters.dxf_read.curves import (
    SAGITTA_MM,
    Arc,
    Line,
    arc_about,
    arc_of_bulge,
)
from satAOI_adapters.dxf_read.curves import (
    Path as Outline,
)
from satAOI_adapters.dxf_read.options import ReadOptions
from satAOI_adapters.dxf_read.shapes import circle_of, room, solid, traces
from satAOI_geo.errors import (
    DrawingError,
    EmptyPlanError,
    InputError,
    LimitError,
    UnitError,
    UnreadableError,
)
from satAOI_geo.plan import Circle, Kind
from tests.drawings import CM, INCH, M, codes, drawing, plan_of, rectangle, standing

FAR_MM = (568_053_449, 5_774_347_227)


def test_full_circle_stays_a_circle(tmp_path: Path) -> None:
    document = drawing()
    document.modelspace().add_circle((3000, 4000), 350, dxfattribs={"layer": "COLUMN"})
    (column,) = standing(plan_of(document, tmp_path), "COLUMN")
    assert column.shape == Circle(3000.0, 4000.0, 350.0)
    assert column.kind is Kind.COLUMN


def test_circle_drawn_as_two_bulges_is_a_circle(tmp_path: Path) -> None:
    document = drawing()
    document.modelspace().add_lwpolyline(
        [(2650, 4000, 1), (3350, 4000, 1)], format="xyb", close=True, dxfattribs={"layer": "COLUMN"}
    )
    (column,) = standing(plan_of(document, tmp_path), "COLUMN")
    assert column.shape == Circle(3000.0, 4000.0, 350.0)


def test_closed_polyline_keeps_its_corners_exactly(tmp_path: Path) -> None:
    document = drawing()
    rectangle(document.modelspace(), 1000, 2000, 1500, 2600, layer="COLUMN")
    (column,) = standing(plan_of(document, tmp_path), "COLUMN")
    assert column.shape == Polygon([(1000, 2000), (1500, 2000), (1500, 2600), (1000, 2600)])


def test_open_line_is_an_obstacle_without_width(tmp_path: Path) -> None:
    document = drawing()
    document.modelspace().add_line((1000, 1000), (1000, 4000), dxfattribs={"layer": "WALL"})
    (wall,) = standing(plan_of(document, tmp_path), "WALL")
    assert wall.shape == LineString([(1000, 1000), (1000, 4000)])


@pytest.mark.parametrize("bulge", [0.1, 1.0, -1.0, 2.5])
def test_bulge_goes_from_corner_to_corner_over_its_sagitta(bulge: float) -> None:
    arc = arc_of_bulge((0.0, 0.0), (200.0, 0.0), bulge)
    assert isinstance(arc, Arc)
    middle = arc_about(arc.centre, (arc.u, arc.v), 0.0, arc.sweep_rad / 2).end
    # the height of an arc over its chord is bulge × half the chord, to the right when positive
    assert middle == pytest.approx((100.0, -100.0 * bulge), abs=1e-10)
    assert arc.is_round
    assert arc.turns_left == (bulge > 0)


@pytest.mark.parametrize("radius_mm", [0.05, 350.0, 10_000.0])
def test_every_corner_of_the_polyline_for_an_arc_keeps_its_side(radius_mm: float) -> None:
    arc = arc_about((0.0, 0.0), ((radius_mm, 0.0), (0.0, radius_mm)), 0.3, 2.0)
    rounding_mm = 1e-9 * radius_mm
    for corner in arc.chords():
        assert math.hypot(*corner) == pytest.approx(radius_mm, abs=rounding_mm)
    for corner in arc.tangents()[1:-1]:
        assert radius_mm < math.hypot(*corner) <= radius_mm + SAGITTA_MM + rounding_mm


def test_small_circle_keeps_sixteen_sides() -> None:
    arc = arc_about((0.0, 0.0), ((0.05, 0.0), (0.0, 0.05)), 0.0, math.tau)
    assert arc.steps() == 16


def half_disc(radius_mm: float) -> Outline:
    """A half disc over the x axis."""
    arc = arc_about((0.0, 0.0), ((radius_mm, 0.0), (0.0, radius_mm)), 0.0, math.pi)
    return Outline((arc, Line(arc.end, arc.start)), closed=True)


def bitten_square(side_mm: float, radius_mm: float) -> Outline:
    """A square with a half disc cut out of its lower side."""
    arc = arc_about((0.0, 0.0), ((-radius_mm, 0.0), (0.0, radius_mm)), 0.0, math.pi)
    corners = [arc.end, (side_mm, 0.0), (side_mm, side_mm), (-side_mm, side_mm), (-side_mm, 0.0)]
    lines = [Line(a, b) for a, b in zip(corners, [*corners[1:], arc.start], strict=True)]
    return Outline((arc, *lines), closed=True)


@pytest.mark.parametrize("radius_mm", [20.0, 350.0, 5000.0])
@pytest.mark.parametrize("shape", ["half disc", "bitten square"])
def test_obstacle_contains_the_true_shape_and_floor_lies_in_it(
    shape: str, radius_mm: float
) -> None:
    disc_mm2 = math.pi * radius_mm**2 / 2
    if shape == "half disc":
        path, true_mm2 = half_disc(radius_mm), disc_mm2
    else:
        path, true_mm2 = bitten_square(2 * radius_mm, radius_mm), 8 * radius_mm**2 - disc_mm2
    (outer,), (inner,) = solid(path), room(path)
    assert inner.area < true_mm2 < outer.area
    assert outer.area - true_mm2 < SAGITTA_MM * outer.length
    assert true_mm2 - inner.area < SAGITTA_MM * outer.length


def test_curved_wall_without_width_lies_in_a_sliver(tmp_path: Path) -> None:
    document = drawing()
    document.modelspace().add_arc((5000, 5000), 2000, 10, 100, dxfattribs={"layer": "WALL"})
    (wall,) = standing(plan_of(document, tmp_path), "WALL")
    assert isinstance(wall.shape, Polygon)
    angles = np.radians(np.linspace(10, 100, 1001))
    arc = shapely.points(5000 + 2000 * np.cos(angles), 5000 + 2000 * np.sin(angles))
    # corners are rounded to 1e-5 mm
    assert shapely.distance(wall.shape, arc).max() <= 1e-5
    assert wall.shape.area < 2 * SAGITTA_MM * 2000 * math.radians(90)


@given(
    a=st.floats(100, 2000),
    ratio=st.floats(0.05, 1.0),
    turn=st.floats(0, math.pi),
)
def test_polygon_of_an_ellipse_contains_it_within_the_bound(
    a: float, ratio: float, turn: float
) -> None:
    b = a * ratio
    major = (a * math.cos(turn), a * math.sin(turn))
    minor = (-b * math.sin(turn), b * math.cos(turn))
    ellipse = arc_about((0.0, 0.0), (major, minor), 0.0, math.tau)
    (outer,) = solid(Outline((ellipse,), closed=True)) if ratio < 1 else (None,)
    if outer is None:
        return
    parameter = np.linspace(0, math.tau, 500)
    x = major[0] * np.cos(parameter) + minor[0] * np.sin(parameter)
    y = major[1] * np.cos(parameter) + minor[1] * np.sin(parameter)
    assert shapely.distance(outer, shapely.points(x, y)).max() <= 1e-5
    assert 0 < outer.area - math.pi * a * b < SAGITTA_MM * outer.length


def test_circle_in_a_stretched_block_is_an_ellipse_on_the_outer_side(tmp_path: Path) -> None:
    document = drawing()
    block = document.blocks.new("PIER")
    block.add_circle((0, 0), 100, dxfattribs={"layer": "COLUMN"})
    document.modelspace().add_blockref("PIER", (5000, 5000), {"xscale": 3, "yscale": 2})
    (column,) = standing(plan_of(document, tmp_path), "COLUMN")
    assert isinstance(column.shape, Polygon)
    true_mm2 = math.pi * 300 * 200
    assert 0 < column.shape.area - true_mm2 < SAGITTA_MM * column.shape.length


def test_closed_spline_contains_its_curve(tmp_path: Path) -> None:
    document = drawing()
    spline = document.modelspace().add_spline(dxfattribs={"layer": "HOLE"})
    spline.set_closed([(1000, 1000, 0), (3000, 1200, 0), (3500, 3000, 0), (1500, 3500, 0)])
    (hole,) = standing(plan_of(document, tmp_path), "HOLE")
    curve = list(spline.construction_tool().approximate(2000))
    points = shapely.points([(p.x, p.y) for p in curve])
    assert shapely.distance(hole.region(), points).max() <= 1e-5
    assert hole.region().area - Polygon([(p.x, p.y) for p in curve]).area < 4 * SAGITTA_MM * 9000


def everything(space: ezdxf.layouts.BaseLayout) -> None:
    """One of each type of entity, none symmetric, all on layer COLUMN."""
    on = {"layer": "COLUMN"}
    space.add_line((100, 0), (400, 90), dxfattribs=on)
    space.add_lwpolyline(
        [(0, 500, 0.4), (300, 500, 0), (350, 800, -0.3), (0, 700, 0)],
        format="xyb",
        close=True,
        dxfattribs=on,
    )
    space.add_circle((700, 200), 90, dxfattribs=on)
    space.add_arc((700, 700), 150, 20, 140, dxfattribs=on)
    space.add_ellipse((1200, 300), (200, 60), 0.4, 0.2, 2.5, dxfattribs=on)
    space.add_solid([(1500, 0), (1600, 20), (1500, 90), (1620, 110)], dxfattribs=on)
    space.add_polyline2d(
        [(1400, 600, 0.5), (1700, 650, 0), (1500, 900, 0)], format="xyb", close=True, dxfattribs=on
    )
    hatch = space.add_hatch(dxfattribs=on)
    edges = hatch.paths.add_edge_path()
    edges.add_line((2000, 0), (2300, 0))
    edges.add_arc((2300, 150), 150, 270, 90, ccw=True)
    edges.add_line((2300, 300), (2000, 300))
    edges.add_arc((2000, 150), 150, 90, 270, ccw=True)


def in_block(**placement: object) -> Drawing:
    document = drawing()
    block = document.blocks.new("THINGS", base_point=(50, 20))
    everything(block)
    reference = document.modelspace().add_blockref("THINGS", (5000, 5000))
    reference.update_dxf_attribs(placement)
    return document


def regions(plan_obstacles: list[object]) -> list[shapely.Geometry]:
    return sorted(
        (obstacle.region() for obstacle in plan_obstacles),  # type: ignore[attr-defined]
        key=lambda region: (round(region.centroid.x, 2), round(region.centroid.y, 2)),
    )


@pytest.mark.parametrize(
    ("placement", "matrix"),
    [
        ({"xscale": -1}, (-1, 0, 0, 1)),
        ({"yscale": -1}, (1, 0, 0, -1)),
        ({"xscale": -1, "rotation": 90}, (0, -1, -1, 0)),
        ({"xscale": -2, "yscale": 2}, (-2, 0, 0, 2)),
        ({"xscale": -1, "yscale": -1}, (-1, 0, 0, -1)),
        ({"extrusion": (0, 0, -1), "insert": (-5000, 5000, 0)}, (-1, 0, 0, 1)),
    ],
)
def test_mirrored_block_is_the_reflected_plan(
    placement: dict[str, object], matrix: tuple[float, ...], tmp_path: Path
) -> None:
    upright = standing(plan_of(in_block(), tmp_path), "COLUMN")
    mirrored = standing(plan_of(in_block(**placement), tmp_path), "COLUMN")
    assert len(upright) == len(mirrored) == 8
    a, b, d, e = matrix
    # about the insertion point (5000, 5000)
    shift = (5000 - 5000 * (a + b), 5000 - 5000 * (d + e))
    expected = [
        shapely.affinity.affine_transform(o.region(), [a, b, d, e, *shift]) for o in upright
    ]
    drawn = regions(list(mirrored))
    wanted = sorted(expected, key=lambda r: (round(r.centroid.x, 2), round(r.centroid.y, 2)))
    for one, other in zip(drawn, wanted, strict=True):
        # both keep to their curves within the sagitta
        assert one.hausdorff_distance(other) < 2 * SAGITTA_MM


def test_nested_blocks_and_their_layers(tmp_path: Path) -> None:
    document = drawing()
    inner = document.blocks.new("INNER")
    inner.add_circle((0, 0), 100)
    outer = document.blocks.new("OUTER")
    outer.add_blockref("INNER", (500, 0), {"layer": "0", "xscale": 2, "yscale": 2})
    document.modelspace().add_blockref("OUTER", (5000, 5000), {"layer": "COLUMN", "rotation": 90})
    (column,) = standing(plan_of(document, tmp_path), "COLUMN")
    assert column.shape == Circle(5000.0, 5500.0, 200.0)


def test_array_of_blocks_stands_row_by_row(tmp_path: Path) -> None:
    document = drawing()
    document.blocks.new("PIER").add_circle((0, 0), 100)
    document.modelspace().add_blockref(
        "PIER",
        (1000, 1000),
        {
            "layer": "COLUMN",
            "column_count": 3,
            "row_count": 2,
            "column_spacing": 2000,
            "row_spacing": 3000,
        },
    )
    columns = standing(plan_of(document, tmp_path), "COLUMN")
    places = {(c.shape.x_mm, c.shape.y_mm) for c in columns if isinstance(c.shape, Circle)}
    assert places == {(x, y) for x in (1000, 3000, 5000) for y in (1000, 4000)}


def test_array_may_have_more_copies_than_blocks_have_levels(tmp_path: Path) -> None:
    document = drawing()
    document.blocks.new("PIER").add_circle((0, 0), 100)
    array = {"column_count": 9, "row_count": 8, "column_spacing": 1000, "row_spacing": 1000}
    document.modelspace().add_blockref("PIER", (1000, 1000), {"layer": "COLUMN", **array})
    assert len(standing(plan_of(document, tmp_path), "COLUMN")) == 72


def test_hatch_turns_filled_and_empty_at_each_outline(tmp_path: Path) -> None:
    document = drawing()
    hatch = document.modelspace().add_hatch(dxfattribs={"layer": "HOLE"})
    for half in (2000, 1500, 500):
        hatch.paths.add_polyline_path(
            [(5000 + x * half, 5000 + y * half) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        )
    plan = plan_of(document, tmp_path)
    assert plan.obstacle_region().area == 4000**2 - 3000**2 + 1000**2


def test_annular_hatch_with_clockwise_edges_contains_the_ring(tmp_path: Path) -> None:
    document = drawing()
    hatch = document.modelspace().add_hatch(dxfattribs={"layer": "WALL"})
    hatch.paths.add_edge_path().add_arc((5000, 5000), 2000, 0, 360, ccw=True)
    inner = hatch.paths.add_edge_path(flags=16)
    inner.add_arc((5000, 5000), 1800, 90, 270, ccw=False)
    inner.add_arc((5000, 5000), 1800, 270, 90, ccw=False)
    (wall,) = standing(plan_of(document, tmp_path), "WALL")
    true_mm2 = math.pi * (2000**2 - 1800**2)
    assert 0 < wall.region().area - true_mm2 < SAGITTA_MM * wall.region().length


def test_small_gap_in_a_hatch_outline_is_bridged(tmp_path: Path) -> None:
    document = drawing()
    edges = document.modelspace().add_hatch(dxfattribs={"layer": "HOLE"}).paths.add_edge_path()
    corners = [(1000, 1000), (2000, 1000), (2000, 2000), (1000, 2000)]
    for (x0, y0), (x1, y1) in zip(corners, [*corners[1:], corners[0]], strict=True):
        edges.add_line((x0, y0), (x1 - 0.1, y1))
    (hole,) = standing(plan_of(document, tmp_path), "HOLE")
    assert hole.region().area == pytest.approx(1000**2, abs=0.1 * 4000)


def test_solid_and_face_are_filled(tmp_path: Path) -> None:
    document = drawing()
    space = document.modelspace()
    on = {"layer": "EQUIPMENT"}
    # SOLID and TRACE cross over: 1, 2, 4, 3 go around
    space.add_solid([(0, 0), (1000, 0), (0, 500), (1000, 500)], dxfattribs=on)
    space.add_trace([(0, 2000), (1000, 2000), (0, 2500), (1000, 2500)], dxfattribs=on)
    space.add_3dface([(0, 4000), (1000, 4000), (1000, 4500), (0, 4500)], dxfattribs=on)
    plan = plan_of(document, tmp_path)
    assert plan.obstacle_region().area == 3 * 1000 * 500


def test_wide_polyline_has_mitred_corners(tmp_path: Path) -> None:
    document = drawing()
    document.modelspace().add_lwpolyline(
        [(1000, 1000), (4000, 1000), (4000, 3000)],
        dxfattribs={"layer": "WALL", "const_width": 200},
    )
    plan = plan_of(document, tmp_path)
    assert plan.obstacle_region().area == pytest.approx(200 * (3100 + 1900), rel=1e-12)


def test_multiline_is_the_body_between_its_outer_lines(tmp_path: Path) -> None:
    document = drawing()
    style = document.mline_styles.new("WALL240")
    style.elements.append(120)
    style.elements.append(0)
    style.elements.append(-120)
    document.modelspace().add_mline(
        [(1000, 1000), (4000, 1000), (4000, 3000)],
        # justification 1: the given line runs in the middle
        dxfattribs={"layer": "WALL", "style_name": "WALL240", "justification": 1},
    )
    plan = plan_of(document, tmp_path)
    assert plan.obstacle_region().area == pytest.approx(240 * (3120 + 1880), rel=1e-9)


def test_texts_dimensions_and_masks_on_a_wall_layer_are_no_obstacles(tmp_path: Path) -> None:
    document = drawing()
    space = document.modelspace()
    on = {"layer": "WALL"}
    space.add_line((1000, 1000), (1000, 4000), dxfattribs=on)
    bare = plan_of(document, tmp_path)
    space.add_text("OFFICE", dxfattribs={**on, "insert": (5000, 5000), "height": 300})
    space.add_mtext("OFFICE", dxfattribs={**on, "insert": (5000, 6000)})
    space.add_linear_dim(
        base=(5000, 4500), p1=(1000, 1000), p2=(9000, 1000), dxfattribs=on
    ).render()
    space.add_wipeout([(6000, 6000), (7000, 7000)], dxfattribs=on)
    space.add_point((5000, 7000), dxfattribs=on)
    assert plan_of(document, tmp_path).obstacles == bare.obstacles


@pytest.mark.parametrize(("unit", "per_unit_mm"), [(CM, 10.0), (M, 1000.0), (INCH, 25.4)])
def test_same_plan_in_another_unit_has_the_same_coordinates(
    unit: int, per_unit_mm: float, tmp_path: Path
) -> None:
    in_mm, other = drawing(), drawing(unit=unit)
    everything(in_mm.modelspace())
    everything(other.modelspace())
    for entity in other.modelspace():
        entity.transform(Matrix44.scale(1 / per_unit_mm))
    one, two = plan_of(in_mm, tmp_path), plan_of(other, tmp_path)
    assert two.source.unit_source == "header"
    assert two.floor == one.floor
    assert [o.shape for o in two.obstacles] == [o.shape for o in one.obstacles]


def test_plan_far_from_the_origin_has_the_same_coordinates(tmp_path: Path) -> None:
    near, far = drawing(), drawing()
    everything(near.modelspace())
    everything(far.modelspace())
    for entity in far.modelspace():
        entity.transform(Matrix44.translate(*FAR_MM, 0))
    one, two = plan_of(near, tmp_path), plan_of(far, tmp_path)
    assert two.frame.origin_mm == (float(FAR_MM[0]), float(FAR_MM[1]))
    assert two.floor == one.floor
    assert [o.shape for o in two.obstacles] == [o.shape for o in one.obstacles]


def test_option_goes_before_the_header(tmp_path: Path) -> None:
    plan = plan_of(drawing(unit=M), tmp_path, units="mm")
    assert plan.floor.area == 10_000.0**2
    assert (plan.source.unit, plan.source.unit_source) == ("mm", "option")


def test_start_is_taken_from_its_layer(tmp_path: Path) -> None:
    document = drawing()
    document.modelspace().add_point((2500, 4000), dxfattribs={"layer": "SATAOI-START"})
    assert plan_of(document, tmp_path).start_mm == (2500.0, 4000.0)


def test_start_is_found_in_a_block_that_holds_the_whole_plan(tmp_path: Path) -> None:
    document = drawing(floor=False)
    block = document.blocks.new("PLAN")
    rectangle(block, 0, 0, 10_000, 10_000, layer="FLOOR")
    block.add_point((2500, 4000), dxfattribs={"layer": "SATAOI-START"})
    document.modelspace().add_blockref("PLAN", (100, 0), {"xscale": -1, "yscale": 1})
    plan = plan_of(document, tmp_path)
    assert plan.frame.to_drawing(plan.start_mm).tolist() == [100 - 2500, 4000]
    assert not {"start-unread", "start-ambiguous"} & set(codes(plan))


def test_start_is_found_in_the_layout_that_is_read(tmp_path: Path) -> None:
    document = drawing(floor=False)
    layout = document.layout("Layout1")
    rectangle(layout, 0, 0, 10_000, 10_000, layer="FLOOR")
    layout.add_point((2500, 4000), dxfattribs={"layer": "SATAOI-START"})
    plan = plan_of(document, tmp_path)
    assert plan.start_mm == (2500.0, 4000.0)


def test_start_marked_by_a_block_is_where_the_block_is_put(tmp_path: Path) -> None:
    document = drawing()
    document.blocks.new("MARK").add_circle((300, 0), 50)
    document.modelspace().add_blockref("MARK", (2500, 4000), {"layer": "SATAOI-START"})
    plan = plan_of(document, tmp_path)
    assert plan.start_mm == (2500.0, 4000.0)
    assert "start-ambiguous" not in codes(plan)


def test_what_is_no_mark_of_the_start_is_said(tmp_path: Path) -> None:
    document = drawing()
    for x in (2500, 2600):
        document.modelspace().add_line((x, 4000), (x + 50, 4000), {"layer": "SATAOI-START"})
    plan = plan_of(document, tmp_path)
    assert plan.start_mm is None
    (said,) = [finding for finding in plan.findings if finding.code == "start-unread"]
    assert said.message.startswith("2 entities on layer SATAOI-START are no mark")


@pytest.mark.parametrize("options", [{}, {"include_hidden": True}])
def test_what_is_invisible_itself_is_left_out_and_said(
    options: dict[str, bool], tmp_path: Path
) -> None:
    document = drawing()
    rectangle(document.modelspace(), 1000, 1000, 2000, 2000, layer="COLUMN")
    document.modelspace()[-1].dxf.invisible = 1
    plan = plan_of(document, tmp_path, **options)
    assert plan.obstacles == ()
    (said,) = [finding for finding in plan.findings if finding.code == "entity-invisible"]
    assert said.remedy.startswith("make them visible in the drawing")


@pytest.mark.parametrize("close_gaps_mm", [-1.0, 501.0, math.nan])
def test_gaps_that_are_none_are_refused(close_gaps_mm: float) -> None:
    with pytest.raises(InputError, match="give 0 to 500"):
        ReadOptions(close_gaps_mm=close_gaps_mm)


def test_a_region_beside_the_drawing_is_refused_with_its_extent(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"drawn from \(0, 0\) to \(10000, 10000\)"):
        plan_of(drawing(), tmp_path, region=(20e3, 20e3, 25e3, 26e3))


def test_own_output_layers_are_not_read(tmp_path: Path) -> None:
    document = drawing()
    bare = plan_of(document, tmp_path)
    rectangle(document.modelspace(), 1000, 1000, 2000, 2000, layer="SATAOI-OBSTACLE-WALL")
    assert plan_of(document, tmp_path).obstacles == bare.obstacles == ()


@pytest.mark.parametrize("state", ["freeze", "off"])
def test_hidden_layer_is_left_out_and_said(state: str, tmp_path: Path) -> None:
    document = drawing()
    rectangle(document.modelspace(), 1000, 1000, 2000, 2000, layer="COLUMN")
    getattr(document.layers.add("COLUMN"), state)()
    plan = plan_of(document, tmp_path)
    assert plan.obstacles == ()
    assert "layer-hidden" in codes(plan)
    assert len(plan_of(document, tmp_path, include_hidden=True).obstacles) == 1


@pytest.mark.parametrize(
    ("of_reference", "of_content", "state", "n_read"),
    [
        ("COLUMN", "0", "freeze", 0),
        ("COLUMN", "0", "off", 0),
        ("OTHER", "COLUMN", "freeze", 0),
        ("OTHER", "COLUMN", "off", 0),
        ("HIDDEN", "COLUMN", "freeze", 0),
        ("HIDDEN", "COLUMN", "off", 1),
        ("OTHER", "COLUMN", "lock", 1),
    ],
)
def test_block_shows_what_the_layers_of_its_reference_and_of_its_content_let_it(
    of_reference: str, of_content: str, state: str, n_read: int, tmp_path: Path
) -> None:
    document = drawing()
    block = document.blocks.new("B")
    corners = [(0, 0), (300, 0), (300, 300), (0, 300)]
    block.add_lwpolyline(corners, close=True, dxfattribs={"layer": of_content})
    document.modelspace().add_blockref("B", (1000, 1000), {"layer": of_reference})
    hidden = "HIDDEN" if of_reference == "HIDDEN" else "COLUMN"
    getattr(document.layers.add(hidden), state)()
    plan = plan_of(document, tmp_path)
    assert len(plan.obstacles) == n_read
    assert ("layer-hidden" in codes(plan)) == (n_read == 0)
    assert len(plan_of(document, tmp_path, include_hidden=True).obstacles) == 1


def test_attributes_of_a_block_are_no_obstacles_and_its_lines_are(tmp_path: Path) -> None:
    document = drawing()
    block = document.blocks.new("COL-TAG")
    block.add_lwpolyline([(0, 0), (300, 0), (300, 300), (0, 300)], close=True)
    block.add_attdef("MARK", (500, 500), "?")
    reference = document.modelspace().add_blockref("COL-TAG", (1000, 1000), {"layer": "COLUMN"})
    reference.add_attrib("MARK", "C1", (1500, 1500), {"layer": "COLUMN", "height": 300})
    (column,) = standing(plan_of(document, tmp_path), "COLUMN")
    assert column.region().bounds == (1000, 1000, 1300, 1300)


def test_small_circle_of_a_drawing_in_metres_is_kept_exactly(tmp_path: Path) -> None:
    document = ezdxf.new("R2010")
    document.header["$INSUNITS"] = M
    rectangle(document.modelspace(), 0, 0, 10, 10, layer="FLOOR")
    document.modelspace().add_circle((5, 5), 0.05, dxfattribs={"layer": "EMBEDDED"})
    (part,) = standing(plan_of(document, tmp_path), "EMBEDDED")
    assert part.shape == Circle(5000.0, 5000.0, 50.0)


def test_own_frozen_layer_is_not_said_to_be_hidden(tmp_path: Path) -> None:
    document = drawing()
    document.layers.add("SATAOI-ZONE").freeze()
    rectangle(document.modelspace(), 0, 0, 1, 1, layer="SATAOI-ZONE")
    assert codes(plan_of(document, tmp_path)) == []


def test_layer_that_is_not_plotted_is_read(tmp_path: Path) -> None:
    document = drawing()
    rectangle(document.modelspace(), 1000, 1000, 2000, 2000, layer="COLUMN")
    document.layers.add("COLUMN").dxf.plot = 0
    assert len(plan_of(document, tmp_path).obstacles) == 1


def test_reference_to_a_missing_block_is_skipped_and_said(tmp_path: Path) -> None:
    document = drawing()
    document.modelspace().add_blockref("NOWHERE", (0, 0))
    plan = plan_of(document, tmp_path)
    assert "block-skipped" in codes(plan)


def test_block_that_contains_itself_is_refused(tmp_path: Path) -> None:
    document = drawing()
    document.blocks.new("A").add_blockref("B", (0, 0))
    document.blocks.new("B").add_blockref("A", (0, 0))
    document.modelspace().add_blockref("A", (0, 0))
    with pytest.raises(DrawingError, match="contains itself"):
        plan_of(document, tmp_path)


def test_bomb_of_blocks_is_refused_before_it_goes_off(tmp_path: Path) -> None:
    document = drawing()
    document.blocks.new("L0").add_line((0, 0), (1, 0))
    for level in range(1, 9):
        block = document.blocks.new(f"L{level}")
        for _ in range(10):
            block.add_blockref(f"L{level - 1}", (0, 0))
    document.modelspace().add_blockref("L8", (0, 0))
    with pytest.raises(LimitError, match="100,000,00"):
        plan_of(document, tmp_path)


def test_huge_array_is_refused(tmp_path: Path) -> None:
    document = drawing()
    document.blocks.new("DOT").add_line((0, 0), (1, 0))
    document.modelspace().add_blockref(
        "DOT",
        (0, 0),
        {"row_count": 30_000, "column_count": 30_000, "row_spacing": 1, "column_spacing": 1},
    )
    with pytest.raises(LimitError):
        plan_of(document, tmp_path)


def test_deep_nesting_is_refused(tmp_path: Path) -> None:
    document = drawing()
    document.blocks.new("D0").add_line((0, 0), (1, 0))
    for level in range(1, 500):
        document.blocks.new(f"D{level}").add_blockref(f"D{level - 1}", (0, 0))
    document.modelspace().add_blockref("D499", (0, 0))
    with pytest.raises(LimitError, match="levels"):
        plan_of(document, tmp_path)


def test_drawing_without_a_unit_is_refused_with_its_sizes(tmp_path: Path) -> None:
    with pytest.raises(UnitError, match=r"--units cm for 100 × 100 m"):
        plan_of(drawing(unit=0), tmp_path)


def test_empty_drawing_is_refused(tmp_path: Path) -> None:
    with pytest.raises(EmptyPlanError, match="empty"):
        plan_of(drawing(floor=False), tmp_path)


def test_missing_file_is_named(tmp_path: Path) -> None:
    from satAOI_adapters.dxf_read import ReadOptions, read

    with pytest.raises(UnreadableError, match=r"nowhere\.dxf"):
        read(tmp_path / "nowhere.dxf", ReadOptions())


def test_floor_that_is_not_closed_is_refused_with_both_ends(tmp_path: Path) -> None:
    document = drawing(floor=False)
    document.modelspace().add_lwpolyline(
        [(0, 0), (5000, 0), (5000, 4000), (0, 4000), (0, 300)], dxfattribs={"layer": "FLOOR"}
    )
    with pytest.raises(DrawingError, match=r"300\.0 mm apart"):
        plan_of(document, tmp_path)


def test_hole_in_the_floor_outline_is_no_floor(tmp_path: Path) -> None:
    document = drawing()
    rectangle(document.modelspace(), 4000, 4000, 6000, 6000, layer="FLOOR")
    assert plan_of(document, tmp_path).floor.area == 10_000**2 - 2000**2


def test_curved_floor_lies_inside_the_drawn_one(tmp_path: Path) -> None:
    document = drawing(floor=False)
    document.modelspace().add_circle((0, 0), 5000, dxfattribs={"layer": "SLAB"})
    floor = plan_of(document, tmp_path).floor
    true_mm2 = math.pi * 5000**2
    assert 0 < true_mm2 - floor.area < SAGITTA_MM * floor.length


def test_traces_of_a_mixed_path_join_end_to_end() -> None:
    arc = arc_about((100.0, 50.0), ((0.0, -50.0), (50.0, 0.0)), 0.0, math.pi)
    path = Outline((Line((0.0, 0.0), arc.start), arc, Line(arc.end, (0.0, 100.0))), closed=False)
    first, bow, last = sorted(traces(path), key=lambda trace: trace.centroid.y)
    assert first.intersects(bow)
    assert last.intersects(bow)
    assert circle_of(path) is None
