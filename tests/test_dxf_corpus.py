"""Drawings and broken files made by other people; skipped where their folder is absent."""

from dataclasses import dataclass
from pathlib import Path

import pytest

from satAOI_adapters.dxf_read import ReadOptions, read
from satAOI_geo.errors import (
    DrawingError,
    EmptyPlanError,
    SatAoiError,
    UnitError,
    UnreadableError,
)
from satAOI_geo.plan import FloorPlan, Kind, polygons_in

CORPUS = Path(__file__).parents[2] / "shared" / "corpus"

pytestmark = pytest.mark.skipif(not CORPUS.is_dir(), reason="the corpus of drawings is absent")


@dataclass(frozen=True)
class Expected:
    """What a drawing is read with, why, and what a person sees in it.

    Attributes:
        options: At most one.
        why: What the drawing does not say.
        floor_m2: Least and most floor area, judged by eye.
        codes: Findings that must be among those made.
    """

    options: dict[str, object]
    why: str
    floor_m2: tuple[float, float]
    codes: frozenset[str] = frozenset()


DRAWINGS = {
    "d01": Expected({}, "", (600, 640), frozenset({"floor-without-tiles"})),
    "d02": Expected(
        {"units": "m"}, "the header says inch", (600, 640), frozenset({"several-plans"})
    ),
    "d03": Expected({}, "", (250, 300), frozenset({"floor-inferred", "wall-thick"})),
    "d04": Expected(
        {"units": "in"}, "the header says mm", (200, 215), frozenset({"window-on-door-layer"})
    ),
    "d05": Expected({}, "", (1000, 1100), frozenset({"unit-estimated"})),
    "d06": Expected({"units": "m"}, "the header says mm", (350, 450), frozenset({"floor-guessed"})),
    "d07": Expected(
        {"units": "mm"}, "the header says inch", (5, 10), frozenset({"door-over-wall"})
    ),
    "d08": Expected({}, "", (94, 97), frozenset({"all-walls"})),
    "d09": Expected({}, "", (160, 172), frozenset({"all-walls", "layer-hidden", "door-over-wall"})),
    "d10": Expected({"units": "cm"}, "the header names no unit", (240, 250)),
    "d11": Expected({}, "", (1400, 1450), frozenset({"room-outline"})),
    "d12": Expected({}, "", (28, 29), frozenset({"wall-on-door-layer"})),
    "d13": Expected({}, "", (20, 22), frozenset({"all-walls"})),
    "d14": Expected({}, "", (135, 142), frozenset({"wall-filled"})),
    "d15": Expected({"units": "mm"}, "R12 has no unit", (840, 860), frozenset({"tile-joints"})),
}

ONE_BUILDING = ("d01", "d02")


def drawing(name: str) -> Path:
    (path,) = (CORPUS / "dxf").glob(f"{name}_*.dxf")
    return path


def plan_of(name: str) -> FloorPlan:
    return read(drawing(name), ReadOptions(**DRAWINGS[name].options))  # type: ignore[arg-type]


def test_every_drawing_is_in_the_table() -> None:
    assert {path.name[:3] for path in (CORPUS / "dxf").glob("*.dxf")} == set(DRAWINGS)


@pytest.mark.parametrize("name", DRAWINGS)
def test_drawing_becomes_a_plan_with_at_most_one_option(name: str) -> None:
    expected = DRAWINGS[name]
    assert len(expected.options) <= 1
    assert bool(expected.options) == bool(expected.why)
    plan = plan_of(name)
    least_m2, most_m2 = expected.floor_m2
    assert least_m2 <= plan.floor.area / 1e6 <= most_m2
    assert plan.floor.is_valid
    assert expected.codes <= {finding.code for finding in plan.findings}
    assert all(obstacle.region().is_valid for obstacle in plan.obstacles)
    assert any(obstacle.kind is not Kind.UNCLASSIFIED for obstacle in plan.obstacles)


def test_one_building_drawn_twice_is_one_plan() -> None:
    one, other = (plan_of(name) for name in ONE_BUILDING)
    assert one.floor.equals(other.floor)
    assert len(one.obstacles) == len(other.obstacles)


def test_tile_joints_and_furniture_are_no_obstacles() -> None:
    layers = {obstacle.layer for obstacle in plan_of("d01").obstacles}
    assert layers == {"Walls", "Columns", "Crystal", "Cancel"}


def test_chairs_and_tables_in_blocks_are_no_obstacles() -> None:
    assert {o.layer for o in plan_of("d12").obstacles} == {
        "A-210 G - Existing Structure 1",
        "A-325G - Internal Doors 3",
    }


def test_room_between_its_outline_and_the_outer_one_is_free() -> None:
    # 5 × 3 m inside walls of 35 cm, with two doors of 1.2 m in these
    assert plan_of("d13").free_region().area == pytest.approx(15e6 + 2 * 1200 * 350, rel=1e-9)


