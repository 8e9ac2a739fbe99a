"""Why a point of the plan is, or is not, in the area of interest: in one sentence."""

import shapely
from shapely.geometry import Point

from satAOI_geo.pipeline import Result
from satAOI_geo.reasons import NARROW_CELLS, SENTENCES, Patch
from satAOI_geo.units import MM2_PER_M2


def explain(result: Result, at_mm: tuple[float, float]) -> str:
    """A sentence for a point in the frame of `result.plan`."""
    point = Point(at_mm)
    if not result.plan.floor.intersects(point):
        return "This point is not on the floor."
    regions = [obstacle.region() for obstacle in result.plan.obstacles]
    hits = shapely.STRtree(regions).query(point, predicate="intersects")
    if hits.size:
        return f"This point lies in {result.plan.obstacles[int(hits.min())].label()}."
    patch = next((patch for patch in result.patches if patch.region.intersects(point)), None)
    if patch is None:
        return "The disc trowels this point from where the robot is set down."
    return f"This point is left over: {_reason(patch)}."


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
