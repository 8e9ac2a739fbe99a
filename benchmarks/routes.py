"""Drive routes again, finely: `python benchmarks/routes.py [--points N] [DRAWING]`.

For random points of the area of interest a route each, replayed at steps of at most 2 mm and 0.5°
against the exact collision test. Prints how many poses were tried and how many touched something;
the exit code is 1 when any did. The points are the same in every run.
"""

import argparse
import itertools
import math
import random
import sys
import time
from pathlib import Path
from typing import Final

import numpy as np

from satAOI_adapters import read_plan
from satAOI_adapters.dxf_read import ReadOptions
from satAOI_geo.collision import Collider
from satAOI_geo.progress import Stopwatch
from satAOI_geo.robot import PROTOTYPE, Pose
from satAOI_geo.route import RouteMap
from satAOI_geo.search import DEFAULTS, search

SAMPLE: Final = Path(__file__).parents[1] / "samples" / "hall_complex.dxf"
STEP_MM: Final = 2.0
TURN_RAD: Final = math.radians(0.5)


def main() -> int:
    """Replay the routes; the exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("drawing", nargs="?", type=Path, default=SAMPLE)
    parser.add_argument("--points", type=int, default=1000)
    asked = parser.parse_args()
    plan = read_plan(asked.drawing, ReadOptions())
    found = search(plan, PROTOTYPE, DEFAULTS, start=None, watch=Stopwatch())
    ways, collider = RouteMap(found), Collider(found.plan, found.robot)
    nodes = np.argwhere(found.pose.nodes(found.start.pose_label)).tolist()
    draw = random.Random(0)  # noqa: S311  a sample, not a secret
    # a pose that many routes share is tried once
    tried: dict[Pose, bool] = {}
    length_mm, begin_s = 0.0, time.perf_counter()
    for _ in range(asked.points):
        iy, ix = draw.choice(nodes)
        angle_rad, off_mm = draw.uniform(0, 2 * math.pi), draw.uniform(0, 349.9)
        x_mm = found.lattice.x_mm(ix) + off_mm * math.cos(angle_rad)
        y_mm = found.lattice.y_mm(iy) + off_mm * math.sin(angle_rad)
        route = ways.to((x_mm, y_mm))
        length_mm += route.length_mm
        for a, b in itertools.pairwise(route.poses()):
            for pose in between(a, b):
                if pose not in tried:
                    tried[pose] = collider.is_free(pose)
    contacts = sum(not free for free in tried.values())
    sys.stdout.write(
        f"{asked.drawing.name}: {asked.points} routes, {length_mm / 1e6:.2f} km in all, "
        f"{len(tried)} different poses tried, {contacts} contacts, "
        f"{time.perf_counter() - begin_s:.0f} s\n"
    )
    return 1 if contacts else 0


def between(a: Pose, b: Pose) -> list[Pose]:
    """Poses from a to b, at most `STEP_MM` and `TURN_RAD` apart, both ends included."""
    ends = np.array([(p.x_mm, p.y_mm, p.a1_rad, p.a2_rad) for p in (a, b)])
    way = np.abs(ends[1] - ends[0])
    n = max(1, math.ceil(math.hypot(*way[:2]) / STEP_MM), math.ceil(max(way[2:]) / TURN_RAD))
    return [Pose(*ends[0] + (ends[1] - ends[0]) * k / n) for k in range(n + 1)]


if __name__ == "__main__":
    sys.exit(main())
