"""A drawing's layers as a file to edit: read with it, nothing changes until it is edited."""

import tomllib
from pathlib import Path

import ezdxf
import pytest
from ezdxf.document import Drawing
from hypothesis import given
from hypothesis import strategies as st

from satAOI_adapters import inspect_plan, layers_write, read_plan
from satAOI_adapters.dxf_read import ReadOptions
from satAOI_adapters.layers import LayerTable, layer_table
from satAOI_adapters.meanings import LayerMap, Meaning, Named
from satAOI_geo import InputError
from tests.drawings import drawing, rectangle

SAMPLES = Path(__file__).parents[1] / "samples"
CORPUS = Path(__file__).parents[2] / "shared" / "corpus"

WORDS = ["wall", "COLS", "Furn", "SLAB-OPEN", "墙", "柱", "*", "?", "[", "]", "!", "=", "#", '"']
NAMES = st.lists(st.sampled_from([*WORDS, " ", "-", "ą", "\\", "\t", "\x7f"]), min_size=1).map(
    "".join
)


def map_of(names: set[str], table: LayerTable) -> LayerMap:
    named = tuple(Named(name, table.of_layer(name), {"LINE": 1}) for name in sorted(names))
    return LayerMap(named, (), table.is_own)


def written(folder: Path, text: str) -> Path:
    file = folder / "mine.toml"
    file.write_text(text, encoding="utf-8")
    return file


def layers_of(plan: Path, **options: Path) -> LayerMap:
    layers = inspect_plan(plan, ReadOptions(**options)).layers
    assert layers is not None
    return layers


@given(names=st.sets(NAMES, max_size=5))
def test_every_name_means_the_same_with_the_file_written(
    names: set[str], tmp_path_factory: pytest.TempPathFactory
) -> None:
    table = layer_table()
    text = layers_write.toml_of(map_of(names, table), "plan.dxf")
    own = layer_table(written(tmp_path_factory.mktemp("own"), text))
    for name in names:
        assert own.of_layer(name).meaning is table.of_layer(name).meaning


def test_a_name_with_bytes_that_are_no_text_is_matched_whatever_they_are(tmp_path: Path) -> None:
    table = layer_table()
    text = layers_write.toml_of(map_of({"[*] WALL \udc87"}, table), "plan\udc87.dxf")
    own = layer_table(written(tmp_path, text))
    assert own.of_layer("[*] WALL \udc87").pattern == "[[][*]] WALL ?"


@pytest.mark.parametrize("name", ["flat", "hall_medium", "two_rooms_900"])
def test_a_sample_read_with_the_file_written_is_the_same_plan(name: str, tmp_path: Path) -> None:
    plan = SAMPLES / f"{name}.dxf"
    file = tmp_path / "mine.toml"
    layers_write.write(file, layers_of(plan), drawing=plan.name, never_over=[plan])
    assert read_plan(plan, ReadOptions(layers=file)) == read_plan(plan)


@pytest.mark.skipif(not CORPUS.is_dir(), reason="the corpus of drawings is absent")
@pytest.mark.parametrize("name", ["dxf/d03_*", "dxf/d09_*", "dxf/d12_*", "bad/*r12_gbk_bytes*"])
def test_a_drawing_read_with_the_file_written_is_the_same_plan(name: str, tmp_path: Path) -> None:
    (plan,) = CORPUS.glob(name)
    file = tmp_path / "mine.toml"
    layers_write.write(file, layers_of(plan), drawing=plan.name, never_over=[plan])
    assert read_plan(plan, ReadOptions(layers=file)) == read_plan(plan)


def with_odd_layers() -> Drawing:
    """A floor with a column and a post on layers that share words, and a block without a layer."""
    document = drawing()
    space = document.modelspace()
    rectangle(space, 1000, 1000, 1300, 1300, layer="K1 POST")
    rectangle(space, 3000, 1000, 3300, 1300, layer="K1")
    rectangle(space, 5000, 1000, 5300, 1300, layer="POST SIGN")
    block = document.blocks.new("TANK 3")
    block.add_circle((0, 0), 200)
    space.add_blockref("TANK 3", (7000, 7000))
    return document


