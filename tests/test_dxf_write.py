"""The drawing that is written: what it holds, what it keeps, and what other programs see in it."""

import json
import math
import os
import pickle
import re
import shutil
import subprocess
import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from ezdxf.document import Drawing
from ezdxf.entities import DXFEntity, Hatch
from ezdxf.lldxf.encoding import decode_dxf_unicode
from PIL import Image
from shapely.geometry import Polygon, box

from satAOI_adapters import read_plan, write_aoi
from satAOI_adapters.dxf_write.legend import note_rows
from satAOI_adapters.dxf_write.pen import begun_on_a_straight
from satAOI_adapters.dxf_write.place import entity_bounds, free_place
from satAOI_geo.aoi import Loop
from satAOI_geo.errors import InputError, UnreadableError
from satAOI_geo.pipeline import Result, area_of_interest
from satAOI_geo.plan import Circle, FloorPlan, Frame, Kind, Obstacle
from satAOI_geo.reasons import Patch
from satAOI_geo.settings import Settings
from tests import plans, results

ROOT = Path(__file__).parents[1]
CORPUS = ROOT.parent / "shared" / "corpus" / "dxf"

IN_METRES = Frame((568_053_449.0, 5_774_347_227.0), math.radians(30), 1000.0)
"""A georeferenced drawing in metres with its walls turned by 30 degrees."""


def written(result: Result, path: Path) -> Drawing:
    write_aoi(path, result)
    return ezdxf.readfile(path)


def on_layer(document: Drawing, layer: str) -> list[DXFEntity]:
    return [entity for entity in document.modelspace() if entity.dxf.layer == layer]


def facts_of(entity: DXFEntity) -> dict[str, object]:
    schema, *tags = entity.get_xdata("SATAOI")
    assert schema.value == "sataoi-dxf/1"
    values = [tag.value for tag in tags]
    return dict(zip(values[::2], values[1::2], strict=True))


def drawing_file(path: Path, version: str = "R2010", *, unit: int = 4) -> Path:
    """A drawing in millimetres with a wall, a text and a block around the furnished room."""
    document = ezdxf.new(version, units=unit)
    space = document.modelspace()
    document.layers.add("A-WALL")
    for corner, other in (((0, 0), (7000, 0)), ((7000, 0), (7000, 5000)), ((0, 0), (0, 5000))):
        space.add_line(corner, other, dxfattribs={"layer": "A-WALL"})
    space.add_text("Halle 墙", height=200).set_placement((2000, 2000))
    block = document.blocks.new("BAY")
    block.add_circle((0, 0), 200)
    space.add_blockref("BAY", (800, 900))
    document.saveas(path)
    return path


@pytest.fixture
def drawn(tmp_path: Path) -> Result:
    """The furnished room as if it had been read from a drawing."""
    path = drawing_file(tmp_path / "plan.dxf")
    return results.on_drawing(results.furnished_result(), path, "mm", Frame())


# --- the area --------------------------------------------------------------------------------


def test_each_part_is_one_hatch_with_its_holes(tmp_path: Path) -> None:
    result = results.with_parts(results.furnished_result(), results.two_parts())
    hatches = on_layer(written(result, tmp_path / "a.dxf"), "SATAOI-AOI")
    assert [hatch.dxftype() for hatch in hatches] == ["HATCH", "HATCH"]
    assert [len(hatch.paths) for hatch in hatches] == [2, 1]
    assert all(hatch.dxf.solid_fill and not hatch.dxf.associative for hatch in hatches)


def test_flags_tell_the_outer_boundary_from_the_holes(tmp_path: Path) -> None:
    result = results.with_parts(results.furnished_result(), results.two_parts())
    hatch = on_layer(written(result, tmp_path / "a.dxf"), "SATAOI-AOI")[0]
    assert isinstance(hatch, Hatch)
    external, polyline, outermost = 1, 2, 16
    flags = [path.path_type_flags for path in hatch.paths]
    assert flags == [external | polyline, outermost | polyline]


def test_arcs_stay_arcs_in_the_outline_and_in_the_hatch(tmp_path: Path) -> None:
    result = results.with_parts(results.furnished_result(), results.two_parts())
    document = written(result, tmp_path / "a.dxf")
    outer, hole, disc = (
        [tuple(point) for point in entity.get_points("xyb")]
        for entity in on_layer(document, "SATAOI-AOI-EDGE")
    )
    quarter = math.tan(math.pi / 8)
    assert outer[:2] == [(350, 0, 0), (1650, 0, pytest.approx(quarter, rel=1e-15))]
    assert hole == [(1000, 1500, -1), (1400, 1500, -1)]
    assert disc == [(5000, 1500, 1), (5700, 1500, 1)]
    hatches = on_layer(document, "SATAOI-AOI")
    filled = [path.vertices for hatch in hatches for path in hatch.paths]
    # the rounded rectangle begins in the middle of its right side, 2300 mm long
    assert filled == [[(2000, 1500, 0), *outer[3:], *outer[:3]], hole, disc]


def test_outlines_are_closed_and_carry_their_part(tmp_path: Path) -> None:
    result = results.with_parts(results.furnished_result(), results.two_parts())
    edges = on_layer(written(result, tmp_path / "a.dxf"), "SATAOI-AOI-EDGE")
    assert all(edge.closed for edge in edges)
    assert [facts_of(edge)["part"] for edge in edges] == [1, 1, 2]


