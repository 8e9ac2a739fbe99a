"""Pictures of what was understood: colours at known places, numbers, frames, words."""

import io
import math
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from xml.etree import ElementTree as ET

import pytest
from ezdxf.document import Drawing
from PIL import Image
from shapely.geometry import box

from satAOI_adapters import inspect_plan, picture_writer_of
from satAOI_adapters.dxf_read import ReadOptions
from satAOI_adapters.inspected import Inspected
from satAOI_adapters.plan_picture import png, svg
from satAOI_adapters.plan_picture.fonts import spelt, wrapped
from satAOI_adapters.plan_picture.key import TOLD_OF_A_SORT, told
from satAOI_adapters.plan_picture.layout import page_of
from satAOI_adapters.plan_picture.page import Page, Strokes, Text
from satAOI_adapters.plan_picture.sheet import Sheet, place_marks, scale_bar
from satAOI_adapters.plan_picture.style import BADGE, BLUE, COLOURS, FLOOR_FILL, RED
from satAOI_geo import DrawingError, InputError, UnitError
from satAOI_geo.plan import Finding, FloorPlan, Kind, Obstacle, Source
from tests.drawings import drawing, rectangle

SAMPLES = Path(__file__).parents[1] / "samples"
CORPUS = Path(__file__).parents[2] / "shared" / "corpus"


def inspected(document: Drawing, folder: Path, **options: object) -> Inspected:
    path = folder / "plan.dxf"
    document.saveas(path)
    return inspect_plan(path, ReadOptions(**options))  # type: ignore[arg-type]


def hall() -> Drawing:
    """A floor of 10 × 10 m with a column at its top right and a round hole at its bottom left."""
    document = drawing()
    rectangle(document.modelspace(), 9000, 9000, 9500, 9500, layer="COLUMN")
    document.modelspace().add_circle((1000, 1000), 300, dxfattribs={"layer": "HOLE"})
    return document


def picture_of(found: Inspected) -> Image.Image:
    return Image.open(io.BytesIO(png.drawn(page_of(found))))


def colour_at(picture: Image.Image, found: Inspected, x_mm: float, y_mm: float) -> str:
    """Colour of the PNG where a point of the drawing lies; the plan's frame is the drawing's."""
    margin = 24.0
    sheet = Sheet.over(found.plan.floor.bounds, x=margin, y=2 * margin + 20, height=1100)
    left_mm, _, _, top_mm = sheet.bounds_mm
    spot = (sheet.x + (x_mm - left_mm) * sheet.per_mm, sheet.y + (top_mm - y_mm) * sheet.per_mm)
    return "#{:02x}{:02x}{:02x}".format(*picture.getpixel(tuple(c * 1.5 for c in spot)))


def elements(page: Page, tag: str) -> list[ET.Element]:
    """The elements of a page's SVG."""
    root = ET.fromstring(svg.drawn(page))  # noqa: S314  we wrote it
    return list(root.iter(f"{{http://www.w3.org/2000/svg}}{tag}"))


def words(page: Page, colour: str | None = None) -> list[str]:
    texts = [mark for mark in page.marks if isinstance(mark, Text)]
    return [text.text for text in texts if colour is None or text.colour == colour]


def labels(page: Page, colour: str) -> list[str]:
    """Numbers on discs of a colour, in the SVG: a text follows its disc."""
    root = ET.fromstring(svg.drawn(page))  # noqa: S314  we wrote it
    children = list(root)
    return [
        after.text or ""
        for disc, after in pairwise(children)
        if disc.get("fill") == colour and after.get("text-anchor") == "middle"
    ]


def test_each_place_has_the_colour_of_what_is_there_and_y_points_up(tmp_path: Path) -> None:
    found = inspected(hall(), tmp_path)
    picture = picture_of(found)
    assert colour_at(picture, found, 9250, 9250) == COLOURS[Kind.COLUMN]
    assert colour_at(picture, found, 1000, 1000) == COLOURS[Kind.HOLE]
    assert colour_at(picture, found, 5000, 5000) == FLOOR_FILL
    assert colour_at(picture, found, 9250, 750) == FLOOR_FILL


def test_what_shows_through_an_obstacle_with_a_hole_is_floor(tmp_path: Path) -> None:
    document = hall()
    hatch = document.modelspace().add_hatch(dxfattribs={"layer": "WALL"})
    for side in (3000, 2400):
        corners = [(4000 - side / 2, 4000 - side / 2), (4000 + side / 2, 4000 - side / 2)]
        corners += [(4000 + side / 2, 4000 + side / 2), (4000 - side / 2, 4000 + side / 2)]
        hatch.paths.add_polyline_path(corners, is_closed=True)
    found = inspected(document, tmp_path)
    picture = picture_of(found)
    assert colour_at(picture, found, 4000, 4000) == FLOOR_FILL
    assert colour_at(picture, found, 4000 + 1350, 4000) == COLOURS[Kind.WALL]


