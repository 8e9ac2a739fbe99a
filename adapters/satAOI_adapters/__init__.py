"""Everything that touches the world: a module a format and direction, listed in two tables.

A new format is one module and one line in `READERS` or `WRITERS`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, TypeAlias, TypeVar

from satAOI_geo.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from satAOI_adapters.dxf_read import ReadOptions
    from satAOI_geo.pipeline import Result
    from satAOI_geo.plan import FloorPlan

    Reader: TypeAlias = Callable[[Path, ReadOptions], FloorPlan]
    Writer: TypeAlias = Callable[[Path, Result], None]

__all__ = ["READERS", "WRITERS", "read_plan", "write_aoi", "writer_of"]


def read_plan(path: Path, options: ReadOptions) -> FloorPlan:
    """Read a floor plan from a file of any known format.

    Raises:
        InputError: If no reader knows the file's suffix.
        DrawingError: If the drawing cannot be used as it is.
    """
    return _by_suffix(READERS, path, "read")(path, options)


def write_aoi(path: Path, result: Result) -> None:
    """Write an area of interest to a file of any known format.

    Raises:
        InputError: If no writer knows the file's suffix, or the file cannot be written.
    """
    writer_of(path)(path, result)


def writer_of(path: Path) -> Writer:
    """The function that writes files of this name.

    Raises:
        InputError: If no writer knows the file's suffix.
    """
    return _by_suffix(WRITERS, path, "write")


def _read_dxf(path: Path, options: ReadOptions) -> FloorPlan:
    from satAOI_adapters import dxf_read

    return dxf_read.read(path, options)


def _read_ifc(path: Path, options: ReadOptions) -> FloorPlan:
    from satAOI_adapters import ifc_read

    return ifc_read.read(path, ifc_read.IfcOptions(units=options.units))


def _write_dxf(path: Path, result: Result) -> None:
    from satAOI_adapters import dxf_write

    dxf_write.write(path, result)


def _write_png(path: Path, result: Result) -> None:
    from satAOI_adapters import raster_write

    raster_write.write_png(path, result)


def _write_npz(path: Path, result: Result) -> None:
    from satAOI_adapters import raster_write

    raster_write.write_npz(path, result)


READERS: Final[dict[str, Reader]] = {".dxf": _read_dxf, ".ifc": _read_ifc}
"""Suffix, in lower case, to the function that reads such a file."""

WRITERS: Final[dict[str, Writer]] = {".dxf": _write_dxf, ".png": _write_png, ".npz": _write_npz}
"""Suffix, in lower case, to the function that writes such a file."""

HINTS: Final = {
    ".dwg": "; save the drawing as DXF (R2010 or newer) in the program it was made with",
    ".pdf": "; a PDF holds no plan to measure, ask for the DXF it was printed from",
}
"""What to do about formats that people try."""

FormatT = TypeVar("FormatT")


def _by_suffix(table: dict[str, FormatT], path: Path, verb: str) -> FormatT:
    """What the table holds for the file's suffix."""
    suffix = path.suffix.lower()
    if suffix not in table:
        raise InputError(
            f"cannot {verb} '{path}': the name must end in {' or '.join(table)}"
            f"{HINTS.get(suffix, '')}"
        )
    return table[suffix]
