"""Which encoding the names in a DXF are written in, whatever its header claims.

Programs write GBK under a Western code page and UTF-8 under a Chinese one. Nothing fails then,
the names only turn into others, and no layer is recognised. The names themselves tell: the
encoding in which most of them mean something is the right one.
"""

import codecs
import re
from dataclasses import dataclass
from typing import Final

from ezdxf.lldxf.encoding import (
    decode_dxf_unicode,
    decode_mif_to_unicode,
    has_dxf_unicode,
    has_mif_encoding,
)
from ezdxf.tools.codepage import toencoding

from satAOI_adapters.layers import LayerTable
from satAOI_geo.errors import InputError
from satAOI_geo.plan import Finding

UTF8_SINCE: Final = "AC1021"
"""Drawings of R2007 and newer are UTF-8, older ones in the code page they name."""

CANDIDATES: Final = ("utf-8", "gbk", "big5", "cp932", "cp949", "cp1251", "cp1250", "cp1252")
"""Encodings that are tried when the one declared makes no sense, the commonest first."""

LAYER_NAME: Final = re.compile(
    rb"^[ \t]*8[ \t]*\r?\n[ \t]*([^\r\n]*[\x80-\xff][^\r\n]*)", re.MULTILINE
)
"""Group code 8, the layer of an entity, with a name beyond ASCII."""

VERSION: Final = re.compile(rb"\$ACADVER\s+1\s+(AC\d+)")
CODE_PAGE: Final = re.compile(rb"\$DWGCODEPAGE\s+3\s+([^\s]+)")


@dataclass(frozen=True, slots=True)
class Decoded:
    r"""A drawing's text.

    Attributes:
        text: With all escapes (`\U+67F1`) resolved.
        encoding: In which the bytes are read, by its name in Python.
        findings: What was noticed about the encoding.
    """

    text: str
    encoding: str
    findings: tuple[Finding, ...]


def decoded(content: bytes, table: LayerTable, option: str | None) -> Decoded:
    """The text of a drawing in the encoding that fits.

    Args:
        content: The bytes of a text DXF.
        table: Layer names that mean something.
        option: The encoding that the user names.

    Raises:
        InputError: If the user names an encoding that does not exist.
    """
    declared = _declared(content)
    names = sorted(set(LAYER_NAME.findall(content)))
    best = _known(option) if option is not None else _best(names, declared, table)
    text = content.removeprefix(codecs.BOM_UTF8).decode(best, errors="surrogateescape")
    if has_dxf_unicode(text):
        text = decode_dxf_unicode(text)
    if has_mif_encoding(text):
        text = decode_mif_to_unicode(text)
    if not names or option is not None:
        return Decoded(text, best, ())
    return Decoded(text, best, _findings(names, declared, best))


def _declared(content: bytes) -> str:
    """The encoding that the header names."""
    head = content[:65536]
    version = VERSION.search(head)
    if version is not None and version[1].decode() >= UTF8_SINCE:
        return "utf-8"
    page = CODE_PAGE.search(head)
    return "cp1252" if page is None else toencoding(page[1].decode("ascii", "replace"))


def _known(option: str) -> str:
    try:
        return codecs.lookup(option).name
    except LookupError as error:
        raise InputError(
            f"unknown encoding '{option}'; give one like utf-8, gbk, big5, cp1251 or cp1252"
        ) from error


def _best(names: list[bytes], declared: str, table: LayerTable) -> str:
    """The encoding in which most names mean something; in doubt the one declared."""
    if not names:
        return declared
    return max((declared, *CANDIDATES), key=lambda encoding: _sense(names, encoding, table))


def _sense(names: list[bytes], encoding: str, table: LayerTable) -> int:
    """How many names mean something in an encoding; -1 if one is impossible in it."""
    try:
        texts = [name.decode(encoding) for name in names]
    except UnicodeDecodeError:
        return -1
    return sum(table.of_layer(text).meaning is not None for text in texts)


def _findings(names: list[bytes], declared: str, best: str) -> tuple[Finding, ...]:
    """What to say when names were impossible or made more sense in another encoding."""
    first = names[0].decode(best, "replace")
    if best != declared:
        claimed = names[0].decode(declared, "replace")
        return (
            Finding(
                "encoding",
                f"layer names are read as {best}, not as {declared} as the header says: "
                f"'{first}', not '{claimed}'",
                "give --encoding if the names are still wrong",
            ),
        )
    if "\ufffd" in first:
        return (
            Finding(
                "encoding",
                f"layer names such as '{first}' are not readable as {declared}",
                "give --encoding, for example --encoding gbk",
            ),
        )
    return ()