def test_a_hatch_says_what_it_stands_for(tmp_path: Path) -> None:
    result = results.with_parts(results.furnished_result(), results.two_parts())
    large, small = on_layer(written(result, tmp_path / "a.dxf"), "SATAOI-AOI")
    facts = facts_of(large)
    assert facts["part"] == 1
    assert facts["connectivity"] == "pose"
    assert facts["robot"] == "magicbim"
    areas = [facts_of(hatch)["area_m2"] for hatch in (large, small)]
    assert sum(areas) == pytest.approx(results.TWO_PARTS_MM2 / 1e6, rel=1e-14)


def test_coordinates_go_through_the_frame_and_bulges_stay(tmp_path: Path) -> None:
    plain = results.with_parts(results.furnished_result(), results.two_parts())
    path = drawing_file(tmp_path / "plan.dxf", unit=6)
    moved = results.on_drawing(plain, path, "m", IN_METRES)
    first = on_layer(written(moved, tmp_path / "a.dxf"), "SATAOI-AOI-EDGE")[0]
    x, y, bulge = first.get_points("xyb")[1]
    # (1650, 0) mm turned by 30 degrees, in metres
    assert x == pytest.approx(568_053.449 + 1.65 * math.cos(math.pi / 6), abs=1e-9)
    assert y == pytest.approx(5_774_347.227 + 1.65 * math.sin(math.pi / 6), abs=1e-9)
    assert bulge == pytest.approx(math.tan(math.pi / 8), rel=1e-15)


# --- what the area leaves over ---------------------------------------------------------------


def drawn_patches(result: Result) -> list[Patch]:
    cell_mm2 = result.lattice.step_mm**2
    return [p for p in result.patches if not p.narrow and p.area_mm2 >= cell_mm2]


def test_fills_and_what_is_too_small_to_draw_add_up_to_the_free_floor(tmp_path: Path) -> None:
    result = results.furnished_result()
    document = written(result, tmp_path / "a.dxf")
    filled_m2 = sum(
        facts_of(entity)["area_m2"]
        for layer in ("SATAOI-AOI", "SATAOI-UNREACHED", "SATAOI-UPPER")
        for entity in on_layer(document, layer)
        if entity.dxftype() == "HATCH"
    )
    drawn = drawn_patches(result)
    small_m2 = sum(p.area_mm2 for p in result.patches if p not in drawn) / 1e6
    # the patches' edges are flattened arcs, at most 0.03 mm off
    assert filled_m2 + small_m2 == pytest.approx(result.report.floor.free_area_m2, abs=1e-6)


def test_a_patch_says_why_it_is_left_and_what_is_in_the_way(tmp_path: Path) -> None:
    result = results.furnished_result()
    document = written(result, tmp_path / "a.dxf")
    expected = Counter(
        (patch.reason.value, patch.blocker.handle if patch.blocker else "")
        for patch in drawn_patches(result)
    )
    drawn = [
        facts_of(entity)
        for layer in ("SATAOI-UNREACHED", "SATAOI-UPPER")
        for entity in on_layer(document, layer)
        if entity.dxftype() == "HATCH"
    ]
    assert Counter((facts["reason"], facts["blocker"]) for facts in drawn) == expected


def test_labels_of_patches_give_area_and_reason(tmp_path: Path) -> None:
    result = results.furnished_result()
    largest = drawn_patches(result)[0]
    entities = on_layer(written(result, tmp_path / "a.dxf"), "SATAOI-UNREACHED")
    labels = [entity.plain_text() for entity in entities if entity.dxftype() == "MTEXT"]
    assert labels[0] == f"{largest.area_mm2 / 1e6:.2f} m²\n{largest.reason}"
    assert not any(label.startswith("0.00") for label in labels)


def test_floor_that_only_the_paper_s_rule_claims_has_a_layer_of_its_own(tmp_path: Path) -> None:
    result = area_of_interest(plans.two_rooms(760.0).plan, settings=Settings(step_mm=20.0))
    document = written(result, tmp_path / "a.dxf")
    (upper,) = on_layer(document, "SATAOI-UPPER")
    claimed_m2 = result.report.disc_connected.area_m2 - result.report.pose_connected.area_m2
    # less what is narrower than a cell
    assert facts_of(upper)["area_m2"] == pytest.approx(claimed_m2, rel=1e-3)


def test_each_zone_is_outlined_on_a_frozen_layer(tmp_path: Path) -> None:
    result = area_of_interest(plans.two_rooms(760.0).plan, settings=Settings(step_mm=20.0))
    document = written(result, tmp_path / "a.dxf")
    assert document.layers.get("SATAOI-ZONE").is_frozen()
    numbers = {facts_of(entity)["zone"] for entity in on_layer(document, "SATAOI-ZONE")}
    assert numbers == set(range(1, len(result.zones) + 1))


def test_every_hatch_carries_facts(tmp_path: Path) -> None:
    # a hatch without extended data makes one reader lose the entity that follows it
    document = written(results.furnished_result(), tmp_path / "a.dxf")
    assert all(hatch.has_xdata("SATAOI") for hatch in document.modelspace().query("HATCH"))


