"""An inspection as JSON for programs and as tables for people."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, TypeAlias

from satAOI_adapters.dxf_read.inspection import Inspection as DxfInspection
from satAOI_adapters.dxf_read.inspection import LayerFigures
from satAOI_geo.units import MM2_PER_M2

if TYPE_CHECKING:
    from satAOI_adapters.ifc_read import Inspection as IfcInspection

Table: TypeAlias = Sequence[Sequence[str]]

MM_PER_M = 1000.0


def tables_of(inspection: "DxfInspection | IfcInspection") -> list[Table]:
    """The inspection as tables: facts first, then plans and layers, or storeys and classes."""
    if isinstance(inspection, DxfInspection):
        plans = [_plans(inspection)] if inspection.plans else []
        return [_drawing(inspection), *plans, _layers(inspection)]
    return [_model(inspection), _storeys(inspection), _classes(inspection)]


def _drawing(inspection: DxfInspection) -> Table:
    start, end = _corners(inspection)
    source = inspection.source
    return [
        ("drawing", f"{source.path} ({inspection.version})"),
        ("unit", f"{source.unit} ({source.unit_source})" if source.unit else "not known"),
        ("size", "-" if inspection.size_mm is None else _size(inspection.size_mm)),
        ("from", f"{start} in drawing units" if start else "-"),
        ("to", end or "-"),
    ]


def _corners(inspection: DxfInspection) -> tuple[str, str]:
    """The lower left and the upper right corner of what is drawn; empty if nothing is."""
    if inspection.bounds is None:
        return "", ""
    left, bottom, right, top = inspection.bounds
    return f"{left:.10g},{bottom:.10g}", f"{right:.10g},{top:.10g}"


def _plans(inspection: DxfInspection) -> Table:
    rows = [
        (str(plan.number), *(f"{x:.10g}" for x in plan.bounds), _size(plan.size_mm))
        for plan in inspection.plans
    ]
    return [("plan", "left", "bottom", "right", "top", "size"), *rows]


def _size(size_mm: tuple[float, float]) -> str:
    width_mm, height_mm = size_mm
    return f"{width_mm / MM_PER_M:.2f} × {height_mm / MM_PER_M:.2f} m"


def _layers(inspection: DxfInspection) -> Table:
    heads = ("layer", "read as", "sure", "pattern", "area m²", "length m", "entities")
    return [heads, *(_layer(layer) for layer in inspection.layers)]


def _layer(layer: LayerFigures) -> tuple[str, ...]:
    hidden = [f"{layer.n_hidden} hidden"] if layer.n_hidden else []
    unread = [f"{told} unread" for told in _counted(layer.unread)]
    return (
        layer.layer,
        layer.meaning or ("-" if layer.entities else "not read"),
        layer.certainty,
        layer.pattern or "-",
        "-" if layer.area_mm2 is None else f"{layer.area_mm2 / MM2_PER_M2:.2f}",
        "-" if layer.length_mm is None else f"{layer.length_mm / MM_PER_M:.2f}",
        ", ".join([*_counted(layer.entities), *unread, *hidden]),
    )


def _model(inspection: "IfcInspection") -> Table:
    source = inspection.source
    return [
        ("model", f"{source.path} ({inspection.schema_name})"),
        ("unit", f"{source.unit} ({source.unit_source})"),
    ]


def _storeys(inspection: "IfcInspection") -> Table:
    heads = ("storey", "name", "floor m", "GlobalId", "holds")
    rows = [
        (
            str(storey.number),
            storey.name or "-",
            f"{storey.elevation_mm / MM_PER_M:.3f}",
            storey.handle,
            ", ".join(_counted(storey.counts)) or "-",
        )
        for storey in inspection.storeys
    ]
    return [heads, *rows]


def _classes(inspection: "IfcInspection") -> Table:
    return [("class", "number"), *((name, str(n)) for name, n in inspection.classes.items())]


def _counted(counts: dict[str, int]) -> list[str]:
    return [f"{count} {name}" for name, count in counts.items()]
