"""How a drawing is read, as data and as tables."""

import json
import math
from pathlib import Path

import ezdxf
import pytest

from satAOI_adapters import inspect_plan, inspect_write, picture_writer_of, read_plan
from satAOI_adapters.dxf_read import ReadOptions
from satAOI_adapters.dxf_read.inspection import Inspection, LayerFigures
from satAOI_adapters.files import json_of
from satAOI_adapters.meanings import Certainty, Meaning
from satAOI_geo import DrawingError, EmptyPlanError, UnitError
from tests.drawings import drawing as drawing_in_mm
from tests.drawings import rectangle
from tests.test_dxf_plans import with_foreign

SAMPLES = Path(__file__).parents[1] / "samples"


@pytest.fixture
def drawing(tmp_path: Path) -> Path:
    """A drawing in metres: a wall of 4 m and one of 3 m, a layer that is off, an unknown one."""
    document = ezdxf.new("R2010")
    document.header["$INSUNITS"] = 6
    space = document.modelspace()
    space.add_line((1, 1), (5, 1), dxfattribs={"layer": "WALL"})
    space.add_line((5, 1), (5, 4), dxfattribs={"layer": "WALL"})
    space.add_circle((2, 3), 0.5, dxfattribs={"layer": "Zeug"})
    document.layers.add("FURNITURE").off()
    space.add_line((0, 0), (9, 9), dxfattribs={"layer": "FURNITURE"})
    file = tmp_path / "drawing.dxf"
    document.saveas(file)
    return file


def layer_of(inspection: Inspection, name: str) -> LayerFigures:
    (layer,) = (layer for layer in inspection.layers if layer.layer == name)
    return layer


def inspected(path: Path, **options: str) -> Inspection:
    figures = inspect_plan(path, ReadOptions(**options)).figures
    assert isinstance(figures, Inspection)
    return figures


def test_a_layer_tells_what_it_is_taken_for_and_why(drawing: Path) -> None:
    wall = layer_of(inspected(drawing), "WALL")
    assert wall.meaning is Meaning.WALL
    assert wall.certainty is Certainty.CERTAIN
    assert wall.entities == {"LINE": 2}


def test_lengths_are_in_millimetres_whatever_the_unit(drawing: Path) -> None:
    assert layer_of(inspected(drawing), "WALL").length_mm == pytest.approx(7000, rel=1e-12)
    in_feet = layer_of(inspected(drawing, units="ft"), "WALL")
    assert in_feet.length_mm == pytest.approx(7 * 304.8, rel=1e-12)


def test_a_layer_no_pattern_knows_is_unknown(drawing: Path) -> None:
    unknown = layer_of(inspected(drawing), "Zeug")
    assert unknown.meaning is None
    assert unknown.certainty is Certainty.UNKNOWN


def test_what_is_hidden_is_counted_and_not_measured(drawing: Path) -> None:
    inspection = inspected(drawing)
    hidden = layer_of(inspection, "FURNITURE")
    assert (hidden.n_hidden, hidden.entities, hidden.length_mm) == (1, {}, 0)
    assert inspection.bounds == (1, 1, 5, 4)
    assert inspection.size_mm == (4000, 3000)


def test_the_unit_comes_with_its_source(drawing: Path) -> None:
    assert (inspected(drawing).source.unit, inspected(drawing).source.unit_source) == (
        "m",
        "header",
    )
    assert inspected(drawing, units="ft").source.unit_source == "option"


def without_unit(drawing: Path) -> Path:
    """The same drawing where nothing tells the unit, and a line of 400 units on layer WALL."""
    document = ezdxf.readfile(drawing)
    document.header["$INSUNITS"] = 0
    document.modelspace().add_line((0, 0), (400, 0), dxfattribs={"layer": "WALL"})
    document.save()
    return drawing


def test_without_any_unit_the_error_shows_the_sizes(drawing: Path) -> None:
    error = inspect_plan(without_unit(drawing)).error
    assert isinstance(error, UnitError)
    assert "--units mm for 0.4 × 0.004 m" in str(error)