@pytest.mark.parametrize(
    "own",
    [
        '[layers]\nignore = ["SIGN"]\n',
        'replace = true\n[layers]\nfloor = ["FLOOR"]\ncolumn = ["K?"]\n[blocks]\nhole = ["TANK"]\n',
    ],
    ids=["before the built-in table", "in its place"],
)
def test_a_file_of_ones_own_written_again_is_the_same_plan(own: str, tmp_path: Path) -> None:
    plan = tmp_path / "plan.dxf"
    with_odd_layers().saveas(plan)
    before = written(tmp_path, own)
    after = tmp_path / "after.toml"
    layers_write.write(after, layers_of(plan, layers=before), drawing="", never_over=[])
    assert read_plan(plan, ReadOptions(layers=after)) == read_plan(plan, ReadOptions(layers=before))


def test_a_reference_that_is_ignored_stays_ignored(tmp_path: Path) -> None:
    document = drawing()
    document.add_xref_def(filename="base.dwg", name="base")
    document.modelspace().add_blockref("base", (2000, 1000), {"layer": "REFS"})
    plan = tmp_path / "plan.dxf"
    document.saveas(plan)
    before = written(tmp_path, '[layers]\nignore = ["REFS"]\n')
    after = tmp_path / "after.toml"
    layers_write.write(after, layers_of(plan, layers=before), drawing="", never_over=[])
    assert read_plan(plan, ReadOptions(layers=after)) == read_plan(plan, ReadOptions(layers=before))


def test_a_layer_is_moved_to_another_kind_by_moving_its_name(tmp_path: Path) -> None:
    plan = tmp_path / "plan.dxf"
    with_odd_layers().saveas(plan)
    text = layers_write.toml_of(layers_of(plan), plan.name)
    keys = tomllib.loads(text)
    assert keys["layers"]["column"] == ["=K1 POST", "=POST SIGN"]
    (moved,) = (line for line in text.splitlines() if "=POST SIGN" in line)
    edited = written(tmp_path, text.replace(moved, f"]\nhole = [{moved.split(',')[0]}"))
    kinds = {o.layer: o.kind for o in read_plan(plan, ReadOptions(layers=edited)).obstacles}
    assert (kinds["K1 POST"], kinds["POST SIGN"]) == ("column", "hole")


def test_each_layer_tells_what_is_on_it_and_what_is_to_be_checked(tmp_path: Path) -> None:
    document = drawing()
    space = document.modelspace()
    space.add_line((0, 0), (1, 0), dxfattribs={"layer": "WALL"})
    space.add_text("1", dxfattribs={"layer": "A-WALL-NEW"})
    space.add_line((0, 0), (1, 0), dxfattribs={"layer": "Zeug"})
    document.layers.add("OFF").off()
    space.add_line((0, 0), (1, 0), dxfattribs={"layer": "OFF"})
    plan = tmp_path / "plan.dxf"
    document.saveas(plan)
    lines = layers_write.toml_of(layers_of(plan), plan.name).splitlines()
    assert '    "=WALL",  # 1 LINE' in lines
    assert '    "=A-WALL-NEW",  # 1 TEXT; check: likely by "WALL"' in lines
    assert '#   "=Zeug",  # 1 LINE' in lines
    assert '#   "=OFF",  # 1 hidden' in lines


def test_kinds_of_obstacle_come_first(tmp_path: Path) -> None:
    plan = tmp_path / "plan.dxf"
    with_odd_layers().saveas(plan)
    keys = tomllib.loads(layers_write.toml_of(layers_of(plan), plan.name))
    order = [Meaning(kind) for kind in keys["layers"]]
    assert order == sorted(order, key=list(Meaning).index)


def test_the_drawing_and_the_file_read_are_not_written_over(tmp_path: Path) -> None:
    plan = tmp_path / "plan.dxf"
    ezdxf.new().saveas(plan)
    with pytest.raises(InputError, match="never written over"):
        layers_write.write(plan, LayerMap((), (), is_own=False), drawing="", never_over=[plan])
