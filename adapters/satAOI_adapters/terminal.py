"""What a person sees: errors, notes and progress on standard error, tables on standard output."""

import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from itertools import groupby
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from rich.console import Console

    from satAOI_geo.plan import Finding

TOLD_OF_A_SORT = 3
"""Findings of one sort told in full; a page of them would hide the figures."""


def accept_any_text() -> None:
    """Let no character of a layer or file name stop a line from being printed.

    A name may hold characters the terminal's encoding lacks, or bytes that are no text at all. And
    whoever starts the program may have closed what it prints to.
    """
    sys.stdout = sys.stdout or _nowhere()
    sys.stderr = sys.stderr or _nowhere()
    for stream in (sys.stdout, sys.stderr):
        # a stream replaced by a caller need not be a text file
        reconfigure = getattr(stream, "reconfigure", None)
        if reconfigure is not None:
            reconfigure(errors="backslashreplace")


def _nowhere() -> TextIO:
    """A stream for the rest of the run whose text nobody reads."""
    return open(os.devnull, "w", encoding="utf-8")  # noqa: PTH123  pathlib is slow to load, and nobody closes it


def say_error(message: str) -> None:
    """One line, whatever the message holds."""
    _say("error", "bold red", message)


def say_note(message: str) -> None:
    """One line of talk."""
    _say("note", "yellow", message)


def _say(word: str, style: str, message: str) -> None:
    line = " ".join(message.split())
    if not sys.stderr.isatty():
        # without colours, for which alone rich would be loaded, and that takes its time
        sys.stderr.write(f"{word}: {line}\n")
        return
    from rich.console import Console

    console = Console(stderr=True, highlight=False, markup=False, emoji=False, soft_wrap=True)
    console.print(f"{word}:", style=style, end=" ")
    console.print(line)


def say_findings(findings: Iterable["Finding"]) -> None:
    """The findings sort by sort, the first few of each in full and the number of the rest."""
    of_a_sort = sorted(findings, key=lambda finding: finding.code)
    for code, group in groupby(of_a_sort, key=lambda finding: finding.code):
        same = list(group)
        for finding in same[:TOLD_OF_A_SORT]:
            say_note(sentence_of(finding))
        if len(same) > TOLD_OF_A_SORT:
            say_note(f"and {len(same) - TOLD_OF_A_SORT} more of '{code}'; --report lists all")


def sentence_of(finding: "Finding") -> str:
    """What was found, where, and what to do about it."""
    where = []
    if finding.layer:
        where.append(f"layer '{finding.layer}'")
    if finding.handle:
        where.append(f"handle {finding.handle}")
    if finding.at_mm is not None:
        where.append(f"at ({finding.at_mm[0]:.0f}, {finding.at_mm[1]:.0f}) mm")
    place = f" [{', '.join(where)}]" if where else ""
    remedy = f"; {finding.remedy}" if finding.remedy else ""
    return f"{finding.message}{remedy}{place}"


def write_table(rows: Sequence[Sequence[str]], stream: TextIO) -> None:
    """Rows of text in aligned columns, two blanks apart; the last column is left as it is."""
    if not rows:
        return
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        cells = [cell.ljust(width) for cell, width in zip(row, widths, strict=True)]
        stream.write("  ".join(cells).rstrip() + "\n")


def _watched(*, quiet: bool) -> "Console | None":
    """Standard error where somebody sees a bar move there, else None."""
    if quiet or not sys.stderr.isatty():
        return None
    from rich.console import Console

    return Console(stderr=True)


@contextmanager
def progress(*, quiet: bool) -> Iterator[Callable[[str, float], None] | None]:
    """Progress bars on a terminal, None elsewhere; they are gone when the work is done."""
    console = _watched(quiet=quiet)
    if console is None:
        yield None
        return
    from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeElapsedColumn

    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        lines: dict[str, TaskID] = {}

        def show(stage: str, share: float) -> None:
            # several may run at once; one that is done makes room
            if stage not in lines:
                lines[stage] = bar.add_task(stage, total=1.0)
            bar.update(lines[stage], completed=share, visible=share < 1.0)

        yield show


@contextmanager
def counted(total: int, *, quiet: bool) -> Iterator[Callable[[str], None]]:
    """Called with the name of each thing done, it shows on a terminal how many are left.

    With an estimate of the time that they will take; gone when all are done.
    """
    console = _watched(quiet=quiet)
    if console is None:
        yield lambda _: None
        return
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeRemainingColumn,
    )

    columns = (
        MofNCompleteColumn(),
        BarColumn(),
        TimeRemainingColumn(),
        TextColumn("{task.description}", markup=False),
    )
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("", total=total)
        yield lambda name: bar.update(task, description=name, advance=1)