def test_without_any_unit_the_layers_are_told_and_nothing_is_measured(drawing: Path) -> None:
    inspection = inspected(without_unit(drawing))
    wall = layer_of(inspection, "WALL")
    assert (wall.meaning, wall.entities) == (Meaning.WALL, {"LINE": 3})
    assert (wall.length_mm, wall.area_mm2, inspection.size_mm) == (None, None, None)
    facts, layers = inspect_write.tables_of(inspection)
    assert ("unit", "not known") in facts
    assert layers[2] == ("WALL", "wall", "certain", "WALL", "-", "-", "3 LINE")


def test_areas_are_those_of_closed_shapes_overlaps_counted_once(drawing: Path) -> None:
    document = ezdxf.readfile(drawing)
    space = document.modelspace()
    for x in (0, 1):
        corners = [(x, 0), (x + 2, 0), (x + 2, 1), (x, 1)]
        space.add_lwpolyline(corners, close=True, dxfattribs={"layer": "COLUMN"})
    document.save()
    inspection = inspected(drawing)
    assert layer_of(inspection, "COLUMN").area_mm2 == pytest.approx(3e6, rel=1e-12)
    assert layer_of(inspection, "Zeug").area_mm2 == pytest.approx(math.pi * 0.25e6, rel=1e-12)
    assert layer_of(inspection, "WALL").area_mm2 == 0


def test_the_plan_comes_along_and_so_do_its_findings(drawing: Path) -> None:
    found = inspect_plan(drawing)
    assert found.plan == read_plan(drawing)
    assert found.findings == found.plan.findings
    assert found.error is None


def test_why_no_plan_comes_of_a_drawing_is_told_beside_its_layers(drawing: Path) -> None:
    document = ezdxf.readfile(drawing)
    document.modelspace().add_line((1, 1), (2, 2), dxfattribs={"layer": "FLOOR"})
    document.save()
    found = inspect_plan(drawing)
    assert found.plan is None
    assert isinstance(found.error, DrawingError)
    assert inspected(drawing).error == str(found.error)
    assert layer_of(inspected(drawing), "FLOOR").meaning is Meaning.FLOOR


def test_layers_are_told_of_a_drawing_with_a_coordinate_that_is_no_number(drawing: Path) -> None:
    document = ezdxf.readfile(drawing)
    document.modelspace().add_line((math.nan, 0), (1, 1), dxfattribs={"layer": "WALL"})
    document.save()
    found = inspect_plan(drawing)
    assert "not a finite number" in str(found.error)
    wall = layer_of(inspected(drawing), "WALL")
    assert (wall.entities, wall.unread) == ({"LINE": 2}, {"LINE": 1})
    _, _, layers = inspect_write.tables_of(found.figures)
    assert layers[2][-1] == "2 LINE, 1 LINE unread"


def test_layers_are_told_of_a_drawing_with_a_reference_that_lies_nowhere(drawing: Path) -> None:
    document = ezdxf.readfile(drawing)
    document.blocks.new("B").add_line((0, 0), (1, 0))
    document.modelspace().add_blockref("B", (math.inf, 0))
    document.save()
    found = inspect_plan(drawing)
    assert "cannot be placed" in str(found.error)
    assert layer_of(inspected(drawing), "WALL").entities == {"LINE": 2}


def test_layers_are_told_of_a_drawing_whose_reference_is_lost(drawing: Path) -> None:
    document = ezdxf.readfile(drawing)
    document.add_xref_def(filename="base.dwg", name="base")
    document.modelspace().add_blockref("base", (2, 1), {"layer": "X-BASE"})
    document.save()
    found = inspect_plan(drawing)
    assert "base.dwg" in str(found.error)
    assert layer_of(inspected(drawing), "X-BASE").unread == {"external reference": 1}
    assert layer_of(inspected(drawing), "WALL").entities == {"LINE": 2}


