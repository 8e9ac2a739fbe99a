"""Thresholds where doors swing, drawn among walls or windows: no obstacle.

Offices with one layer for doors and windows draw the threshold of a door on it, too. It lies within
the depth of the wall and runs from jamb to jamb.

      ┌╮ leaf and swing
      │ ╲
    ──┤  ╲──   jambs
    ──┼───┼──
      threshold
"""

from collections.abc import Iterator, Sequence
from typing import Final

import shapely
from shapely.geometry import LineString, Polygon

from satAOI_adapters.dxf_read.doors import ABREAST_MM
from satAOI_adapters.dxf_read.linework import WALL_MM
from satAOI_adapters.dxf_read.obstacles import Standing
from satAOI_adapters.dxf_read.openings import PLACES, Span, as_one, depth_at, shut, walls_at
from satAOI_adapters.dxf_read.swings import Swing
from satAOI_adapters.dxf_read.terms import Terms
from satAOI_adapters.wording import are, counted
from satAOI_geo.plan import Finding, Obstacle

JAMBS_MM: Final = (20.0, 60.0, 100.0)
"""How far beyond a door's ends its jambs are looked for: farther off the wall may turn a corner."""


def without_thresholds(walls: Standing, doors: Sequence[Swing], terms: Terms) -> Standing:
    """Walls less the lines that are thresholds of doors, with what is to be said about these.

    Args:
        walls: With the openings that doors show.
        doors: That swing.
        terms: The terms of the reading.
    """
    if not doors:
        return walls
    tree = shapely.STRtree([wall.region() for wall in walls.obstacles])
    found: set[int] = set()
    for span in _spans(doors):
        found.update(_thresholds(span, tree, walls.obstacles))
    if not found:
        return walls
    kept = tuple(wall for i, wall in enumerate(walls.obstacles) if i not in found)
    said = _finding([walls.obstacles[i] for i in sorted(found)], terms)
    return Standing(kept, (*walls.findings, said))


def _spans(doors: Sequence[Swing]) -> Iterator[Span]:
    """Where doors may be when they are shut, whichever way their symbols lie; two leaves as one."""
    spans = [span for door in doors for span in shut(door)]
    for span in spans:
        yield span
        yield span.turned()
    yield from as_one(spans)


def _thresholds(span: Span, tree: shapely.STRtree, walls: Sequence[Obstacle]) -> Iterator[int]:
    """Which lines run from jamb to jamb of a door."""
    doorway = _doorway(span, tree)
    if doorway is None:
        return
    across = [span.across(share * span.width_mm) for share in PLACES]
    for i in tree.query(doorway, predicate="contains").tolist():
        line = walls[i].shape
        if isinstance(line, LineString) and all(map(line.intersects, across)):
            yield i


def _doorway(span: Span, tree: shapely.STRtree) -> Polygon | None:
    """The place of a door's threshold, as deep as its jambs are in common; None without both."""
    walls = walls_at(span, tree)
    starts = [depth_at(span, -beyond_mm, walls) for beyond_mm in JAMBS_MM]
    ends = [depth_at(span, span.width_mm + beyond_mm, walls) for beyond_mm in JAMBS_MM]
    if not (any(starts) and any(ends)):
        return None
    rights_mm, lefts_mm = zip(*(depth for depth in (*starts, *ends) if depth), strict=True)
    right_mm, left_mm = max(rights_mm) - ABREAST_MM, min(lefts_mm) + ABREAST_MM
    if not 0 < left_mm - right_mm <= WALL_MM:
        return None
    before_mm, after_mm = -max(JAMBS_MM), span.width_mm + max(JAMBS_MM)
    corners = (
        (before_mm, right_mm),
        (after_mm, right_mm),
        (after_mm, left_mm),
        (before_mm, left_mm),
    )
    return Polygon([span.at(*corner) for corner in corners])


def _finding(lines: Sequence[Obstacle], terms: Terms) -> Finding:
    first, *_ = lines
    x_mm, y_mm = terms.frame.to_drawing_mm(shapely.get_coordinates(first.region())[:1])[0]
    return Finding(
        "threshold",
        f"{counted(len(lines), 'line')} from jamb to jamb where doors swing {are(len(lines))} "
        "taken for thresholds, which do not stop the robot, the first at "
        f"({x_mm:.1f}, {y_mm:.1f}) mm on layer '{first.layer}'",
        "draw what is no threshold on another layer",
        layer=first.layer,
        handle=first.handle,
        at_mm=(float(x_mm), float(y_mm)),
    )
