"""Drive routes again, finely: `python -m benchmarks.routes [--points N] [DRAWING]`.

For random points of the area of interest a route each, replayed at steps of at most 2 mm and 0.5°
against the exact collision test. Prints how many poses were tried and how many touched something;
the exit code is 1 when any did. The points are the same in every run.
"""

import argparse
import sys
import time
from pathlib import Path
from typing import Final

from benchmarks.driving import driven, points_in_the_area
from satAOI_adapters import read_plan
from satAOI_geo.collision import Collider
from satAOI_geo.progress import Stopwatch
from satAOI_geo.robot import PROTOTYPE, Pose
from satAOI_geo.route import RouteMap
from satAOI_geo.search import search
from satAOI_geo.settings import DEFAULTS

SAMPLE: Final = Path(__file__).parents[1] / "samples" / "hall_complex.dxf"


def main() -> int:
    """Replay the routes; the exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("drawing", nargs="?", type=Path, default=SAMPLE)
    parser.add_argument("--points", type=int, default=1000)
    asked = parser.parse_args()
    found = search(read_plan(asked.drawing), PROTOTYPE, DEFAULTS, start=None, watch=Stopwatch())
    ways, collider = RouteMap(found), Collider(found.plan, found.robot)
    # a pose that many routes share is tried once
    tried: dict[Pose, bool] = {}
    length_mm, begin_s = 0.0, time.perf_counter()
    for point_mm in points_in_the_area(found, seed=0, n=asked.points):
        route = ways.to(point_mm)
        length_mm += route.length_mm
        for pose in driven(route):
            if pose not in tried:
                tried[pose] = collider.is_free(pose)
    contacts = sum(not free for free in tried.values())
    sys.stdout.write(
        f"{asked.drawing.name}: {asked.points} routes, {length_mm / 1e6:.2f} km in all, "
        f"{len(tried)} different poses tried, {contacts} contacts, "
        f"{time.perf_counter() - begin_s:.0f} s\n"
    )
    return 1 if contacts else 0


if __name__ == "__main__":
    sys.exit(main())