# --- what is drawn around it -----------------------------------------------------------------


def test_the_start_is_the_disc_with_a_cross(tmp_path: Path) -> None:
    result = results.furnished_result()
    entities = on_layer(written(result, tmp_path / "a.dxf"), "SATAOI-START")
    assert [entity.dxftype() for entity in entities] == ["CIRCLE", "LWPOLYLINE", "LWPOLYLINE"]
    circle = entities[0]
    iy, ix = result.search.start.node
    assert circle.dxf.radius == result.robot.disc_radius_mm
    assert (circle.dxf.center.x, circle.dxf.center.y) == (25 * ix + 12.5, 25 * iy + 12.5)


def test_obstacles_are_drawn_as_they_were_read_with_kind_and_source(tmp_path: Path) -> None:
    document = written(results.furnished_result(), tmp_path / "a.dxf")
    drawn = {}
    for entity in on_layer(document, "SATAOI-OBSTACLE"):
        facts = facts_of(entity)
        drawn.setdefault((facts["kind"], facts.get("handle")), []).append(entity)
    assert {key: len(entities) for key, entities in drawn.items()} == {
        ("floor", None): 1,
        ("equipment", "A1"): 1,
        ("column", "A2"): 1,
        ("wall", "A3"): 1,
        ("hole", "A4"): 2,
        ("embedded", "A5"): 1,
        ("unclassified", "A6"): 1,
    }
    (column,), (wall,) = drawn["column", "A2"], drawn["wall", "A3"]
    assert (column.dxftype(), column.dxf.radius) == ("CIRCLE", 200)
    assert not wall.closed
    colours = {entities[0].dxf.color for entities in drawn.values()}
    assert len(colours) == len(drawn)


def test_the_note_lies_beside_everything_that_was_drawn(drawn: Result, tmp_path: Path) -> None:
    document = written(drawn, tmp_path / "a.dxf")
    space = document.modelspace()
    notes = [entity for entity in space if entity.dxf.layer == "SATAOI-NOTE"]
    frame = next(entity for entity in notes if entity.dxftype() == "LWPOLYLINE")
    framed = Polygon([point[:2] for point in frame.get_points("xy")])
    for note in notes:
        space.unlink_entity(note)
    for left, bottom, right, top in entity_bounds(space).tolist():
        assert not framed.intersects(box(left, bottom, right, top))
    assert all(framed.contains(box(*bounds)) for bounds in text_boxes(notes))


def text_boxes(notes: list[DXFEntity]) -> list[tuple[float, float, float, float]]:
    """Room of each text, 0.85 of its height a letter."""
    boxes = []
    for text in notes:
        if text.dxftype() == "MTEXT":
            x, y, _ = text.dxf.insert
            width, half = 0.85 * text.dxf.char_height * len(text.text), text.dxf.char_height / 2
            boxes.append((x, y - half, x + width, y + half))
    return boxes


def test_the_note_gives_the_figures_of_the_report(tmp_path: Path) -> None:
    result = results.furnished_result()
    document = written(result, tmp_path / "a.dxf")
    texts = [entity.text for entity in on_layer(document, "SATAOI-NOTE") if hasattr(entity, "text")]
    aoi = result.report.aoi
    assert f"{aoi.area_m2:.2f} m² = {aoi.percent_of_free:.1f} % of the free floor" in texts
    assert "pose-connected" in texts
    assert [row.label for row in note_rows(result) if row.label in set(Kind)] == list(Kind)


def test_names_in_the_note_cannot_give_orders_to_the_text_engine(tmp_path: Path) -> None:
    result = results.furnished_result()
    robot = replace(result.report.robot, name="{\\H9;big}\n0\nEOF^J%%c")
    report = replace(result.report, robot=robot)
    other = replace(result.robot, name="x\n  0\nEOF\n" + 300 * "y")
    odd = replace(result, report=report, search=replace(result.search, robot=other))
    document = written(odd, tmp_path / "a.dxf")
    texts = [e.plain_text() for e in on_layer(document, "SATAOI-NOTE") if e.dxftype() == "MTEXT"]
    assert "{\\H9;big} 0 EOF^J% %c, disc radius 350 mm" in texts
    name = facts_of(on_layer(document, "SATAOI-AOI")[0])["robot"]
    assert isinstance(name, str)
    assert len(name) == 250


def test_facts_fit_into_a_string_of_255_bytes_in_any_encoding(tmp_path: Path) -> None:
    result = results.furnished_result()
    other = replace(result.robot, name="壁" * 100)
    document = written(
        replace(result, search=replace(result.search, robot=other)), tmp_path / "a.dxf"
    )
    name = facts_of(on_layer(document, "SATAOI-AOI")[0])["robot"]
    assert isinstance(name, str)
    assert 0 < len(name) * len(r"\U+58C1") <= 255


def test_a_long_name_makes_the_note_no_wider_than_what_is_shown_of_it(tmp_path: Path) -> None:
    result = results.furnished_result()
    widths = []
    for n_letters in (100, 300):
        robot = replace(result.report.robot, name="r" * n_letters)
        odd = replace(result, report=replace(result.report, robot=robot))
        document = written(odd, tmp_path / f"{n_letters}.dxf")
        frame = next(e for e in on_layer(document, "SATAOI-NOTE") if e.dxftype() == "LWPOLYLINE")
        x = [point[0] for point in frame.get_points()]
        widths.append(max(x) - min(x))
    assert widths[0] == widths[1]


