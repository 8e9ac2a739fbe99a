"""The area is that of the union of discs; its outline bounds it, and the clean one runs inside."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from shapely.geometry import Point, Polygon
from shapely.geometry.base import BaseGeometry

from satAOI_geo.aoi import CLEAN_MM, Aoi, Loop, area, areas
from satAOI_geo.errors import InputError
from satAOI_geo.lattice import Lattice
from satAOI_geo.nodes import Nodes
from satAOI_geo.plan import BoolArray, FloatArray

STEP_MM = 10.0
DISC_MM = 350.0
SAGITTA_MM = 0.002

RADII = (2.5, 3.5, 5.0, 1.0, 0.3, 0.5, 0.7, math.sqrt(0.5), math.sqrt(1.25), math.sqrt(2), 3.333)
"""In steps. The first three make many circles meet in one point and many discs touch; from
sqrt(1/2) down the four neighbours of a node do not cover its circle."""


STEPS_MM = (10.0, 1.0, 0.25)
"""At these radii the clean outline keeps all scallops, drops those of unit steps, drops most."""


def lattice_of(shape: tuple[int, ...], step_mm: float = STEP_MM) -> Lattice:
    n_rows, n_columns = shape
    return Lattice((-1234.5, 777.25), step_mm, n_rows, n_columns, 24, (0,))


@dataclass(frozen=True)
class Discs:
    """Reached nodes and the discs' radius in steps."""

    reached: BoolArray
    radius: float
    step_mm: float = STEP_MM

    @property
    def radius_mm(self) -> float:
        return self.radius * self.step_mm

    @property
    def lattice(self) -> Lattice:
        return lattice_of(self.reached.shape, self.step_mm)

    def aoi(self, *, exact: bool = True) -> Aoi:
        return area(Nodes.of(self.reached), self.lattice, self.radius_mm, exact=exact)

    def nodes_mm(self) -> FloatArray:
        """Shape (n, 2)."""
        lattice = self.lattice
        nodes = [(lattice.x_mm(ix), lattice.y_mm(iy)) for iy, ix in np.argwhere(self.reached)]
        return np.array(nodes).reshape(-1, 2)


@st.composite
def discs(draw: st.DrawFn) -> Discs:
    """Rectangles of nodes set and cleared one after the other, down to single nodes."""
    shape = draw(st.integers(1, 16)), draw(st.integers(1, 16))
    corner, side = st.integers(0, 15), st.sampled_from((1, 1, 1, 2, 3, 5, 8, 13))
    rectangle = st.tuples(corner, corner, side, side, st.sampled_from((True, True, True, False)))
    reached = np.zeros(shape, dtype=np.bool_)
    for iy, ix, height, width, value in draw(st.lists(rectangle, min_size=1, max_size=14)):
        reached[iy : iy + height, ix : ix + width] = value
    return Discs(reached, draw(st.sampled_from(RADII)), draw(st.sampled_from(STEPS_MM)))


def at(*nodes: tuple[int, int], shape: tuple[int, int], radius: float) -> Discs:
    """Discs on nodes (row, column)."""
    reached = np.zeros(shape, dtype=np.bool_)
    reached[tuple(np.array(nodes).T)] = True
    return Discs(reached, radius)


def rectangle_of_nodes(rows: int, columns: int) -> Discs:
    reached = np.zeros((rows + 80, columns + 80), dtype=np.bool_)
    reached[40 : 40 + rows, 40 : 40 + columns] = True
    return Discs(reached, DISC_MM / STEP_MM)


def polygons(aoi: Aoi, sagitta_mm: float = SAGITTA_MM) -> list[Polygon]:
    return [outline.polygon(sagitta_mm) for outline in aoi.outlines]


def loops(aoi: Aoi) -> Iterable[Loop]:
    for outline in aoi.outlines:
        yield outline.exterior
        yield from outline.holes


