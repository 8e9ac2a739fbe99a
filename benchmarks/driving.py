"""Routes driven again, finely: poses close enough together that no contact slips between them."""

import itertools
import math
import random
from typing import Final

import numpy as np

from satAOI_geo.robot import Pose
from satAOI_geo.route import Route
from satAOI_geo.search import Search

STEP_MM: Final = 2.0
TURN_RAD: Final = math.radians(0.5)


def driven(route: Route) -> list[Pose]:
    """The poses of a route, at most `STEP_MM` and `TURN_RAD` apart."""
    poses = route.poses()
    return [poses[0], *(pose for pair in itertools.pairwise(poses) for pose in between(*pair)[1:])]


def between(a: Pose, b: Pose) -> list[Pose]:
    """Poses from a to b, at most `STEP_MM` and `TURN_RAD` apart, both ends included."""
    ends = np.array([(p.x_mm, p.y_mm, p.a1_rad, p.a2_rad) for p in (a, b)])
    way = np.abs(ends[1] - ends[0])
    n = max(1, math.ceil(math.hypot(*way[:2]) / STEP_MM), math.ceil(max(way[2:]) / TURN_RAD))
    return [Pose(*ends[0] + (ends[1] - ends[0]) * k / n) for k in range(n + 1)]


def points_in_the_area(found: Search, seed: int, n: int) -> list[tuple[float, float]]:
    """Points, in mm, that the disc covers from a reached node, at random."""
    draw = random.Random(seed)  # noqa: S311  a sample, not a secret
    nodes = np.argwhere(found.pose.nodes(found.start.pose_label).as_array()).tolist()
    # a hair inside the disc, for rounding
    within_mm = found.robot.disc_radius_mm - 0.1
    points_mm = []
    for _ in range(n):
        iy, ix = draw.choice(nodes)
        angle_rad, off_mm = draw.uniform(0, 2 * math.pi), draw.uniform(0, within_mm)
        x_mm = found.lattice.x_mm(ix) + off_mm * math.cos(angle_rad)
        y_mm = found.lattice.y_mm(iy) + off_mm * math.sin(angle_rad)
        points_mm.append((x_mm, y_mm))
    return points_mm
