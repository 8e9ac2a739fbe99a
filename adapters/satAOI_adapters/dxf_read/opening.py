"""Open a DXF file: its bytes, their digest, and the document in them, repaired if need be."""

import hashlib
import io
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import ezdxf
from ezdxf import recover
from ezdxf.document import Drawing
from ezdxf.lldxf.const import DXFError
from ezdxf.lldxf.tagger import binary_tags_loader

from satAOI_adapters.dxf_read import limits, sniff
from satAOI_adapters.dxf_read.encodings import decoded
from satAOI_adapters.dxf_read.entities import DRAWN
from satAOI_adapters.ezdxf_log import heard
from satAOI_adapters.layers import LayerTable
from satAOI_adapters.wording import counted
from satAOI_geo.errors import UnreadableError
from satAOI_geo.plan import Finding

FAULTS: Final = (
    DXFError,
    ValueError,
    ArithmeticError,
    LookupError,
    TypeError,
    AttributeError,
    AssertionError,
    StopIteration,
    RecursionError,
)
"""What ezdxf raises on damaged drawings."""

ENTITY: Final = re.compile(
    rf"^[ \t]*0[ \t]*\n[ \t]*({'|'.join(map(re.escape, DRAWN))})[ \t]*$", re.MULTILINE
)
"""The beginning of an entity that is read."""

NUMBER_CODES: Final = (*range(10, 60), *range(110, 150), *range(210, 240))
"""Group codes whose value is a number with a fraction."""

KIND_CODE, HANDLE_CODE, LAYER_CODE = 0, 5, 8
"""Group codes that begin an entity and name it."""

PAIR: Final = re.compile(r"^[ \t]*(\d+)[ \t]*\n(.*)$", re.MULTILINE)
"""A group code and its value."""


@dataclass(frozen=True, slots=True)
class Opened:
    """A drawing that could be opened.

    Attributes:
        document: As ezdxf holds it.
        sha256: Hexadecimal digest of the file's bytes.
        encoding: Of the names in it, by its name in Python; empty for a binary file.
        findings: What had to be repaired.
    """

    document: Drawing
    sha256: str
    encoding: str = ""
    findings: tuple[Finding, ...] = ()


def open_drawing(path: Path, table: LayerTable, encoding: str | None = None) -> Opened:
    """Open a DXF file.

    Args:
        path: The file.
        table: Layer names that mean something; they tell which encoding is right.
        encoding: Goes before the one that the file declares.

    Raises:
        InputError: If there is no such encoding.
        UnreadableError: If there is no such file, or it is not a whole, readable DXF.
        LimitError: If it is larger than `limits.MAX_FILE_BYTES`.
    """
    content = _content(path)
    sniff.check(content, path.name)
    sha256 = hashlib.sha256(content).hexdigest()
    if content.startswith(sniff.BINARY_DXF):
        document, repairs = _loaded(
            path.name,
            lambda: Drawing.load(binary_tags_loader(content, errors="surrogateescape")),
            lambda: recover.read(io.BytesIO(content))[0],
        )
        return Opened(document, sha256, findings=repairs)
    names = decoded(content, table, encoding)
    text = names.text.replace("\r\n", "\n")
    document, repairs = _loaded(
        path.name,
        lambda: ezdxf.read(io.StringIO(text)),
        # escapes need no encoding, so none can be mistaken
        lambda: recover.read(io.BytesIO(text.encode("ascii", "dxfreplace")))[0],
        text,
    )
    _check_complete(document, text, path.name)
    return Opened(document, sha256, names.encoding, (*names.findings, *repairs))


def _content(path: Path) -> bytes:
    try:
        limits.hold(
            "bytes", path.stat().st_size, limits.MAX_FILE_BYTES, "purge the drawing or split it"
        )
        return path.read_bytes()
    except OSError as error:
        raise UnreadableError(f"cannot read '{path}': {error.strerror or error}") from error


def _loaded(
    name: str, load: Callable[[], Drawing], repair: Callable[[], Drawing], text: str = ""
) -> tuple[Drawing, tuple[Finding, ...]]:
    """The document, loaded as it is or repaired, and what ezdxf had to say about it."""
    with heard() as said:
        try:
            return load(), _repairs(said)
        except FAULTS as error:
            fault = _one_line(error)
        _check_numbers(text, name)
        try:
            document = repair()
        except FAULTS as error:
            raise UnreadableError(
                f"'{name}' is a damaged DXF drawing: {_one_line(error)}; open it in a CAD program, "
                "run its audit and save it again"
            ) from error
    return document, (
        Finding(
            "file-repaired",
            f"the file is damaged ({fault}) and was repaired while reading",
            "open it in a CAD program, run its audit and save it again",
        ),
        *_repairs(said),
    )


def _repairs(said: list[str]) -> tuple[Finding, ...]:
    if not said:
        return ()
    return (
        Finding(
            "file-flaws",
            f"{counted(len(said), 'flaw')} in the file, noticed while reading; the first: "
            f"{_one_line(said[0])}",
            "run the audit of a CAD program over it if something is missing",
        ),
    )


def _check_numbers(text: str, name: str) -> None:
    """Name the first value that should be a number and is not.

    Raises:
        UnreadableError: If there is one; a repair would cut `1,5` down to 1.
    """
    kind = handle = layer = ""
    for pair in PAIR.finditer(text):
        code, value = int(pair[1]), pair[2].strip()
        if code == KIND_CODE:
            kind, handle, layer = value, "", ""
        elif code == HANDLE_CODE:
            handle = value
        elif code == LAYER_CODE:
            layer = value
        elif code in NUMBER_CODES and not _is_number(value):
            line = text.count("\n", 0, pair.start(2)) + 1
            hint = "; export it with decimal points" if "," in value else ""
            raise UnreadableError(
                f"'{name}' is damaged: line {line}, group code {code} of {kind} {handle} on layer "
                f"'{layer}', should be a number and is '{value[:40]}'{hint}",
                layer=layer,
                handle=handle,
            )


def _is_number(value: str) -> bool:
    try:
        float(value)
    except ValueError:
        return False
    return True


def _check_complete(document: Drawing, text: str, name: str) -> None:
    """Refuse a document that holds fewer entities than the file.

    Raises:
        UnreadableError: If reading or repairing lost some.
    """
    written = len(ENTITY.findall(text))
    held = sum(entity.dxftype() in DRAWN for entity in document.entitydb.values())
    if held < written:
        raise UnreadableError(
            f"'{name}' is damaged: {written - held} of its {written} lines, polylines and other "
            "shapes cannot be read; open it in a CAD program, run its audit and save it again"
        )


def _one_line(error: object) -> str:
    return " ".join(str(error).split()).rstrip(".")
