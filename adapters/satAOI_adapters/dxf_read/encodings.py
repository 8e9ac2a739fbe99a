"""Which encoding the names in a DXF are written in, whatever its header claims.

Programs write GBK under a Western code page and UTF-8 under a Chinese one. Nothing fails then,
the names only turn into others, and no layer is recognised. The names themselves tell: the
encoding in which most of them mean something is the right one. By chance a name or two mean
something in a wrong one, too: of the letters of Turkish some become a Japanese door. So the
encoding declared is left only for names that look like writing, and for one name only where it
does not make writing of all itself. Bytes that are UTF-8 are so by chance only where two of them
make a Chinese character, so they are hardly ever of a code page of single bytes.
"""

import codecs
import re
import unicodedata
from dataclasses import dataclass
from typing import Final

from ezdxf.lldxf.encoding import (
    decode_dxf_unicode,
    decode_mif_to_unicode,
    has_dxf_unicode,
    has_mif_encoding,
)
from ezdxf.tools.codepage import toencoding

from satAOI_adapters.layers import WORD, LayerTable
from satAOI_geo.errors import InputError
from satAOI_geo.plan import Finding

UTF8_SINCE: Final = "AC1021"
"""Drawings of R2007 and newer are UTF-8, older ones in the code page they name."""

CANDIDATES: Final = ("utf-8", "gbk", "big5", "cp932", "cp949", "cp1251", "cp1250", "cp1252")
"""Encodings that are tried when the one declared makes no sense, the commonest first."""

TWO_BYTES: Final = ("gbk", "cp932", "cp949", "cp950")
"""Code pages of which two bytes that make a character may also make one of UTF-8."""

LEAD: Final = 2
"""Names that must mean more in another encoding than in one in which all look like writing."""

EASTERN: Final = frozenset({"CJK", "HIRAGANA", "KATAKANA", "KATAKANA-HIRAGANA", "HALFWIDTH"})
"""Scripts that Chinese and Japanese mix, by the first word of their characters' names."""

SIGNS: Final = ("S", "C")
"""Categories of characters that names are seldom written with: symbols and controls."""

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
    best = _known(option) if option is not None else _best(content, names, declared, table)
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
    if content.startswith(codecs.BOM_UTF8):
        return "utf-8"
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


def _is_utf8(content: bytes) -> bool:
    try:
        content.decode("utf-8")
    except UnicodeDecodeError:
        return False
    return True


def _best(content: bytes, names: list[bytes], declared: str, table: LayerTable) -> str:
    """The encoding in which most names mean something; in doubt the one declared."""
    is_utf8 = _is_utf8(content)
    if not names or (declared == "utf-8" and is_utf8):
        return declared
    likely = "utf-8" if is_utf8 and declared not in TWO_BYTES else declared
    texts = {encoding: _texts(names, encoding) for encoding in (likely, *CANDIDATES)}
    written = {encoding: list(filter(_looks_written, texts[encoding])) for encoding in texts}
    sense = {encoding: _n_meant(written[encoding], table) for encoding in texts}
    best = max(sense, key=lambda encoding: (sense[encoding], len(written[encoding])))
    if not texts[likely]:
        return best
    is_writing = len(written[likely]) == len(names)
    lead = LEAD if is_writing and not (is_utf8 and best == "utf-8") else 1
    return best if sense[best] - _n_meant(texts[likely], table) >= lead else likely


def _texts(names: list[bytes], encoding: str) -> list[str]:
    """Names in an encoding; none if one of them is impossible in it."""
    try:
        return [name.decode(encoding) for name in names]
    except UnicodeDecodeError:
        return []


def _n_meant(names: list[str], table: LayerTable) -> int:
    """How many names mean something."""
    return sum(table.of_layer(name).meaning is not None for name in names)


def _looks_written(name: str) -> bool:
    """Whether each word is of one script, and if of Latin, mostly of letters without accents.

    Before and after Chinese and Japanese stand Latin capitals: `A墙`, but no `T眉ren`.
    """
    if any(unicodedata.category(c)[0] in SIGNS for c in name if not c.isascii()):
        return False
    return all(_is_one_script(word) for word in WORD.findall(name) if not word.isascii())


def _is_one_script(word: str) -> bool:
    latin = [c for c in word if _script(c) == "LATIN"]
    others = {_script(c) for c in word} - {"LATIN"}
    if not others:
        return 2 * sum(c.isascii() for c in latin) > len(latin)
    is_one = len(others) == 1 or others <= EASTERN
    return is_one and all(c.isascii() and c.isupper() for c in latin)


def _script(letter: str) -> str:
    """`LATIN`, `CJK`: the first word of a character's name."""
    return unicodedata.name(letter, "").partition(" ")[0]


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
