"""The unit of length: option, header, estimate, in this order, and no silent contradiction."""

from pathlib import Path

import ezdxf
import pytest
from ezdxf.document import Drawing
from ezdxf.math import Matrix44

from satAOI_geo.errors import InputError, UnitError
from satAOI_geo.units import MM_PER_UNIT
from tests.drawings import codes, plan_of, rectangle

INSUNITS = {"mm": 4, "cm": 5, "m": 6, "in": 1, "ft": 2}


def flat(unit: str, header: str | None) -> Drawing:
    """A flat with walls of 240 mm, doors of 800 mm and texts, drawn in a unit."""
    document = ezdxf.new("R2010")
    document.header["$INSUNITS"] = INSUNITS[header] if header else 0
    space = document.modelspace()
    rectangle(space, 0, 0, 9000, 7000, layer="WALL")
    rectangle(space, 240, 240, 8760, 6760, layer="WALL")
    for x in (3000, 6000):
        rectangle(space, x, 240, x + 240, 5000, layer="WALL")
        space.add_arc((x, 5000), 800, 0, 90, dxfattribs={"layer": "DOOR"})
        space.add_text("room", dxfattribs={"insert": (x, 3000), "height": 200, "layer": "TEXT"})
    for entity in space:
        entity.transform(Matrix44.scale(1 / MM_PER_UNIT[unit]))
    return document


@pytest.mark.parametrize("unit", INSUNITS)
def test_missing_unit_is_estimated_from_doors_and_walls(unit: str, tmp_path: Path) -> None:
    plan = plan_of(flat(unit, None), tmp_path)
    assert (plan.source.unit, plan.source.unit_source) == (unit, "estimate")
    assert plan.floor.area == pytest.approx(9000 * 7000, rel=1e-9)
    assert "unit-estimated" in codes(plan)


@pytest.mark.parametrize("unit", INSUNITS)
def test_right_header_is_believed(unit: str, tmp_path: Path) -> None:
    plan = plan_of(flat(unit, unit), tmp_path)
    assert (plan.source.unit, plan.source.unit_source) == (unit, "header")


@pytest.mark.parametrize(
    ("unit", "header"),
    [("m", "in"), ("m", "mm"), ("mm", "in"), ("in", "mm"), ("cm", "m"), ("ft", "in")],
)
def test_header_that_doors_and_walls_contradict_is_refused_with_both_sizes(
    unit: str, header: str, tmp_path: Path
) -> None:
    with pytest.raises(UnitError, match=f"--units {unit} or --units {header}") as caught:
        plan_of(flat(unit, header), tmp_path)
    assert "9 × 7 m" in str(caught.value)


def test_option_settles_a_contradiction(tmp_path: Path) -> None:
    plan = plan_of(flat("m", "in"), tmp_path, units="m")
    assert plan.floor.area == pytest.approx(9000 * 7000, rel=1e-9)


def test_plain_drawing_does_not_contradict_its_header(tmp_path: Path) -> None:
    document = ezdxf.new("R2010")
    document.header["$INSUNITS"] = INSUNITS["mm"]
    rectangle(document.modelspace(), 0, 0, 10_450, 19_190, layer="FLOOR")
    for k in range(6):
        rectangle(document.modelspace(), 1000 * k, 0, 1000 * k + 60, 60, layer="COLUMN")
    assert plan_of(document, tmp_path).source.unit_source == "header"


def test_unknown_unit_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="furlong"):
        plan_of(flat("mm", "mm"), tmp_path, units="furlong")
