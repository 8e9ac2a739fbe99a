"""Zones and set-downs: how often the robot has to be set down, and where."""

from dataclasses import replace

import numpy as np
import pytest
from shapely.geometry import Polygon, box

from satAOI_geo.cells import covered_cells
from satAOI_geo.collision import Collider
from satAOI_geo.errors import EmptyPlanError, NothingFreeError, StartBlockedError
from satAOI_geo.lattice import Lattice
from satAOI_geo.nodes import Nodes
from satAOI_geo.pipeline import Result, area_of_interest
from satAOI_geo.plan import FloorPlan, Kind, Obstacle
from satAOI_geo.reach import DiscComponents
from satAOI_geo.settings import Settings
from satAOI_geo.start import StartMark
from satAOI_geo.zones import ZONE_MM2, _area_bounds_mm2, _area_mm2
from tests import plans

SETTINGS = Settings(step_mm=25.0, n_directions=12)


def result(seed: int) -> Result:
    return area_of_interest(plans.random_plan(seed), settings=SETTINGS)


def two_rooms_apart() -> FloorPlan:
    """Rooms of 4 × 4 and 3 × 4 m with a wall without an opening between them."""
    return FloorPlan(
        box(0, 0, 7200, 4000), (Obstacle(box(4000, 0, 4200, 4000), Kind.WALL, "W", "1F"),)
    )


def test_rooms_apart_are_two_zones_the_larger_first() -> None:
    zones = area_of_interest(two_rooms_apart(), settings=SETTINGS).zones
    assert len(zones) == 2
    rooms_mm2 = [plans.room_on_lattice_mm2(side, 4000.0, 25.0) for side in (4000.0, 3000.0)]
    # 350 mm is 14 cells, so the closed form for whole steps holds; clean outlines lose 0.05 mm
    found_mm2 = [zone.area_mm2 for zone in zones]
    assert found_mm2 == pytest.approx(rooms_mm2, abs=0.05 * 16000)


def test_as_many_set_downs_as_rooms() -> None:
    set_downs = area_of_interest(two_rooms_apart(), settings=SETTINGS).set_downs
    assert len(set_downs) == 2


@pytest.mark.parametrize("seed", range(5))
def test_set_down_is_a_free_pose_of_its_zone(seed: int) -> None:
    found = result(seed)
    collider = Collider(found.plan, found.robot)
    for zone in found.zones:
        assert found.search.pose.at(*zone.set_down) == zone.label
        assert collider.is_free(found.lattice.pose(*zone.set_down))


@pytest.mark.parametrize("seed", range(5))
def test_zones_are_all_components_of_half_a_square_metre(seed: int) -> None:
    found = result(seed)
    pose = found.search.pose
    radius = found.robot.disc_radius_mm / found.lattice.step_mm
    listed = {zone.label for zone in found.zones}
    for label in range(len(pose.boxes)):
        raster_mm2 = covered_cells(pose.nodes(label), radius).count() * found.lattice.step_mm**2
        if raster_mm2 > 1.1 * ZONE_MM2:
            assert label in listed
        if raster_mm2 < 0.9 * ZONE_MM2:
            assert label not in listed


@pytest.mark.parametrize("seed", range(5))
def test_set_downs_together_cover_what_any_pose_can(seed: int) -> None:
    found = result(seed)
    pose = found.search.pose
    radius = found.robot.disc_radius_mm / found.lattice.step_mm
    covered = np.zeros(found.lattice.shape, dtype=np.bool_)
    for one in found.set_downs:
        cells = covered_cells(pose.nodes(one.label), radius).as_array()
        gain_mm2 = (cells & ~covered).sum() * found.lattice.step_mm**2
        assert one.gain_mm2 == pytest.approx(gain_mm2)
        covered |= cells
    assert np.array_equal(covered, covered_cells(found.search.free, radius).as_array())
    gains_mm2 = [one.gain_mm2 for one in found.set_downs]
    assert gains_mm2 == sorted(gains_mm2, reverse=True)


@pytest.mark.parametrize("seed", range(5))
def test_no_component_adds_more_than_the_set_down_that_is_next(seed: int) -> None:
    found = result(seed)
    pose, cell_mm2 = found.search.pose, found.lattice.step_mm**2
    radius = found.robot.disc_radius_mm / found.lattice.step_mm
    covers = [covered_cells(pose.nodes(label), radius).words for label in range(len(pose.boxes))]
    todo = covered_cells(found.search.free, radius).words
    for one in found.set_downs:
        gains = [int(np.bitwise_count(cells & todo).sum()) for cells in covers]
        # of equal gains that of the lowest number
        assert (one.label, one.gain_mm2) == (gains.index(max(gains)), max(gains) * cell_mm2)
        assert pose.at(*one.state) == one.label
        todo = todo & ~covers[one.label]
    assert not todo.any()


