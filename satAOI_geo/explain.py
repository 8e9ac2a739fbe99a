"""Why a point of the plan is, or is not, in the area of interest: in one sentence."""

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
    iy, ix = ((np.array(at_mm[::-1]) - lattice.origin_mm[::-1]) // lattice.step_mm).astype(int)
    rows, columns = lattice.around(slice(iy, iy + 1), slice(ix, ix + 1), disc_mm + CONTACT_MM)
    near = np.argwhere(of_start.window(rows, columns).as_array())
    x_mm = lattice.origin_mm[0] + (near[:, 1] + columns.start + 0.5) * lattice.step_mm
    y_mm = lattice.origin_mm[1] + (near[:, 0] + rows.start + 0.5) * lattice.step_mm
    away_mm = np.hypot(x_mm - at_mm[0], y_mm - at_mm[1])
    return bool((away_mm <= disc_mm + CONTACT_MM).any())


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
