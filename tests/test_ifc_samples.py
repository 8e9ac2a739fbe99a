"""A plan as a building model gives the area that the same plan gives as a drawing."""

import importlib
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import ifcopenshell
import ifcopenshell.validate
import pytest
import shapely

from satAOI_adapters import dxf_read, ifc_read
from satAOI_geo.pipeline import area_of_interest
from satAOI_geo.plan import FloorPlan, Kind
from tests.test_ifc_read import plan_in

SAMPLES = Path(__file__).parents[1] / "samples"

WRITTEN_WITH = "0.9.0"
"""Version of ifcopenshell that wrote the committed files."""

SCHEMAS = ("IFC2X3", "IFC4", "IFC4X3")
UNITS = ("mm", "m")


@pytest.fixture(scope="module")
def script() -> Iterator[ModuleType]:
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(SAMPLES))
        yield importlib.import_module("make_ifc_samples")


def drawing(name: str) -> FloorPlan:
    return dxf_read.read(SAMPLES / f"{name}.dxf", dxf_read.ReadOptions())


def model(script: ModuleType, folder: Path, name: str, schema: str, unit: str) -> FloorPlan:
    path = folder / f"{name}.ifc"
    path.write_text(script.SAMPLES[name](schema=schema, unit=unit).text(), encoding="ascii")
    return plan_in(path)


@pytest.mark.skipif(
    not ifcopenshell.version.startswith(WRITTEN_WITH), reason=f"written with {WRITTEN_WITH}"
)
def test_the_script_writes_the_samples_byte_for_byte(script: ModuleType, tmp_path: Path) -> None:
    script.main(tmp_path)
    for path in sorted(tmp_path.iterdir()):
        assert path.read_bytes() == (SAMPLES / path.name).read_bytes(), path.name


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("schema", SCHEMAS)
@pytest.mark.parametrize("name", ["two_rooms_900", "flat"])
def test_samples_follow_their_schema(script: ModuleType, name: str, schema: str, unit: str) -> None:
    log = ifcopenshell.validate.json_logger()
    text = script.SAMPLES[name](schema=schema, unit=unit).text()
    ifcopenshell.validate.validate(ifcopenshell.file.from_string(text), log)
    assert not log.statements


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("schema", SCHEMAS)
@pytest.mark.parametrize("name", ["two_rooms_760", "two_rooms_900"])
def test_two_rooms_give_the_same_area_as_the_drawing(
    script: ModuleType, tmp_path: Path, name: str, schema: str, unit: str
) -> None:
    drawn = drawing(name)
    built = replace(model(script, tmp_path, name, schema, unit), start_mm=drawn.start_mm)
    expected = area_of_interest(drawn).aoi
    assert area_of_interest(built).aoi.area_mm2 == pytest.approx(expected.area_mm2, rel=1e-6)


def test_the_flat_gives_the_same_area_as_the_drawing() -> None:
    drawn = area_of_interest(drawing("flat"))
    built = area_of_interest(ifc_read.read(SAMPLES / "flat.ifc", ifc_read.IfcOptions()))
    assert built.aoi.area_mm2 == pytest.approx(drawn.aoi.area_mm2, rel=1e-6)
    assert built.upper.area_mm2 == pytest.approx(drawn.upper.area_mm2, rel=1e-6)


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("schema", SCHEMAS)
def test_the_flat_is_the_same_plan_in_every_schema_and_unit(
    script: ModuleType, tmp_path: Path, schema: str, unit: str
) -> None:
    built, drawn = model(script, tmp_path, "flat", schema, unit), drawing("flat")
    assert shapely.symmetric_difference(built.floor, drawn.floor).area < 100.0
    unlike = shapely.symmetric_difference(built.free_region(), drawn.free_region())
    # the curved wall, 4 m long on each side, is flattened to a hundredth of a millimetre
    assert unlike.area < 2 * 4000.0 * 0.02
    assert {o.kind for o in built.obstacles} == {Kind.WALL, Kind.COLUMN, Kind.HOLE}
    assert {o.layer for o in built.obstacles}.isdisjoint({"IfcDoor", "IfcFurniture"})
    assert not built.findings
