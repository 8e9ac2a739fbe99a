r"""Names in an encoding that the model does not declare, spelled as they were meant.

A STEP file has escapes of its own for all characters. Some programs write the bytes of a code page
instead, raw or escaped one by one as if they were Latin-1: `1\X\8AK` is meant to be 1階. The parser
hands out one character for each byte. The names themselves tell the encoding: the one in which most
of their letters could stand where they do.
"""

import unicodedata
from collections.abc import Collection
from dataclasses import dataclass
from typing import Final

import ifcopenshell

from satAOI_geo.plan import Finding


@dataclass(frozen=True, slots=True)
class Encoding:
    """An encoding, and which of its characters of two bytes are in daily use.

    In the large ones nearly any two bytes are some character, most of them hardly ever written.

    Attributes:
        name: As Python knows it.
        leads: First bytes of characters in daily use.
        least_trail: Least second byte of these.
    """

    name: str
    leads: Collection[int] = ()
    least_trail: int = 0

    def uses_daily(self, char: str) -> bool:
        """Whether a character is in daily use."""
        code = char.encode(self.name)
        return not self.leads or (code[0] in self.leads and code[-1] >= self.least_trail)


ENCODINGS: Final = (
    Encoding("utf-8"),
    # up to the end of the first level of the JIS; of GB 2312; of Big5
    Encoding("cp932", range(0x81, 0x99)),
    Encoding("gbk", (*range(0xA1, 0xA4), *range(0xB0, 0xD8)), 0xA1),
    Encoding("big5", range(0xA1, 0xC7)),
    Encoding("cp1251"),
    Encoding("cp1252"),
    Encoding("mac-roman"),
)
"""Encodings that are tried; of two that make as much sense, the first."""


def respell_names(model: ifcopenshell.file, *, raw: bool) -> tuple[Finding, ...]:
    """Give the products of an open model the names that were meant.

    Args:
        model: The model, which is changed in memory only.
        raw: Whether the file holds bytes beyond ASCII. In one that does not, names of Latin-1 are
            what they say, unless some hold control characters, which nobody types.
    """
    products = [product for product in model.by_type("IfcProduct") if _is_bytes(product.Name)]
    names = sorted({product.Name for product in products})
    if not names or not (raw or any(_has_controls(name) for name in names)):
        return ()
    remedy = "export the model with names in the escapes of STEP if they are wrong"
    encoding = encoding_of(names)
    if encoding is None:
        message = f"names are in no known encoding, for example '{printable(names[0])}'"
        return (Finding("encoding", message, remedy),)
    for product in products:
        product.Name = respelled(product.Name, encoding)
    example = respelled(names[0], encoding)
    message = f"names are read as {encoding.name}, which the model does not say: '{example}'"
    return (Finding("encoding", message, remedy),)


def printable(name: str) -> str:
    """A name without control characters, which a wrong code page leaves behind."""
    return "".join(c if c.isprintable() else f"\\x{ord(c):02x}" for c in name)


def encoding_of(names: Collection[str]) -> Encoding | None:
    """The encoding in which names make most sense, None if they do in none.

    Args:
        names: One character for each byte.
    """
    senses = {encoding: _sense(names, encoding) for encoding in ENCODINGS}
    best = max(ENCODINGS, key=lambda encoding: senses[encoding])
    return best if senses[best] > 0 else None


def respelled(name: str, encoding: Encoding) -> str:
    """A name of one character for each byte, as it was meant."""
    return name.encode("latin-1").decode(encoding.name)


def _is_bytes(name: str | None) -> bool:
    return name is not None and not name.isascii() and max(name) <= "\xff"


def _has_controls(name: str) -> bool:
    return any("\x80" <= char <= "\x9f" for char in name)


def _sense(names: Collection[str], encoding: Encoding) -> int:
    """Bytes whose characters can stand where they do, less those that cannot.

    0 if there are bytes that the encoding lacks.
    """
    try:
        texts = [respelled(name, encoding) for name in names]
    except UnicodeDecodeError:
        return 0
    sense = 0
    for text in texts:
        padded = f" {text} "
        for before, char, after in zip(padded, padded[1:], padded[2:], strict=False):
            if not char.isascii():
                n_bytes = len(char.encode(encoding.name))
                fits = encoding.uses_daily(char) and _can_stand(before, char, after)
                sense += n_bytes if fits else -n_bytes
    return sense


def _can_stand(before: str, char: str, after: str) -> bool:
    """Whether a character can stand between two others."""
    if not char.isalpha():
        return char.isprintable()
    if unicodedata.name(char).startswith("LATIN"):
        # AÉB, Éa and aéb, but neither aÉb nor AéB
        return not (
            (char.isupper() and before.isalpha() and (before.islower() or after.islower()))
            or (char.islower() and before.isupper() and after.isupper())
        )
    beside = [other.isascii() and other.isalpha() for other in (before, after)]
    # an alphabet is not mixed with another one within a word, signs for words may stand beside one
    return not (any(beside) if char.upper() != char.lower() else all(beside))