def union_area_mm2(nodes_mm: FloatArray, radius_mm: float) -> float:
    """Green's theorem, ½ ∮ x dy - y dx, over what no other disc covers of each circle."""
    total_mm2 = 0.0
    nodes_mm = nodes_mm - nodes_mm.mean(axis=0)
    for node_mm in nodes_mm:
        x_mm, y_mm = (nodes_mm - node_mm).T
        apart_mm = np.hypot(x_mm, y_mm)
        meets = (apart_mm > 0) & (apart_mm < 2 * radius_mm - 1e-6)
        half_rad = np.arccos(apart_mm[meets] / (2 * radius_mm))
        begins_rad = (np.arctan2(y_mm[meets], x_mm[meets]) - half_rad) % (2 * math.pi)
        covered = sorted(zip(begins_rad, begins_rad + 2 * half_rad, strict=True))
        # what is covered up to here, carried over from the end of the turn
        end_rad = max((end for _, end in covered), default=2 * math.pi) - 2 * math.pi
        for begin_rad, until_rad in covered or [(2 * math.pi, 2 * math.pi)]:
            if begin_rad > end_rad:
                along_x = math.sin(begin_rad) - math.sin(end_rad)
                along_y = math.cos(end_rad) - math.cos(begin_rad)
                moment_mm2 = radius_mm * (node_mm[0] * along_x + node_mm[1] * along_y)
                total_mm2 += (moment_mm2 + radius_mm**2 * (begin_rad - end_rad)) / 2
            end_rad = max(end_rad, until_rad)
    return total_mm2


def n_overlapping_groups(nodes_mm: FloatArray, radius_mm: float) -> int:
    """How many parts the open discs make; discs that only touch are apart."""
    ungrouped = set(range(len(nodes_mm)))
    n_groups = 0
    while ungrouped:
        n_groups += 1
        group = [ungrouped.pop()]
        while group:
            apart_mm = np.hypot(*(nodes_mm - nodes_mm[group.pop()]).T)
            near = ungrouped & set(np.flatnonzero(apart_mm < 2 * radius_mm - 1e-6).tolist())
            ungrouped -= near
            group.extend(near)
    return n_groups


def lines_lie_within(distance_mm: float, one: BaseGeometry, other: BaseGeometry) -> bool:
    """Whether each lies within a distance of the other: the Hausdorff distance, but quicker."""
    return bool(one.buffer(distance_mm).covers(other) and other.buffer(distance_mm).covers(one))


def test_one_node_covers_one_disc_in_two_half_circles() -> None:
    (outline,) = at((40, 50), shape=(80, 100), radius=35.0).aoi().outlines
    assert outline.area_mm2() == pytest.approx(math.pi * DISC_MM**2, rel=1e-15)
    assert outline.exterior.vertices[:, 2].tolist() == [1.0, 1.0]


def test_no_node_covers_nothing() -> None:
    aoi = Discs(np.zeros((20, 30), dtype=np.bool_), 3.5).aoi()
    assert (aoi.outlines, aoi.area_mm2, aoi.raster_area_mm2) == ((), 0.0, 0.0)
    assert not aoi.raster.any()


def test_nodes_of_another_lattice_are_refused() -> None:
    with pytest.raises(InputError, match="shape"):
        area(Nodes.of(np.ones((3, 4), dtype=np.bool_)), lattice_of((4, 3)), DISC_MM)


@pytest.mark.parametrize(("rows", "columns"), [(21, 39), (2, 2), (300, 5)])
def test_rectangle_of_nodes_covers_the_rounded_rectangle_less_a_scallop_a_step(
    rows: int, columns: int
) -> None:
    height_mm, width_mm = (rows - 1) * STEP_MM, (columns - 1) * STEP_MM
    rounded_mm2 = (width_mm + 2 * DISC_MM) * (height_mm + 2 * DISC_MM)
    rounded_mm2 -= (4 - math.pi) * DISC_MM**2
    half_rad = math.asin(STEP_MM / 2 / DISC_MM)
    n_steps = 2 * (rows - 1 + columns - 1)
    under_arc_mm2 = DISC_MM**2 * (half_rad + math.sin(half_rad) * math.cos(half_rad))
    exact_mm2 = rounded_mm2 - n_steps * (STEP_MM * DISC_MM - under_arc_mm2)
    segment_mm2 = DISC_MM**2 * (2 * half_rad - math.sin(2 * half_rad)) / 2
    clean_mm2 = exact_mm2 - (n_steps - 4) * segment_mm2
    rectangle = rectangle_of_nodes(rows, columns)
    assert rectangle.aoi().area_mm2 == pytest.approx(exact_mm2, rel=1e-13)
    assert rectangle.aoi(exact=False).area_mm2 == pytest.approx(clean_mm2, rel=1e-13)


