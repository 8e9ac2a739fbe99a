"""The alternatives that the project is compared with do what is said of them."""

import json
import math
import os
import sys
from pathlib import Path

import numpy as np
import pytest
import scipy.ndimage
from shapely.geometry import LineString, box

from benchmarks import compare, hall
from benchmarks.cells import occupied_cells
from benchmarks.contender import CONTENDERS
from benchmarks.fft_raster import (
    PlainSlider,
    Slider,
    TunedSlider,
    add_shifted,
    free_nodes,
    rim_of_footprints,
    troweled_cells,
)
from benchmarks.kdtree_loop import KdTreeArrays, KdTreeLoop
from benchmarks.node_by_node import ReferenceLoop, drawn, flooded
from benchmarks.question import Images, Question
from satAOI_geo.freespace import free_space
from satAOI_geo.intervals import Intervals
from satAOI_geo.lattice import Lattice
from satAOI_geo.plan import BoolArray, Circle, FloorPlan, Kind, Obstacle
from satAOI_geo.robot import PROTOTYPE
from tests import plans
from tests.command_line import drawn_room

ROOT = Path(__file__).parents[1]
STEP_MM = 50.0


def coarse(plan: FloorPlan) -> Lattice:
    return Lattice.over(plan.floor.bounds, PROTOTYPE, step_mm=STEP_MM)


def sliders(image: BoolArray, rim: int, *, beyond: bool) -> list[Slider]:
    return [PlainSlider(image, beyond=beyond), TunedSlider(image, beyond=beyond, rim=rim)]


def test_a_cell_is_occupied_when_its_centre_lies_in_an_obstacle() -> None:
    # cells of 50 mm: centres at 25, 75, 125, ...; contact counts
    obstacles = (
        Obstacle(box(100, 100, 225, 174), Kind.COLUMN),
        Obstacle(Circle(375.0, 375.0, 50.0), Kind.HOLE),
        Obstacle(LineString([(0, 260), (500, 260)]), Kind.WALL),
    )
    plan = FloorPlan(box(0, 0, 500, 500), obstacles)
    occupied = occupied_cells(plan, coarse(plan))
    column = {(2, 2), (2, 3), (2, 4)}
    hole = {(7, 7), (6, 7), (8, 7), (7, 6), (7, 8)}
    wall = {(5, ix) for ix in range(10)}
    assert set(map(tuple, np.argwhere(occupied).tolist())) == column | hole | wall


@pytest.mark.parametrize("beyond", [False, True])
def test_both_sliders_find_what_a_dilation_finds(*, beyond: bool) -> None:
    draw = np.random.default_rng(1)
    image = draw.random((40, 57)) < 0.02
    footprint = draw.random((13, 13)) < 0.3
    # at a node: any set cell under the footprint; so the image grows by the mirrored footprint
    turned = footprint[::-1, ::-1]
    expected = scipy.ndimage.binary_dilation(
        np.pad(image, 6, constant_values=beyond), turned, border_value=beyond
    )[6:-6, 6:-6]
    opposite = scipy.ndimage.binary_dilation(
        np.pad(image, 6, constant_values=beyond), footprint, border_value=beyond
    )[6:-6, 6:-6]
    for slider in sliders(image, rim=6, beyond=beyond):
        assert np.array_equal(slider.hits(footprint), expected)
        both = slider.hits_both_ways(footprint)
        assert np.array_equal(both, (expected, opposite))


def test_a_shift_leads_from_the_cells_to_the_others() -> None:
    others = np.zeros((4, 5), dtype=np.bool_)
    others[2, 4] = True
    cells = np.zeros_like(others)
    add_shifted(cells, others, np.array((1.6, -0.6)))
    assert np.argwhere(cells).tolist() == [[3, 2]]


def test_the_raster_finds_all_that_is_free_with_half_a_cell_to_spare() -> None:
    # occupied centres lie in true obstacles, and a vehicle is shifted by half a diagonal at most
    plan = plans.random_plan(3, n_obstacles=4, side_mm=(4000, 5000))
    lattice = coarse(plan)
    spare = Intervals.of(plan, PROTOTYPE, lattice, clearance_mm=STEP_MM / math.sqrt(2))
    expected = free_space(spare, PROTOTYPE, lattice).free_nodes().as_array()
    assert expected.any()
    rim = rim_of_footprints(PROTOTYPE, lattice)
    for slider in sliders(occupied_cells(plan, lattice), rim, beyond=True):
        assert not (expected & ~free_nodes(slider, lattice, PROTOTYPE)).any()


