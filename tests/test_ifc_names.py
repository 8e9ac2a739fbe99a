"""Names in encodings that a model does not declare: what they were meant to say."""

from pathlib import Path

import pytest

from satAOI_adapters import read_plan
from satAOI_adapters.ifc_read import IfcOptions
from satAOI_adapters.ifc_read.model import open_model
from satAOI_adapters.ifc_read.names import encoding_of, respell_names, respelled
from satAOI_adapters.ifc_read.parsable import has_raw_names, parsable
from satAOI_geo.plan import Finding
from tests.ifc_models import Pen

CASES = [
    ("utf-8", ["Wände", "1er étage", "墙柱"]),
    ("utf-8", ["Mauerwerk ½ Stein"]),
    ("cp932", ["1階", "2階", "屋根"]),
    ("cp932", ["コンクリート-構造2 200", "柱500X500"]),
    ("gbk", ["墙柱", "预埋件", "1层"]),
    ("big5", ["牆", "樓板", "柱子"]),
    ("cp1251", ["Стена", "Этаж 1"]),
    ("cp1252", ["Wände", "Außenwand – alt", "Öffnung", "KÜCHE"]),
    ("cp1252", ["Déjà vu", "1er étage", "Ébauche"]),
    ("mac-roman", ["Käche", "Gebäude", "Tür", "Außenwand"]),
    ("mac-roman", ["Café"]),
]


@pytest.mark.parametrize(("name", "meant"), CASES, ids=lambda value: str(value)[:20])
def test_names_tell_their_encoding(name: str, meant: list[str]) -> None:
    said = [text.encode(name).decode("latin-1") for text in meant]
    encoding = encoding_of(said)
    assert encoding is not None
    assert [respelled(text, encoding) for text in said] == meant


def test_bytes_that_mean_nothing_have_no_encoding() -> None:
    assert encoding_of(["a\x81 b"]) is None


def storey_model(folder: Path, name: bytes) -> Path:
    """A model of one storey, whose name stands in the file as it is given."""
    pen = Pen()
    pen.contain(pen.storey("NAME"), pen.slab(6000.0, 4000.0))
    path = pen.save(folder)
    path.write_bytes(path.read_bytes().replace(b"'NAME'", b"'" + name + b"'"))
    return path


def storeys_in(path: Path) -> tuple[list[str], tuple[Finding, ...]]:
    """The names of a model's storeys, and what is said of names."""
    data = path.read_bytes()
    with parsable(path, data) as parsed:
        model = open_model(path, parsed).model
    findings = respell_names(model, raw=has_raw_names(data))
    return [storey.Name for storey in model.by_type("IfcBuildingStorey")], findings


@pytest.mark.parametrize(
    ("written", "read"),
    [
        (b"Wand", "Wand"),
        (rb"W\X2\00E4\X0\nde", "Wände"),
        (rb"W\X\E4nde", "Wände"),
        (rb"W\S\dnde", "Wände"),
        (rb"\X4\0001F3D7\X0\ Bau", "\U0001f3d7 Bau"),
    ],
)
def test_escapes_are_read_as_the_standard_says(tmp_path: Path, written: bytes, read: str) -> None:
    assert storeys_in(storey_model(tmp_path, written)) == ([read], ())


@pytest.mark.parametrize(
    ("written", "read"),
    [
        ("Wände 墙".encode(), "Wände 墙"),
        ("墙柱".encode("gbk"), "墙柱"),
        ("Wände".encode("cp1252"), "Wände"),
        (rb"1\X\8AK", "1階"),
        # the second byte of this one is a backslash
        (rb"\X\8D\\\X\91\S\"", "構造"),
        (rb"Caf\X\8E", "Café"),
    ],
)
def test_bytes_of_a_code_page_become_the_names_that_were_meant(
    tmp_path: Path, written: bytes, read: str
) -> None:
    names, (finding,) = storeys_in(storey_model(tmp_path, written))
    assert names == [read]
    assert finding.code == "encoding"
    assert read in finding.message


def test_names_in_no_known_encoding_are_told_of(tmp_path: Path) -> None:
    _, (finding,) = storeys_in(storey_model(tmp_path, b"a\x81 b"))
    assert finding.message == r"names are in no known encoding, for example 'a\x81 b'"


def test_a_storey_is_found_by_the_name_that_was_meant(tmp_path: Path) -> None:
    path = storey_model(tmp_path, "1階".encode("cp932"))
    plan = read_plan(path, ifc=IfcOptions(storey="1階"))
    assert [finding.code for finding in plan.findings] == ["encoding", "no-obstacles"]