# --- where the note goes ---------------------------------------------------------------------

PLAN = (0.0, 0.0, 10.0, 10.0)


@pytest.mark.parametrize(
    ("taken", "expected"),
    [
        pytest.param([], (11, 8, 14, 10), id="right of the plan, level with its top"),
        pytest.param([(12, 9, 13, 20)], (14, 8, 17, 10), id="past what stands there"),
        pytest.param([(12, 0, 13, 6.9)], (11, 8, 14, 10), id="above what stands lower down"),
        pytest.param([(10, 0, 99, 10)], (-4, 8, -1, 10), id="left when the right is taken"),
        pytest.param([(-99, 0, 99, 10)], (0, -3, 3, -1), id="below when both sides are taken"),
        pytest.param([(-99, -99, 99, 10)], (0, 11, 3, 13), id="above when all else is taken"),
    ],
)
def test_the_note_goes_to_the_first_free_side(
    taken: list[tuple[float, float, float, float]], expected: tuple[float, float, float, float]
) -> None:
    boxes = np.array([PLAN, *taken], dtype=float)
    assert free_place(PLAN, (3.0, 2.0), gap=1.0, taken=boxes) == expected


def test_bounds_are_told_piece_by_piece() -> None:
    space = ezdxf.new().modelspace()
    space.add_line((5, 1), (2, 3))
    space.add_lwpolyline([(0, 0), (4, 0), (4, 3)], close=True)
    space.add_lwpolyline([(0, 0), (4, 0), (4, 3)])
    space.add_circle((7, 7), 1)
    space.add_lwpolyline([(0, 0, 1), (2, 0, 0), (2, 5, 0)], format="xyb")
    assert entity_bounds(space).tolist() == pytest.approx(
        np.array(
            [
                (2, 1, 5, 3),
                *((0, 0, 4, 0), (4, 0, 4, 3), (0, 0, 4, 3)),
                *((0, 0, 4, 0), (4, 0, 4, 3)),
                (6, 6, 8, 8),
                *((0, -1, 2, 0), (2, 0, 2, 5)),
            ]
        )
    )


def test_a_polyline_seen_from_behind_is_bounded_where_it_is_seen() -> None:
    space = ezdxf.new().modelspace()
    space.add_lwpolyline([(1, 0), (4, 2)], dxfattribs={"extrusion": (0, 0, -1)})
    assert entity_bounds(space).tolist() == [[-4, 0, -1, 2]]


def test_a_block_is_bounded_wherever_it_stands() -> None:
    document = ezdxf.new()
    block = document.blocks.new("DESK", base_point=(1, 0))
    block.add_lwpolyline([(1, 0), (3, 0), (3, 1), (1, 1)], close=True)
    block.add_attdef("NUMBER", (99, 99), height=1)
    document.blocks.new("TWO").add_blockref("DESK", (0, 0))
    document.blocks.get("TWO").add_blockref("DESK", (10, 0), {"rotation": 90})
    space = document.modelspace()
    space.add_blockref("DESK", (5, 5), {"xscale": 2, "yscale": -1})
    space.add_blockref("TWO", (100, 0))
    in_a_row = {"column_count": 3, "column_spacing": 4}
    space.add_blockref("DESK", (0, 20), in_a_row).add_attrib("NUMBER", "7", (0, 30))
    found = entity_bounds(space)
    assert found[found[:, 1] < 25] == pytest.approx(
        np.array(
            [
                (5, 4, 9, 5),
                (100, 0, 110, 2),
                *((0, 20, 2, 21), (4, 20, 6, 21), (8, 20, 10, 21)),
            ]
        )
    )
    # the number on each desk of the row
    assert found[found[:, 1] > 25].shape == (3, 4)


def test_a_block_that_holds_itself_is_bounded_by_what_else_it_holds() -> None:
    document = ezdxf.new()
    block = document.blocks.new("ENDLESS")
    block.add_line((0, 0), (2, 1))
    block.add_blockref("ENDLESS", (5, 5))
    space = document.modelspace()
    space.add_blockref("ENDLESS", (10, 10))
    assert entity_bounds(space).tolist() == [[10, 10, 12, 11]]


def test_letters_are_measured_without_a_font_and_keep_their_own() -> None:
    document = ezdxf.new()
    style = document.styles.add("STAMP", font="arial.ttf")
    space = document.modelspace()
    space.add_text("four", height=2, dxfattribs={"style": "STAMP", "insert": (1, 1)})
    ((left, bottom, right, _),) = entity_bounds(space).tolist()
    assert (left, right) == (1, 1 + 4 * 2)
    assert bottom <= 1
    assert style.dxf.font == "arial.ttf"


def test_an_entity_that_cannot_be_measured_is_left_out() -> None:
    document = ezdxf.new()
    space = document.modelspace()
    space.add_blockref("NOWHERE", (0, 0))
    space.add_lwpolyline([])
    space.add_lwpolyline([(3, 4)])
    assert entity_bounds(space).shape == (0, 4)


