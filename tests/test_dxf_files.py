"""Files as they come: of other kinds, damaged, in other encodings."""

import codecs
import contextlib
import gc
import io
import math
from pathlib import Path

import ezdxf
import pytest

from satAOI_adapters.dxf_read import ReadOptions, read
from satAOI_adapters.dxf_write.document import base_document, file_bytes
from satAOI_geo.errors import DrawingError, InputError, UnreadableError
from satAOI_geo.plan import FloorPlan, Kind
from tests.drawings import MM, codes, drawing, plan_of, rectangle

ENCODINGS = ["utf-8", "gbk", "big5", "cp932"]


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "is empty"),
        (b"\r\n\r\n", "is empty"),
        (b"AC1032\0\0\0\0", "a DWG drawing"),
        (b"%PDF-1.7\n", "a PDF"),
        (b"PK\x03\x04rest", "a ZIP archive"),
        (b"\x1f\x8b\x08rest", "a gzip archive"),
        (b"\x89PNG\r\n\x1a\n", "a PNG picture"),
        (b"<!DOCTYPE html><html></html>", "a web page"),
        (b"version https://git-lfs.github.com/spec/v1\noid", "a Git LFS pointer"),
        (b"ISO-10303-21;\nHEADER;", "an IFC or STEP model"),
        (b"Dear all,\nplease find attached", "does not begin with a section"),
    ],
)
def test_file_of_another_kind_is_named(content: bytes, says: str, tmp_path: Path) -> None:
    path = tmp_path / "plan.dxf"
    path.write_bytes(content)
    with pytest.raises(UnreadableError) as caught:
        read(path, ReadOptions())
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


def text_of(document: ezdxf.document.Drawing) -> str:
    stream = io.StringIO()
    document.write(stream)
    return stream.getvalue()


def read_text(text: str, tmp_path: Path, **options: object) -> FloorPlan:
    path = tmp_path / "plan.dxf"
    path.write_text(text, encoding="utf-8")
    return read(path, ReadOptions(**options))  # type: ignore[arg-type]


@pytest.mark.parametrize("share", [0.3, 0.6, 0.9, 0.99])
def test_beginning_of_a_drawing_is_refused(share: float, tmp_path: Path) -> None:
    text = text_of(drawing())
    with pytest.raises(UnreadableError, match="cut off"):
        read_text(text[: int(share * len(text))], tmp_path)


def test_comment_before_the_first_section_is_no_damage(tmp_path: Path) -> None:
    assert read_text("999\nmade by hand\n" + text_of(drawing()), tmp_path).floor.area


def line_to(x: str) -> str:
    """A drawing with a line whose end has this as its x."""
    document = drawing()
    document.modelspace().add_line((1000, 1000), (4321.5, 1000), dxfattribs={"layer": "WALL"})
    text = text_of(document)
    assert text.count("4321.5\n") == 1
    return text.replace("4321.5\n", f"{x}\n")


@pytest.mark.parametrize("x", ["nan", "inf", "-inf", "1e400"])
def test_coordinate_that_is_no_finite_number_is_refused_with_its_place(
    x: str, tmp_path: Path
) -> None:
    with pytest.raises(DrawingError) as caught:
        read_text(line_to(x), tmp_path)
    assert caught.value.layer == "WALL"
    assert caught.value.handle
    assert str(caught.value).startswith(
        f"LINE {caught.value.handle} on layer 'WALL' cannot be read: group code 11 is {float(x)}, "
        "not a finite number"
    )


def test_coordinate_that_is_no_finite_number_is_found_in_a_block(tmp_path: Path) -> None:
    document = drawing()
    line = document.blocks.new("B").add_line((0, 0), (1, math.nan), dxfattribs={"layer": "0"})
    document.modelspace().add_blockref("B", (1000, 1000), dxfattribs={"layer": "WALL"})
    with pytest.raises(DrawingError) as caught:
        plan_of(document, tmp_path)
    assert str(caught.value).startswith(
        f"LINE {line.dxf.handle} on layer 'WALL' in block 'B' cannot be read: group code 21 is nan"
    )


def test_block_reference_that_lies_nowhere_is_refused(tmp_path: Path) -> None:
    document = drawing()
    document.blocks.new("B").add_line((0, 0), (1, 0))
    document.modelspace().add_blockref(
        "B", (0, 0), dxfattribs={"layer": "WALL", "xscale": math.inf}
    )
    with pytest.raises(DrawingError, match=r"block 'B' on layer 'WALL'.*group code 41 is inf"):
        plan_of(document, tmp_path)