def test_every_obstacle_of_the_svg_tells_layer_and_handle(tmp_path: Path) -> None:
    found = inspected(hall(), tmp_path)
    titles = [title.text for title in elements(page_of(found), "title")]
    assert {obstacle.label() for obstacle in found.plan.obstacles} <= set(titles)


def test_the_key_tells_every_kind_how_often_it_stands_there(tmp_path: Path) -> None:
    said = words(page_of(inspected(hall(), tmp_path)))
    assert "floor: 100.00 m² (layer)" in said
    assert "column: 1 piece, 0.25 m² of the floor" in said
    assert "wall: none" in said
    assert {word.split(":")[0] for word in said} >= {*Kind}


def test_a_finding_with_a_place_has_the_same_number_there_and_in_the_key(tmp_path: Path) -> None:
    document = hall()
    space = document.modelspace()
    space.add_line((3000, 5000), (5000, 5000), dxfattribs={"layer": "WALL"})
    space.add_line((5020, 5000), (7000, 5000), dxfattribs={"layer": "WALL"})
    found = inspected(document, tmp_path)
    (gap,) = (finding for finding in found.findings if finding.code == "gap-open")
    page = page_of(found)
    assert gap.at_mm is not None
    assert labels(page, RED) == ["1", "1"]
    assert "miss each other by 20.0 mm" in " ".join(words(page))


def test_of_many_findings_of_a_sort_the_first_are_numbered_and_all_are_marked() -> None:
    gaps = [Finding("gap", f"gap {i}", at_mm=(float(i), 0.0)) for i in range(9)]
    others = [Finding("layer", "a layer")]
    lines = told([*others, *gaps])
    assert [line.label for line in lines] == ["1", "2", "3", "", ""]
    assert sum(len(line.places_mm) for line in lines) == 9
    assert lines[TOLD_OF_A_SORT].text == "and 6 more of 'gap'"


def test_the_number_of_a_finding_off_the_sheet_stands_at_its_rim() -> None:
    sheet = Sheet.over((0, 0, 9000, 9000), x=0, y=0, height=1000)
    right = sheet.width
    marks = list(place_marks([((99_000.0, 4500.0), "7")], sheet))
    (number,) = (mark for mark in marks if isinstance(mark, Text))
    assert number.text == "7"
    assert math.hypot(number.x - right, number.y - sheet.height / 2) < 4 * BADGE


def test_of_several_plans_each_is_framed_with_the_number_that_chooses_it(tmp_path: Path) -> None:
    document = hall()
    rectangle(document.modelspace(), 30_000, 0, 35_000, 5000, layer="FLOOR")
    page = page_of(inspected(document, tmp_path))
    assert labels(page, BLUE) == ["N", "1", "2"]
    assert {"plan 1", "plan 2"} <= {title.text for title in elements(page, "title")}


def test_a_single_plan_has_no_frame(tmp_path: Path) -> None:
    assert labels(page_of(inspected(hall(), tmp_path)), BLUE) == []


def test_the_start_is_marked(tmp_path: Path) -> None:
    document = hall()
    assert "start" not in [
        t.text for t in elements(page_of(inspected(document, tmp_path)), "title")
    ]
    document.modelspace().add_point((5000, 5000), dxfattribs={"layer": "SATAOI-START"})
    titles = [t.text for t in elements(page_of(inspected(document, tmp_path)), "title")]
    assert titles.count("start") == 2  # on the plan and in the key


def test_a_drawing_whose_unit_is_not_known_is_drawn_with_a_scale_in_units(tmp_path: Path) -> None:
    # 400 units may be 4 m in cm, or as well 10 m in inches
    document = drawing(unit=0, floor=False)
    rectangle(document.modelspace(), 0, 0, 400, 400, layer="FLOOR")
    found = inspected(document, tmp_path)
    assert isinstance(found.error, UnitError)
    said = words(page_of(found))
    assert "drawn in a unit that is not known" in said
    assert "50 units" in said  # a fifth of 400 units and the blank around them is 85


def test_a_drawing_that_is_no_plan_is_drawn_with_the_reason(tmp_path: Path) -> None:
    document = drawing(floor=False)
    space = document.modelspace()
    space.add_lwpolyline(
        [(0, 0), (9000, 0), (9000, 9000), (0, 9000)], dxfattribs={"layer": "FLOOR"}
    )
    rectangle(space, 1000, 1000, 1300, 1300, layer="COLUMN")
    found = inspected(document, tmp_path)
    assert isinstance(found.error, DrawingError)
    page = page_of(found)
    assert labels(page, RED) == ["!", "!"]
    assert "Cannot be used as it is" in words(page)
    assert "is open" in " ".join(words(page, RED))
    strokes = [path.get("stroke") for path in elements(page, "path")]
    assert strokes.count(COLOURS[Kind.COLUMN]) == 2  # in the key and on the plan


