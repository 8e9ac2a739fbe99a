"""Open a DXF file: what it really is, its bytes' digest, and the document in it."""

import hashlib
from dataclasses import dataclass
from pathlib import Path

import ezdxf
from ezdxf.document import Drawing
from ezdxf.lldxf.const import DXFError

from satAOI_adapters.dxf_read import limits
from satAOI_geo.errors import UnreadableError
from satAOI_geo.plan import Finding


@dataclass(frozen=True, slots=True)
class Opened:
    """A drawing that could be opened.

    Attributes:
        document: As ezdxf holds it.
        sha256: Hexadecimal digest of the file's bytes.
        findings: What had to be repaired.
    """

    document: Drawing
    sha256: str
    findings: tuple[Finding, ...] = ()


def open_drawing(path: Path) -> Opened:
    """Open a DXF file.

    Raises:
        UnreadableError: If there is no such file, or it is not a readable DXF.
        LimitError: If it is larger than `limits.MAX_FILE_BYTES`.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise UnreadableError(f"cannot read '{path}': {error.strerror or error}") from error
    limits.hold("bytes", len(content), limits.MAX_FILE_BYTES, "purge the drawing or split it")
    try:
        document = ezdxf.readfile(path)
    except (DXFError, OSError, ValueError) as error:
        raise UnreadableError(f"'{path}' is not a readable DXF drawing: {error}") from error
    return Opened(document, hashlib.sha256(content).hexdigest())