def test_doors_over_walls_open_the_room_behind_them() -> None:
    # walls of single lines run through under its 12 doors, one of them drawn carelessly and
    # one with two leaves
    plan = plan_of("d09")
    assert sum(finding.code == "door-over-wall" for finding in plan.findings) == 12
    free = plan.free_region()
    assert max(part.area for part in polygons_in([free])) > 0.9 * free.area


NO_PLAN = {
    "derived_all_lines_zero_length": (EmptyPlanError, "without any length"),
    "derived_comma_decimal": (UnreadableError, "decimal points"),
    "derived_cyclic_block_reference": (DrawingError, "contains itself"),
    "derived_html_error_page": (UnreadableError, "a web page"),
    "derived_lfs_pointer": (UnreadableError, "a Git LFS pointer"),
    "derived_nan_coordinate": (DrawingError, "not a finite number"),
    "derived_png_renamed": (UnreadableError, "a PNG picture"),
    "derived_truncated_mid_entities": (UnreadableError, "cut off"),
    "derived_unresolved_xref": (DrawingError, "COLUMN GRID.dwg"),
    "derived_zero_bytes": (UnreadableError, "is empty"),
    "real_186_byte_stub": (UnreadableError, "damaged"),
    "real_ac1003_prehistoric": (UnitError, "--units"),
    "real_binary_dxf_r12": (UnitError, "--units"),
    "real_binary_dxf_r2000": (EmptyPlanError, "1 TEXT"),
    "real_corridor_centerline_graph_not_walls": (EmptyPlanError, "enclose nothing"),
    "real_empty_modelspace": (EmptyPlanError, "is empty"),
    "real_invalid_group_code_unreadable": (UnreadableError, "damaged"),
    "real_layout_broken_links_empty_model": (EmptyPlanError, "is empty"),
    "real_not_a_plan_tree_of_splines": (UnitError, "0.237 × 0.242 m"),
    "real_r12_empty_handles": (UnitError, "--units"),
    "real_r12_house_elevation_stray_endsec": (UnreadableError, "cut off"),
    "real_r12_nameless_table_entry": (UnitError, "--units"),
    "real_r12_polylines_3dface_not_a_plan": (UnitError, "--units"),
    "real_r12_trash_after_eof": (EmptyPlanError, "nothing that could enclose"),
    "real_zero_extent_single_point": (EmptyPlanError, "1 POINT"),
}

READ_WITH_FINDINGS = {
    "derived_flat_offset_5e8_4e9_inch": "all-walls",
    "derived_insert_missing_block_zero_scale": "block-skipped",
    "derived_one_line_at_1e30": "far-away",
    "derived_r12_gbk_bytes_codepage_says_1252": "encoding",
    "derived_r12_gbk_chinese_layers_ansi936": "unit-estimated",
    "derived_r12_utf8_bytes_codepage_says_936": "encoding",
    "real_duplicate_handles": "file-flaws",
    "real_r2018_broken_tables": "file-repaired",
}


def test_every_broken_file_is_in_a_table() -> None:
    names = {path.stem for path in (CORPUS / "bad").glob("*.dxf")}
    assert names == {*NO_PLAN, *READ_WITH_FINDINGS}


@pytest.mark.parametrize("name", NO_PLAN)
def test_broken_file_gets_one_line_that_says_what(name: str) -> None:
    kind, says = NO_PLAN[name]
    with pytest.raises(SatAoiError) as caught:
        read(CORPUS / "bad" / f"{name}.dxf", ReadOptions())
    assert type(caught.value) is kind
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", READ_WITH_FINDINGS)
def test_flawed_file_is_read_and_its_flaw_said(name: str) -> None:
    plan = read(CORPUS / "bad" / f"{name}.dxf", ReadOptions())
    assert READ_WITH_FINDINGS[name] in {finding.code for finding in plan.findings}


def test_chinese_layers_give_one_plan_in_three_encodings() -> None:
    plans = [
        read(CORPUS / "bad" / f"{name}.dxf", ReadOptions())
        for name in READ_WITH_FINDINGS
        if "r12" in name
    ]
    assert len(plans) == 3
    assert all(plan.floor == plans[0].floor for plan in plans)
    assert all(plan.obstacles == plans[0].obstacles for plan in plans)


def test_flat_far_away_is_the_same_flat() -> None:
    near = plan_of("d08")
    far = read(CORPUS / "bad" / "derived_flat_offset_5e8_4e9_inch.dxf", ReadOptions())
    # at 1e11 mm a double has 1.5e-5 mm; inches need not be whole millimetres
    assert far.floor.area == pytest.approx(near.floor.area, rel=1e-8)
    assert len(far.obstacles) == len(near.obstacles)
