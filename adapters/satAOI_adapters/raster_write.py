"""Write the area of interest as a picture or as arrays."""

import io
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt
import shapely
from PIL import Image, ImageDraw
from PIL.PngImagePlugin import PngInfo
from shapely.geometry import LineString, Polygon

from satAOI_adapters.files import written_whole
from satAOI_geo.lattice import Lattice
from satAOI_geo.pipeline import Result
from satAOI_geo.plan import Circle, Shape, polygons_in

OUTSIDE: Final = 0
OBSTACLE: Final = 1
UNREACHED: Final = 2
AREA: Final = 3

LEGEND: Final = {
    OUTSIDE: ("outside the floor", (255, 255, 255)),
    OBSTACLE: ("obstacle", (70, 70, 70)),
    UNREACHED: ("floor not in the area of interest", (222, 222, 222)),
    AREA: ("area of interest", (126, 200, 130)),
}
"""Pixel value to its meaning and its colour in the picture's palette."""


def write_png(path: Path, result: Result) -> None:
    """Write a picture with one pixel a cell, north up, its values as in `LEGEND`.

    The area of interest is exact: a pixel has its value when the cell's centre is in the area.
    Floor and obstacles are drawn for orientation, to the nearest pixel. Text chunks of the file
    repeat the legend and say where the picture lies: `origin_mm` is the lower left corner of the
    lower left pixel, in the drawing's axes, `step_mm` a pixel's side, `turn_rad` the direction
    of a pixel row in the drawing.

    Raises:
        InputError: If the file must not or cannot be written.
    """
    cells = _background(result)
    cells[result.aoi.raster] = AREA
    # row 0 of the raster lies at the smallest y, row 0 of a picture at the top
    picture = Image.fromarray(np.flipud(cells), mode="P")
    picture.putpalette([channel for _, colour in LEGEND.values() for channel in colour])
    buffer = io.BytesIO()
    picture.save(buffer, format="PNG", pnginfo=_place_and_legend(result))
    _write(path, result, buffer.getvalue())


def write_npz(path: Path, result: Result) -> None:
    """Write the arrays of the area of interest in numpy's format.

    Keys:
        aoi: Boolean, [row, column], row 0 at the smallest y: the cell's centre is in the area.
        origin_mm: Lower left corner of cell [0, 0], in the drawing's axes.
        step_mm: Side of a cell.
        turn_rad: Direction of a row in the drawing.
        mm_per_unit: Millimetres in one drawing unit.
        start_node: [row, column] of the cell whose centre the disc starts from.

    Raises:
        InputError: If the file must not or cannot be written.
    """
    frame = result.plan.frame
    buffer = io.BytesIO()
    np.savez_compressed(
        buffer,
        aoi=result.aoi.raster,
        origin_mm=frame.to_drawing_mm(result.lattice.origin_mm),
        step_mm=np.float64(result.lattice.step_mm),
        turn_rad=np.float64(frame.turn_rad),
        mm_per_unit=np.float64(frame.mm_per_unit),
        start_node=np.array(result.search.start.node),
    )
    _write(path, result, buffer.getvalue())


def _background(result: Result) -> npt.NDArray[np.uint8]:
    """Floor and obstacles as pixel values, [row, column] as the raster."""
    lattice = result.lattice
    picture = Image.new("L", (lattice.n_columns, lattice.n_rows), OUTSIDE)
    for polygon in polygons_in([result.plan.floor]):
        _fill(picture, polygon, lattice, UNREACHED)
    for obstacle in result.plan.obstacles:
        _draw(picture, obstacle.shape, lattice)
    return np.array(picture)


def _draw(picture: Image.Image, shape: Shape, lattice: Lattice) -> None:
    if isinstance(shape, LineString):
        ImageDraw.Draw(picture).line(_pixels(shape, lattice), fill=OBSTACLE)
    else:
        polygon = shape.polygon() if isinstance(shape, Circle) else shape
        _fill(picture, polygon, lattice, OBSTACLE)


def _fill(picture: Image.Image, polygon: Polygon, lattice: Lattice, value: int) -> None:
    """Fill a polygon and leave what shows through its holes as it was."""
    if not polygon.interiors:
        ImageDraw.Draw(picture).polygon(_pixels(polygon.exterior, lattice), fill=value)
        return
    mask = Image.new("1", picture.size, 0)
    draw = ImageDraw.Draw(mask)
    draw.polygon(_pixels(polygon.exterior, lattice), fill=1)
    for hole in polygon.interiors:
        draw.polygon(_pixels(hole, lattice), fill=0)
    picture.paste(value, mask=mask)


def _pixels(line: LineString, lattice: Lattice) -> list[tuple[float, float]]:
    """Points of a line counted in cells; a whole number is the centre of a cell."""
    points_mm = shapely.get_coordinates(line)
    cells = (points_mm - np.array(lattice.origin_mm)) / lattice.step_mm - 0.5
    return [(x, y) for x, y in cells.tolist()]


def _place_and_legend(result: Result) -> PngInfo:
    """The picture's text chunks."""
    frame = result.plan.frame
    x_mm, y_mm = frame.to_drawing_mm(result.lattice.origin_mm).tolist()
    texts = PngInfo()
    texts.add_text("origin_mm", f"{x_mm!r} {y_mm!r}")
    texts.add_text("step_mm", f"{result.lattice.step_mm!r}")
    texts.add_text("turn_rad", f"{frame.turn_rad!r}")
    for value, (meaning, _) in LEGEND.items():
        texts.add_text(f"value {value}", meaning)
    return texts


def _write(path: Path, result: Result, data: bytes) -> None:
    source = result.plan.source
    inputs = [Path(source.path)] if source.path else []
    with written_whole(path, never_over=inputs) as stream:
        stream.write(data)
