"""An inspection as JSON for programs and as tables for people."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

from pydantic import TypeAdapter

from satAOI_adapters.dxf_read.inspection import Inspection as DxfInspection
from satAOI_adapters.dxf_read.inspection import LayerFigures

if TYPE_CHECKING:
    from satAOI_adapters.ifc_read import Inspection as IfcInspection

Table: TypeAlias = Sequence[Sequence[str]]

MM_PER_M = 1000.0


def json_of(inspection: "DxfInspection | IfcInspection") -> str:
    """The inspection as JSON."""
    adapter: TypeAdapter[Any] = TypeAdapter(type(inspection))
    return adapter.dump_json(inspection, indent=2).decode() + "\n"


def tables_of(inspection: "DxfInspection | IfcInspection") -> list[Table]:
    """The inspection as tables: facts first, then plans and layers, or storeys and classes."""
    if isinstance(inspection, DxfInspection):
        return [_drawing(inspection), _plans(inspection), _layers(inspection)]
    return [_model(inspection), _storeys(inspection), _classes(inspection)]


def _drawing(inspection: DxfInspection) -> Table:
    left, bottom, right, top = inspection.bounds
    width_mm, height_mm = inspection.size_mm
    source = inspection.source
    return [
        ("drawing", f"{source.path} ({inspection.version})"),
        ("unit", f"{source.unit} ({source.unit_source})"),
        ("size", f"{width_mm / MM_PER_M:.2f} × {height_mm / MM_PER_M:.2f} m"),
        ("from", f"{left:.10g},{bottom:.10g} in drawing units"),
        ("to", f"{right:.10g},{top:.10g}"),
    ]


def _plans(inspection: DxfInspection) -> Table:
    corners = [(str(plan.number), *(f"{x:.10g}" for x in plan.bounds)) for plan in inspection.plans]
    return [("plan", "left", "bottom", "right", "top"), *corners]


def _layers(inspection: DxfInspection) -> Table:
    heads = ("layer", "read as", "sure", "pattern", "length m", "entities")
    return [heads, *(_layer(layer) for layer in inspection.layers)]


def _layer(layer: LayerFigures) -> tuple[str, ...]:
    hidden = [f"{layer.n_hidden} hidden"] if layer.n_hidden else []
    return (
        layer.layer,
        layer.meaning or ("-" if layer.entities else "not read"),
        layer.certainty,
        layer.pattern or "-",
        f"{layer.length_mm / MM_PER_M:.2f}",
        ", ".join([*_counted(layer.entities), *hidden]),
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