def test_clean_outline_of_a_rectangle_of_nodes_is_four_lines_and_four_quarter_arcs() -> None:
    (outline,) = rectangle_of_nodes(21, 39).aoi(exact=False).outlines
    # a corner's arc ends half a step beyond its quarter turn on both sides
    quarter_rad = math.pi / 2 + 2 * math.asin(STEP_MM / 2 / DISC_MM)
    bulges = outline.exterior.vertices[:, 2]
    assert bulges[0::2].tolist() == [0.0] * 4
    assert bulges[1::2] == pytest.approx([math.tan(quarter_rad / 4)] * 4, rel=1e-14)
    # and the first line, along the bottom, is level to the last bit
    assert outline.exterior.vertices[0, 1] == outline.exterior.vertices[1, 1]


def test_loop_of_nodes_along_the_walls_of_a_room_leaves_a_hole() -> None:
    reached = rectangle_of_nodes(121, 181).reached
    reached[41:160, 41:220] = False
    (outline,) = Discs(reached, 35.0).aoi(exact=False).outlines
    height_mm, width_mm = 1200.0, 1800.0
    outer_mm2 = (width_mm + 700) * (height_mm + 700) - (4 - math.pi) * DISC_MM**2
    inner_mm2 = (width_mm - 700) * (height_mm - 700)
    (hole,) = outline.holes
    depth_mm = STEP_MM**2 / (8 * DISC_MM) * 1.001
    assert 0 <= outer_mm2 - outline.exterior.area_mm2() <= 6000 * depth_mm
    assert 0 <= -hole.area_mm2() - inner_mm2 <= 3200 * depth_mm


def test_touching_discs_are_two_parts_that_share_a_point() -> None:
    # 21, 28, 35: the centres are 70 steps apart, twice the radius
    apart = at((40, 40), (40 + 42, 40 + 56), shape=(140, 160), radius=35.0).aoi()
    first, second = apart.outlines
    shared = {tuple(v) for v in first.exterior.vertices[:, :2]} & {
        tuple(v) for v in second.exterior.vertices[:, :2]
    }
    lattice = lattice_of((140, 160))
    assert shared == {(lattice.x_mm(68), lattice.y_mm(61))}
    assert apart.area_mm2 == pytest.approx(2 * math.pi * DISC_MM**2, rel=1e-14)


@pytest.mark.parametrize(("square", "node"), [(5, (1, 2)), (2, (1, 1)), (13, (2, 3)), (1, (0, 1))])
def test_discs_touch_although_their_radius_is_rounded(square: int, node: tuple[int, int]) -> None:
    aoi = at((0, 0), node, shape=(4, 4), radius=math.sqrt(square / 4)).aoi()
    assert len(aoi.outlines) == 2
    assert aoi.area_mm2 == pytest.approx(math.pi / 2 * square * STEP_MM**2, rel=1e-14)


def test_island_in_a_hole_is_a_part_and_the_hole_belongs_to_what_surrounds_it() -> None:
    reached = np.zeros((41, 41), dtype=np.bool_)
    reached[5:36, 5:36] = True
    reached[6:35, 6:35] = False
    reached[20, 20] = True
    ring, island = Discs(reached, 3.5).aoi().outlines
    assert [len(ring.holes), len(island.holes)] == [1, 0]


