"""The area of interest of the named plans against what a person can compute."""

from dataclasses import replace
from functools import cache

import pytest
import shapely

from satAOI_geo.pipeline import Result, area_of_interest
from satAOI_geo.settings import Settings
from satAOI_geo.units import MM2_PER_M2
from tests import plans

STEP_MM = 10.0


@cache
def result(name: str) -> Result:
    case = plans.CASES[name]()
    marked = replace(case.plan, start_mm=case.start_mm)
    return area_of_interest(marked, settings=Settings(step_mm=STEP_MM, exact_outline=True))


def closed(measure: str) -> list[str]:
    """Names of the plans whose area by a rule has a closed form."""
    return sorted(name for name, case in plans.CASES.items() if getattr(case(), measure))


def assert_short_by_less_than_a_cell_along_the_outline(
    area_mm2: float, closed_mm2: float, outline_mm: float
) -> None:
    assert 0 <= closed_mm2 - area_mm2 <= outline_mm * STEP_MM


@pytest.mark.parametrize("name", closed("disc_area_mm2"))
def test_disc_connected_area_is_the_closed_form_within_the_lattice_s_error(name: str) -> None:
    case = plans.CASES[name]()
    assert case.disc_area_mm2 is not None
    area_mm2 = result(name).report.disc_connected.area_m2 * MM2_PER_M2
    assert_short_by_less_than_a_cell_along_the_outline(
        area_mm2, case.disc_area_mm2, case.outline_mm
    )


@pytest.mark.parametrize("name", closed("pose_area_mm2"))
def test_pose_connected_area_is_the_closed_form_within_the_lattice_s_error(name: str) -> None:
    case = plans.CASES[name]()
    assert case.pose_area_mm2 is not None
    area_mm2 = result(name).aoi.area_mm2
    assert_short_by_less_than_a_cell_along_the_outline(
        area_mm2, case.pose_area_mm2, case.outline_mm
    )


@pytest.mark.parametrize("name", closed("beyond_mm"))
def test_area_does_not_hold_what_no_motion_leads_to(name: str) -> None:
    case = plans.CASES[name]()
    beyond = shapely.points(case.beyond_mm)
    outlines = [outline.polygon() for outline in result(name).aoi.outlines]
    assert case.plan.free_region().contains(beyond)
    assert not any(outline.contains(beyond) for outline in outlines)


def test_area_of_an_empty_room_is_exact_on_the_lattice() -> None:
    # some 900 arcs add up to 1.2e7 mm², each rounded to 1e-9 mm² or so
    assert result("room").aoi.area_mm2 == pytest.approx(
        plans.room_on_lattice_mm2(4000.0, 3000.0, STEP_MM), abs=1e-6
    )


def test_paper_s_rule_leaks_through_an_opening_too_narrow_for_the_vehicle() -> None:
    narrow = result("two_rooms_760")
    assert narrow.report.disc_connected.area_m2 > 31.7
    assert narrow.aoi.area_mm2 < 16.8 * MM2_PER_M2


@pytest.mark.parametrize("name", sorted(plans.CASES))
def test_area_overlaps_no_obstacle(name: str) -> None:
    case = plans.CASES[name]()
    covered = shapely.union_all([outline.polygon() for outline in result(name).aoi.outlines])
    assert covered.difference(case.plan.free_region()).area < 1e-6 * MM2_PER_M2
