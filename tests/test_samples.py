"""The samples are what samples/README.md says; this reading of them shares no code with ours."""

import math
import os
import subprocess
import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import ezdxf
import ezdxf.units
import pytest
import shapely
from ezdxf.document import Drawing
from ezdxf.entities import Circle, DXFEntity, DXFGraphic, Insert, LWPolyline
from shapely.geometry import Point, Polygon

from satAOI_adapters import read_plan
from satAOI_adapters.dxf_read import ReadOptions
from satAOI_geo.pipeline import Result, area_of_interest

SAMPLES = Path(__file__).parents[1] / "samples"
NAMES = ("flat", "hall_complex", "hall_medium", "hall_simple", "two_rooms_760", "two_rooms_900")
HALLS = {"hall_simple": 7.00, "hall_medium": 14.96, "hall_complex": 25.84}
"""Obstacle areas of the paper's table 1 in m²."""

WRITTEN_WITH = "1.4.5"
"""Version of ezdxf that wrote the committed files."""

OBSTACLES = {"WALL", "COLUMN", "EMBEDDED", "HOLE"}
PARTITION_MM2 = 120.0 * 19_190.0


@dataclass(frozen=True, slots=True)
class Thing:
    """One outline or circle of a hall: where it is, and its area in closed form."""

    layer: str
    region: Polygon
    area_mm2: float

    def size_mm(self) -> tuple[float, float]:
        """Width and height."""
        left, bottom, right, top = self.region.bounds
        return right - left, top - bottom


def drawing(name: str) -> Drawing:
    return ezdxf.readfile(SAMPLES / f"{name}.dxf")


def entities(
    group: Iterable[DXFEntity], outer_layer: str = "0"
) -> Iterator[tuple[DXFGraphic, str]]:
    """Everything but blocks, blocks opened, each with the layer it counts as."""
    for entity in group:
        assert isinstance(entity, DXFGraphic)
        layer = outer_layer if entity.dxf.layer == "0" else entity.dxf.layer
        if isinstance(entity, Insert):
            for instance in entity.multi_insert() if entity.mcount > 1 else [entity]:
                yield from entities(instance.virtual_entities(), layer)
        else:
            yield entity, layer


def things(name: str) -> list[Thing]:
    """Floor and obstacles of a hall."""
    wanted = OBSTACLES | {"FLOOR"}
    return [
        thing(entity, layer)
        for entity, layer in entities(drawing(name).modelspace())
        if layer in wanted
    ]


def thing(entity: DXFGraphic, layer: str) -> Thing:
    if isinstance(entity, Circle):
        centre, radius_mm = entity.ocs().to_wcs(entity.dxf.center), entity.dxf.radius
        region = Point(centre.x, centre.y).buffer(radius_mm, quad_segs=256)
        return Thing(layer, region, math.pi * radius_mm**2)
    assert isinstance(entity, LWPolyline)
    assert entity.closed
    corners_mm = [(corner.x, corner.y) for corner in entity.vertices_in_wcs()]
    if entity.has_arc:
        # a slotted hole: a rectangle and, beyond its short sides, two half discs
        (x0, y0), (x1, y1), (x2, _), _ = corners_mm
        radius_mm = abs(x2 - x1) / 2
        region = shapely.LineString([((x0 + x2) / 2, y0), ((x0 + x2) / 2, y1)])
        area_mm2 = 2 * radius_mm * abs(y1 - y0) + math.pi * radius_mm**2
        return Thing(layer, region.buffer(radius_mm, quad_segs=256), area_mm2)
    polygon = Polygon(corners_mm)
    return Thing(layer, polygon, polygon.area)


def on_the_floor(name: str) -> list[Thing]:
    """Obstacles of a hall that are not outside the floor."""
    all_things = things(name)
    (floor,) = (t.region for t in all_things if t.layer == "FLOOR")
    inside = [t for t in all_things if t.layer != "FLOOR" and t.region.intersects(floor)]
    return [t for t in inside if t.region.intersection(floor).area > 0]