# --- what is kept, and in which order --------------------------------------------------------


def test_the_input_is_kept_whole(drawn: Result, tmp_path: Path) -> None:
    before = ezdxf.readfile(drawn.plan.source.path)
    after = written(drawn, tmp_path / "a.dxf")
    for entity in before.modelspace():
        kept = after.entitydb[entity.dxf.handle]
        assert kept.dxftype() == entity.dxftype()
        assert kept.dxf.all_existing_dxf_attribs() == entity.dxf.all_existing_dxf_attribs()
    assert "BAY" in after.blocks


def test_the_hatches_come_first_and_are_drawn_first(drawn: Result, tmp_path: Path) -> None:
    document = written(drawn, tmp_path / "a.dxf")
    space = document.modelspace()
    hatches = on_layer(document, "SATAOI-AOI")
    assert list(space)[: len(hatches)] == hatches
    assert list(space.entities_in_redraw_order())[: len(hatches)] == hatches
    assert document.header["$SORTENTS"] & 16


def test_the_order_the_input_was_drawn_in_is_kept(tmp_path: Path) -> None:
    path = drawing_file(tmp_path / "plan.dxf")
    document = ezdxf.readfile(path)
    space = document.modelspace()
    upside_down = [entity.dxf.handle for entity in space][::-1]
    space.set_redraw_order(dict(zip(upside_down, sorted(upside_down), strict=True)))
    document.saveas(path)
    result = results.on_drawing(results.furnished_result(), path, "mm", Frame())
    after = written(result, tmp_path / "a.dxf").modelspace()
    order = [entity.dxf.handle for entity in after.entities_in_redraw_order()]
    assert [handle for handle in order if handle in upside_down] == upside_down


def test_our_own_earlier_output_is_replaced_not_doubled(drawn: Result, tmp_path: Path) -> None:
    once = written(drawn, tmp_path / "once.dxf")
    again = results.on_drawing(drawn, tmp_path / "once.dxf", "mm", Frame())
    twice = written(again, tmp_path / "twice.dxf")
    layers = [Counter(e.dxf.layer for e in document.modelspace()) for document in (once, twice)]
    assert layers[0] == layers[1]
    assert len(twice.objects) == len(once.objects)
    assert len(twice.layers) == len(once.layers)


def test_an_earlier_note_does_not_push_the_new_one_away(drawn: Result, tmp_path: Path) -> None:
    once = written(drawn, tmp_path / "once.dxf")
    again = results.on_drawing(drawn, tmp_path / "once.dxf", "mm", Frame())
    twice = written(again, tmp_path / "twice.dxf")
    left, right = (
        min(e.dxf.insert.x for e in on_layer(document, "SATAOI-NOTE") if e.dxftype() == "MTEXT")
        for document in (once, twice)
    )
    assert left == right


def test_layers_that_were_switched_off_are_shown_again(tmp_path: Path) -> None:
    path = drawing_file(tmp_path / "plan.dxf")
    document = ezdxf.readfile(path)
    layer = document.layers.add("SATAOI-AOI")
    layer.off()
    layer.freeze()
    document.saveas(path)
    result = results.on_drawing(results.furnished_result(), path, "mm", Frame())
    shown = written(result, tmp_path / "a.dxf").layers.get("SATAOI-AOI")
    assert shown.is_on()
    assert not shown.is_frozen()


def test_an_entity_of_an_unknown_type_goes_through(tmp_path: Path) -> None:
    path = drawing_file(tmp_path / "plan.dxf")
    wall = "  0\nTCH_WALL\n  5\nFEFE\n100\nAcDbEntity\n  8\nWALL\n100\nTDbWall\n 40\n1.0\n"
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace("  2\nENTITIES\n", "  2\nENTITIES\n" + wall), encoding="utf-8")
    result = results.on_drawing(results.furnished_result(), path, "mm", Frame())
    write_aoi(tmp_path / "a.dxf", result)
    assert wall.partition("FEFE")[0] in (tmp_path / "a.dxf").read_text(encoding="utf-8")


# --- the file --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("version", "expected"),
    [("R12", "AC1024"), ("R2000", "AC1024"), ("R2010", "AC1024"), ("R2018", "AC1032")],
)
def test_the_version_is_r2010_or_the_newer_one_of_the_input(
    tmp_path: Path, version: str, expected: str
) -> None:
    path = drawing_file(tmp_path / "plan.dxf", version)
    result = results.on_drawing(results.furnished_result(), path, "mm", Frame())
    document = written(result, tmp_path / "a.dxf")
    assert document.dxfversion == expected
    (text,) = document.modelspace().query("TEXT")
    assert decode_dxf_unicode(text.dxf.text) == "Halle 墙"


def test_the_header_gives_the_unit_that_was_used(tmp_path: Path) -> None:
    inches, millimetres = 1, 4
    path = drawing_file(tmp_path / "plan.dxf", unit=inches)
    result = results.on_drawing(results.furnished_result(), path, "mm", Frame())
    assert written(result, tmp_path / "a.dxf").units == millimetres


