"""The named plans are what they say: their closed forms hold against shapely's buffers."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
from shapely.geometry import Point

from satAOI_geo.plan import Circle
from tests import plans

QUARTER_SEGMENTS = 360
"""Chords of a quarter circle: a disc of 350 mm loses 1.2 mm² of its 384 845 mm²."""


CLOSED = sorted(name for name, case in plans.CASES.items() if case().disc_area_mm2 is not None)


def opened_mm2(case: plans.Case) -> float:
    """What a disc alone covers from the start, rolling: erosion, the start's part, dilation."""
    radius_mm = plans.DISC_MM
    blocked = case.plan.obstacle_region().buffer(radius_mm, quad_segs=QUARTER_SEGMENTS)
    inner = case.plan.floor.buffer(-radius_mm, quad_segs=QUARTER_SEGMENTS)
    # two steps: eroding the floor with the column already cut out of it, GEOS 3.14 loses 0.75 m²
    # of `arc_tangent_to_wall`
    centres = inner.difference(blocked)
    start = Point(case.start_mm)
    (part,) = (p for p in getattr(centres, "geoms", [centres]) if p.contains(start))
    return float(part.buffer(radius_mm, quad_segs=QUARTER_SEGMENTS).area)


@pytest.mark.parametrize("name", CLOSED)
def test_closed_form_is_the_area_a_rolling_disc_covers(name: str) -> None:
    case = plans.CASES[name]()
    # 20 mm² for every corner of a plan with at most 12 of them: the chords' share, see above
    assert opened_mm2(case) == pytest.approx(case.disc_area_mm2, abs=240)


def test_room_on_a_lattice_is_the_union_of_the_discs_on_its_nodes() -> None:
    x_mm, y_mm = np.meshgrid(np.arange(355, 500, 10.0), np.arange(355, 450, 10.0))
    discs = shapely.buffer(shapely.points(x_mm.ravel(), y_mm.ravel()), 350, quad_segs=2000)
    # in this room the free nodes run from 355 to 495 and from 355 to 445
    area_mm2 = plans.room_on_lattice_mm2(850.0, 800.0)
    assert shapely.union_all(discs).area == pytest.approx(area_mm2, abs=0.2)


@pytest.mark.parametrize("seed", range(30))
def test_random_plan_is_valid_and_repeats(seed: int) -> None:
    plan = plans.random_plan(seed)
    assert plan == plans.random_plan(seed)
    assert plan.floor.is_valid
    assert all(obstacle.region().is_valid for obstacle in plan.obstacles)


def test_random_plans_hold_every_sort_of_obstacle() -> None:
    shapes = [o.shape for seed in range(30) for o in plans.random_plan(seed).obstacles]
    sorts = {type(shape).__name__ for shape in shapes}
    assert sorts == {"Polygon", "LineString", "Circle"}
    solids = [s for s in shapes if isinstance(s, shapely.Polygon)]
    assert any(s.area < 0.99 * s.convex_hull.area for s in solids)


@pytest.mark.parametrize("seed", range(30))
def test_four_quarter_turns_or_two_mirrors_give_the_same_plan(seed: int) -> None:
    plan = plans.random_plan(seed)
    turned = plan
    for _ in range(4):
        turned = plans.quarter_turned(turned)
    assert turned == plan
    assert plans.mirrored(plans.mirrored(plan)) == plan


@pytest.mark.parametrize("seed", range(30))
def test_shift_there_and_back_gives_the_same_plan(seed: int) -> None:
    plan = plans.random_plan(seed)
    assert plans.shifted(plans.shifted(plan, 12_340.0, -560.0), -12_340.0, 560.0) == plan


def test_motions_keep_circles_as_circles() -> None:
    plan = plans.room_with_round_column().plan
    (column,) = plans.quarter_turned(plan).obstacles
    assert column.shape == Circle(-3000.0, 3000.0, 300.0)


@pytest.mark.parametrize("seed", range(30))
def test_obstacle_area_is_that_of_the_obstacle_region(seed: int) -> None:
    plan = plans.random_plan(seed)
    assert plan.obstacle_area_mm2() == pytest.approx(plan.obstacle_region().area, rel=1e-12)


def test_floor_without_obstacles_has_no_obstacle_area() -> None:
    assert replace(plans.random_plan(0), obstacles=()).obstacle_area_mm2() == 0.0