@pytest.mark.parametrize("hall", HALLS)
def test_hall_measures_10450_by_19190(hall: str) -> None:
    (floor,) = (t for t in things(hall) if t.layer == "FLOOR")
    assert floor.region.bounds == (0.0, 0.0, 10_450.0, 19_190.0)


@pytest.mark.parametrize("hall", HALLS)
def test_obstacles_of_a_hall_have_the_paper_s_area(hall: str) -> None:
    area_m2 = sum(t.area_mm2 for t in on_the_floor(hall)) / 1e6
    # the sump's sides are whole millimetres, so a few mm² are left over
    assert area_m2 == pytest.approx(HALLS[hall], abs=1e-5)


@pytest.mark.parametrize("hall", HALLS)
def test_reader_finds_the_paper_s_area_and_has_nothing_to_say(hall: str) -> None:
    plan = read_plan(SAMPLES / f"{hall}.dxf", ReadOptions())
    area_m2 = plan.obstacle_region().area / 1e6
    # the ends of slotted holes are flattened outwards by at most 0.01 mm
    assert area_m2 == pytest.approx(HALLS[hall], abs=1e-4)
    assert plan.findings == ()


@pytest.mark.parametrize("hall", HALLS)
def test_obstacles_of_a_hall_lie_on_the_floor_and_apart(hall: str) -> None:
    regions = [t.region for t in on_the_floor(hall)]
    floor = shapely.box(0, 0, 10_450, 19_190)
    assert all(floor.covers(region) for region in regions)
    tree = shapely.STRtree(regions)
    left, right = tree.query(regions, predicate="intersects")
    assert list(left) == list(right)


@pytest.mark.parametrize("hall", HALLS)
def test_parts_and_holes_of_a_hall_measure_160_to_2000_mm(hall: str) -> None:
    for part in on_the_floor(hall):
        if part.layer != "WALL":
            narrow_mm, long_mm = sorted(part.size_mm())
            assert narrow_mm >= 160.0 - 1e-9
            assert long_mm <= 2000.0 + 1e-9


def test_partition_cuts_the_simple_hall_from_bottom_to_top() -> None:
    (partition,) = (t for t in on_the_floor("hall_simple") if t.layer == "WALL")
    assert partition.area_mm2 == PARTITION_MM2
    assert partition.region.bounds[1::2] == (0.0, 19_190.0)


def test_halls_hold_what_a_reader_finds_hard() -> None:
    medium = drawing("hall_medium")
    assert [e for e in medium.modelspace() if isinstance(e, Insert) and e.dxf.xscale < 0]
    assert [e for e in medium.modelspace() if isinstance(e, LWPolyline) and e.has_arc]
    assert {e.dxftype() for e in medium.blocks.get("BAY")} >= {"CIRCLE", "INSERT", "LWPOLYLINE"}
    simple = drawing("hall_simple")
    assert [e for e in simple.modelspace() if isinstance(e, Insert) and e.mcount > 1]


@pytest.mark.parametrize(
    ("name", "opening_mm", "units", "unit_mm"),
    [
        ("two_rooms_760", 760.0, ezdxf.units.MM, 1.0),
        ("two_rooms_900", 900.0, ezdxf.units.M, 1000.0),
    ],
)
def test_rooms_are_4_by_4_m_with_the_opening_of_the_name(
    name: str, opening_mm: float, units: int, unit_mm: float
) -> None:
    doc = drawing(name)
    assert doc.units == units
    (outline,) = doc.modelspace().query('LWPOLYLINE[layer=="FLOOR"]')
    assert isinstance(outline, LWPolyline)
    floor = Polygon([(v.x * unit_mm, v.y * unit_mm) for v in outline.vertices_in_wcs()])
    assert floor.area == pytest.approx(2 * 4000.0**2 + 200.0 * opening_mm, rel=1e-12)
    assert floor.bounds == pytest.approx((0.0, 0.0, 8200.0, 4000.0), rel=1e-12)


