"""A sample drawn another way gives the same plan and the same area."""

import io
import math
import random
import re
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Final

import ezdxf
import numpy as np
import pytest
import shapely
from ezdxf import transform
from ezdxf.addons import r12export
from ezdxf.document import Drawing
from ezdxf.math import Matrix44
from shapely.geometry.base import BaseGeometry

from satAOI_adapters.dxf_read import ReadOptions, read
from satAOI_geo.pipeline import area_of_interest
from satAOI_geo.plan import FloorPlan, Kind
from satAOI_geo.settings import Settings
from tests.drawings import CM, INCH, MM, M

SAMPLES = Path(__file__).parents[1] / "samples"

NAMES: Final = ("flat", "hall_complex", "two_rooms_760")
"""Walls as solids and arcs with blocks for columns; lines, hatches and circles; the least."""

FAR_MM: Final = (568_053_449, 5_774_347_227)
"""A place in UTM coordinates, in millimetres."""

TURN_DEG: Final = 30.0

UNITLESS: Final = 0

NOISE_MM: Final = 1e-4
"""Corners are kept to 1e-5 mm, each way of drawing rounds a few times."""


def shuffled(document: Drawing) -> None:
    random.Random(1).shuffle(document.modelspace().entity_space.entities)


def shifted(document: Drawing) -> None:
    transform.inplace(document.modelspace(), Matrix44.translate(*FAR_MM, 0))


def turned(document: Drawing) -> None:
    transform.inplace(document.modelspace(), Matrix44.z_rotate(math.radians(TURN_DEG)))


def in_mirrored_blocks(document: Drawing) -> None:
    """The whole plan mirrored in a block, mirrored back and turned in a second one around it."""
    space = document.modelspace()
    inner, outer = document.blocks.new("INNER"), document.blocks.new("OUTER")
    transform.inplace(space, Matrix44.scale(-1, 1, 1))
    for entity in list(space):
        space.unlink_entity(entity)
        inner.add_entity(entity)
    outer.add_blockref("INNER", (0, 0), dxfattribs={"xscale": -1, "rotation": 90})
    space.add_blockref("OUTER", (0, 0), dxfattribs={"rotation": -90})


def in_unit(code: int, unit_mm: float) -> Callable[[Drawing], None]:
    def change(document: Drawing) -> None:
        share = 1 / unit_mm
        transform.inplace(document.modelspace(), Matrix44.scale(share, share, share))
        document.header["$INSUNITS"] = code

    return change


UPRIGHT: Final[dict[str, Callable[[Drawing], None]]] = {
    "entities shuffled": shuffled,
    "far from the origin": shifted,
    "in mirrored blocks": in_mirrored_blocks,
    "in mm": in_unit(MM, 1.0),
    "in cm": in_unit(CM, 10.0),
    "in m": in_unit(M, 1000.0),
    "in inch": in_unit(INCH, 25.4),
}
"""Ways to draw a plan that leave its own coordinates as they are."""


@cache
def as_drawn(name: str) -> FloorPlan:
    return read(SAMPLES / f"{name}.dxf", ReadOptions())


def redrawn(name: str, change: Callable[[Drawing], None], folder: Path) -> FloorPlan:
    document = ezdxf.readfile(SAMPLES / f"{name}.dxf")
    change(document)
    document.saveas(folder / "plan.dxf")
    return read(folder / "plan.dxf", ReadOptions())


def aoi_m2(plan: FloorPlan) -> float:
    return area_of_interest(plan, settings=Settings(step_mm=100.0)).report.aoi.area_m2


def region_of(plan: FloorPlan, kind: Kind) -> BaseGeometry:
    return shapely.union_all([o.region() for o in plan.obstacles if o.kind is kind])


def assert_same(one: BaseGeometry, other: BaseGeometry) -> None:
    """No more differs than noise along the outlines, and nothing lies beyond noise."""
    between = one.symmetric_difference(other)
    assert between.area <= NOISE_MM * (one.length + other.length)
    assert other.difference(one.buffer(NOISE_MM)).is_empty
    assert one.difference(other.buffer(NOISE_MM)).is_empty


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("way", UPRIGHT)
def test_plan_drawn_another_way_is_the_same_plan(name: str, way: str, tmp_path: Path) -> None:
    plan = redrawn(name, UPRIGHT[way], tmp_path)
    assert_same(as_drawn(name).floor, plan.floor)
    for kind in Kind:
        assert_same(region_of(as_drawn(name), kind), region_of(plan, kind))
    assert len(plan.obstacles) == len(as_drawn(name).obstacles)