def test_part_that_touches_itself_closes_around_a_hole() -> None:
    reached = np.zeros((41, 41), dtype=np.bool_)
    reached[5:36, 5:36] = True
    reached[6:35, 6:35] = False
    # six nodes missing in a ring: the discs of radius 3.5 on both sides of the gap just touch
    reached[5, 17:23] = False
    (outline,) = Discs(reached, 3.5).aoi().outlines
    (hole,) = outline.holes
    touching = {tuple(v) for v in outline.exterior.vertices[:, :2]} & {
        tuple(v) for v in hole.vertices[:, :2]
    }
    lattice = lattice_of(reached.shape)
    assert touching == {((lattice.x_mm(19) + lattice.x_mm(20)) / 2, lattice.y_mm(5))}
    assert outline.polygon().is_valid


def test_rows_of_discs_that_touch_all_along_leave_a_hole_between_any_two_touches() -> None:
    reached = np.zeros((30, 40), dtype=np.bool_)
    reached[[5, 12], 5:35] = True
    reached[5:13, 5] = True
    (outline,) = Discs(reached, 3.5).aoi().outlines
    # the side that joins the rows covers the first 4 of 30 touches; each other closes one hole
    assert len(outline.holes) == 26
    assert outline.polygon().is_valid


def test_twelve_circles_through_one_point_have_one_corner_there() -> None:
    triples = [(21, 28), (28, 21), (35, 0), (0, 35)]
    around = {(sx * x, sy * y) for x, y in triples for sx in (1, -1) for sy in (1, -1)}
    shape, (iy, ix) = (160, 160), (80, 80)
    lattice = lattice_of(shape)
    right = at(*((iy + y, ix + x) for x, y in around if x > 0), shape=shape, radius=35.0)
    (outline,) = right.aoi().outlines
    apart_mm = np.hypot(
        *(outline.exterior.vertices[:, :2] - (lattice.x_mm(ix), lattice.y_mm(iy))).T
    )
    nearest_mm, next_mm = np.sort(apart_mm)[:2]
    assert nearest_mm == pytest.approx(0, abs=1e-9)
    assert next_mm > STEP_MM
    closed = at(*((iy + y, ix + x) for x, y in around), shape=shape, radius=35.0)
    assert [len(part.holes) for part in closed.aoi().outlines] == [0]


def test_raster_is_cut_off_at_the_lattice_and_the_outline_is_not() -> None:
    corner = at((0, 0), shape=(3, 3), radius=35.0).aoi()
    assert corner.raster.all()
    assert corner.area_mm2 == pytest.approx(math.pi * DISC_MM**2, rel=1e-13)


def test_sets_of_nodes_looked_at_together_cover_what_each_covers_alone() -> None:
    rng = np.random.default_rng(7)
    shapes = [(30, 70), (5, 64), (41, 130), (1, 1)]
    # the first row and the last: discs reach beyond both ends of each window
    sets = [Nodes.of((rng.random(shape) < 0.2) | (np.indices(shape)[0] == 0)) for shape in shapes]
    windows = [lattice_of(shape) for shape in shapes]
    radius_mm = 7.3 * STEP_MM
    for together, nodes, window in zip(areas(sets, windows, radius_mm), sets, windows, strict=True):
        alone = area(nodes, window, radius_mm)
        assert np.array_equal(together.raster, alone.raster)
        assert together.raster_area_mm2 == alone.raster_area_mm2
        pairs = zip(loops(together), loops(alone), strict=True)
        for loop, same in pairs:
            assert loop.vertices == pytest.approx(same.vertices, abs=1e-9)


