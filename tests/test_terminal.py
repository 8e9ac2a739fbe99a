"""Talk is plain text, coloured on a terminal only."""

import io
import sys

import pytest

from satAOI_adapters.terminal import progress, say_note


class Terminal(io.StringIO):
    """A stream somebody looks at."""

    def isatty(self) -> bool:
        return True


def on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> Terminal:
    """Standard error, to be called where it is used: pytest sets its own for every stage."""
    stream = Terminal()
    monkeypatch.setattr(sys, "stderr", stream)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.delenv("NO_COLOR", raising=False)
    return stream


def test_a_message_is_one_line_whatever_it_holds(capsys: pytest.CaptureFixture[str]) -> None:
    say_note("layer 'a\nb' :key: [bold] " + 30 * "is long ")
    assert capsys.readouterr().err == "note: layer 'a b' :key: [bold]" + 30 * " is long" + "\n"


def test_on_a_terminal_it_says_the_same_in_colour(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = on_a_terminal(monkeypatch)
    say_note(":key: [bold] " + 30 * "is long ")
    assert terminal.getvalue().endswith(":key: [bold]" + 30 * " is long" + "\n")
    assert "\x1b[33mnote:" in terminal.getvalue()


def test_a_bar_moves_on_a_terminal_unless_all_shall_be_quiet(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    terminal = on_a_terminal(monkeypatch)
    with progress(quiet=True) as told:
        assert told is None
    with progress(quiet=False) as told:
        assert told is not None
        told("search", 0.5)
    assert "search" in terminal.getvalue()


def test_no_bar_moves_where_nobody_looks(capsys: pytest.CaptureFixture[str]) -> None:
    with progress(quiet=False) as told:
        assert told is None
    assert not capsys.readouterr().err
