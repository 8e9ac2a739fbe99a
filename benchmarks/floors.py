"""How time and memory grow with the floor: `python -m benchmarks.floors [--sides 1 2 4 8]`.

A floor is the complex hall of the samples, 200 m², repeated a number of times to each side. Each
is searched in a process of its own, after a run on one hall that compiles. A table goes to
standard error, the figures as JSON to standard output.
"""

import argparse
import json
import math
import os
import platform
import subprocess
import sys
from dataclasses import asdict, replace
from itertools import pairwise
from pathlib import Path
from typing import Any, Final, TypeAlias

from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table
from shapely.affinity import translate
from shapely.geometry import box

from benchmarks.clock import now, peak_mb, since
from satAOI_adapters import read_plan
from satAOI_geo import Settings, area_of_interest
from satAOI_geo.plan import Circle, FloorPlan, Shape
from satAOI_geo.units import MM2_PER_M2

HALL: Final = Path(__file__).parents[1] / "samples" / "hall_complex.dxf"
ONE: Final = "--one"

Figures: TypeAlias = dict[str, Any]


def main() -> None:
    """Search each floor and print how the figures grow."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sides", nargs="+", default=["1", "2", "4", "8"], metavar="N")
    parser.add_argument("--memory", default="0.5", metavar="GB", help="for the free space")
    parser.add_argument(ONE, metavar="N", type=int, help="search this floor in this process")
    asked = parser.parse_args()
    if asked.one is not None:
        sys.stdout.write(json.dumps(figures_of(asked.one, float(asked.memory))) + "\n")
        return
    figures = [said_by(side, asked.memory) for side in asked.sides]
    for smaller, larger in pairwise(figures):
        grown = larger["floor_m2"] / smaller["floor_m2"]
        larger["exponent"] = math.log(larger["cores_s"] / smaller["cores_s"], grown)
    Console(stderr=True, width=100).print(table_of(figures))
    machine = {"cores": os.cpu_count(), "machine": platform.machine()}
    sys.stdout.write(json.dumps({**machine, "floors": figures}, indent=2) + "\n")


def said_by(side: str, memory_gb: str) -> Figures:
    """The figures of a floor, found in a process of its own."""
    command = [sys.executable, "-m", "benchmarks.floors", ONE, side, "--memory", memory_gb]
    done = subprocess.run(  # noqa: S603  our own module, by our own interpreter
        command, check=True, stdout=subprocess.PIPE, text=True
    )
    figures: Figures = json.loads(done.stdout)
    return figures


def figures_of(side: int, memory_gb: float) -> Figures:
    """The figures of a floor of side × side halls."""
    hall = read_plan(HALL)
    area_of_interest(hall)
    plan, settings = repeated(hall, side), Settings(memory_gb=memory_gb)
    begin = now()
    result = area_of_interest(plan, settings=settings)
    report = result.report
    return {
        "floor_m2": plan.floor.area / MM2_PER_M2,
        "n_bands": len(result.search.pose.bands),
        **asdict(since(begin)),
        "timing_s": report.timing_s,
        "peak_mb": peak_mb(),
        "n_zones": len(report.zones),
        "n_patches": len(report.unreached),
    }


def repeated(hall: FloorPlan, side: int) -> FloorPlan:
    """A floor of halls in rows and columns, without walls between them."""
    left, bottom, right, top = hall.floor.bounds
    width_mm, height_mm = right - left, top - bottom
    obstacles = [
        replace(obstacle, shape=moved(obstacle.shape, column * width_mm, row * height_mm))
        for row in range(side)
        for column in range(side)
        for obstacle in hall.obstacles
    ]
    floor = box(left, bottom, left + side * width_mm, bottom + side * height_mm)
    return replace(hall, floor=floor, obstacles=tuple(obstacles), start_mm=None)


def moved(shape: Shape, x_mm: float, y_mm: float) -> Shape:
    """A shape moved."""
    if isinstance(shape, Circle):
        return Circle(shape.x_mm + x_mm, shape.y_mm + y_mm, shape.radius_mm)
    return translate(shape, x_mm, y_mm)


def table_of(figures: list[Figures]) -> Table:
    """A row for each floor; the exponent is that of the cores' time from the floor before."""
    table = Table(box=SIMPLE)
    stages = list(figures[0]["timing_s"])
    for head in ("floor m²", "bands", "time s", "cores s", "exponent", *stages, "memory MB"):
        table.add_column(head, justify="right")
    for one in figures:
        table.add_row(
            f"{one['floor_m2']:.0f}",
            str(one["n_bands"]),
            f"{one['clock_s']:.1f}",
            f"{one['cores_s']:.1f}",
            f"{one['exponent']:.2f}" if "exponent" in one else "",
            *(f"{one['timing_s'][stage]:.1f}" for stage in stages),
            f"{one['peak_mb']:.0f}",
        )
    return table


if __name__ == "__main__":
    main()
