"""Building models that nobody of this project made: what is read from them, against witnesses."""

from dataclasses import dataclass
from pathlib import Path

import pytest
import shapely

from satAOI_adapters.ifc_read.bodies import NoBodyError
from satAOI_adapters.ifc_read.classes import Choice
from satAOI_adapters.ifc_read.flaws import Flaws
from satAOI_adapters.ifc_read.meshes import GROWTH_MM
from satAOI_adapters.ifc_read.model import body_items, open_model, units_of
from satAOI_adapters.ifc_read.prisms import View
from satAOI_adapters.ifc_read.site import Site, Standing
from satAOI_geo.errors import EmptyPlanError
from satAOI_geo.plan import FloorPlan
from tests.test_ifc_read import codes, plan_in

MODELS = Path(__file__).parents[2] / "shared" / "corpus" / "ifc"
pytestmark = pytest.mark.skipif(not MODELS.is_dir(), reason="the corpus is not here")


@dataclass(frozen=True, slots=True)
class Case:
    """A storey; its floor's area by hand; a free point and its distance from the nearest thing.

    Point and distance were measured by others, on sections of the kernel's meshes, in metres.
    """

    model: str
    storey: str | None
    source: str
    floor_m2: float
    point_m: tuple[float, float]
    clear_m: float


CASES = (
    Case("i01_fzk_haus_ifc4_m", "Erdgeschoss", "slab", 12.0 * 10.0, (9.6, 6.4), 1.95),
    # two slabs and two terraces
    Case("i02_duplex_ifc2x3_m", "Level 1", "slab", 180.53, (3.26, -14.24), 2.85),
    # two blocks of the same size
    Case("i03_large_building_two_blocks_mm", "Level 1", "slab", 308.88, (-11.23, 0.61), 2.96),
    Case("i04_tall_building_mm", "Level 1", "slab", 8.2 * 8.2, (0.28, -5.93), 1.85),
    # no storey; the floor is made of tiles, and two pools are missing tiles
    Case("i05_barcelona_pavilion_freecad_no_storey", None, "support", 608.01, (5.0, -4.0), 2.6),
    Case("i06_pcert_architecture_georef_mm_triangulated", None, "slab", 25.75, (6.8, 5.1), 0.36),
    Case("i07_rotated_walls_swept_ifc4", "0", "slab", 32.16, (-1.08, -1.77), 1.92),
    # no slab: the house stands on a footing as large as itself
    Case("i08_openhouse_ifc4_mapped_walls_mm", None, "support", 55.15, (0.63, 2.46), 2.28),
    Case("i09_skew_hall_columns_offset_mm", "Level 1", "slab", 165.43, (-21.5, 100.25), 3.57),
    # neither slab nor space: walls around 3 x 6 m
    Case("i11_bonsai_tutorial_openings_m", None, "inferred", 18.0, (1.5, 1.6), 1.3),
)


def storey_plan(model: str, storey: str | None) -> FloorPlan:
    return plan_in(MODELS / f"{model}.ifc", storey=storey)


@pytest.mark.parametrize("case", CASES, ids=[case.model[:3] for case in CASES])
def test_floors_and_clear_distances_are_those_that_others_measured(case: Case) -> None:
    plan = storey_plan(case.model, case.storey)
    assert plan.floor_source == case.source
    assert plan.floor.area / 1e6 == pytest.approx(case.floor_m2, abs=0.005)
    at = [metres * 1000.0 / plan.frame.mm_per_unit for metres in case.point_m]
    point = shapely.Point(plan.frame.to_local_mm(at))
    assert plan.floor.contains(point)
    clear_mm = min(obstacle.region().distance(point) for obstacle in plan.obstacles)
    # a window frame, or a handrail, more or less
    assert clear_mm / 1000.0 == pytest.approx(case.clear_m, abs=0.03)
    assert "element-unreadable" not in codes(plan)


@pytest.mark.parametrize("model", [case.model for case in CASES], ids=lambda name: name[:3])
def test_exact_bodies_agree_with_the_kernels_meshes(model: str) -> None:
    path = MODELS / f"{model}.ifc"
    opened = open_model(path, path).model
    units, _ = units_of(opened, None)
    site = Site.of(opened, units, Choice(), Flaws({}), lambda _: None)
    view = View(1.0, 1200.0, outward=True)
    for product in site.products:
        if body_items(product) and site.is_near(product, view.low_mm, view.high_mm):
            exact = site.reader.body(product, view)
            if exact.meshes:
                continue
            try:
                meshed = site.reader.meshed(product)
            except NoBodyError:
                continue
            seen, expected = (
                Standing(product, body, tuple(body.in_band(view))).region()
                for body in (exact, meshed)
            )
            # a mesh of curves is inscribed, and grown for that
            slack_mm2 = 10.0 + GROWTH_MM * 1.1 * expected.length * bool(meshed.meshes[0].growth_mm)
            assert seen.symmetric_difference(expected).area <= slack_mm2, product


def test_a_hole_in_the_slab_of_the_storey_above_belongs_to_its_floor() -> None:
    ground = storey_plan("i01_fzk_haus_ifc4_m", "Erdgeschoss")
    upper = storey_plan("i01_fzk_haus_ifc4_m", "Dachgeschoss")
    assert not [o for o in ground.obstacles if o.kind == "hole"]
    (stairwell,) = [o for o in upper.obstacles if o.kind == "hole"]
    assert stairwell.layer == "IfcOpeningElement"
    assert stairwell.region().area / 1e6 == pytest.approx(15.8, abs=0.05)


def test_a_georeferenced_model_stays_near_its_own_origin() -> None:
    plan = storey_plan("i06_pcert_architecture_georef_mm_triangulated", None)
    assert plan.frame.origin_mm == (3199.0, 3000.0)


def test_openings_of_a_hand_are_holes_round_and_square() -> None:
    plan = storey_plan("i12_ifc4x3_slab_two_openings_mm", None)
    assert len(plan.obstacles) == 2
    assert {o.kind for o in plan.obstacles} == {"hole"}


@pytest.mark.parametrize("model", ["i13_ifc4x3_single_wall_mm", "i14_ifc4x3_georef_utm_proxy"])
def test_models_without_a_floor_say_so(model: str) -> None:
    with pytest.raises(EmptyPlanError, match="no slab, space or other level surface"):
        storey_plan(model, None)