def test_the_rasters_cover_the_cells_within_the_disc() -> None:
    plan = FloorPlan(box(0, 0, 3000, 3000))
    lattice, reached = coarse(plan), np.zeros((60, 60), dtype=np.bool_)
    reached[20, 30] = True
    rows, columns = np.indices(reached.shape)
    expected = np.hypot(rows - 20, columns - 30) <= PROTOTYPE.disc_radius_mm / STEP_MM
    rim = rim_of_footprints(PROTOTYPE, lattice)
    for slider in sliders(reached, rim, beyond=False):
        assert np.array_equal(troweled_cells(slider, lattice, PROTOTYPE), expected)


def test_the_paper_s_search_reaches_all_of_an_empty_room_but_a_rim() -> None:
    # 60 × 60 cells, the disc 7 cells in radius: the rim beyond the edge is in contact with a disc
    # on the 7th node, not on the 8th
    plan = FloorPlan(box(0, 0, 3000, 3000))
    lattice = Lattice.over(plan.floor.bounds, PROTOTYPE, step_mm=STEP_MM, n_directions=4)
    loop = KdTreeArrays(occupied_cells(plan, lattice), lattice, PROTOTYPE)
    reached = flooded((30, 30), loop.fits)
    assert reached == {(iy, ix) for iy in range(7, 53) for ix in range(7, 53)}
    troweled: set[int] = set()
    loop.trowel((30, 30), troweled)
    n_in_disc = sum(dy * dy + dx * dx <= 49 for dy in range(-7, 8) for dx in range(-7, 8))
    assert len(troweled) == n_in_disc


def test_loops_and_arrays_of_the_paper_s_program_agree() -> None:
    plan = plans.random_plan(5, n_obstacles=4, side_mm=(4000, 5000))
    lattice = coarse(plan)
    images = Images.of(plan, lattice)
    loop = KdTreeLoop(images.occupied, lattice, PROTOTYPE)
    arrays = KdTreeArrays(images.occupied, lattice, PROTOTYPE)
    nodes = drawn(images.tried(), 20)
    assert [loop.fits(node) for node in nodes] == [arrays.fits(node) for node in nodes]


def test_the_reference_node_by_node_finds_the_free_nodes() -> None:
    plan = plans.random_plan(5, n_obstacles=4, side_mm=(4000, 5000))
    lattice = coarse(plan)
    images = Images.of(plan, lattice)
    fits = ReferenceLoop(plan, lattice).fits
    nodes = drawn(images.tried(), 100)
    assert [fits(node) for node in nodes] == [bool(images.free[node]) for node in nodes]
    assert 0 < sum(map(fits, nodes)) < len(nodes)


def test_all_contenders_answer_the_same_question() -> None:
    # 10 mm, for the project's own search chooses that lattice
    plan = FloorPlan(box(0, 0, 2600, 2400), (Obstacle(box(0, 0, 200, 200), Kind.COLUMN),))
    lattice = Lattice.over(plan.floor.bounds, PROTOTYPE)
    question = Question(plan, lattice, Images.of(plan, lattice), n_runs=1, n_sampled=2)
    figures = {name: contender(question) for name, contender in CONTENDERS.items()}
    assert tuple(figures) == compare.CONTENDERS
    assert all(one.clock_s > 0 for one in figures.values())
    for name in ("reference", *compare.OURS, "whole answer"):
        assert figures[name].n_wrongly_free == figures[name].n_wrongly_blocked == 0


def test_a_contender_in_a_process_of_its_own_tells_its_figures(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(sys.path))
    given = str(ROOT / "samples" / "two_rooms_900.dxf"), str(tmp_path / "images.npz")
    compare.said_by("images", *given)
    figures = json.loads(compare.said_by("disc-connected", *given, "--runs", "1"))
    assert figures["peak_mb"] >= figures["before_mb"] > 0
    assert figures["n_wrongly_free"] == figures["n_wrongly_blocked"] == 0
    assert figures["n_nodes"] > 300_000


def test_times_are_told_in_hours_and_seconds() -> None:
    assert compare.time_in_words(0.256, 0.0) == "0.26 s"
    assert compare.time_in_words(1575.4, 218.6) == "1575 ± 219 s"
    assert compare.time_in_words(9 * 3600.0, 1800.0) == "9.00 ± 0.50 h"


def test_every_stage_that_is_timed_runs(tmp_path: Path) -> None:
    for job in hall.stages(drawn_room(tmp_path / "room.dxf"), tmp_path).values():
        job()
    assert (tmp_path / "stage.dxf").exists()