@pytest.mark.parametrize("version", ["R12", "R2000", "R2010", "R2018"])
def test_what_is_added_audits_clean(tmp_path: Path, version: str) -> None:
    path = drawing_file(tmp_path / "plan.dxf", version)
    result = results.on_drawing(results.furnished_result(), path, "mm", Frame())
    auditor = written(result, tmp_path / "a.dxf").audit()
    assert (auditor.errors, auditor.fixes) == ([], [])


def test_the_record_holds_the_run_in_short_strings(drawn: Result, tmp_path: Path) -> None:
    document = written(drawn, tmp_path / "a.dxf")
    tags = document.rootdict["SATAOI"].tags
    assert tags[0] == (1, "sataoi-dxf/1")
    assert all(len(tag.value) <= 250 for tag in tags)
    settings = json.loads("".join(tag.value for tag in tags[1:]))
    assert settings["frame"] == {"origin_mm": [0.0, 0.0], "turn_rad": 0.0, "mm_per_unit": 1.0}
    assert settings["robot"]["disc_radius_mm"] == 350.0
    assert settings["lattice"]["step_mm"] == 25.0
    assert settings["aoi"]["connectivity"] == "pose"
    assert "timing_s" not in settings


def test_strings_are_short_enough_for_every_reader(drawn: Result, tmp_path: Path) -> None:
    write_aoi(tmp_path / "a.dxf", drawn)
    lines = (tmp_path / "a.dxf").read_text(encoding="utf-8").splitlines()
    assert max(map(len, lines)) <= 255


def test_layer_names_are_ascii(drawn: Result, tmp_path: Path) -> None:
    layers = written(drawn, tmp_path / "a.dxf").layers
    ours = {layer.dxf.name for layer in layers if layer.dxf.name.startswith("SATAOI")}
    assert ours == {
        "SATAOI-AOI",
        "SATAOI-AOI-EDGE",
        "SATAOI-UNREACHED",
        "SATAOI-UPPER",
        "SATAOI-ZONE",
        "SATAOI-START",
        "SATAOI-OBSTACLE",
        "SATAOI-NOTE",
    }


WRITE_ALL = """
import pickle, sys
from pathlib import Path
from satAOI_adapters import read_plan, write_aoi
folder, *pickled = map(Path, sys.argv[1:])
for number, path in enumerate(pickled):
    write_aoi(folder / f"{number}.dxf", pickle.loads(path.read_bytes()))
"""


def old_version(path: Path) -> Path:
    """The drawing, said to be of R14, which is given arrows as it is brought up to date."""
    path.write_bytes(path.read_bytes().replace(b"AC1015", b"AC1014"))
    return path