def test_area_of_a_loop_is_signed() -> None:
    circle = np.array(((3.0, 1.0, 1.0), (7.0, 1.0, 1.0)))
    assert Loop(circle).area_mm2() == pytest.approx(4 * math.pi, rel=1e-15)
    assert Loop(circle * (1, 1, -1)).area_mm2() == pytest.approx(-4 * math.pi, rel=1e-15)
    square = np.array(((0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (2.0, 2.0, 0.0), (0.0, 2.0, 0.0)))
    assert Loop(square).area_mm2() == 4.0
    assert Loop(square[::-1]).area_mm2() == -4.0


@pytest.mark.parametrize("bulge", [1.0, -1.0, 0.2, -0.2, 1e-9, 2.4])
def test_points_of_a_loop_lie_on_its_arcs_and_as_close_as_asked(bulge: float) -> None:
    angle_rad = 4 * math.atan(bulge)
    chain = np.array(((-3.0, 4.0, bulge), (3.0, 4.0, 0.0)))
    points_mm = Loop(chain).points_mm(0.01)
    # the centre lies to the left of a counter-clockwise arc less than half a circle
    centre_mm = (0.0, 4.0 + 3.0 / math.tan(angle_rad / 2))
    radius_mm = 3.0 / abs(math.sin(angle_rad / 2))
    from_centre_mm = points_mm - centre_mm
    assert np.hypot(*from_centre_mm.T) == pytest.approx(radius_mm, rel=1e-9)
    chords_mm = np.hypot(*np.diff(points_mm, axis=0).T)
    rises_mm = radius_mm - np.sqrt(np.maximum(radius_mm**2 - (chords_mm / 2) ** 2, 0))
    assert rises_mm.max(initial=0) <= 0.01
    assert (np.sign(points_mm[1:-1, 1] - 4.0) == -np.sign(bulge)).all()


@settings(deadline=None)
@given(discs())
def test_raster_holds_the_cells_within_the_radius_of_a_reached_node(case: Discs) -> None:
    iy, ix = np.indices(case.reached.shape)
    expected = np.zeros(case.reached.shape, dtype=np.bool_)
    for row, column in np.argwhere(case.reached):
        square = (iy - row) ** 2 + (ix - column) ** 2
        expected |= square <= case.radius**2 * (1 + 1e-9)
    aoi = case.aoi()
    assert np.array_equal(aoi.raster, expected)
    assert aoi.raster_area_mm2 == expected.sum() * case.step_mm**2


@settings(deadline=None)
@given(case=discs(), n_quarters=st.integers(1, 3), is_mirrored=st.booleans())
def test_turned_and_mirrored_nodes_cover_the_turned_and_mirrored_area(
    case: Discs, n_quarters: int, *, is_mirrored: bool
) -> None:
    def moved(raster: BoolArray) -> BoolArray:
        return np.rot90(raster[:, ::-1] if is_mirrored else raster, n_quarters)

    copy = replace(case, reached=moved(case.reached))
    for exact in (True, False):
        aoi, other = case.aoi(exact=exact), copy.aoi(exact=exact)
        assert np.array_equal(other.raster, moved(aoi.raster))
        assert other.area_mm2 == pytest.approx(aoi.area_mm2, rel=1e-12)
        assert len(other.outlines) == len(aoi.outlines)


@settings(deadline=None)
@given(discs())
def test_area_is_that_of_the_union_of_discs(case: Discs) -> None:
    nodes_mm = case.nodes_mm()
    expected_mm2 = union_area_mm2(nodes_mm, case.radius_mm) if len(nodes_mm) else 0.0
    assert case.aoi().area_mm2 == pytest.approx(expected_mm2, rel=1e-12)


@settings(deadline=None)
@given(discs())
def test_outline_lies_between_the_unions_of_inner_and_outer_polygons(case: Discs) -> None:
    corners, centres = 64, shapely.points(case.nodes_mm())
    outer_mm = case.radius_mm / math.cos(math.pi / corners)
    inner = shapely.union_all(shapely.buffer(centres, case.radius_mm, quad_segs=corners // 4))
    outer = shapely.union_all(shapely.buffer(centres, outer_mm, quad_segs=corners // 4))
    covered = shapely.union_all(polygons(case.aoi()))
    assert covered.difference(outer).area <= 1e-6
    # the outline's own chords stay SAGITTA_MM inside
    assert inner.difference(covered.buffer(2 * SAGITTA_MM)).area <= 1e-6


@settings(deadline=None)
@given(case=discs(), exact=st.booleans())
def test_parts_are_valid_apart_and_as_many_as_groups_of_overlapping_discs(
    case: Discs, *, exact: bool
) -> None:
    aoi = case.aoi(exact=exact)
    parts = polygons(aoi)
    assert all(part.is_valid for part in parts)
    assert len(parts) == n_overlapping_groups(case.nodes_mm(), case.radius_mm)
    together_mm2 = shapely.union_all(parts).area
    assert together_mm2 == pytest.approx(sum(part.area for part in parts), rel=1e-9)


@settings(deadline=None)
@given(discs())
def test_outlines_come_largest_first_and_start_lowest_then_leftmost(case: Discs) -> None:
    aoi = case.aoi()
    areas_mm2 = [outline.exterior.area_mm2() for outline in aoi.outlines]
    assert all(a > b - 1 for a, b in pairwise(areas_mm2))
    for loop in loops(aoi):
        x_mm, y_mm, _ = loop.vertices.T
        assert (y_mm[0], x_mm[0]) == min(zip(y_mm, x_mm, strict=True))


@settings(deadline=None)
@given(discs())
def test_holes_run_clockwise_inside_their_exterior(case: Discs) -> None:
    for outline in case.aoi().outlines:
        assert outline.exterior.area_mm2() > 0
        around = Polygon(outline.exterior.points_mm(SAGITTA_MM))
        for hole in outline.holes:
            assert hole.area_mm2() < 0
            assert around.buffer(1e-6).covers(Polygon(hole.points_mm(SAGITTA_MM)))


@settings(deadline=None)
@given(discs())
def test_clean_outline_runs_inside_the_exact_one_and_close_to_it(case: Discs) -> None:
    assume(case.reached.any())
    exact, clean = (shapely.union_all(polygons(case.aoi(exact=exact))) for exact in (True, False))
    # the exact outline's own chords stand SAGITTA_MM inside at most
    assert exact.buffer(2 * SAGITTA_MM).covers(clean)
    assert lines_lie_within(CLEAN_MM + 2 * SAGITTA_MM, exact.boundary, clean.boundary)


def test_clean_outline_of_a_slanted_wall_runs_inside_the_exact_one() -> None:
    iy, ix = np.indices((400, 500))
    slanted = Discs((7 * iy > 2 * ix + 400) & (iy < 360) & (ix > 40) & (ix < 460), 35.0)
    exact, clean = (polygons(slanted.aoi(exact=exact))[0] for exact in (True, False))
    assert exact.buffer(2 * SAGITTA_MM).covers(clean)
    assert lines_lie_within(CLEAN_MM + 2 * SAGITTA_MM, exact.boundary, clean.boundary)
    assert len(clean.exterior.coords) < len(exact.exterior.coords)


@settings(deadline=None)
@given(case=discs(), exact=st.booleans())
def test_raster_and_outline_agree_away_from_the_outline(case: Discs, *, exact: bool) -> None:
    aoi = case.aoi(exact=exact)
    lattice = case.lattice
    covered = shapely.union_all(polygons(aoi))
    for (iy, ix), is_covered in np.ndenumerate(aoi.raster):
        centre = Point(lattice.x_mm(ix), lattice.y_mm(iy))
        if not aoi.outlines or covered.boundary.distance(centre) > CLEAN_MM + SAGITTA_MM:
            assert covered.covers(centre) == is_covered


@settings(deadline=None)
@given(discs())
def test_raster_and_outline_areas_differ_by_less_than_perimeter_times_step(case: Discs) -> None:
    margin = math.ceil(case.radius) + 1
    aoi = replace(case, reached=np.pad(case.reached, margin)).aoi()
    perimeter_mm = sum(part.length for part in polygons(aoi))
    assert abs(aoi.area_mm2 - aoi.raster_area_mm2) <= perimeter_mm * case.step_mm


@settings(deadline=None)
@given(discs())
def test_more_nodes_never_cover_less(case: Discs) -> None:
    kept = np.indices(case.reached.shape).sum(axis=0) % 3 > 0
    fewer = replace(case, reached=case.reached & kept)
    assert fewer.aoi().area_mm2 <= case.aoi().area_mm2 * (1 + 1e-12)
    assert not (fewer.aoi().raster & ~case.aoi().raster).any()
