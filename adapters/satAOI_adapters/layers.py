"""What a layer is, by its name: a table of patterns, kept as data in `layers.toml`.

The built-in table knows the names of several offices and languages; a user's own TOML file of
the same form goes before it, or takes its place with `replace = true`.
"""

import re
import unicodedata
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Final

from satAOI_adapters.meanings import Certainty, Meaning, Verdict
from satAOI_adapters.settings_read import keys_of, read_settings

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails

BUILT_IN: Final = Path(__file__).with_name("layers.toml")
"""The table that comes with the program."""

XREF_PREFIX: Final = re.compile(r"^.*(\$\d+\$|\|)")
"""`plan$0$` of a bound external reference, `plan|` of an attached one."""

WORD: Final = re.compile(r"[^\W\d_]+")
"""A run of letters: digits, signs and blanks part the words of a name."""

HUMP: Final = re.compile(r"(?<=[a-z])(?=[A-Z])")
"""Where `OuterWall` parts into two words."""


PLAIN: Final = str.maketrans(
    {"ı": "i", "ł": "l", "đ": "d", "ð": "d", "ø": "o", "æ": "ae", "œ": "oe"}
)
"""Letters that are no others with an accent, and what is written in their place without them."""

EXACT: Final = "="
"""In front of a name: this name and no other, letter for letter."""


@dataclass(frozen=True, slots=True)
class Patterns:
    """Patterns in an order, sorted by how a name is compared with them.

    Attributes:
        texts: As written in the table, in their order.
        names: Place in that order of each that is a name itself.
        words: Of each that is a word, folded.
        globs: Place of each that is a glob, and the glob, folded.
        plain_globs: Those of them that a name in ASCII can fit.
    """

    texts: tuple[str, ...]
    names: Mapping[str, int]
    words: Mapping[str, int]
    globs: tuple[tuple[int, str], ...]
    plain_globs: tuple[tuple[int, str], ...]

    @classmethod
    def of(cls, texts: Iterable[str]) -> "Patterns":
        """Patterns as they are written."""
        texts = tuple(texts)
        names: dict[str, int] = {}
        words: dict[str, int] = {}
        globs = []
        for place, text in enumerate(texts):
            if text.startswith(EXACT):
                names.setdefault(text[len(EXACT) :], place)
            elif "*" in text or "?" in text:
                globs.append((place, _folded(text)))
            else:
                words.setdefault(_folded(text), place)
        # [!ж] is the only piece of a glob that fits other letters than its own
        plain_globs = tuple((i, glob) for i, glob in globs if glob.isascii() or "[" in glob)
        return cls(texts, names, words, tuple(globs), plain_globs)

    def first(self, name: str) -> str | None:
        """The first that fits: a name itself, any word of the name, or a glob the whole name."""
        folded = _folded(name)
        n_patterns = len(self.texts)
        found = [self.words.get(word, n_patterns) for word in (folded, *_words(name))]
        first = min(self.names.get(name, n_patterns), *found)
        # most globs are of scripts that most names have no letter of
        globs = self.plain_globs if folded.isascii() else self.globs
        earlier = (place for place, glob in globs if place < first and is_like(folded, glob))
        first = next(earlier, first)
        return self.texts[first] if first < n_patterns else None


@dataclass(frozen=True, slots=True)
class Rule:
    """Patterns of one meaning; a name must match one of `patterns` and none of `exceptions`."""

    meaning: Meaning
    patterns: Patterns
    exceptions: Patterns
    given: bool

    def verdict(self, name: str) -> Verdict | None:
        """The first pattern that matches the name, or None."""
        pattern = self.patterns.first(name)
        if pattern is None or self.exceptions.first(name) is not None:
            return None
        return Verdict(self.meaning, pattern, self._certainty(pattern, name))

    def _certainty(self, pattern: str, name: str) -> Certainty:
        if self.given:
            return Certainty.GIVEN
        whole = _folded(pattern) == _folded(name)
        return Certainty.CERTAIN if whole else Certainty.LIKELY


