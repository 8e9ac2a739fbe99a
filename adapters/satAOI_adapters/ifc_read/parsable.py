r"""A copy of a model that the parser understands, where it would not understand the model itself.

The parser knows each schema by one name, refuses a byte order mark, and drops bytes beyond ASCII
from names without a word. In the copy the schema has the name that the parser knows, and such a
byte is escaped, `\X\E4`, so that it comes through.
"""

import codecs
import re
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from satAOI_adapters.ifc_read.text import ALIASES, SCHEMA_PATTERN, schema_in
from satAOI_geo.plan import Finding

BEYOND_ASCII: Final = re.compile(rb"[\x80-\xff]")


@contextmanager
def parsable(path: Path, data: bytes) -> Iterator[Path]:
    """Where a model can be parsed: its own place or, while this lasts, that of a changed copy.

    Args:
        path: The model.
        data: Its bytes, checked by `text.read_bytes`.
    """
    copy = SCHEMA_PATTERN.sub(_known_schema, data, count=1).removeprefix(codecs.BOM_UTF8)
    if not copy.isascii():
        copy = BEYOND_ASCII.sub(lambda match: b"\\X\\%02X" % ord(match[0]), copy)
    if copy == data:
        yield path
        return
    with tempfile.TemporaryDirectory(prefix="satAOI-geo-") as folder:
        place = Path(folder) / "copy.ifc"
        place.write_bytes(copy)
        yield place


def has_raw_names(data: bytes) -> bool:
    """Whether a model holds bytes beyond ASCII, which mean nothing in a STEP file."""
    return not data.removeprefix(codecs.BOM_UTF8).isascii()


def alias_findings(data: bytes) -> tuple[Finding, ...]:
    """What to say of a schema that was read by another name."""
    match = SCHEMA_PATTERN.search(data)
    schema = "" if match is None else schema_in(match)
    if schema not in ALIASES:
        return ()
    return (
        Finding(
            "schema-alias",
            f"the schema {schema} was read as {ALIASES[schema]}",
            "compare the picture of what was read, or export the model in that schema",
        ),
    )


def _known_schema(match: re.Match[bytes]) -> bytes:
    schema = schema_in(match)
    known = ALIASES.get(schema)
    return match[0] if known is None else match[0].replace(match[1], known.encode())
