"""Why a point of the plan is, or is not, in the area of interest: in one sentence."""

import math
from typing import Final

import numpy as np
import shapely
from shapely.geometry import Point

from satAOI_geo.pipeline import Result
from satAOI_geo.plan import CONTACT_MM
from satAOI_geo.reasons import NARROW_CELLS, SENTENCES, Patch
from satAOI_geo.units import MM2_PER_M2

TROWELLED: Final = "The disc trowels this point from where the robot is set down."


def explain(result: Result, at_mm: tuple[float, float]) -> str:
    """A sentence for a point in the frame of `result.plan`."""
    point = Point(at_mm)
    if not result.plan.floor.intersects(point):
        return "This point is not on the floor."
    regions = [obstacle.region() for obstacle in result.plan.obstacles]
    hits = shapely.STRtree(regions).query(point, predicate="intersects")
    if hits.size:
        return f"This point lies in {result.plan.obstacles[int(hits.min())].label()}."
    if _is_trowelled(result, at_mm):
        return TROWELLED
    patch = next((patch for patch in result.patches if patch.region.intersects(point)), None)
    if patch is None:
        return TROWELLED
    return f"This point is left over: {_reason(patch)}."


def _is_trowelled(result: Result, at_mm: tuple[float, float]) -> bool:
    """Whether the disc covers a point from one of its positions, as the raster has it.

    The outline that patches border on runs up to 0.05 mm inside.
    """
    search, lattice, disc_mm = result.search, result.lattice, result.robot.disc_radius_mm
    of_start = (
        search.disc.nodes(search.start.disc_label)
        if result.settings.connectivity == "disc"
        else search.pose.nodes(search.start.pose_label)
    )
    node = lattice.nearest_node(*at_mm)
    if node is None:
        # on the edge of the floor, which the disc does not touch
        return False
    within_mm = disc_mm + CONTACT_MM
    row, column = (slice(k, k + 1) for k in node)
    rows, columns = lattice.around(row, column, within_mm)
    window = lattice.window(rows, columns)
    near = np.argwhere(of_start.window(rows, columns).as_array()).tolist()
    return any(math.dist((window.x_mm(ix), window.y_mm(iy)), at_mm) <= within_mm for iy, ix in near)


def _reason(patch: Patch) -> str:
    """Why a patch is left over, how large it is and what it is tight against."""
    size = f"{patch.area_mm2 / MM2_PER_M2:.2f} m²"
    if patch.narrow:
        return (
            f"it is in a strip beside a wall, narrower than {NARROW_CELLS} lattice "
            f"cells ({size} of them in all): the disc's positions are a cell apart"
        )
    near = f"; nearest to it is {patch.blocker.label()}" if patch.blocker else ""
    return f"{SENTENCES[patch.reason]} (a patch of {size}{near})"
