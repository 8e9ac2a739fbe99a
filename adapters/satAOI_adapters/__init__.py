"""Everything that touches the world: a module a format and direction, listed in tables.

A new format is one module and one line in `READERS`, `INSPECTORS`, `WRITERS` or `ROUTE_WRITERS`.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple, TypeAlias, TypeVar

from satAOI_geo.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Callable

    from satAOI_adapters.dxf_read import ReadOptions
    from satAOI_adapters.dxf_read.inspection import Inspection as DxfInspection
    from satAOI_adapters.ifc_read import IfcOptions
    from satAOI_adapters.ifc_read import Inspection as IfcInspection
    from satAOI_geo.pipeline import Result
    from satAOI_geo.plan import FloorPlan
    from satAOI_geo.route import Route

    Inspection: TypeAlias = DxfInspection | IfcInspection
    Reader: TypeAlias = Callable[[Path, "Choices"], FloorPlan]
    Inspector: TypeAlias = Callable[[Path, "Choices"], Inspection]
    Writer: TypeAlias = Callable[[Path, Result], None]
    RouteWriter: TypeAlias = Callable[[Path, Result, Route], None]

__all__ = [
    "INSPECTORS",
    "READERS",
    "ROUTE_WRITERS",
    "WRITERS",
    "Choices",
    "inspect_plan",
    "read_plan",
    "route_writer_of",
    "write_aoi",
    "write_route",
    "writer_of",
]


class Choices(NamedTuple):
    """How files are to be read, by format; None for the defaults."""

    dxf: ReadOptions | None = None
    ifc: IfcOptions | None = None


def read_plan(
    path: Path | str, dxf: ReadOptions | None = None, ifc: IfcOptions | None = None
) -> FloorPlan:
    """Read a floor plan from a file of any known format.

    Args:
        path: The file; its suffix tells the format.
        dxf: How a DXF drawing is read, if it is one.
        ifc: How an IFC model is read, if it is one.

    Raises:
        InputError: If no reader knows the file's suffix, or an option is wrong.
        DrawingError: If the drawing cannot be used as it is.
        LimitError: If it asks for more than the reader's limits allow.
    """
    path = Path(path)
    return _by_suffix(READERS, path, "read")(path, Choices(dxf, ifc))


def inspect_plan(
    path: Path | str, dxf: ReadOptions | None = None, ifc: IfcOptions | None = None
) -> Inspection:
    """Tell how a plan would be read; arguments and errors as for `read_plan`."""
    path = Path(path)
    return _by_suffix(INSPECTORS, path, "inspect")(path, Choices(dxf, ifc))


def write_aoi(path: Path | str, result: Result) -> None:
    """Write an area of interest to a file of any known format.

    Raises:
        InputError: If no writer knows the file's suffix, or the file cannot be written.
    """
    path = Path(path)
    writer_of(path)(path, result)


def writer_of(path: Path) -> Writer:
    """The function that writes files of this name.

    Raises:
        InputError: If no writer knows the file's suffix.
    """
    return _by_suffix(WRITERS, path, "write")


def write_route(path: Path | str, result: Result, route: Route) -> None:
    """Write a route, found on a result's search, to a file of any known format.

    Raises:
        InputError: If no writer knows the file's suffix, or the file cannot be written.
    """
    path = Path(path)
    route_writer_of(path)(path, result, route)


def route_writer_of(path: Path) -> RouteWriter:
    """The function that writes routes to files of this name.

    Raises:
        InputError: If no writer knows the file's suffix.
    """
    return _by_suffix(ROUTE_WRITERS, path, "write")


def _read_dxf(path: Path, choices: Choices) -> FloorPlan:
    from satAOI_adapters import dxf_read

    return dxf_read.read(path, choices.dxf or dxf_read.ReadOptions())


def _read_ifc(path: Path, choices: Choices) -> FloorPlan:
    from satAOI_adapters import ifc_read

    return ifc_read.read(path, choices.ifc or ifc_read.IfcOptions())


def _inspect_dxf(path: Path, choices: Choices) -> Inspection:
    from satAOI_adapters.dxf_read import inspection, options

    return inspection.inspect(path, choices.dxf or options.ReadOptions())


def _inspect_ifc(path: Path, choices: Choices) -> Inspection:
    from satAOI_adapters import ifc_read

    return ifc_read.inspect(path, choices.ifc or ifc_read.IfcOptions())


def _write_dxf(path: Path, result: Result) -> None:
    from satAOI_adapters import dxf_write

    dxf_write.write(path, result)


def _write_ifc(path: Path, result: Result) -> None:
    from satAOI_adapters import ifc_write

    ifc_write.write(path, result)


def _write_bcf(path: Path, result: Result) -> None:
    from satAOI_adapters import bcf_write

    bcf_write.write(path, result)


def _write_png(path: Path, result: Result) -> None:
    from satAOI_adapters import raster_write

    raster_write.write_png(path, result)


def _write_npz(path: Path, result: Result) -> None:
    from satAOI_adapters import raster_write

    raster_write.write_npz(path, result)


def _write_route_dxf(path: Path, result: Result, route: Route) -> None:
    from satAOI_adapters.dxf_write import route as route_drawing

    route_drawing.write(path, result, route)


def _write_route_json(path: Path, result: Result, route: Route) -> None:
    from satAOI_adapters import route_write

    route_write.write(path, result, route)


READERS: Final[dict[str, Reader]] = {".dxf": _read_dxf, ".ifc": _read_ifc}
"""Suffix, in lower case, to the function that reads such a file."""

INSPECTORS: Final[dict[str, Inspector]] = {".dxf": _inspect_dxf, ".ifc": _inspect_ifc}
"""Suffix, in lower case, to the function that tells how such a file is read."""

WRITERS: Final[dict[str, Writer]] = {
    ".dxf": _write_dxf,
    ".ifc": _write_ifc,
    ".bcf": _write_bcf,
    ".png": _write_png,
    ".npz": _write_npz,
}
"""Suffix, in lower case, to the function that writes such a file."""

ROUTE_WRITERS: Final[dict[str, RouteWriter]] = {
    ".dxf": _write_route_dxf,
    ".json": _write_route_json,
}
"""Suffix, in lower case, to the function that writes a route to such a file."""

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
