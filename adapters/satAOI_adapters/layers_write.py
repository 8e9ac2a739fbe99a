"""A drawing's layers as a file for `--layers`, to be edited: read with it, the plan is the same."""

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Final

from satAOI_adapters.files import written_whole
from satAOI_adapters.layers import EXACT
from satAOI_adapters.meanings import Certainty, LayerMap, Meaning, Named, Verdict
from satAOI_adapters.settings_read import toml_string

HEAD: Final = """\
# Which layer of {drawing} is what, as satAOI-geo reads it. Move names to other kinds as needed,
# then give this file with --layers.
#
# Kinds of obstacle: wall column hole embedded equipment; a window stops the robot as a wall does.
# Others: door, floor (its outline), room (an outline around what is free), ignore.
# A name after `=` is this name and no other. Layers that the file does not name are read
# {rest}.
"""

SURE: Final = {Certainty.GIVEN, Certainty.CERTAIN}
"""How sure a name has to be not to be marked."""


def write(path: Path, layers: LayerMap, *, drawing: str, never_over: Iterable[Path]) -> None:
    """Write the file, whole or not at all.

    Args:
        path: The file.
        layers: The drawing's layers and blocks.
        drawing: The drawing's name.
        never_over: Files that must survive.

    Raises:
        InputError: If the file must not or cannot be written.
    """
    with written_whole(path, never_over=never_over) as stream:
        stream.write(toml_of(layers, drawing).encode())


def toml_of(layers: LayerMap, drawing: str) -> str:
    """The text of the file."""
    rest = "as unknown" if layers.is_own else "by the built-in table"
    lines = [
        *HEAD.format(drawing=toml_string(_encodable(drawing)), rest=rest).splitlines(),
        *(["", "replace = true"] if layers.is_own else []),
        "",
        "[layers]",
        *_by_meaning(layers.layers),
        *_unknown([named for named in layers.layers if named.verdict.meaning is None]),
        "",
        "[blocks]",
        *_by_meaning(layers.blocks),
    ]
    return "\n".join(lines) + "\n"


def _by_meaning(names: Sequence[Named]) -> Iterator[str]:
    for meaning in Meaning:
        own = [named for named in names if named.verdict.meaning is meaning]
        if own:
            yield f"{meaning} = ["
            yield from (f"    {_entry(named)}" for named in own)
            yield "]"


def _unknown(names: Sequence[Named]) -> Iterator[str]:
    if names:
        yield ""
        yield "# Not known; move each to the kind that it is:"
        yield from (f"#   {_entry(named)}" for named in names)


def _entry(named: Named) -> str:
    """The pattern for a name, and what a person needs to judge it."""
    drawn = ", ".join(f"{n} {kind}" for kind, n in named.counts.items())
    return f"{toml_string(_pattern(named.name))},  # {drawn}{_doubt(named.verdict)}"


def _doubt(verdict: Verdict) -> str:
    if verdict.meaning is None or verdict.certainty in SURE:
        return ""
    return f"; check: likely by {toml_string(verdict.pattern)}"


def _pattern(name: str) -> str:
    """A pattern for exactly this name; where bytes in it are no text, for any letter there."""
    if _encodable(name) == name:
        return EXACT + name
    as_glob = name.replace("[", "[[]").replace("*", "[*]").replace("?", "[?]")
    return _encodable(as_glob)


def _encodable(name: str) -> str:
    """The name with `?` for bytes that are no text."""
    return name.encode(errors="replace").decode()
