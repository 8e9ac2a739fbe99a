"""The raster as a picture and as arrays."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from satAOI_adapters import raster_write, write_aoi
from satAOI_geo.errors import InputError
from satAOI_geo.plan import Frame
from tests.results import furnished_result, with_plan


def pixels_of(path: Path) -> np.ndarray:
    with Image.open(path) as picture:
        return np.array(picture)


def test_arrays_read_back_as_they_were(tmp_path: Path) -> None:
    result = furnished_result()
    moved = replace(result.plan, frame=Frame((5000.0, -2000.0), 0.0, 1000.0))
    write_aoi(tmp_path / "a.npz", with_plan(result, moved))
    with np.load(tmp_path / "a.npz", allow_pickle=False) as arrays:
        assert np.array_equal(arrays["aoi"], result.aoi.raster)
        assert arrays["origin_mm"].tolist() == [5000.0, -2000.0]
        assert float(arrays["step_mm"]) == 25.0
        assert float(arrays["mm_per_unit"]) == 1000.0
        assert tuple(arrays["start_node"]) == result.search.start.node


def test_row_0_of_the_picture_is_the_top_of_the_plan(tmp_path: Path) -> None:
    result = furnished_result()
    write_aoi(tmp_path / "a.png", result)
    pixels = pixels_of(tmp_path / "a.png")
    assert np.array_equal(np.flipud(pixels) == raster_write.AREA, result.aoi.raster)


def test_pixels_have_the_values_of_the_legend(tmp_path: Path) -> None:
    write_aoi(tmp_path / "a.png", furnished_result())
    pixels = np.flipud(pixels_of(tmp_path / "a.png"))
    # row, column of the cells around points of the furnished room
    assert pixels[36, 32] == raster_write.OBSTACLE  # the column's centre
    assert pixels[168, 248] == raster_write.UNREACHED  # inside the ring
    assert pixels[168, 236] == raster_write.OBSTACLE  # the ring itself
    assert pixels[60, 120] == raster_write.AREA  # the start
    assert pixels[0, 0] == raster_write.UNREACHED  # a corner of the room stays rough


def test_the_picture_says_where_it_lies_and_what_its_values_mean(tmp_path: Path) -> None:
    write_aoi(tmp_path / "a.png", furnished_result())
    with Image.open(tmp_path / "a.png") as picture:
        assert picture.text["origin_mm"] == "0.0 0.0"
        assert picture.text["step_mm"] == "25.0"
        assert picture.text[f"value {raster_write.AREA}"] == "area of interest"


@pytest.mark.parametrize("suffix", [".png", ".npz"])
def test_the_same_result_gives_the_same_bytes(tmp_path: Path, suffix: str) -> None:
    one, other = tmp_path / f"1{suffix}", tmp_path / f"2{suffix}"
    write_aoi(one, furnished_result())
    write_aoi(other, furnished_result())
    assert one.read_bytes() == other.read_bytes()


def test_an_unknown_suffix_names_the_known_ones(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"must end in \.dxf or .*\.png or \.npz"):
        write_aoi(tmp_path / "a.gif", furnished_result())


@pytest.mark.parametrize(("name", "hint"), [("a.DWG", "save the drawing as DXF"), ("a.pdf", "PDF")])
def test_formats_that_people_try_get_a_hint(tmp_path: Path, name: str, hint: str) -> None:
    with pytest.raises(InputError, match=hint):
        write_aoi(tmp_path / name, furnished_result())
