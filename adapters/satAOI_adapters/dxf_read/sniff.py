"""What a file really is, whatever its name says: told from its first and last bytes."""

import re
from typing import Final

from satAOI_geo.errors import UnreadableError

BINARY_DXF: Final = b"AutoCAD Binary DXF\r\n\x1a\x00"
"""How a binary DXF begins."""

STRANGERS: Final = (
    (b"AC10", "a DWG drawing", "save it as DXF (R2010 or newer) in the program it was made with"),
    (b"%PDF", "a PDF", "ask for the DXF it was printed from"),
    (b"PK\x03\x04", "a ZIP archive", "unpack it first"),
    (b"\x1f\x8b", "a gzip archive", "unpack it first"),
    (b"\x89PNG", "a PNG picture", "ask for the DXF it was exported from"),
    (b"\xff\xd8\xff", "a JPEG picture", "ask for the DXF it was exported from"),
    (b"\xd0\xcf\x11\xe0", "an old Office document", "ask for the DXF it was made from"),
    (b"ISO-10303-21", "an IFC or STEP model", "give it a name that ends in .ifc"),
    (b"version https://git-lfs", "a Git LFS pointer", "fetch the drawing itself with git lfs pull"),
    (b"<", "a web page or XML", "download the drawing itself"),
    (b"\xff\xfe", "a text in UTF-16", "save it again as DXF"),
    (b"\xfe\xff", "a text in UTF-16", "save it again as DXF"),
)
"""How files begin that are no DXF: first bytes, what they are, what to do."""

END_MARK: Final = re.compile(rb"^[ \t]*0[ \t]*\r?\n[ \t]*EOF\s*?$", re.MULTILINE)
"""Group code 0, value EOF: the last thing in a DXF."""

FIRST_PAIR: Final = re.compile(rb"\s*(?:999[ \t]*\r?\n[^\n]*\n\s*)*0[ \t]*\r?\n[ \t]*SECTION")
"""A DXF begins with a section, after comments."""


def check(content: bytes, name: str) -> None:
    """Refuse what is no DXF, or only the beginning of one.

    Args:
        content: The file's bytes.
        name: The file's name, for messages.

    Raises:
        UnreadableError: If the bytes are not those of a whole DXF drawing.
    """
    start = content[:4096].removeprefix(b"\xef\xbb\xbf").lstrip()
    if not start:
        raise UnreadableError(f"'{name}' is empty; copy or export it again")
    if content.startswith(BINARY_DXF):
        is_whole = b"EOF" in content[-64:]
    else:
        for first, what, remedy in STRANGERS:
            if start.startswith(first):
                raise UnreadableError(f"'{name}' is {what}, not a DXF drawing; {remedy}")
        if not FIRST_PAIR.match(start):
            raise UnreadableError(
                f"'{name}' is not a DXF drawing: it does not begin with a section; export it again"
            )
        is_whole = END_MARK.search(content) is not None
    if not is_whole:
        raise UnreadableError(
            f"'{name}' is cut off: its end mark (EOF) is missing after {len(content):,} bytes; "
            "copy or export it again"
        )
