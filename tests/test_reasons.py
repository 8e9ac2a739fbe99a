"""Every patch of free floor that is left over has one reason, and none is lost."""

import itertools
from dataclasses import replace
from typing import Literal

import numpy as np
import pytest
import shapely
from shapely.geometry import Point, Polygon, box

from satAOI_geo import tiles
from satAOI_geo.explain import explain
from satAOI_geo.pipeline import Result, area_of_interest
from satAOI_geo.plan import FloorPlan, Kind, Obstacle, polygons_in
from satAOI_geo.reasons import Patch, Reason, _Blockers, _Piece, put_together, unreached
from satAOI_geo.settings import Settings
from satAOI_geo.start import StartMark
from satAOI_geo.units import MM2_PER_M2
from tests import plans

SETTINGS = Settings(step_mm=10.0)

SLACK_MM2 = 1e-6 * MM2_PER_M2


def at(result: Result, x_mm: float, y_mm: float) -> Patch:
    """The patch that holds a point."""
    (patch,) = [p for p in result.patches if p.region.intersects(Point(x_mm, y_mm))]
    return patch


def blocks(*boxes: tuple[float, float, float, float]) -> tuple[Obstacle, ...]:
    return tuple(
        Obstacle(box(*bounds), Kind.WALL, "WALL", f"{number:X}")
        for number, bounds in enumerate(boxes, start=10)
    )


def niche(width_mm: float, depth_mm: float) -> Result:
    """A 4 × 4 m room with a niche in its right wall, in the middle of it, robot on the left."""
    low, high = 2000 - width_mm / 2, 2000 + width_mm / 2
    right = 4000 + depth_mm
    walls = blocks((4000, 0, right, low), (4000, high, right, 4000))
    plan = FloorPlan(box(0, 0, right, 4000), walls)
    return area_of_interest(plan, settings=SETTINGS, start=StartMark((1500.0, 2000.0)))


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("connectivity", ["disc", "pose"])
def test_patches_and_area_add_up_to_the_free_floor(seed: int, connectivity: str) -> None:
    settings = Settings(step_mm=25.0, n_directions=12, connectivity=connectivity)
    result = area_of_interest(plans.random_plan(seed), settings=settings)
    left_mm2 = sum(patch.area_mm2 for patch in result.patches)
    free_mm2 = result.plan.free_region().area
    assert left_mm2 + result.aoi.area_mm2 == pytest.approx(free_mm2, abs=SLACK_MM2)


@pytest.mark.parametrize("seed", range(6))
def test_patches_do_not_overlap(seed: int) -> None:
    settings = Settings(step_mm=25.0, n_directions=12)
    regions = [
        p.region for p in area_of_interest(plans.random_plan(seed), settings=settings).patches
    ]
    together = shapely.union_all(regions).area
    assert together == pytest.approx(sum(region.area for region in regions), abs=SLACK_MM2)


def test_a_patch_keeps_the_area_of_its_shape_in_16_bytes_a_corner() -> None:
    for patch in niche(690, 1600).patches:
        n_rings = sum(1 + len(part.interiors) for part in polygons_in([patch.region]))
        assert patch.area_mm2 == patch.region.area
        assert len(patch.wkb) <= 16 * shapely.get_num_coordinates(patch.region) + 16 * (n_rings + 1)


@pytest.mark.parametrize("seed", range(6))
def test_label_lies_in_its_patch(seed: int) -> None:
    settings = Settings(step_mm=25.0, n_directions=12)
    for patch in area_of_interest(plans.random_plan(seed), settings=settings).patches:
        assert patch.region.intersects(Point(patch.label_mm))