@pytest.mark.parametrize(("x", "says"), [("12,5", "decimal points"), ("1.#QNAN", "1.#QNAN")])
def test_number_that_is_none_is_refused_with_its_line(x: str, says: str, tmp_path: Path) -> None:
    text = line_to(x)
    with pytest.raises(UnreadableError, match=says) as caught:
        read_text(text, tmp_path)
    line = text[: text.index(f"{x}\n")].count("\n") + 1
    assert f"line {line}, group code 11 of LINE {caught.value.handle} on layer 'WALL'" in str(
        caught.value
    )


def test_stray_entity_far_away_is_left_out_and_said(tmp_path: Path) -> None:
    document = drawing()
    bare = plan_of(document, tmp_path)
    document.modelspace().add_line((1e12, 0), (1e12, 5), dxfattribs={"layer": "WALL"})
    plan = plan_of(document, tmp_path)
    assert plan.floor == bare.floor
    assert "far-away" in codes(plan)


def test_damaged_file_is_repaired_and_said(tmp_path: Path) -> None:
    text = text_of(drawing())
    # a second ENDSEC ends a section that never began
    broken = text.replace("  0\nENDSEC\n", "  0\nENDSEC\n  0\nENDSEC\n", 1)
    plan = read_text(broken, tmp_path)
    assert plan.floor.area == 10_000**2
    assert "file-repaired" in codes(plan)


def r12_with(names: dict[str, str]) -> str:
    """An R12 drawing of a floor and a rectangle on a layer of each name."""
    document = ezdxf.new("R12")
    document.header["$INSUNITS"] = MM
    space = document.modelspace()
    for layer, corners in {
        "FLOOR": [(0, 0), (10_000, 0), (10_000, 10_000), (0, 10_000)],
        **{
            name: [(x, 1000), (x + 200, 1000), (x + 200, 1200), (x, 1200)]
            for x, name in zip(range(1000, 9000, 1000), names, strict=False)
        },
    }.items():
        space.add_polyline2d(corners, close=True, dxfattribs={"layer": layer})
    return text_of(document)


CHINESE = {"墙体": "wall", "柱子": "column", "楼板洞口": "hole", "预埋件": "embedded"}


@pytest.mark.parametrize("claimed", ["ANSI_936", "ANSI_1252", "ANSI_1251", "ANSI_932", "gb2312"])
@pytest.mark.parametrize("encoding", ["gbk", "utf-8"])
def test_chinese_layers_are_known_whatever_the_header_claims(
    encoding: str, claimed: str, tmp_path: Path
) -> None:
    text = r12_with(CHINESE).replace("ANSI_1252", claimed)
    path = tmp_path / "plan.dxf"
    path.write_bytes(text.encode(encoding))
    plan = read(path, ReadOptions(units="mm"))
    assert {o.layer: o.kind.value for o in plan.obstacles} == CHINESE


@pytest.mark.parametrize("sections_end", ["once", "twice"])
@pytest.mark.parametrize("claimed", ["ANSI_936", "ANSI_1252"])
def test_names_survive_into_the_drawing_that_is_written(
    claimed: str, sections_end: str, tmp_path: Path
) -> None:
    text = r12_with(CHINESE).replace("ANSI_1252", claimed)
    if sections_end == "twice":
        # damage that is repaired while reading
        text = text.replace("  0\nENDSEC\n", "  0\nENDSEC\n  0\nENDSEC\n", 1)
    path = tmp_path / "plan.dxf"
    path.write_bytes(text.encode("gbk"))
    plan = read(path, ReadOptions(units="mm"))
    assert plan.source.encoding == "gbk"
    out = tmp_path / "out.dxf"
    out.write_bytes(file_bytes(base_document(plan)))
    kept = ezdxf.readfile(out)
    assert {entity.dxf.layer for entity in kept.modelspace()} == {"FLOOR", *CHINESE}


@pytest.mark.parametrize("style", ["unicode", "mif"])
def test_escaped_names_are_known(style: str, tmp_path: Path) -> None:
    def escaped(character: str) -> str:
        if character.isascii():
            return character
        if style == "unicode":
            return f"\\U+{ord(character):04X}"
        # 5: simplified Chinese
        return f"\\M+5{character.encode('gbk').hex().upper()}"

    path = tmp_path / "plan.dxf"
    path.write_text("".join(map(escaped, r12_with(CHINESE))), encoding="ascii")
    plan = read(path, ReadOptions(units="mm"))
    assert {o.layer: o.kind.value for o in plan.obstacles} == CHINESE


def test_western_names_stay_western(tmp_path: Path) -> None:
    path = tmp_path / "plan.dxf"
    path.write_bytes(r12_with({"Wände": "wall", "Stützen": "column"}).encode("cp1252"))
    plan = read(path, ReadOptions(units="mm"))
    assert {o.layer for o in plan.obstacles} == {"Wände", "Stützen"}
    assert "encoding" not in codes(plan)


