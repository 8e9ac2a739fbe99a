"""Arcs found again: rings whose corners lie on circles are drawn as circles."""

import math

import numpy as np
import pytest
import shapely
from shapely.geometry import LinearRing, box

from satAOI_adapters.arcs import RISE_MM, loops_with_arcs, outlines_with_arcs
from satAOI_geo.aoi import Loop
from satAOI_geo.plan import polygons_in
from tests import results


def loop_with_arcs(ring: LinearRing) -> Loop:
    """What becomes of a ring, whatever rings come before and after it."""
    alone, _, among, _ = loops_with_arcs([ring, ring_about(400, 350.0), ring, ring_about(8, 9.0)])
    assert alone.vertices.tolist() == among.vertices.tolist()
    return alone


def ring_about(n_corners: int, radius_mm: float) -> LinearRing:
    angles_rad = np.arange(n_corners) * math.tau / n_corners
    return LinearRing(radius_mm * np.column_stack((np.cos(angles_rad), np.sin(angles_rad))))


@pytest.mark.parametrize("begin", [0, 1, 29, 30, 100])
@pytest.mark.parametrize(
    "loop",
    [
        pytest.param(results.rounded_rectangle(2000, 3000, 350), id="rounded rectangle"),
        pytest.param(Loop(np.array([(0, 0, 1), (0, 700, 0)])), id="half a disc"),
        pytest.param(Loop(np.array([(0, 0, 0.3), (0, 700, 0.2)])), id="lens: arc after arc"),
        pytest.param(Loop(np.array([(0, 0, -1), (0, 700, 0.5)])), id="moon, clockwise"),
        pytest.param(Loop(np.array([(0, 350, 2.0), (350, 0, 0), (0, 0, 0)])), id="most of a disc"),
    ],
)
def test_arcs_cut_into_chords_come_back_wherever_the_ring_begins(loop: Loop, begin: int) -> None:
    corners_mm = np.roll(loop.points_mm(0.01), -begin, axis=0)
    found = loop_with_arcs(LinearRing(corners_mm))
    assert sorted(found.vertices.tolist()) == [
        pytest.approx(vertex, abs=1e-9) for vertex in sorted(loop.vertices.tolist())
    ]
    # centres come from three corners, with a few digits less than these have
    assert found.area_mm2() == pytest.approx(loop.area_mm2(), rel=1e-10)


@pytest.mark.parametrize("begin", [0, 1, 29, 30, 100])
def test_arcs_whose_corners_keep_their_area_come_back_with_their_true_ends(begin: int) -> None:
    # the corners between the ends lie on a circle of their own, a few micrometres larger
    loop = results.rounded_rectangle(2000, 3000, 350)
    corners_mm = np.roll(loop.equal_area_points_mm(0.01), -begin, axis=0)
    found = loop_with_arcs(LinearRing(corners_mm))
    assert sorted(found.vertices.tolist()) == [
        pytest.approx(vertex, abs=1e-6) for vertex in sorted(loop.vertices.tolist())
    ]


@pytest.mark.parametrize("bulge", [1.0, -1.0])
def test_corners_all_around_a_circle_are_two_half_circles(bulge: float) -> None:
    ring = ring_about(400, 350.0)
    loop = loop_with_arcs(ring if bulge > 0 else ring.reverse())
    expected = np.array([(350.0, 0.0, bulge), (-350.0, 0.0, bulge)])
    assert loop.vertices == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize(
    "drawn",
    [
        pytest.param(box(0, 0, 400, 400).exterior, id="square"),
        pytest.param(ring_about(8, 200.0), id="pillar of eight corners"),
        pytest.param(ring_about(64, 200.0), id="64 corners, the circle 0.24 mm over its chords"),
        pytest.param(LinearRing([(0, 0), (9, 0), (4, 7)]), id="triangle"),
    ],
)
def test_what_was_drawn_with_corners_keeps_them(drawn: LinearRing) -> None:
    loop = loop_with_arcs(drawn)
    assert loop.vertices[:, :2].tolist() == shapely.get_coordinates(drawn)[:-1].tolist()
    assert not loop.vertices[:, 2].any()


@pytest.mark.parametrize("width_mm", [0.0, 1e-6])
def test_spikes_and_repeated_corners_are_left_out(width_mm: float) -> None:
    corners = [(0, 0), (9, 0), (9, 5), (12, 5), (12, 5), (9, 5 + width_mm), (9, 9), (0, 9), (0, 9)]
    loop = loop_with_arcs(LinearRing(corners))
    left = {(x, y) for x, y, _ in loop.vertices.round(3).tolist()}
    assert left == {(0, 0), (9, 0), (9, 5), (9, 9), (0, 9)}
    assert loop.area_mm2() == pytest.approx(81, abs=1e-4)


def test_a_spike_of_many_corners_is_left_out_whole() -> None:
    n = 1500
    there = [(k, 5.0) for k in range(9, n)]
    corners = [(0, 0), (9, 0), *there, *there[-2::-1], (9, 9), (0, 9)]
    assert loop_with_arcs(LinearRing(corners)).area_mm2() == pytest.approx(81)


def test_no_patch_is_drawn_farther_off_than_the_rise_of_its_arcs() -> None:
    regions = [patch.region for patch in results.furnished_result().patches if not patch.narrow]
    polygons = polygons_in(regions)
    for polygon, outline in zip(polygons, outlines_with_arcs(polygons), strict=True):
        drawn = outline.polygon(RISE_MM / 4)
        corners = shapely.points(shapely.get_coordinates(drawn))
        assert shapely.distance(corners, polygon.boundary).max() <= RISE_MM
        assert drawn.area == pytest.approx(polygon.area, abs=RISE_MM * polygon.length)


def test_patches_beside_discs_are_drawn_with_far_fewer_corners() -> None:
    regions = [patch.region for patch in results.furnished_result().patches if not patch.narrow]
    outlines = outlines_with_arcs(polygons_in(regions))
    n_drawn = sum(len(loop.vertices) for o in outlines for loop in (o.exterior, *o.holes))
    assert n_drawn < sum(map(shapely.get_num_coordinates, regions)) / 4


def test_no_polygons_have_no_outlines() -> None:
    assert outlines_with_arcs([]) == []