@pytest.mark.parametrize("seed", [0, 2, 6])
@pytest.mark.parametrize("tile_cells", [64, 128])
def test_a_floor_cut_into_tiles_has_the_same_left_over(
    monkeypatch: pytest.MonkeyPatch, seed: int, tile_cells: int
) -> None:
    settings = Settings(step_mm=25.0, n_directions=12)
    result = area_of_interest(plans.random_plan(seed), settings=settings)
    monkeypatch.setattr(tiles, "TILE_CELLS", tile_cells)
    cut = unreached(result.search, result.aoi, result.upper)

    left_mm2 = sum(patch.area_mm2 for patch in result.patches)
    assert sum(patch.area_mm2 for patch in cut) == pytest.approx(left_mm2, abs=SLACK_MM2)
    together = shapely.union_all([patch.region for patch in cut]).area
    assert together == pytest.approx(left_mm2, abs=SLACK_MM2)
    # a seam may change to which reason a sliver counts, and no more than that
    for reason in Reason:
        whole_mm2, cut_mm2 = (
            sum(patch.area_mm2 for patch in patches if patch.reason is reason)
            for patches in (result.patches, cut)
        )
        assert cut_mm2 == pytest.approx(whole_mm2, abs=0.004 * left_mm2)
    assert cut[0].area_mm2 == pytest.approx(result.patches[0].area_mm2, rel=0.01)


@pytest.mark.parametrize("seed", [1, 3])
def test_free_floor_by_rectangles_is_the_free_floor(seed: int) -> None:
    plan = plans.random_plan(seed)
    whole = plan.free_region()
    free = tiles.FreeFloor(plan.floor, [obstacle.region() for obstacle in plan.obstacles])
    left, bottom, right, top = plan.floor.bounds
    middle_mm = (left + right) / 2
    for bounds_mm in [(left, bottom, middle_mm, top), (middle_mm, bottom, right, top)]:
        own = free.within(bounds_mm)
        assert own.symmetric_difference(whole.intersection(box(*bounds_mm))).area < SLACK_MM2


@pytest.mark.parametrize("corner_mm", [10.0, 10.0 - 1e-9], ids=["on the seam", "beside it"])
def test_pieces_become_one_where_a_corner_is_on_one_side_of_their_seam_only(
    corner_mm: float,
) -> None:
    left = box(0, 0, 10, 10)
    right = Polygon([(10, 0), (20, 0), (20, 10), (10, 10), (corner_mm, 5)])
    together = put_together(np.array([left, right], dtype=object))
    assert together.geom_type == "Polygon"
    assert together.area == pytest.approx(200.0)


def test_niche_narrower_than_the_disc_is_left_for_the_disc() -> None:
    patch = at(niche(690, 1600), 5000, 2000)
    assert patch.reason is Reason.DISC
    assert patch.blocker is not None
    assert patch.blocker.handle in {"A", "B"}


@pytest.mark.parametrize(
    ("nearer_mm", "handle"), [(0.0, "A"), (1e-9, "A"), (-1e-9, "A"), (1.0, "B")]
)
def test_of_walls_as_near_but_for_a_rounding_the_first_is_in_the_way(
    nearer_mm: float, handle: str
) -> None:
    walls = blocks((0, 0, 100, 1000), (300 - nearer_mm, 0, 400, 1000))
    plan = FloorPlan(box(-1000, -1000, 2000, 2000), walls)
    blockers = _Blockers(plan, [wall.region() for wall in walls])
    between = blockers.patch(_Piece(Reason.DISC, box(190, 490, 210, 510)))
    assert between.blocker is not None
    assert between.blocker.handle == handle


@pytest.mark.parametrize("turn_deg", [0, 7, 20, 33, 52, 71])
def test_corners_of_a_room_come_from_the_left_though_roundings_tell_them_apart(
    turn_deg: float,
) -> None:
    room = shapely.affinity.rotate(box(0, 0, 4000, 4000), turn_deg, origin=(0, 0))
    patches = area_of_interest(FloorPlan(room, ()), settings=SETTINGS).patches
    corners = [patch for patch in patches if not patch.narrow and patch.reason is Reason.DISC]
    assert len({round(patch.area_mm2) for patch in corners}) == 1
    assert len(corners) == 4
    assert [patch.label_mm for patch in corners] == sorted(patch.label_mm for patch in corners)