def test_exact_outlines_have_the_same_zones_a_little_larger() -> None:
    exact = area_of_interest(two_rooms_apart(), settings=replace(SETTINGS, exact_outline=True))
    clean = area_of_interest(two_rooms_apart(), settings=SETTINGS)
    assert [zone.set_down for zone in exact.zones] == [zone.set_down for zone in clean.zones]
    for more, less in zip(exact.zones, clean.zones, strict=True):
        assert more.raster_area_mm2 == less.raster_area_mm2
        # clean outlines run up to 0.05 mm inside, and 16 m are around the larger room
        assert 0 <= more.area_mm2 - less.area_mm2 <= 0.05 * 16000


def test_without_a_start_the_largest_zone_is_taken() -> None:
    found = area_of_interest(two_rooms_apart(), settings=SETTINGS)
    assert found.search.start.source == "largest"
    assert found.search.start.pose_label == found.zones[0].label
    assert found.aoi.area_mm2 == pytest.approx(found.zones[0].area_mm2)


def test_start_in_the_smaller_room_trowels_the_smaller_room() -> None:
    found = area_of_interest(
        two_rooms_apart(), settings=SETTINGS, start=StartMark((5700.0, 2000.0))
    )
    assert found.aoi.area_mm2 == pytest.approx(found.zones[1].area_mm2)


def test_start_in_a_wall_names_the_wall_and_the_nearest_free_node() -> None:
    plan = two_rooms_apart()
    with pytest.raises(StartBlockedError) as caught:
        area_of_interest(plan, settings=SETTINGS, start=StartMark((4100.0, 2000.0)))
    error = caught.value
    assert (error.handle, error.layer) == ("1F", "W")
    assert error.nearest_mm is not None
    # whatever is nearest must do as a start
    found = area_of_interest(plan, settings=SETTINGS, start=StartMark(error.nearest_mm))
    assert found.report.start.xy_mm == pytest.approx(error.nearest_mm)


def test_start_with_angles_keeps_the_pose_that_was_asked_for() -> None:
    mark = StartMark((2000.0, 2000.0), angles_rad=(np.pi / 2, -np.pi / 6))
    report = area_of_interest(two_rooms_apart(), settings=SETTINGS, start=mark).report
    assert (report.start.a1_deg, report.start.a2_deg) == pytest.approx((90.0, -30.0))


def test_start_whose_pose_is_blocked_names_what_the_pose_touches() -> None:
    # disc 1 m off the wall, arm straight at it: the vehicle stands in it
    mark = StartMark((3000.0, 2000.0), angles_rad=(0.0, 0.0))
    with pytest.raises(StartBlockedError, match="this pose is not free; wall 1F"):
        area_of_interest(two_rooms_apart(), settings=SETTINGS, start=mark)


def test_floor_that_the_robot_does_not_fit_on_is_an_error() -> None:
    with pytest.raises(NothingFreeError, match="fits nowhere"):
        area_of_interest(FloorPlan(box(0, 0, 1000, 1000)), settings=SETTINGS)


def test_a_plan_without_a_floor_is_an_error() -> None:
    with pytest.raises(EmptyPlanError, match="no floor"):
        area_of_interest(FloorPlan(Polygon()), settings=SETTINGS)


def test_the_obstacle_that_takes_most_of_a_floor_without_free_poses_is_named() -> None:
    block, post = box(500, 500, 3500, 3500), box(0, 0, 100, 100)
    plan = FloorPlan(
        box(0, 0, 4000, 4000),
        (Obstacle(post, Kind.COLUMN, "C", "1E"), Obstacle(block, Kind.WALL, "ROOF", "1F")),
    )
    with pytest.raises(NothingFreeError, match=r"1F.*'ROOF' takes 9\.00 m²"):
        area_of_interest(plan, settings=SETTINGS)


@pytest.mark.parametrize("disc_mm", [20.0, 50.0, 350.0])
def test_no_set_covers_more_cells_than_its_bound_says(disc_mm: float) -> None:
    rng = np.random.default_rng(7)
    for _ in range(30):
        chosen = rng.random((rng.integers(1, 5), rng.integers(1, 9))) < 0.7
        chosen[0, 0] = True
        lattice = Lattice((0.0, 0.0), 10.0, *np.add(chosen.shape, 80).tolist(), 4, (0,))
        # room for all that the disc covers
        sets = DiscComponents.of(Nodes.of(np.pad(chosen, 40)))
        bounds_mm2 = _area_bounds_mm2(sets.boxes, disc_mm, lattice.step_mm)
        for label, bound_mm2 in enumerate(bounds_mm2.tolist()):
            assert _area_mm2(sets, label, lattice, disc_mm) <= bound_mm2
