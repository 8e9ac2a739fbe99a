"""Letters: a typeface that has those of a text, how wide lines get, where they break."""

import unicodedata
from collections.abc import Iterable, Iterator
from functools import cache
from typing import Final, TypeAlias

from PIL import ImageFont

Font: TypeAlias = ImageFont.FreeTypeFont | ImageFont.ImageFont

FACES: Final = (
    "DejaVuSans.ttf",
    "LiberationSans-Regular.ttf",
    "Arial.ttf",
    "arial.ttf",
    "NotoSansCJK-Regular.ttc",
    "wqy-zenhei.ttc",
    "DroidSansFallbackFull.ttf",
    "msyh.ttc",
    "PingFang.ttc",
    "Arial Unicode.ttf",
)
"""Typefaces of the usual systems; the last ones for letters that the first ones lack."""

PROBE_SIZE: Final = 16.0
"""Size at which letters are looked for."""

NO_LETTER: Final = "\uffff"
"""Drawn as what a typeface shows for letters it lacks."""


@cache
def font(face: str, size: float) -> Font:
    """A typeface at a size; an empty name is the one that comes with the library."""
    return ImageFont.truetype(face, size) if face else ImageFont.load_default(size)


def face_for(texts: Iterable[str]) -> str:
    """The first typeface of this machine that has all letters, or most of them."""
    letters = frozenset("".join(texts))
    best, most = "", -1
    for face in _faces():
        n_known = sum(_has(face, letter) for letter in letters)
        if n_known > most:
            best, most = face, n_known
        if n_known == len(letters):
            break
    return best


def spelt(text: str, face: str) -> str:
    """The text in letters that a typeface has: plain for fancy ones, codes for unknown ones."""
    return "".join(_spelt(letter, face) for letter in text)


def _spelt(letter: str, face: str) -> str:
    if _has(face, letter):
        return letter
    plain = [c for c in unicodedata.normalize("NFKD", letter) if not unicodedata.combining(c)]
    if plain and all(_has(face, c) for c in plain):
        return "".join(plain)
    return letter.encode("ascii", "backslashreplace").decode()


def wrapped(text: str, face: str, size: float, width: float) -> Iterator[str]:
    """The text in lines of at most this width, broken at blanks; a longer word has its own.

    Letters that the typeface lacks are as wide as what stands for them.
    """
    line = ""
    for word in text.split():
        longer = f"{line} {word}" if line else word
        if line and font(face, size).getlength(spelt(longer, face)) > width:
            yield line
            line = word
        else:
            line = longer
    if line:
        yield line


def _faces() -> Iterator[str]:
    for face in FACES:
        try:
            font(face, PROBE_SIZE)
        except OSError:
            continue
        yield face
    yield ""


@cache
def _has(face: str, letter: str) -> bool:
    drawn = font(face, PROBE_SIZE)
    return bytes(drawn.getmask(letter)) != bytes(drawn.getmask(NO_LETTER))
