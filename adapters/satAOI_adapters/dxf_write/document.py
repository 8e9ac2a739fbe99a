"""The drawing that is drawn into, and its bytes."""

import contextlib
import io
from collections.abc import Iterator
from hashlib import sha256
from pathlib import Path
from typing import Any, Final

import ezdxf
from ezdxf import recover
from ezdxf.document import Drawing
from ezdxf.entities import DXFGraphic, Ellipse
from ezdxf.lldxf.const import DXF2010, DXFError
from ezdxf.render.arrows import ARROWS

from satAOI_adapters.dxf_write.layers import PREFIX
from satAOI_adapters.dxf_write.pen import Pen
from satAOI_adapters.dxf_write.place import floor_bounds
from satAOI_adapters.ezdxf_log import heard
from satAOI_geo.errors import UnreadableError
from satAOI_geo.plan import FloorPlan, Source, polygons_in

INSUNITS: Final = {
    "in": 1,
    "ft": 2,
    "mi": 3,
    "mm": 4,
    "cm": 5,
    "m": 6,
    "km": 7,
    "yd": 10,
    "um": 13,
    "dm": 14,
}
"""Value of the header variable $INSUNITS for a unit of length."""

DAMAGED: Final = (
    DXFError,
    ValueError,
    LookupError,
    TypeError,
    AttributeError,
    AssertionError,
    OSError,
)
"""What the library raises on a file that breaks the format's rules."""


def base_document(plan: FloorPlan) -> Drawing:
    """The drawing a plan came from, or a new one with the plan drawn on plain layers.

    What an earlier run drew is taken out. The version is R2010, or the input's where that is
    newer; the header's unit is the one the plan was read with.

    Raises:
        UnreadableError: If the drawing is gone or is not the one that was read.
    """
    from_dxf = plan.source.format == "dxf"
    # what the reader heard of the file's flaws, it has said
    with heard(), _arrows_in_order():
        document = _opened(plan.source) if from_dxf else _drawn(plan)
    _turn_ellipses(document)
    document.dxfversion = max(document.dxfversion, DXF2010)
    document.header["$INSUNITS"] = INSUNITS[plan.source.unit]
    _remove_earlier_output(document)
    return document


def file_bytes(document: Drawing) -> bytes:
    """The drawing as an ASCII DXF file; equal drawings give equal bytes.

    Dates and GUIDs in the header are fixed, and classes that the library adds come in the order
    of their names: it would take them from a set, in another order every time.

    Raises:
        UnreadableError: If the input holds something that cannot be written again.
    """
    classes = document.classes.classes
    loaded = set(classes)
    document.classes.add_required_classes(document.dxfversion)
    # the numbers of the input's own classes follow from their order, so that order is kept
    for key in sorted(set(classes) - loaded):
        classes[key] = classes.pop(key)
    text = io.StringIO(newline="\n")
    try:
        with _fixed_meta_data(), heard():
            document.write(text)
    except DAMAGED as error:
        raise UnreadableError(
            f"the drawing holds something that cannot be written again: {error}; open it in a CAD "
            "program, run its audit and save it again"
        ) from error
    return text.getvalue().encode(document.output_encoding, errors="dxfreplace")


def _opened(source: Source) -> Drawing:
    """The input drawing, loaded as it stands where possible.

    A damaged one is loaded with repairs, as the reader did, which reported them; what cannot be
    repaired is then missing from the output too.
    """
    path = Path(source.path)
    try:
        data = path.read_bytes()
    except OSError as error:
        raise UnreadableError(f"cannot read '{path}' again: {error.strerror}") from error
    if source.sha256 and sha256(data).hexdigest() != source.sha256:
        raise UnreadableError(f"'{path}' was changed while it was worked on; run again")
    with contextlib.suppress(*DAMAGED):
        return ezdxf.readfile(path, encoding=source.encoding or None)
    try:
        return recover.read(io.BytesIO(_escaped(data, source.encoding)))[0]
    except DAMAGED as error:
        raise UnreadableError(f"'{path}' cannot be loaded to draw into: {error}") from error


def _escaped(data: bytes, encoding: str) -> bytes:
    """A text drawing with all but ASCII as escapes, which no header can make mean others."""
    if not encoding:
        return data
    return data.decode(encoding, "surrogateescape").encode("ascii", "dxfreplace")


def _drawn(plan: FloorPlan) -> Drawing:
    """A new drawing of a plan, on layers named after the kinds of obstacles."""
    with _fixed_meta_data():
        document = ezdxf.new(DXF2010)
    floor_pen = Pen(document.modelspace(), plan.frame, "FLOOR")
    for polygon in polygons_in([plan.floor]):
        floor_pen.shape(polygon)
    for obstacle in plan.obstacles:
        Pen(document.modelspace(), plan.frame, obstacle.kind.name).shape(obstacle.shape)
    for layer in sorted({entity.dxf.layer for entity in document.modelspace()}):
        document.layers.add(layer)
    _look_at_floor(document, plan)
    return document


def _look_at_floor(document: Drawing, plan: FloorPlan) -> None:
    """Open the drawing with the floor in the left half of a wide screen, the note in the right."""
    left, bottom, right, top = floor_bounds(plan)
    document.set_modelspace_vport(
        height=1.2 * max(right - left, top - bottom), center=(right, (bottom + top) / 2)
    )


def _turn_ellipses(document: Drawing) -> None:
    """Let the longer axis of every ellipse be its first, without which none is written."""
    for entity in document.entitydb.values():
        if isinstance(entity, Ellipse) and entity.dxf.ratio > 1:
            entity.swap_axis()  # type: ignore[no-untyped-call]  # ezdxf gives it no types


def _remove_earlier_output(document: Drawing) -> None:
    """Take everything on this program's layers out of model space."""
    space = document.modelspace()
    for entity in list(space):
        # an entity of an unknown type has no layer that could be asked for
        if isinstance(entity, DXFGraphic) and entity.dxf.layer.upper().startswith(PREFIX):
            space.delete_entity(entity)


@contextlib.contextmanager
def _arrows_in_order() -> Iterator[None]:
    """While this lasts, drawings of R13 and R14 are given arrows in the order of their names.

    The library, which does so to bring them up to R2000, would take them from a set, in another
    order every time.
    """
    arrows: Any = ARROWS
    arrows.__acad__ = dict.fromkeys(sorted(arrows.__acad__))
    try:
        yield
    finally:
        # what its class has comes to the fore again
        del arrows.__acad__


@contextlib.contextmanager
def _fixed_meta_data() -> Iterator[None]:
    """While this lasts, the library writes constant dates and GUIDs."""
    before = ezdxf.options.write_fixed_meta_data_for_testing
    ezdxf.options.write_fixed_meta_data_for_testing = True
    try:
        yield
    finally:
        ezdxf.options.write_fixed_meta_data_for_testing = before