@pytest.mark.parametrize("way", UPRIGHT)
def test_plan_drawn_another_way_has_the_same_area_of_interest(way: str, tmp_path: Path) -> None:
    plan = redrawn("two_rooms_760", UPRIGHT[way], tmp_path)
    assert aoi_m2(plan) == pytest.approx(aoi_m2(as_drawn("two_rooms_760")), rel=1e-6)


@pytest.mark.parametrize("name", NAMES)
def test_plan_turned_is_the_plan_turned(name: str, tmp_path: Path) -> None:
    plan = redrawn(name, turned, tmp_path)
    turn_rad = math.radians(TURN_DEG)
    matrix = np.array(
        [[math.cos(turn_rad), -math.sin(turn_rad)], [math.sin(turn_rad), math.cos(turn_rad)]]
    )

    def seen(region: BaseGeometry) -> BaseGeometry:
        """What was drawn upright, where it lies in the frame of the turned plan."""
        origin_mm = np.array(plan.frame.origin_mm)
        return shapely.transform(
            region, lambda xy: as_drawn(name).frame.to_drawing_mm(xy) @ matrix.T - origin_mm
        )

    assert_same(seen(as_drawn(name).floor), plan.floor)
    # curves are cut into chords from their start on, wherever that is
    for kind in Kind:
        one, other = seen(region_of(as_drawn(name), kind)), region_of(plan, kind)
        assert other.area == pytest.approx(one.area, rel=1e-6)
    assert len(plan.obstacles) == len(as_drawn(name).obstacles)


@pytest.mark.parametrize("name", NAMES)
def test_plan_turned_has_the_same_area_of_interest(name: str, tmp_path: Path) -> None:
    plan = redrawn(name, turned, tmp_path)
    assert aoi_m2(plan) == pytest.approx(aoi_m2(as_drawn(name)), rel=1e-6)


LAYERS: Final = {
    "chinese": {
        "WALL": "墙",
        "COLUMN": "柱",
        "HOLE": "洞口",
        "EMBEDDED": "预埋件",
        "FLOOR": "楼板",
    },
    "russian": {"WALL": "Стены", "COLUMN": "Колонны", "FLOOR": "Пол"},
}
"""Layers of the complex hall under other names; what is not listed keeps its own."""

ENCODED: Final = {
    "R12 gbk": ("R12", "gbk", "ANSI_936", "chinese"),
    "R12 gbk under a western header": ("R12", "gbk", "ANSI_1252", "chinese"),
    "R2000 gbk": ("R2000", "gbk", "ANSI_936", "chinese"),
    "R2000 utf-8 under a chinese header": ("R2000", "utf-8", "ANSI_936", "chinese"),
    "R2004 cp1251": ("R2004", "cp1251", "ANSI_1251", "russian"),
    "R2007 utf-8": ("R2007", "utf-8", "ANSI_1252", "russian"),
    "R2018 utf-8": ("R2018", "utf-8", "ANSI_936", "chinese"),
}
"""Version, encoding of the bytes, code page in the header, language."""


@pytest.mark.parametrize("case", ENCODED)
def test_plan_in_another_encoding_is_the_same_plan(case: str, tmp_path: Path) -> None:
    version, encoding, page, language = ENCODED[case]
    names = LAYERS[language]
    document = ezdxf.readfile(SAMPLES / "hall_complex.dxf")
    document.header["$INSUNITS"] = UNITLESS
    if version == "R12":
        document = r12export.convert(document)
    document.dxfversion = version
    stream = io.StringIO()
    document.write(stream)
    text = re.sub(r"(\$DWGCODEPAGE\s+3\n)\w+", rf"\g<1>{page}", stream.getvalue())
    text = re.sub(r"(?m)^(  8\n)(.+)$", lambda m: m[1] + names.get(m[2], m[2]), text)
    path = tmp_path / "plan.dxf"
    path.write_bytes(text.encode(encoding))
    # R12 has no unit of length
    plan = read(path, ReadOptions(units="mm"))
    drawn = as_drawn("hall_complex")
    assert_same(drawn.floor, plan.floor)
    for kind in Kind:
        assert_same(region_of(drawn, kind), region_of(plan, kind))
    assert {o.layer for o in plan.obstacles} == {
        names.get(o.layer, o.layer) for o in drawn.obstacles
    }