@dataclass(frozen=True, slots=True)
class LayerTable:
    """Which layer and which block means what: the first rule that matches decides.

    Attributes:
        layers: Rules for layers.
        blocks: Rules for blocks.
        is_own: Whether the user's file takes the place of the built-in table.
    """

    layers: tuple[Rule, ...]
    blocks: tuple[Rule, ...]
    is_own: bool = False

    def of_layer(self, name: str) -> Verdict:
        """What a layer of this name means; prefixes of external references are dropped."""
        return _first(self.layers, without_xref_prefix(name))

    def names_not_among(self, layers: Iterable[str]) -> list[str]:
        """Names that the user's file gives letter for letter, and that none of some layers has."""
        there = {own for name in layers for own in (name, without_xref_prefix(name))}
        given = [rule for rule in self.layers if rule.given]
        names = [
            *(rule.patterns.names for rule in given),
            *(rule.exceptions.names for rule in given),
        ]
        return [name for each in names for name in each if name not in there]

    def of_fill(self, name: str) -> Verdict:
        """What the fills on a layer of this name fill: a layer of patterns for walls, walls."""
        telling = tuple(rule for rule in self.layers if rule.meaning is not Meaning.IGNORE)
        return _first(telling, without_xref_prefix(name))

    def of_block(self, name: str) -> Verdict:
        """What a block of this name means."""
        return _first(self.blocks, without_xref_prefix(name))


def layer_table(own: Path | None = None) -> LayerTable:
    """The built-in table, with the user's file before it or in its place.

    Raises:
        InputError: If the user's file is missing, not TOML, or names an unknown kind.
    """
    built_in = _built_in()
    if own is None:
        return built_in
    from satAOI_adapters.layers_file import LayersFile

    file = read_settings(own, LayersFile, what="layer file", complaint=_complaint)
    layers = _rules(file.layers.items(), given=True)
    blocks = _rules(file.blocks.items(), given=True)
    if file.replace:
        return LayerTable(layers, blocks, is_own=True)
    return LayerTable(layers + built_in.layers, blocks + built_in.blocks)


def without_xref_prefix(name: str) -> str:
    """The layer's own name: `plan$0$A-WALL` and `plan|A-WALL` are A-WALL."""
    return XREF_PREFIX.sub("", name) or name


@cache
def _built_in() -> LayerTable:
    # our own file fits the schema of everybody's; a test holds it to that
    keys = keys_of(BUILT_IN, what="layer file")
    return LayerTable(
        _rules(keys["layers"].items(), given=False), _rules(keys["blocks"].items(), given=False)
    )


def _complaint(key: str, fault: "ErrorDetails") -> str:
    """What is wrong with one key of a layer file, and what to write there."""
    if fault["loc"][-1] == "[key]":
        return f"unknown kind '{key}'; known are {', '.join(Meaning)}"
    if fault["loc"][0] in {"layers", "blocks"}:
        return f"'{key}' is {fault['input']!r}; give a list of patterns, like [\"A-WALL*\"]"
    return f"'{key}' is {fault['input']!r}; give true or false"


def _rules(table: Iterable[tuple[str, list[str]]], *, given: bool) -> tuple[Rule, ...]:
    return tuple(
        Rule(
            Meaning(meaning),
            Patterns.of(pattern for pattern in patterns if not pattern.startswith("!")),
            Patterns.of(pattern[1:] for pattern in patterns if pattern.startswith("!")),
            given,
        )
        for meaning, patterns in table
    )


def _first(rules: tuple[Rule, ...], name: str) -> Verdict:
    verdicts = (rule.verdict(name) for rule in rules)
    return next((verdict for verdict in verdicts if verdict is not None), Verdict())


def is_like(name: str, pattern: str) -> bool:
    """Whether a glob fits the whole name.

    One with no sign but `*` is compared piece by piece: to make regular expressions of the table's
    patterns takes as long as to read a small drawing.
    """
    if "*" not in pattern or "?" in pattern or "[" in pattern:
        return fnmatchcase(name, pattern)
    first, *middle, last = pattern.split("*")
    if not name.startswith(first):
        return False
    done = len(first)
    for part in middle:
        begin = name.find(part, done)
        if begin < 0:
            return False
        done = begin + len(part)
    return name.endswith(last) and done + len(last) <= len(name)


@cache
def _words(name: str) -> frozenset[str]:
    texts = (_folded(name), _folded(HUMP.sub(" ", name)))
    return frozenset(word for text in texts for word in WORD.findall(text))


@cache
def _folded(text: str) -> str:
    """The text without case, accents and letters that only some languages have."""
    if text.isascii():
        return text.lower()
    decomposed = unicodedata.normalize("NFKD", text.casefold())
    return "".join(c for c in decomposed if not unicodedata.combining(c)).translate(PLAIN)