def test_end_of_a_deep_niche_that_only_the_disc_fits_is_left_for_the_vehicle() -> None:
    # the disc gets in as deep as the vehicle, 830 mm wide, can follow with its arm: 700 mm
    patch = at(niche(760, 2500), 6000, 2000)
    assert patch.reason is Reason.VEHICLE


def test_well_as_wide_as_the_disc_is_left_for_the_arm() -> None:
    # a closed 800 × 800 mm shaft holds the disc, but not the 1345 mm of disc and arm
    around = blocks(
        (1500, 1500, 2500, 1600),
        (1500, 2400, 2500, 2500),
        (1500, 1600, 1600, 2400),
        (2400, 1600, 2500, 2400),
    )
    plan = FloorPlan(box(0, 0, 6000, 4000), around)
    result = area_of_interest(plan, settings=SETTINGS, start=StartMark((4500.0, 2000.0)))
    assert at(result, 2000, 2000).reason is Reason.ARM


def test_far_room_behind_a_gap_for_the_disc_alone_is_left_for_want_of_a_path() -> None:
    case = plans.two_rooms(760.0)
    result = area_of_interest(case.plan, settings=SETTINGS, start=StartMark(case.start_mm))
    assert case.beyond_mm is not None
    assert at(result, *case.beyond_mm).reason is Reason.PATH


def test_far_room_behind_a_gap_too_narrow_for_the_disc_is_another_zone() -> None:
    case = plans.two_rooms(690.0)
    result = area_of_interest(case.plan, settings=SETTINGS, start=StartMark(case.start_mm))
    far_mm = (case.plan.floor.bounds[2] - 1000.0, 2000.0)
    assert at(result, *far_mm).reason is Reason.ZONE


@pytest.mark.parametrize("connectivity", ["disc", "pose"])
def test_the_middle_of_a_cell_is_explained_as_the_raster_has_it(
    connectivity: Literal["disc", "pose"],
) -> None:
    # walls on whole steps: the disc touches the middles of cells along them
    case = plans.two_rooms(760.0)
    settings = replace(SETTINGS, step_mm=10.0, n_directions=8, connectivity=connectivity)
    result = area_of_interest(case.plan, settings=settings, start=StartMark(case.start_mm))
    cells, lattice = result.aoi.cells.as_array(), result.lattice
    around = np.pad(cells, 1)
    neighbours = [np.roll(around, by, axis)[1:-1, 1:-1] for axis in (0, 1) for by in (-1, 1)]
    edge = np.argwhere(np.any([each != cells for each in neighbours], axis=0))
    blocked = shapely.union_all([one.region() for one in result.plan.obstacles])
    for iy, ix in edge[:: len(edge) // 150].tolist():
        at_mm = lattice.x_mm(ix), lattice.y_mm(iy)
        if not blocked.intersects(Point(at_mm)):
            assert explain(result, at_mm).startswith("The disc trowels") == cells[iy, ix]


def test_a_point_is_explained_by_what_holds_it() -> None:
    result = niche(690, 600)
    sentences = {
        "trowelled": explain(result, (1500.0, 2000.0)),
        "left over": explain(result, (4500.0, 2000.0)),
        "in a wall": explain(result, (4300.0, 500.0)),
        "outside": explain(result, (-1.0, 0.0)),
    }
    assert sentences["trowelled"].startswith("The disc trowels this point")
    assert "too narrow for the troweling disc" in sentences["left over"]
    assert sentences["in a wall"] == "This point lies in wall A on layer 'WALL'."
    assert sentences["outside"] == "This point is not on the floor."
    assert all(a != b for a, b in itertools.combinations(sentences.values(), 2))