def test_flat_has_solid_walls_one_curved_and_columns_as_blocks() -> None:
    doc = drawing("flat")
    msp = doc.modelspace()
    walls = msp.query('HATCH[layer=="A-WALL"]')
    assert all(wall.dxf.solid_fill for wall in walls)
    assert {arc.dxf.radius for arc in msp.query('ARC[layer=="A-WALL"]')} == {2500.0, 2260.0}
    assert len(msp.query('INSERT[layer=="A-COLS"]')) == 3
    assert "A-FLOR" not in doc.layers


@cache
def result(name: str) -> Result:
    return area_of_interest(read_plan(SAMPLES / f"{name}.dxf", ReadOptions()))


def is_troweled(name: str, at: tuple[float, float]) -> bool:
    """Whether the area of interest of a sample holds a point, given in drawing units."""
    there = shapely.points(result(name).plan.frame.to_local_mm(at))
    return any(outline.polygon().contains(there) for outline in result(name).aoi.outlines)


def test_robot_gets_through_an_opening_of_900_mm_and_not_of_760() -> None:
    assert is_troweled("two_rooms_760", (2000.0, 2000.0))
    assert not is_troweled("two_rooms_760", (6200.0, 2000.0))
    assert is_troweled("two_rooms_900", (2.0, 2.0))
    assert is_troweled("two_rooms_900", (6.2, 2.0))


@pytest.mark.parametrize(
    ("room", "centre", "reached"),
    [
        ("bedroom 1", (2300.0, 2300.0), True),
        ("bedroom 2", (2000.0, 6100.0), True),
        ("living", (6500.0, 2500.0), True),
        ("kitchen", (8500.0, 6000.0), True),
        ("bath", (5200.0, 6000.0), False),
    ],
)
def test_robot_gets_into_every_room_of_the_flat_but_the_bath(
    room: str, centre: tuple[float, float], *, reached: bool
) -> None:
    assert is_troweled("flat", centre) is reached, room


def test_robot_trowels_no_wall_column_or_shaft_of_the_flat() -> None:
    wall, column, shaft = (4460.0, 1500.0), (8200.0, 2600.0), (4370.0, 7460.0)
    assert not any(is_troweled("flat", at) for at in (wall, column, shaft))


@pytest.mark.parametrize("name", NAMES)
def test_sample_passes_the_audit_of_ezdxf(name: str) -> None:
    auditor = drawing(name).audit()
    assert (auditor.errors, auditor.fixes) == ([], [])


def test_readme_has_a_line_for_every_sample() -> None:
    assert sorted(path.stem for path in SAMPLES.glob("*.dxf")) == sorted(NAMES)
    readme = (SAMPLES / "README.md").read_text(encoding="utf-8")
    assert all(f"`{name}.dxf`" in readme for name in NAMES)


def written(folder: Path, *, hash_seed: str) -> dict[str, bytes]:
    """What the script writes; the order of sets of strings follows from the seed."""
    folder.mkdir()
    subprocess.run(
        [sys.executable, SAMPLES / "make_samples.py", folder],
        check=True,
        timeout=120,
        env={**os.environ, "PYTHONHASHSEED": hash_seed},
    )
    return {path.stem: path.read_bytes() for path in folder.iterdir()}


def test_script_writes_the_same_bytes_on_every_run(tmp_path: Path) -> None:
    once = written(tmp_path / "once", hash_seed="1")
    again = written(tmp_path / "again", hash_seed="2")
    assert sorted(once) == sorted(NAMES)
    assert once == again


@pytest.mark.skipif(
    ezdxf.__version__ != WRITTEN_WITH,
    reason=f"the samples were written with ezdxf {WRITTEN_WITH}; another may write other bytes",
)
def test_script_writes_the_committed_files_byte_for_byte(tmp_path: Path) -> None:
    committed = {name: (SAMPLES / f"{name}.dxf").read_bytes() for name in NAMES}
    assert written(tmp_path / "new", hash_seed="0") == committed
