"""The unit of length: option, header, estimate, in this order, and no silent contradiction."""

from pathlib import Path

import ezdxf
import pytest
from ezdxf.document import Drawing
from ezdxf.math import Matrix44

from satAOI_geo.errors import InputError, UnitError
from satAOI_geo.units import MM_PER_UNIT
from tests.drawings import CM, INCH, MM, M, codes, drawing, plan_of, rectangle

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


@pytest.mark.parametrize(
    ("unit", "header", "size"), [("cm", "in", "22.9 × 17.8 m"), ("m", "ft", "2.74 × 2.13 m")]
)
def test_header_that_two_doors_contradict_is_believed_with_a_word(
    unit: str, header: str, size: str, tmp_path: Path
) -> None:
    plan = plan_of(flat(unit, header), tmp_path)
    (doubt,) = (finding for finding in plan.findings if finding.code == "unit-doubtful")
    assert plan.source.unit == header
    assert size in doubt.message
    assert "9 × 7 m" in doubt.message
    assert f"--units {unit}" in doubt.remedy


def test_header_is_doubted_also_where_layers_say_nothing(tmp_path: Path) -> None:
    document = flat("cm", "in")
    for entity in list(document.modelspace()):
        entity.dxf.layer = "0"
        if entity.dxftype() == "TEXT":
            document.modelspace().delete_entity(entity)
    plan = plan_of(document, tmp_path)
    assert {"all-walls", "unit-doubtful"} <= set(codes(plan))


def test_header_that_many_doors_contradict_is_refused(tmp_path: Path) -> None:
    document = flat("cm", "in")
    for y in (200, 400):
        document.modelspace().add_arc((0, y), 80, 0, 90, dxfattribs={"layer": "DOOR"})
    with pytest.raises(UnitError, match="--units cm or --units in"):
        plan_of(document, tmp_path)


def hall(header: str) -> Drawing:
    """A hall of 36 × 18 m with columns and no door, in centimetres: in inches it is one, too."""
    document = drawing(unit=INSUNITS[header], floor=False)
    space = document.modelspace()
    rectangle(space, 0, 0, 3600, 1800, layer="WALL")
    rectangle(space, 24, 24, 3576, 1776, layer="WALL")
    for x in range(600, 3600, 600):
        rectangle(space, x, 900, x + 40, 940, layer="COLUMN")
    return document


@pytest.mark.parametrize("header", ["mm", "m", "ft"])
def test_header_is_refused_also_where_two_other_units_are_as_likely(
    header: str, tmp_path: Path
) -> None:
    with pytest.raises(UnitError, match=f"--units cm or --units in or --units {header}") as caught:
        plan_of(hall(header), tmp_path)
    assert "36 × 18 m or 91.4 × 45.7 m" in str(caught.value)


@pytest.mark.parametrize("header", ["cm", "in"])
def test_header_is_believed_where_its_unit_is_as_likely_as_another(
    header: str, tmp_path: Path
) -> None:
    plan = plan_of(hall(header), tmp_path)
    assert plan.source.unit == header
    assert "unit-doubtful" not in codes(plan)


def test_width_of_a_polyline_is_the_thickness_of_a_wall(tmp_path: Path) -> None:
    document = drawing(unit=INCH, floor=False)
    space = document.modelspace()
    corners = [(0, 0), (8000, 0), (8000, 5000), (0, 5000)]
    space.add_lwpolyline(corners, close=True, dxfattribs={"layer": "WALL", "const_width": 250})
    space.add_arc((4000, 4000), 900, 0, 90, dxfattribs={"layer": "DOOR"})
    with pytest.raises(UnitError, match="wall thicknesses and overall size say mm"):
        plan_of(document, tmp_path)


@pytest.mark.parametrize(
    ("header", "width", "height", "size"),
    [(M, 8000, 5000, "8000 × 5000 m"), (MM, 8, 5, "0.008 × 0.005 m"), (CM, 150, 100, "1.5 × 1 m")],
)
def test_plan_of_impossible_size_is_refused(
    header: int, width: float, height: float, size: str, tmp_path: Path
) -> None:
    document = drawing(unit=header, floor=False)
    rectangle(document.modelspace(), 0, 0, width, height, layer="FLOOR")
    with pytest.raises(UnitError, match="give --units mm for") as caught:
        plan_of(document, tmp_path)
    assert size in str(caught.value)


def test_option_settles_an_impossible_size(tmp_path: Path) -> None:
    document = drawing(unit=M, floor=False)
    rectangle(document.modelspace(), 0, 0, 8000, 5000, layer="FLOOR")
    assert plan_of(document, tmp_path, units="m").floor.area == pytest.approx(40e12)


def test_plan_in_a_site_of_any_size_is_read(tmp_path: Path) -> None:
    document = drawing(unit=M, floor=False)
    rectangle(document.modelspace(), 0, 0, 20, 10, layer="FLOOR")
    rectangle(document.modelspace(), 7000, 7000, 7004, 7004, layer="WALL")
    assert plan_of(document, tmp_path).floor.area == pytest.approx(200e6)


def test_size_alone_tells_no_unit(tmp_path: Path) -> None:
    document = drawing(unit=0, floor=False)
    rectangle(document.modelspace(), 0, 0, 45_000, 37_000, layer="FLOOR")
    with pytest.raises(UnitError, match="--units mm for 45 × 37 m"):
        plan_of(document, tmp_path)


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
