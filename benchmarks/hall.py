"""Time the complex hall: `python -m benchmarks.hall [--runs N] [DRAWING]`.

Every figure is the median of several runs, after one run that compiles: seconds on the clock, and
seconds of all cores together, which tell more on a machine that has other things to do. The table
goes to stderr, the same figures as JSON to stdout.
"""

import argparse
import json
import os
import platform
import subprocess
import sys
import tempfile
from dataclasses import asdict
from pathlib import Path
from typing import Final

from benchmarks.clock import Job, timed
from satAOI_adapters import read_plan, write_aoi
from satAOI_geo.aoi import area
from satAOI_geo.freespace import free_space
from satAOI_geo.intervals import Intervals
from satAOI_geo.kernels import VARIABLE
from satAOI_geo.lattice import Lattice
from satAOI_geo.pipeline import area_of_interest
from satAOI_geo.reach import Band, DiscComponents, PoseComponents
from satAOI_geo.reasons import unreached
from satAOI_geo.robot import ROBOTS
from satAOI_geo.zones import set_downs, zones

SAMPLE: Final = Path(__file__).parents[1] / "samples" / "hall_complex.dxf"
COMMAND: Final = "import sys; from satAOI_geo.program import main; sys.exit(main())"


def main() -> None:
    """Time each stage and the whole command."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("drawing", nargs="?", type=Path, default=SAMPLE)
    parser.add_argument("--runs", type=int, default=5)
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        jobs = stages(asked.drawing, Path(folder)) | commands(asked.drawing, Path(folder))
        medians = {name: timed(job, asked.runs) for name, job in jobs.items()}
    for name, median in medians.items():
        sys.stderr.write(f"{name:<30} {median.clock_s:8.3f} s {median.cores_s:8.3f} s\n")
    figures = {
        "drawing": asked.drawing.name,
        "runs": asked.runs,
        "cores": os.cpu_count(),
        "machine": platform.machine(),
        "python": platform.python_version(),
        "medians": {name: asdict(median) for name, median in medians.items()},
    }
    sys.stdout.write(json.dumps(figures, indent=2) + "\n")


def stages(drawing: Path, folder: Path) -> dict[str, Job]:
    """One job a stage, each on the result of the stages before it."""
    robot = ROBOTS["magicbim"]
    plan = read_plan(drawing)
    lattice = Lattice.over(plan.floor.bounds, robot)
    engine = Intervals.of(plan, robot, lattice)
    space = free_space(engine, robot, lattice)
    free = space.free_nodes()
    result = area_of_interest(plan, robot)
    found = result.search
    return {
        "read the drawing": lambda: read_plan(drawing),
        "free space": lambda: free_space(Intervals.of(plan, robot, lattice), robot, lattice),
        "disc-connected sets": lambda: DiscComponents.of(free),
        "pose-connected sets": lambda: PoseComponents.of(lattice, [Band.of(engine, robot, space)]),
        "area": lambda: area(free, lattice, robot.disc_radius_mm),
        "zones": lambda: zones(found.pose, lattice, robot.disc_radius_mm, {}),
        "set-downs": lambda: set_downs(found.pose, found.free, lattice, robot.disc_radius_mm, {}),
        "reasons": lambda: unreached(found, result.aoi, result.upper),
        "write the drawing": lambda: write_aoi(folder / "stage.dxf", result),
    }


def commands(drawing: Path, folder: Path) -> dict[str, Job]:
    """The whole command in processes of its own: its help, by each rule, and where it compiles."""

    def command(*arguments: str, **environment: str) -> None:
        program, own = [sys.executable, "-c", COMMAND, *arguments], os.environ | environment
        # installed, the program's sources are not compiled by Python at each start
        own.pop("PYTHONDONTWRITEBYTECODE", None)
        quiet = subprocess.DEVNULL
        subprocess.run(program, check=True, stdout=quiet, env=own)  # noqa: S603  the command timed

    def whole(connectivity: str) -> Job:
        output = str(folder / f"{connectivity}.dxf")
        options = ["--connectivity", connectivity, "--quiet"]
        return lambda: command(str(drawing), "-o", output, *options)

    def first() -> None:
        with tempfile.TemporaryDirectory() as empty:
            arguments = [str(drawing), "-o", str(folder / "first.dxf"), "--quiet"]
            command(*arguments, **{VARIABLE: empty})

    return {
        "--help": lambda: command("--help"),
        "whole command, disc": whole("disc"),
        "whole command, pose": whole("pose"),
        "whole command, first run": first,
    }


if __name__ == "__main__":
    main()
