"""The project against its alternatives: `python -m benchmarks.compare [DRAWING ...]`.

On each drawing, the three halls of the samples without any, all contenders are asked the same in
the same run, each in a process of its own:

    paper            the paper's program, a loop over poses with a KD-tree of occupied cells
    paper, arrays    the same with numpy's arrays for its inner loops
    reference        the exact collision test of this project, a node at a time
    raster           footprints slid over an image by FFT, as one writes it
    raster, tuned    the same with as few and as small transforms as possible
    disc-connected   this project, the paper's rule: the question that all those answer
    pose-connected   this project, what motions join with the start
    whole answer     this project, with zones, reasons and report

The first three try some hundred nodes and give the time that all the nodes of the search would
take. A table goes to standard error, the figures as JSON to standard output.
"""

import argparse
import json
import os
import platform
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any, Final, TypeAlias

from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table

SAMPLES: Final = Path(__file__).parents[1] / "samples"
HALLS: Final = [SAMPLES / f"hall_{name}.dxf" for name in ("simple", "medium", "complex")]
OURS: Final = ("disc-connected", "pose-connected")
CONTENDERS: Final = (
    "paper",
    "paper, arrays",
    "reference",
    "raster",
    "raster, tuned",
    *OURS,
    "whole answer",
)

TABLE_WIDTH: Final = 100

Figures: TypeAlias = dict[str, Any]


def main() -> None:
    """Compare on each drawing."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("drawings", nargs="*", type=Path, default=HALLS, metavar="DRAWING")
    parser.add_argument("--runs", default="5", help="runs whose median counts")
    parser.add_argument("--sample", default="300", help="nodes tried where not all are")
    asked = parser.parse_args()
    console = Console(stderr=True, width=TABLE_WIDTH)
    halls = {}
    for drawing in asked.drawings:
        figures = compared(drawing, ["--runs", asked.runs, "--sample", asked.sample])
        console.print(table_of(drawing, figures))
        halls[drawing.name] = figures
    machine = {
        "cores": os.cpu_count(),
        "machine": platform.machine(),
        "python": platform.python_version(),
    }
    sys.stdout.write(json.dumps({**machine, "drawings": halls}, indent=2) + "\n")


def compared(drawing: Path, options: list[str]) -> dict[str, Figures]:
    """The figures of all contenders on one drawing."""
    with tempfile.TemporaryDirectory() as folder:
        given = [str(drawing), str(Path(folder) / "images.npz")]
        said_by("images", *given)
        figures = {name: json.loads(said_by(name, *given, *options)) for name in CONTENDERS}
    for one in figures.values():
        one["times_ours"] = {ours: one["clock_s"] / figures[ours]["clock_s"] for ours in OURS}
    return figures


def said_by(*arguments: str) -> str:
    """What a contender writes to standard output.

    This process stays small, since on Linux a process inherits its parent's peak of memory.
    """
    command = [sys.executable, "-m", "benchmarks.contender", *arguments]
    done = subprocess.run(  # noqa: S603  our own module, by our own interpreter
        command, check=True, stdout=subprocess.PIPE, text=True
    )
    return done.stdout


def table_of(drawing: Path, figures: dict[str, Figures]) -> Table:
    """The figures of one drawing."""
    table = Table(title=drawing.name, title_justify="left", box=SIMPLE)
    table.add_column("")
    for head in ("time", "cores", "× disc", "× pose", "memory", "wrong nodes"):
        table.add_column(head, justify="right", no_wrap=True)
    for name, one in figures.items():
        n_wrong = one["n_wrongly_free"] + one["n_wrongly_blocked"]
        table.add_row(
            name,
            time_in_words(one["clock_s"], one["error_s"]),
            time_in_words(one["cores_s"], 0.0),
            *(f"{one['times_ours'][ours]:,.{1 if one['clock_s'] < 100 else 0}f}" for ours in OURS),
            f"{one['peak_mb']:.0f} MB",
            f"{n_wrong} of {one['n_nodes']}",
        )
    return table


def time_in_words(time_s: float, error_s: float) -> str:
    """A time with the standard error of an estimate."""
    unit, unit_s = ("h", 3600) if time_s >= 3600 else ("s", 1)
    digits = 2 if time_s / unit_s < 100 else 0
    error = f" ± {error_s / unit_s:.{digits}f}" if error_s else ""
    return f"{time_s / unit_s:.{digits}f}{error} {unit}"


if __name__ == "__main__":
    main()
