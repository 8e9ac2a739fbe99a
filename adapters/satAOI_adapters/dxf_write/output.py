"""What all drawings share: the input underneath, a note beside the plan, one file at the end."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from ezdxf.layouts import Modelspace

from satAOI_adapters.dxf_write.document import base_document, file_bytes
from satAOI_adapters.dxf_write.layers import Style, add_layers
from satAOI_adapters.dxf_write.legend import Row
from satAOI_adapters.dxf_write.metadata import add_appid, record_run
from satAOI_adapters.dxf_write.note import draw_note
from satAOI_adapters.dxf_write.place import entity_bounds
from satAOI_adapters.files import refuse_unfit_target, written_whole
from satAOI_geo.pipeline import Result


@contextmanager
def drawing(
    path: Path, result: Result, styles: Iterable[Style], rows: list[Row]
) -> Iterator[Modelspace]:
    """The input's model space to draw into; when that is done, the drawing is written.

    The same entities drawn give the same bytes.

    Args:
        path: The DXF file to write.
        result: The area of interest and the plan it was found on.
        styles: The layers that are drawn on.
        rows: What the note beside the plan tells.

    Raises:
        InputError: If the file must not or cannot be written.
        UnreadableError: If the input drawing is gone or was changed since it was read.
    """
    source = result.plan.source
    inputs = [Path(source.path)] if source.path else []
    refuse_unfit_target(path, inputs)
    document = base_document(result.plan)
    add_layers(document, styles)
    add_appid(document)
    space = document.modelspace()
    # before anything is drawn into it: what comes on top lies within the plan
    taken = entity_bounds(space)
    yield space
    draw_note(space, result.plan, rows, taken)
    record_run(document, result)
    data = file_bytes(document)
    with written_whole(path, never_over=inputs) as stream:
        stream.write(data)
