"""What can be said about a file before anything parses it.

The parser opens files that were cut off, and drops numbers it cannot read; both would lose walls
without a word.
"""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from satAOI_geo.errors import LimitError, UnreadableError

MAX_FILE_BYTES: Final = 2_000_000_000
SCHEMAS: Final = ("IFC2X3", "IFC4", "IFC4X3_ADD2")
"""Schemas that the parser knows, by the names that it knows."""

ALIASES: Final = {
    "IFC2X3_TC1": "IFC2X3",
    "IFC2X3_FINAL": "IFC2X3",
    "IFC4_ADD1": "IFC4",
    "IFC4_ADD2": "IFC4",
    "IFC4_ADD2_TC1": "IFC4",
    "IFC4X1": "IFC4",
    "IFC4X2": "IFC4",
    "IFC4X3": "IFC4X3_ADD2",
    "IFC4X3_TC1": "IFC4X3_ADD2",
    "IFC4X3_ADD1": "IFC4X3_ADD2",
}
"""Other names of these schemas, earlier editions, and drafts that only add to them: what they add
is told of as unknown. Other drafts (IFC4X3_RC1 and so on) call the same things differently."""

TRAILER: Final = b"END-ISO-10303-21"
TAIL_BYTES: Final = 4096

OTHER_KINDS: Final = (
    (b"version https://git-lfs", "a Git LFS pointer: fetch the model itself with `git lfs pull`"),
    (b"\x1f\x8b", "packed with gzip: unpack it first"),
    (b"PK\x03\x04", "a ZIP archive: unpack it first"),
    (b"%PDF", "a PDF: export the model as IFC (STEP)"),
    (b"<?xml", "XML: export the model as IFC in STEP format"),
    (b"<", "a web page or XML: fetch or export the model as IFC in STEP format"),
    (b"AC10", "a DWG: export the model as IFC (STEP)"),
)
SCHEMA_PATTERN: Final = re.compile(rb"FILE_SCHEMA\s*\(\s*\(\s*'([^']*)'", re.IGNORECASE)
# strings and comments are matched first so that a "nan" in a name is not mistaken for a number
NOT_A_NUMBER: Final = re.compile(
    rb"'(?:[^']|'')*'|/\*.*?\*/|[(,]\s*[-+]?(nan|inf(?:inity)?)\s*(?=[,)])",
    re.IGNORECASE | re.DOTALL,
)
ENTITY_ID: Final = re.compile(rb"#(\d+)\s*=")


def read_bytes(path: Path) -> bytes:
    """The file's bytes, checked to be a whole IFC model of a known schema.

    Raises:
        UnreadableError: If there is no such file, it is of another kind, of another schema, or
            was cut off.
        LimitError: If it is larger than `MAX_FILE_BYTES`.
    """
    try:
        size_bytes = path.stat().st_size
        if size_bytes > MAX_FILE_BYTES:
            raise LimitError(
                f"'{path}' has {size_bytes:,} bytes, more than {MAX_FILE_BYTES:,}; export the "
                "storey alone",
                limit="file-bytes",
                value=size_bytes,
                allowed=MAX_FILE_BYTES,
            )
        data = path.read_bytes()
    except OSError as error:
        raise UnreadableError(f"cannot read '{path}': {error.strerror or error}") from error
    _check_kind(path, data)
    _check_schema(path, data)
    if TRAILER not in data[-TAIL_BYTES:]:
        raise UnreadableError(
            f"'{path}' was cut off: it does not end with {TRAILER.decode()}; export or copy it "
            "again"
        )
    return data


def _check_kind(path: Path, data: bytes) -> None:
    start = data[:TAIL_BYTES].removeprefix(b"\xef\xbb\xbf").lstrip()
    if not start:
        raise UnreadableError(f"'{path}' is empty; export the model again")
    if b"ISO-10303-21" in start:
        return
    for magic, what in OTHER_KINDS:
        if start.startswith(magic):
            raise UnreadableError(f"'{path}' is not an IFC model but {what}")
    raise UnreadableError(
        f"'{path}' is not an IFC model: it does not begin with ISO-10303-21; export it again"
    )


def _check_schema(path: Path, data: bytes) -> None:
    match = SCHEMA_PATTERN.search(data)
    if match is None:
        raise UnreadableError(f"'{path}' names no schema (FILE_SCHEMA); export it again")
    schema = schema_in(match)
    if schema not in SCHEMAS and schema not in ALIASES:
        raise UnreadableError(
            f"'{path}' uses schema {schema}, which cannot be read; export it as "
            f"{', '.join(SCHEMAS[:-1])} or {SCHEMAS[-1]}"
        )


def schema_in(match: re.Match[bytes]) -> str:
    """The schema's name, of a match of `SCHEMA_PATTERN`."""
    return match[1].decode("latin-1").strip().upper()


def ids_with_bad_numbers(data: bytes) -> Iterator[int]:
    """Ids of the entities that hold a number which is not one, in the file's order."""
    for match in NOT_A_NUMBER.finditer(data):
        if match[1] is not None:
            statement = data.rfind(b";", 0, match.start()) + 1
            entity = ENTITY_ID.search(data, statement, match.start())
            if entity is not None:
                yield int(entity[1])