@pytest.mark.parametrize("width_m", [0.03, 1, 7, 12, 230, 41_000])
def test_the_scale_bar_has_a_round_length_and_is_as_long_as_it_says(width_m: float) -> None:
    sheet = Sheet.over((0, 0, width_m * 1000, width_m * 300), x=0, y=0, height=1000)
    line, text = scale_bar(sheet)
    assert isinstance(line, Strokes)
    assert isinstance(text, Text)
    length_m = float(text.text.removesuffix(" m"))
    assert line.lines[0].length / sheet.per_mm / 1000 == pytest.approx(length_m, rel=1e-12)
    assert f"{length_m:e}"[:8] in {"1.000000", "2.000000", "5.000000"}
    assert sheet.width / 13 < line.lines[0].length <= sheet.width / 5


def test_names_that_are_no_text_and_no_xml_are_drawn_all_the_same() -> None:
    name = "<A&B> 墙体 \udc87\x01\n"
    column = Obstacle(box(1000, 1000, 2000, 2000), Kind.COLUMN, layer=name, handle="1F")
    plan = FloorPlan(box(0, 0, 9000, 9000), (column,), source=Source(path=name))
    figures = SimpleNamespace(source=plan.source)
    page = page_of(Inspected(figures, [Finding("odd", name, at_mm=(1.0, 1.0))], plan))
    titles = [title.text or "" for title in elements(page, "title")]
    assert "column 1F on layer '<A&B> 墙体 ?? '" in titles
    assert png.drawn(page).startswith(b"\x89PNG")


def test_a_storey_of_a_model_is_drawn_as_its_plan() -> None:
    found = inspect_plan(SAMPLES / "two_rooms_900.ifc", with_plan=True)
    page = page_of(found)
    assert found.plan is not None
    titles = [title.text for title in elements(page, "title")]
    assert {obstacle.label() for obstacle in found.plan.obstacles} <= set(titles)


@pytest.mark.skipif(not CORPUS.is_dir(), reason="the corpus of drawings is absent")
@pytest.mark.parametrize(
    ("name", "options", "n_parts", "n_places"),
    [("d02", {"units": "m"}, 6, 2), ("d03", {}, 1, 7)],
)
def test_a_drawing_of_other_people_is_drawn_with_all_that_was_understood(
    name: str, options: dict[str, str], n_parts: int, n_places: int
) -> None:
    (path,) = (CORPUS / "dxf").glob(f"{name}_*")
    found = inspect_plan(path, ReadOptions(**options))
    page = page_of(found)
    titles = {title.text for title in elements(page, "title")}
    assert {obstacle.label() for obstacle in found.plan.obstacles} <= titles
    frames = {f"plan {number}" for number in range(1, n_parts + 1)} if n_parts > 1 else set()
    assert {title for title in titles if title.startswith("plan ")} == frames
    # on the plan and in the list
    assert sorted(labels(page, RED)) == sorted(2 * [str(k + 1) for k in range(n_places)])


def test_a_model_is_drawn_only_if_that_is_asked_for() -> None:
    assert inspect_plan(SAMPLES / "two_rooms_900.ifc").plan is None


@pytest.mark.parametrize("suffix", [".png", ".svg"])
def test_the_drawing_is_never_written_over(suffix: str, tmp_path: Path) -> None:
    found = inspected(hall(), tmp_path)
    target = tmp_path / f"plan{suffix}"
    target.write_bytes(b"")
    with pytest.raises(InputError, match="never written over"):
        picture_writer_of(target)(target, found, [target])
    assert target.read_bytes() == b""
    picture_writer_of(target)(target, found, [tmp_path / "plan.dxf"])
    assert target.stat().st_size > 1000


def test_a_line_breaks_at_blanks_before_it_is_too_long() -> None:
    text = "one two three four five six seven eight"
    lines = list(wrapped(text, "", 13, 100))
    assert len(lines) > 1
    assert " ".join(lines) == text


def test_letters_that_a_typeface_lacks_are_spelt_in_others() -> None:
    # the typeface that comes with the library has little more than the English letters
    assert spelt("2 m² Tür 墙", "") == "2 m2 Tur \\u5899"


def test_letters_that_are_spelt_in_others_are_as_wide_as_these() -> None:
    # the built-in typeface has no Chinese letters: each is a code of six
    lines = list(wrapped("layer 墙体 layer 墙体", "", 13, 100))
    assert [spelt(line, "") for line in lines] == [
        "layer",
        "\\u5899\\u4f53",
        "layer",
        "\\u5899\\u4f53",
    ]