TURKISH = {"Kap\u0131": "wall", "Ta\u015f\u0131y\u0131c\u0131 kolon": "column"}
"""Names for doors and bearing columns; in Japanese code pages the first ends in a door."""


@pytest.mark.parametrize("names", [tuple(TURKISH), ("b\u00e2timent",)])
def test_names_in_right_utf8_stay_as_they_are(names: tuple[str, ...], tmp_path: Path) -> None:
    document = drawing()
    for x, layer in zip((1000, 3000), names, strict=False):
        rectangle(document.modelspace(), x, 1000, x + 400, 1400, layer=layer)
    document.modelspace().add_text("D\u00f6\u015feme", dxfattribs={"layer": "TEXT"})
    plan = plan_of(document, tmp_path)
    assert plan.source.encoding == "utf-8"
    assert "encoding" not in codes(plan)
    assert {o.layer for o in plan.obstacles} <= set(names)


@pytest.mark.parametrize("claimed", ["ANSI_1252", "ANSI_1254", "ANSI_1250"])
def test_utf8_under_a_code_page_of_single_bytes_is_told_by_its_bytes(
    claimed: str, tmp_path: Path
) -> None:
    # northern lights, which the table does not know
    name = "Kuzey \u0131\u015f\u0131klar\u0131"
    text = r12_with({name: ""}).replace("ANSI_1252", claimed)
    path = tmp_path / "plan.dxf"
    path.write_bytes(text.encode())
    plan = read(path, ReadOptions(units="mm"))
    assert plan.source.encoding == "utf-8"
    assert "encoding" in codes(plan)


def test_byte_order_mark_goes_before_the_code_page(tmp_path: Path) -> None:
    path = tmp_path / "plan.dxf"
    path.write_bytes(codecs.BOM_UTF8 + r12_with(TURKISH).encode())
    plan = read(path, ReadOptions(units="mm"))
    assert plan.source.encoding == "utf-8"
    assert "encoding" not in codes(plan)


def test_one_name_that_means_something_by_chance_leaves_no_encoding(tmp_path: Path) -> None:
    # storeroom; read as Western European it is a row of accented letters
    name = "".join(map(chr, (0x43A, 0x43B, 0x430, 0x434, 0x43E, 0x432, 0x430, 0x44F)))
    own = tmp_path / "layers.toml"
    chance = name.encode("cp1251").decode("cp1252")
    own.write_text(f'[layers]\nwall = ["*{chance}*"]\n', encoding="utf-8")
    path = tmp_path / "plan.dxf"
    text = r12_with({name: ""}).replace("ANSI_1252", "ANSI_1251")
    path.write_bytes(text.encode("cp1251"))
    assert read(path, ReadOptions(units="mm", layers=own)).source.encoding == "cp1251"


def test_encoding_option_goes_before_the_header(tmp_path: Path) -> None:
    path = tmp_path / "plan.dxf"
    path.write_bytes(r12_with({"Стены": "wall"}).encode("cp866"))
    plan = read(path, ReadOptions(units="mm", encoding="cp866"))
    assert [o.kind for o in plan.obstacles] == [Kind.WALL]


def test_unknown_encoding_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="klingon"):
        plan_of(drawing(), tmp_path, encoding="klingon")


def test_binary_drawing_reads_like_the_text(tmp_path: Path) -> None:
    document = drawing()
    rectangle(document.modelspace(), 1000, 1000, 1300, 1400, layer="COLUMN")
    as_text = plan_of(document, tmp_path)
    path = tmp_path / "binary.dxf"
    document.saveas(path, fmt="bin")
    as_binary = read(path, ReadOptions())
    assert as_binary.floor == as_text.floor
    assert as_binary.obstacles == as_text.obstacles


@pytest.mark.parametrize("content", ["", text_of(drawing())], ids=["nothing", "a plan"])
def test_garbage_is_collected_again_after_reading(content: str, tmp_path: Path) -> None:
    with contextlib.suppress(UnreadableError):
        read_text(content, tmp_path)
    assert gc.isenabled()


def test_reading_says_nothing_on_the_screen(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    document = drawing()
    document.modelspace().add_point((1, 1))
    text = text_of(document)
    # the same handle twice: ezdxf has something to say about it
    first = text.index("POINT\n", text.index("ENTITIES"))
    point = text[text.rindex("  0\n", 0, first) : text.index("  0\n", first)]
    plan = read_text(text.replace(point, point + point), tmp_path)
    assert "file-flaws" in codes(plan)
    assert capfd.readouterr() == ("", "")