def test_bytes_do_not_depend_on_the_hash_seed_or_the_time(tmp_path: Path) -> None:
    whole = results.furnished_result()
    # the kernels' data do not travel between processes, and no writer looks at them
    new = replace(whole, search=replace(whole.search, engine=None, pose=None))
    plan = drawing_file(tmp_path / "plan.dxf", "R2018")
    old = old_version(drawing_file(tmp_path / "old.dxf", "R2000"))
    over, upgraded = (results.on_drawing(new, file, "mm", Frame()) for file in (plan, old))
    names = ("new", "over", "upgraded")
    for name, result in zip(names, (new, over, upgraded), strict=True):
        (tmp_path / name).write_bytes(pickle.dumps(result))
    runs = []
    for seed in ("1", "2", "3"):
        folder = tmp_path / seed
        folder.mkdir()
        path = os.pathsep.join((str(ROOT), str(ROOT / "adapters")))
        subprocess.run(
            [sys.executable, "-c", WRITE_ALL, folder, *(tmp_path / name for name in names)],
            check=True,
            env={**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": path},
        )
        runs.append([(folder / f"{number}.dxf").read_bytes() for number in range(3)])
    assert runs[0] == runs[1] == runs[2]


# --- what must not happen --------------------------------------------------------------------


def test_the_input_is_never_written_over(drawn: Result) -> None:
    path = Path(drawn.plan.source.path)
    before = path.read_bytes()
    with pytest.raises(InputError, match="is an input"):
        write_aoi(path, drawn)
    assert path.read_bytes() == before


def test_a_drawing_that_changed_meanwhile_is_refused(drawn: Result, tmp_path: Path) -> None:
    path = Path(drawn.plan.source.path)
    path.write_bytes(path.read_bytes() + b"999\nlater\n")
    with pytest.raises(UnreadableError, match="changed while it was worked on"):
        write_aoi(tmp_path / "a.dxf", drawn)
    path.unlink()
    with pytest.raises(UnreadableError, match="cannot read"):
        write_aoi(tmp_path / "a.dxf", drawn)
    assert not (tmp_path / "a.dxf").exists()


def test_a_damaged_drawing_is_written_as_far_as_it_can_be_repaired(tmp_path: Path) -> None:
    path = drawing_file(tmp_path / "plan.dxf", "R12")
    whole = path.read_text(encoding="cp1252")
    path.write_text(whole.replace("  0\nEOF", "  0\nENDSEC\n  0\nEOF"), encoding="cp1252")
    with pytest.raises(ezdxf.DXFStructureError):
        ezdxf.readfile(path)
    result = results.on_drawing(results.furnished_result(), path, "mm", Frame())
    assert len(on_layer(written(result, tmp_path / "a.dxf"), "A-WALL")) == 3


def test_an_ellipse_whose_second_axis_is_the_longer_is_the_same_ellipse(tmp_path: Path) -> None:
    path = drawing_file(tmp_path / "plan.dxf", "R2010")
    document = ezdxf.readfile(path)
    document.modelspace().add_ellipse(
        (100, 200), (1000, 0), ratio=0.5, start_param=0.5, end_param=2.0
    )
    document.saveas(path)
    text = path.read_text(encoding="utf-8")
    assert text.count("\n 40\n0.5\n") == 1
    path.write_text(text.replace("\n 40\n0.5\n", "\n 40\n1.5\n"), encoding="utf-8")
    result = results.on_drawing(results.furnished_result(), path, "mm", Frame())
    (after,) = written(result, tmp_path / "a.dxf").modelspace().query("ELLIPSE")
    assert after.dxf.ratio == pytest.approx(1 / 1.5)
    for angle_rad, point in ((0.5, after.start_point), (2.0, after.end_point)):
        there = (100 + 1000 * math.cos(angle_rad), 200 + 1500 * math.sin(angle_rad))
        assert (point.x, point.y) == pytest.approx(there, rel=1e-12)


def test_flaws_of_the_input_are_not_said_again_on_the_screen(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    path = drawing_file(tmp_path / "plan.dxf", "R2010")
    lines = path.read_text(encoding="utf-8").splitlines()
    start, end = lines.index("ENTITIES"), lines.index("OBJECTS")
    first, second, *_ = (i + 1 for i in range(start, end) if lines[i] == "  5")
    lines[second] = lines[first]
    path.write_text("\n".join(lines), encoding="utf-8")
    written(results.on_drawing(results.furnished_result(), path, "mm", Frame()), tmp_path / "a.dxf")
    assert capfd.readouterr().err == ""


# --- a plan that came from no drawing --------------------------------------------------------


def test_a_plan_from_elsewhere_is_drawn_on_plain_layers(tmp_path: Path) -> None:
    document = written(results.furnished_result(), tmp_path / "a.dxf")
    layers = Counter(entity.dxf.layer for entity in document.modelspace())
    assert layers["FLOOR"] == layers["WALL"] == layers["COLUMN"] == layers["EMBEDDED"] == 1
    assert layers["HOLE"] == 2
    assert document.units == 4


def test_a_floor_in_two_pieces_with_a_hole_is_three_outlines(tmp_path: Path) -> None:
    pierced = Polygon(box(0, 0, 7000, 5000).exterior, [box(100, 100, 300, 300).exterior.coords])
    plan = FloorPlan(
        pierced.union(box(8000, 0, 9000, 1000)), (Obstacle(Circle(500, 500, 50), Kind.COLUMN),)
    )
    document = written(results.with_plan(results.furnished_result(), plan), tmp_path / "a.dxf")
    assert len(on_layer(document, "FLOOR")) == 3


def test_the_output_read_again_gives_the_same_area_from_the_same_start(tmp_path: Path) -> None:
    result = results.furnished_result()
    write_aoi(tmp_path / "a.dxf", result)
    again = area_of_interest(read_plan(tmp_path / "a.dxf"), settings=result.settings)
    assert again.search.start.node == result.search.start.node
    assert again.aoi.area_mm2 == pytest.approx(result.aoi.area_mm2, rel=1e-12)


# --- other programs --------------------------------------------------------------------------


def program(name: str) -> str:
    found = shutil.which(name)
    if found is None:
        pytest.skip(f"{name} is not installed")
    return found


@pytest.mark.parametrize("frame", [Frame(), IN_METRES], ids=["mm", "m, georeferenced, turned"])
def test_gdal_reads_the_same_area(tmp_path: Path, frame: Frame) -> None:
    ogrinfo = program("ogrinfo")
    unit = "mm" if frame.mm_per_unit == 1 else "m"
    path = drawing_file(tmp_path / "plan.dxf")
    result = results.on_drawing(results.furnished_result(), path, unit, frame)
    write_aoi(tmp_path / "a.dxf", result)
    query = "SELECT COUNT(*) n, SUM(ST_Area(geometry)) a FROM entities WHERE Layer='SATAOI-AOI'"
    options = {
        "DXF_ENCODING": "UTF-8",
        "DXF_HATCH_TOLERANCE": f"{0.0001 / frame.mm_per_unit}",
        "OGR_ARC_STEPSIZE": "0.05",
    }
    run = subprocess.run(
        [ogrinfo, "-ro", "-q", "-dialect", "SQLite", "-sql", query, str(tmp_path / "a.dxf")],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, **options},
    )
    if "no such function" in run.stderr:
        pytest.skip("ogrinfo is built without SpatiaLite")
    assert "ERROR" not in run.stderr
    count, area = re.findall(r"\(\w+\) = ([\d.]+)", run.stdout)
    assert int(count) == len(result.aoi.outlines)
    in_mm2 = float(area) * frame.mm_per_unit**2
    assert in_mm2 == pytest.approx(result.report.aoi.area_m2 * 1e6, rel=1e-6)


FREECAD_AREAS = """
import os, FreeCAD, Part, importDXF
draft = FreeCAD.ParamGet("User parameter:BaseApp/Preferences/Mod/Draft")
draft.SetBool("dxfUseLegacyImporter", False)
draft.SetBool("dxfShowDialog", False)
importDXF.open(os.environ["DXF"])
shapes = [o.Shape for o in FreeCAD.ActiveDocument.Objects if hasattr(o, "Shape")]
edges = [edge for shape in shapes if not shape.isNull() for edge in shape.Edges]
for chain in Part.sortEdges(edges):
    wire = Part.Wire(chain)
    if wire.isClosed():
        print("AREA %.6f" % Part.Face(wire).Area)
"""


def test_freecad_measures_every_loop_with_true_arcs(tmp_path: Path) -> None:
    freecad = program("freecadcmd")
    result = results.with_parts(results.furnished_result(), results.two_parts())
    write_aoi(tmp_path / "a.dxf", result)
    (tmp_path / "areas.py").write_text(FREECAD_AREAS)
    run = subprocess.run(
        [freecad, "-c", f"exec(open({str(tmp_path / 'areas.py')!r}).read())"],
        capture_output=True,
        text=True,
        stdin=subprocess.DEVNULL,
        timeout=100,
        check=False,
        env={**os.environ, "DXF": str(tmp_path / "a.dxf"), "HOME": str(tmp_path)},
    )
    areas = [float(area) for area in re.findall(r"AREA ([\d.]+)", run.stdout)]
    for outline in result.aoi.outlines:
        for loop in (outline.exterior, *outline.holes):
            assert pytest.approx(abs(loop.area_mm2()), rel=1e-9) in areas


def test_librecad_shows_the_walls_over_the_fill(tmp_path: Path) -> None:
    librecad, pdftoppm = program("librecad"), program("pdftoppm")
    path = tmp_path / "plan.dxf"
    document = ezdxf.readfile(drawing_file(path))
    # a bar of the input across the whole area, in a colour of its own
    document.modelspace().add_solid(
        [(0, 2000), (7000, 2000), (0, 2300), (7000, 2300)], dxfattribs={"color": 4}
    )
    document.saveas(path)
    result = results.on_drawing(results.furnished_result(), path, "mm", Frame())
    write_aoi(tmp_path / "a.dxf", result)
    environment = {**os.environ, "QT_QPA_PLATFORM": "offscreen", "HOME": str(tmp_path)}
    for command in (
        [librecad, "dxf2pdf", "-a", "-c", "-p", "420x297", "-t", ".", "a.dxf"],
        [pdftoppm, "-r", "72", "-png", "-singlefile", "a.pdf", "a"],
    ):
        subprocess.run(
            command, cwd=tmp_path, env=environment, timeout=60, check=True, capture_output=True
        )
    with Image.open(tmp_path / "a.png") as picture:
        pixels = {colour: n for n, colour in picture.convert("RGB").getcolors(1 << 24)}
    bar_mm2 = 7000 * 300
    # outlines and a text hide a little of both
    in_view = pixels[0, 255, 255] / pixels[197, 232, 183]
    assert in_view == pytest.approx(bar_mm2 / (result.aoi.area_mm2 - bar_mm2), rel=0.1)


def test_hatches_begin_where_no_vertices_crowd() -> None:
    crowded = np.array([(0, 0, 0), (0.01, 0, 0), (8, 0, 0.5), (8, 9, 0), (0, 9, 0)])
    begun = begun_on_a_straight(crowded)
    assert begun.tolist() == [
        [0, 4.5, 0],
        [0, 0, 0],
        [0.01, 0, 0],
        [8, 0, 0.5],
        [8, 9, 0],
        [0, 9, 0],
    ]
    assert Loop(begun).area_mm2() == pytest.approx(Loop(crowded).area_mm2(), rel=1e-15)


def test_a_loop_of_arcs_alone_is_left_as_it_is() -> None:
    disc = np.array([(0.0, 0.0, 1.0), (2.0, 0.0, 1.0)])
    assert begun_on_a_straight(disc) is disc


@pytest.mark.parametrize(
    "name",
    [
        "d01_barcelona_pavilion_plan_m.dxf",
        "d08_flat_lines_only_inch.dxf",
        "d09_hal9k_single_line_walls_cm_danish.dxf",
        "d11_learning_center_mm.dxf",
        "d12_two_rooms_rotated_nested_blocks_m.dxf",
        "d15_barcelona_r12_plan_inside_inserts_mm.dxf",
    ],
)
def test_real_drawings_are_kept_and_get_no_new_audit_entries(tmp_path: Path, name: str) -> None:
    if not CORPUS.is_dir():
        pytest.skip("the collection of real drawings is not here")
    result = results.on_drawing(results.furnished_result(), CORPUS / name, "mm", Frame())
    after = written(result, tmp_path / "a.dxf")
    before = ezdxf.readfile(CORPUS / name)
    theirs = [e for e in after.modelspace() if not e.dxf.layer.startswith("SATAOI-")]
    assert [e.dxf.handle for e in theirs] == [e.dxf.handle for e in before.modelspace()]
    audits = [document.audit() for document in (before, after)]
    assert len(audits[0].errors) == len(audits[1].errors)
    assert len(audits[0].fixes) == len(audits[1].fixes)