def test_layers_are_told_of_a_drawing_whose_walls_are_objects_of_another_program(
    tmp_path: Path,
) -> None:
    path = tmp_path / "plan.dxf"
    path.write_text(with_foreign("TCH_WALL", "A-WALL"), encoding="utf-8")
    assert "T3" in str(inspect_plan(path).error)
    wall = layer_of(inspected(path), "A-WALL")
    assert (wall.meaning, wall.entities, wall.unread) == (Meaning.WALL, {}, {"TCH_WALL": 1})
    assert layer_of(inspected(path), "FLOOR").entities == {"LWPOLYLINE": 1}


@pytest.mark.parametrize("suffix", [".png", ".svg"])
def test_a_drawing_without_a_line_is_told_of_and_pictured(suffix: str, tmp_path: Path) -> None:
    document = ezdxf.new("R2010")
    document.layers.add("WALL").freeze()
    document.modelspace().add_line((0, 0), (9, 9), dxfattribs={"layer": "WALL"})
    document.saveas(tmp_path / "empty.dxf")
    found = inspect_plan(tmp_path / "empty.dxf")
    assert isinstance(found.error, EmptyPlanError)
    figures = inspected(tmp_path / "empty.dxf")
    assert (figures.bounds, figures.size_mm, figures.plans) == (None, None, ())
    assert layer_of(figures, "WALL").n_hidden == 1
    facts, _ = inspect_write.tables_of(figures)
    assert ("from", "-") in facts
    picture = tmp_path / f"empty{suffix}"
    picture_writer_of(picture)(picture, found, ())
    assert picture.stat().st_size > 0


def test_the_tables_have_a_line_a_layer(drawing: Path) -> None:
    facts, _, layers = inspect_write.tables_of(inspected(drawing))
    assert ("size", "4.00 × 3.00 m") in facts
    assert [row[:3] for row in layers[1:]] == [
        ("FURNITURE", "not read", "unknown"),
        ("WALL", "wall", "certain"),
        ("Zeug", "-", "unknown"),
    ]
    assert layers[1][-1] == "1 hidden"


def test_plans_are_numbered_with_their_corners(drawing: Path) -> None:
    document = ezdxf.readfile(drawing)
    outline = [(20, 0), (24, 0), (24, 3), (20, 3)]
    document.modelspace().add_lwpolyline(outline, close=True, dxfattribs={"layer": "WALL"})
    document.save()
    found = inspected(drawing).plans
    assert [plan.number for plan in found] == [1, 2]
    assert {plan.bounds for plan in found} == {(1, 1, 5, 4), (20, 0, 24, 3)}


def test_a_plan_is_read_by_the_number_that_it_is_listed_with(tmp_path: Path) -> None:
    document = drawing_in_mm(floor=False)
    # four rooms of equal rank, on layers in turn
    for i, layer in enumerate(("WALL", "A-WALL", "WALL", "S-WALL")):
        rectangle(document.modelspace(), 20_000 * i, 0, 20_000 * i + 5000, 4000, layer=layer)
    path = tmp_path / "rooms.dxf"
    document.saveas(path)
    found = inspected(path).plans
    assert len(found) == 4
    for plan in found:
        read = read_plan(path, ReadOptions(plan=plan.number))
        left, bottom = read.frame.to_drawing((0, 0))
        assert (left, bottom) == (plan.bounds[0], plan.bounds[1])


def test_the_json_holds_the_same(drawing: Path) -> None:
    inspection = inspected(drawing)
    data = json.loads(json_of(inspection))
    assert data["source"]["unit"] == "m"
    assert [layer["layer"] for layer in data["layers"]] == [
        layer.layer for layer in inspection.layers
    ]


def test_a_models_storeys_are_told() -> None:
    model = SAMPLES / "two_rooms_900.ifc"
    if not model.exists():
        pytest.skip("no sample model")
    facts, storeys, classes = inspect_write.tables_of(inspect_plan(model).figures)
    assert facts[0][0] == "model"
    assert storeys[1][0] == "1"
    assert classes[0] == ("class", "number")
