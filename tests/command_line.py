"""A small room to run the program on, and what is asked of its runs."""

import json
import os
import subprocess
import sys
from pathlib import Path

import ezdxf
import pytest

from satAOI_geo.program import main

ROOT = Path(__file__).parents[1]

START = """
import sys
sys.path[:0] = sys.argv.pop(1).split("|")
from satAOI_geo.program import main
sys.exit(main())
"""
"""The program for `python -c`; its first argument says where it lies."""


def drawn_room(file: Path, *, insunits: int = 4, unit_mm: float = 1.0) -> Path:
    """A room of 4 × 4 m with its lower left corner at (-1, -1) m, a column at its top right.

    (-1, 3) ┌───────┬┐
            │       └┤  300 × 300 mm
            │        │
    (-1,-1) └────────┘ (3, -1)
    """
    document = ezdxf.new("R2010")
    document.header["$INSUNITS"] = insunits
    for layer, left, bottom, side in (("FLOOR", -1000, -1000, 4000), ("COLUMN", 2700, 2700, 300)):
        corners = [(0, 0), (side, 0), (side, side), (0, side)]
        points = [((left + x) / unit_mm, (bottom + y) / unit_mm) for x, y in corners]
        document.modelspace().add_lwpolyline(points, close=True, dxfattribs={"layer": layer})
    document.saveas(file)
    return file


def figures(capsys: pytest.CaptureFixture[str], *arguments: object) -> dict:
    """The report of a run that is expected to go well."""
    assert main([*map(str, arguments), "--report", "-"]) == 0
    return json.loads(capsys.readouterr().out)


def the_error(capsys: pytest.CaptureFixture[str]) -> str:
    """The one line that a failed run says."""
    said = capsys.readouterr()
    assert said.out == ""
    (line,) = said.err.splitlines()
    assert line.startswith("error: ")
    return line


def printed(code: str, **environment: str) -> str:
    """What code prints in a Python of its own, the last line of it for an error."""
    code = f"import sys; sys.path[:0] = {sys.path!r}\n{code}"
    command, own = [sys.executable, "-c", code], os.environ | environment
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=own)
    return done.stdout + "".join(done.stderr.splitlines()[-1:])


def program(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """The program as a shell would start it."""
    return subprocess.run(
        [sys.executable, "-W", "error", "-c", START, f"{ROOT}|{ROOT / 'adapters'}", *arguments],
        capture_output=True,
        encoding="utf-8",
        errors="replace",
        env={**os.environ, **environment},
        check=False,
        timeout=300,
    )
