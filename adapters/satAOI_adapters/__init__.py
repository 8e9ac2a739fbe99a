"""Everything that touches the world: a module a format and direction, listed in tables.

A new format is one module and one line in `READERS`, `INSPECTORS`, `WRITERS` or `ROUTE_WRITERS`.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple, Protocol, TypeAlias, TypeVar

from satAOI_geo.errors import InputError, SatAoiError

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from satAOI_adapters.dxf_read import ReadOptions
    from satAOI_adapters.dxf_read.inspection import Inspection as DxfInspection
    from satAOI_adapters.ifc_read import IfcOptions
    from satAOI_adapters.ifc_read import Inspection as IfcInspection
    from satAOI_adapters.inspected import Inspected
    from satAOI_adapters.meanings import LayerMap
    from satAOI_geo.pipeline import Result
    from satAOI_geo.plan import FloorPlan
    from satAOI_geo.progress import Progress
    from satAOI_geo.route import Route

    Inspection: TypeAlias = Inspected[DxfInspection] | Inspected[IfcInspection]
    Reader: TypeAlias = Callable[[Path, "Choices", Progress | None], FloorPlan]
    Writer: TypeAlias = Callable[[Path, Result], None]
    LayersWriter: TypeAlias = Callable[[Path, LayerMap, Sequence[Path]], None]
    PictureWriter: TypeAlias = Callable[[Path, Inspection, Sequence[Path]], None]
    RouteWriter: TypeAlias = Callable[[Path, Result, Route], None]

    class Inspector(Protocol):
        """A function that tells how a file is read."""

        def __call__(self, path: Path, choices: Choices, *, with_plan: bool) -> Inspection: ...


__all__ = [
    "INSPECTORS",
    "LAYERS_WRITERS",
    "PICTURE_WRITERS",
    "RASTERS",
    "READERS",
    "ROUTE_WRITERS",
    "WRITERS",
    "Choices",
    "inspect_plan",
    "layers_writer_of",
    "picture_writer_of",
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
    path: Path | str,
    dxf: ReadOptions | None = None,
    ifc: IfcOptions | None = None,
    *,
    progress: Progress | None = None,
) -> FloorPlan:
    """Read a floor plan from a file of any known format.

    Args:
        path: The file; its suffix tells the format.
        dxf: How a DXF drawing is read, if it is one.
        ifc: How an IFC model is read, if it is one.
        progress: Called with "reading" and the share of it that is done.

    Raises:
        InputError: If no reader knows the file's suffix, or an option is wrong.
        DrawingError: If the drawing cannot be used as it is.
        LimitError: If it asks for more than the reader's limits allow.
    """
    path = Path(path)
    reader = _by_suffix(READERS, path, "read")
    told = progress or (lambda _stage, _share: None)
    told("reading", 0.0)
    plan = reader(path, Choices(dxf, ifc), told)
    told("reading", 1.0)
    return plan


def inspect_plan(
    path: Path | str,
    dxf: ReadOptions | None = None,
    ifc: IfcOptions | None = None,
    *,
    with_plan: bool = False,
) -> Inspection:
    """Tell how a plan is read; arguments and errors as for `read_plan`.

    What keeps a file from being used that something can be told of is not raised, but a part of
    the answer.

    Args:
        path: The file; its suffix tells the format.
        dxf: How a DXF drawing is read, if it is one.
        ifc: How an IFC model is read, if it is one.
        with_plan: Whether the plan is wanted, too. A drawing's always comes along; a model's
            takes the time that reading it does.
    """
    path = Path(path)
    return _by_suffix(INSPECTORS, path, "inspect")(path, Choices(dxf, ifc), with_plan=with_plan)


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


def layers_writer_of(path: Path) -> LayersWriter:
    """The function that writes a drawing's layers, to be edited, to files of this name.

    It takes the file, the layers, and files that must survive.

    Raises:
        InputError: If no writer knows the file's suffix.
    """
    return _by_suffix(LAYERS_WRITERS, path, "write")


def picture_writer_of(path: Path) -> PictureWriter:
    """The function that draws an inspection to files of this name.

    It takes the file, what was inspected, and files that must survive.

    Raises:
        InputError: If no writer knows the file's suffix.
    """
    return _by_suffix(PICTURE_WRITERS, path, "write")


def _read_dxf(
    path: Path,
    choices: Choices,
    progress: Progress | None = None,  # noqa: ARG001 - there is little to wait for
) -> FloorPlan:
    from satAOI_adapters import dxf_read

    return dxf_read.read(path, choices.dxf or dxf_read.ReadOptions())


def _read_ifc(path: Path, choices: Choices, progress: Progress | None = None) -> FloorPlan:
    from satAOI_adapters import ifc_read

    return ifc_read.read(path, choices.ifc or ifc_read.IfcOptions(), progress)


def _inspect_dxf(
    path: Path,
    choices: Choices,
    *,
    with_plan: bool,  # noqa: ARG001 - it comes along anyway
) -> Inspection:
    from satAOI_adapters.dxf_read import inspection, options

    return inspection.inspect(path, choices.dxf or options.ReadOptions())


def _inspect_ifc(path: Path, choices: Choices, *, with_plan: bool) -> Inspection:
    from satAOI_adapters import ifc_read
    from satAOI_adapters.inspected import Inspected

    figures = ifc_read.inspect(path, choices.ifc or ifc_read.IfcOptions())
    if not with_plan:
        return Inspected(figures, figures.findings)
    try:
        plan = _read_ifc(path, choices)
    except SatAoiError as error:
        return Inspected(figures, figures.findings, error=error)
    return Inspected(figures, plan.findings, plan)


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


def _write_layers(path: Path, layers: LayerMap, inputs: Sequence[Path]) -> None:
    from satAOI_adapters import layers_write

    layers_write.write(path, layers, drawing=inputs[0].name, never_over=inputs)


def _picture_png(path: Path, inspection: Inspection, inputs: Sequence[Path]) -> None:
    from satAOI_adapters import plan_picture

    plan_picture.write_png(path, inspection, never_over=inputs)


def _picture_svg(path: Path, inspection: Inspection, inputs: Sequence[Path]) -> None:
    from satAOI_adapters import plan_picture

    plan_picture.write_svg(path, inspection, never_over=inputs)


READERS: Final[dict[str, Reader]] = {".dxf": _read_dxf, ".ifc": _read_ifc}
"""Suffix, in lower case, to the function that reads such a file."""

INSPECTORS: Final[dict[str, Inspector]] = {".dxf": _inspect_dxf, ".ifc": _inspect_ifc}
"""Suffix, in lower case, to the function that tells how such a file is read."""

RASTERS: Final[dict[str, Writer]] = {".png": _write_png, ".npz": _write_npz}
"""Suffix, in lower case, to the function that writes the area as a raster to such a file."""

WRITERS: Final[dict[str, Writer]] = {
    ".dxf": _write_dxf,
    ".ifc": _write_ifc,
    ".bcf": _write_bcf,
    **RASTERS,
}
"""Suffix, in lower case, to the function that writes such a file."""

ROUTE_WRITERS: Final[dict[str, RouteWriter]] = {
    ".dxf": _write_route_dxf,
    ".json": _write_route_json,
}
"""Suffix, in lower case, to the function that writes a route to such a file."""

LAYERS_WRITERS: Final[dict[str, LayersWriter]] = {".toml": _write_layers}
"""Suffix, in lower case, to the function that writes a drawing's layers to such a file."""

PICTURE_WRITERS: Final[dict[str, PictureWriter]] = {".png": _picture_png, ".svg": _picture_svg}
"""Suffix, in lower case, to the function that draws an inspection to such a file."""

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
