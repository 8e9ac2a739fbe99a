"""Add an area of interest to the IFC model that its plan was read from.

The model's own bytes stay as they are, to the last one. What is added stands in one block before
the end of the data, between two comments, and is replaced when the result is written again:

    SATAOI-AOI         the area of interest: a thin body on the floor, with its figures
    SATAOI-UNREACHED   a patch of free floor that is not reached, with its reason

Both are object types of an IfcSpatialZone, which IFC2X3 lacks: there, of IfcBuildingElementProxy.
"""

import re
from hashlib import sha256
from pathlib import Path
from typing import Final

from satAOI_adapters.files import refuse_unfit_target, written_whole
from satAOI_geo.errors import InputError, UnreadableError
from satAOI_geo.pipeline import Result

__all__ = ["AOI_TYPE", "UNREACHED_TYPE", "write"]

AOI_TYPE: Final = "SATAOI-AOI"
UNREACHED_TYPE: Final = "SATAOI-UNREACHED"
"""Object types of the zones; reading leaves out whatever begins with SATAOI-."""

BEGIN: Final = b"/* satAOI-geo begin */\n"
END: Final = b"/* satAOI-geo end */\n"
BLOCK: Final = re.compile(re.escape(BEGIN) + b".*?" + re.escape(END), re.DOTALL)
END_OF_DATA: Final = re.compile(rb"ENDSEC\s*;\s*END-ISO-10303-21", re.IGNORECASE)


def write(path: Path, result: Result) -> None:
    """Write the model with the area of interest added.

    The same result gives the same bytes.

    Args:
        path: The IFC file to write.
        result: The area of interest and the plan it was found on.

    Raises:
        InputError: If the plan is not from an IFC model, or the file must not or cannot be written.
        UnreadableError: If the model is gone or was changed since it was read.
    """
    source = result.plan.source
    if source.format != "ifc":
        raise InputError(
            f"'{path}': an area can be added to the IFC model its plan was read from, and this "
            "plan is no IFC model; give an output that ends in .dxf"
        )
    model = Path(source.path)
    refuse_unfit_target(path, [model])
    data = _unchanged(model, source.sha256)
    from satAOI_adapters.ifc_read.parsable import parsable
    from satAOI_adapters.ifc_write.zones import lines_of

    bare = BLOCK.sub(b"", data)
    *_, end = END_OF_DATA.finditer(bare)
    with parsable(model, data) as parsed:
        added = "\n".join(lines_of(parsed, result)).encode("ascii")
    with written_whole(path, never_over=[model]) as stream:
        stream.write(bare[: end.start()] + BEGIN + added + b"\n" + END + bare[end.start() :])


def _unchanged(path: Path, digest: str) -> bytes:
    """The bytes of the model, the same as when it was read."""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise UnreadableError(f"cannot read '{path}' again: {error.strerror or error}") from error
    if sha256(data).hexdigest() != digest:
        raise UnreadableError(f"'{path}' was changed since it was read; run again")
    return data
