"""Floors and obstacles out of IFC models made here, each with numbers one can check by hand."""

import hashlib
import io
import math
import random
import re
from pathlib import Path

import pytest
import shapely
from ifcopenshell import entity_instance
from shapely.geometry import Polygon, box

from satAOI_adapters.ifc_read import IfcOptions, process, reading, text
from satAOI_adapters.ifc_read.meshes import GROWTH_MM
from satAOI_adapters.ifc_read.records import ANSWER, Failed, Read, Request
from satAOI_adapters.ifc_read.worker import Worker
from satAOI_geo import errors
from satAOI_geo.plan import Circle, FloorPlan, Kind, Obstacle, Source
from tests.ifc_models import Pen, Point

WALL_MM2 = 5000.0 * 200.0
LOCAL_MM = 1e-5
"""Plans are rounded to this."""


def plan_in(path: Path, **options: object) -> FloorPlan:
    """The plan in a file, read in this process: quicker, and the tests see into it."""
    answers = io.StringIO()
    chosen = IfcOptions(**options)
    bad_ids = frozenset(text.ids_with_bad_numbers(path.read_bytes()))
    request = Request(
        path=str(path),
        parsed=str(path),
        options=chosen,
        file_mb=0.0,
        memory_mb=0,
        bad_ids=bad_ids,
    )
    Worker(request, answers).run()
    answer = ANSWER.validate_json(answers.getvalue().splitlines()[-1])
    if isinstance(answer, Failed):
        raise process.as_error(answer)
    assert isinstance(answer, Read)
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    return reading.plan_of(answer, Source(str(path), digest, "ifc", answer.model.unit, "header"))


@pytest.fixture
def pen() -> Pen:
    return Pen()


def with_storey(pen: Pen, *elements: entity_instance, z_mm: float = 0.0) -> None:
    pen.contain(pen.storey(z_mm=z_mm), *elements)


def wall(pen: Pen, *, z_mm: float = 0.0, **attributes: object) -> entity_instance:
    """5 m along x, 200 mm thick, 3 m high, its lower left corner at (500, 500)."""
    body = pen.box((500.0, 500.0, z_mm), (5500.0, 700.0, z_mm + 3000.0))
    return pen.product("IfcWall", body, **attributes)


def only(plan: FloorPlan) -> Obstacle:
    (obstacle,) = plan.obstacles
    return obstacle


def codes(plan: FloorPlan) -> list[str]:
    return [finding.code for finding in plan.findings]


def covered_mm2(plan: FloorPlan) -> float:
    return float(shapely.union_all([o.region() for o in plan.obstacles]).area)


@pytest.mark.parametrize("schema", ["IFC2X3", "IFC4", "IFC4X3"])
@pytest.mark.parametrize("unit", ["mm", "m"])
def test_a_wall_on_a_slab_is_read_to_the_digit(tmp_path: Path, schema: str, unit: str) -> None:
    pen = Pen(schema=schema, unit=unit)
    standing = wall(pen)
    with_storey(pen, pen.slab(6000.0, 4000.0), standing)
    plan = plan_in(pen.save(tmp_path))
    assert plan.floor.equals(box(0.0, 0.0, 6000.0, 4000.0))
    assert plan.floor_source == "slab"
    assert only(plan).shape.equals(box(500.0, 500.0, 5500.0, 700.0))
    assert (only(plan).kind, only(plan).layer) == (Kind.WALL, "IfcWall")
    assert only(plan).handle == standing.GlobalId
    assert not plan.findings


def test_a_doorway_stays_open(tmp_path: Path, pen: Pen) -> None:
    standing = wall(pen)
    pen.void(standing, pen.box((1000.0, 400.0, 0.0), (1900.0, 800.0, 2100.0)))
    with_storey(pen, pen.slab(6000.0, 4000.0), standing)
    plan = plan_in(pen.save(tmp_path))
    assert covered_mm2(plan) == WALL_MM2 - 900.0 * 200.0
    assert len(plan.obstacles) == 2


@pytest.mark.parametrize(
    ("bottom_mm", "top_mm"), [(900.0, 2100.0), (0.0, 1100.0)], ids=["sill", "low lintel"]
)
def test_an_opening_that_leaves_material_in_the_band_blocks(
    tmp_path: Path, pen: Pen, bottom_mm: float, top_mm: float
) -> None:
    standing = wall(pen)
    pen.void(standing, pen.box((1000.0, 400.0, bottom_mm), (1900.0, 800.0, top_mm)))
    with_storey(pen, pen.slab(6000.0, 4000.0), standing)
    assert covered_mm2(plan_in(pen.save(tmp_path))) == WALL_MM2


def test_the_band_decides_what_blocks(tmp_path: Path, pen: Pen) -> None:
    standing = wall(pen)
    pen.void(standing, pen.box((1000.0, 400.0, 0.0), (1900.0, 800.0, 1100.0)))
    with_storey(pen, pen.slab(6000.0, 4000.0), standing)
    low_robot = plan_in(pen.save(tmp_path), band_mm=1000.0)
    assert covered_mm2(low_robot) == WALL_MM2 - 900.0 * 200.0


def test_an_opening_extruded_through_the_wall_is_exact_too(tmp_path: Path, pen: Pen) -> None:
    standing = wall(pen)
    # a rectangle in the plane of the wall, swept along y
    frame = pen.axes((1450.0, 400.0, 1050.0), z=(0.0, 1.0, 0.0), x=(1.0, 0.0, 0.0))
    pen.void(standing, pen.extrusion(pen.rectangle(900.0, 2100.0), 400.0, frame))
    with_storey(pen, pen.slab(6000.0, 4000.0), standing)
    plan = plan_in(pen.save(tmp_path))
    assert covered_mm2(plan) == pytest.approx(WALL_MM2 - 900.0 * 200.0, rel=1e-12)
    assert "mesh-section" not in codes(plan)


def test_a_round_column_is_a_circle_wherever_it_is_placed(tmp_path: Path, pen: Pen) -> None:
    building = pen.placement((1000.0, 0.0, 0.0), turn_rad=math.pi / 2)
    here = pen.placement((2000.0, -500.0, 0.0), turn_rad=0.3, within=building)
    column = pen.product("IfcColumn", pen.extrusion(pen.circle(300.0), 3000.0), placement=here)
    with_storey(pen, pen.slab(6000.0, 4000.0), column)
    circle = only(plan_in(pen.save(tmp_path))).shape
    assert isinstance(circle, Circle)
    assert (circle.x_mm, circle.y_mm) == pytest.approx((1500.0, 2000.0), abs=LOCAL_MM)
    assert circle.radius_mm == 300.0


def test_a_pipe_keeps_its_inside_free(tmp_path: Path, pen: Pen) -> None:
    profile = pen.new(
        "IfcCircleHollowProfileDef",
        ProfileType="AREA",
        Position=pen.new("IfcAxis2Placement2D", Location=pen.point(3000.0, 2000.0)),
        Radius=1000.0,
        WallThickness=100.0,
    )
    with_storey(pen, pen.slab(6000.0, 4000.0), pen.product("IfcWall", pen.extrusion(profile, 3e3)))
    pipe = only(plan_in(pen.save(tmp_path))).shape
    centre = shapely.Point(3000.0, 2000.0)
    assert pipe.exterior.distance(centre) >= 1000.0 - LOCAL_MM
    assert pipe.interiors[0].hausdorff_distance(centre) <= 900.0 + LOCAL_MM
    assert pipe.area == pytest.approx(math.pi * (1000.0**2 - 900.0**2), rel=1e-4)


@pytest.mark.parametrize("schema", ["IFC2X3", "IFC4"])
def test_a_curved_wall_contains_the_arc_and_hardly_more(tmp_path: Path, schema: str) -> None:
    pen = Pen(schema=schema)
    profile = half_ring_of_arcs(pen) if schema == "IFC4" else half_ring_of_trimmed_circles(pen)
    standing = pen.product("IfcWall", pen.extrusion(profile, 3000.0))
    with_storey(pen, pen.slab(6000.0, 4000.0), standing)
    plan = plan_in(pen.save(tmp_path))
    assert "mesh-section" not in codes(plan)
    ring = only(plan).shape
    true_mm2 = math.pi / 2 * (1200.0**2 - 1000.0**2)
    outline_mm = math.pi * (1200.0 + 1000.0)
    assert true_mm2 <= ring.area <= true_mm2 + 0.01 * outline_mm
    assert ring.covers(shapely.Point(3000.0, 2200.0 - 1e-9))
    assert not ring.covers(shapely.Point(3000.0, 1990.0))


def half_ring_of_arcs(pen: Pen) -> entity_instance:
    """The upper half of a ring about (3000, 1000), radii 1000 and 1200, as arcs by index."""
    points = [(1800, 1000), (3000, 2200), (4200, 1000), (4000, 1000), (3000, 2000), (2000, 1000)]
    segments = [
        pen.value("IfcArcIndex", [3, 2, 1]),
        pen.value("IfcLineIndex", [1, 6]),
        pen.value("IfcArcIndex", [6, 5, 4]),
        pen.value("IfcLineIndex", [4, 3]),
    ]
    curve = pen.new(
        "IfcIndexedPolyCurve",
        Points=pen.new("IfcCartesianPointList2D", CoordList=[list(map(float, p)) for p in points]),
        Segments=segments,
    )
    return pen.new("IfcArbitraryClosedProfileDef", ProfileType="AREA", OuterCurve=curve)


def half_ring_of_trimmed_circles(pen: Pen) -> entity_instance:
    """The same as trimmed circles, the inner one run backwards."""
    position = pen.new("IfcAxis2Placement2D", Location=pen.point(3000.0, 1000.0))

    def half(radius_mm: float) -> entity_instance:
        return pen.new(
            "IfcTrimmedCurve",
            BasisCurve=pen.new("IfcCircle", Position=position, Radius=radius_mm),
            Trim1=[pen.value("IfcParameterValue", 0.0)],
            Trim2=[pen.value("IfcParameterValue", math.pi)],
            SenseAgreement=True,
            MasterRepresentation="PARAMETER",
        )

    def line(*ends: tuple[float, float]) -> entity_instance:
        return pen.new("IfcPolyline", Points=[pen.point(*end) for end in ends])

    pieces = [
        (half(1200.0), True),
        (line((1800.0, 1000.0), (2000.0, 1000.0)), True),
        (half(1000.0), False),
        (line((4000.0, 1000.0), (4200.0, 1000.0)), True),
    ]
    segments = [
        pen.new(
            "IfcCompositeCurveSegment", Transition="CONTINUOUS", SameSense=sense, ParentCurve=curve
        )
        for curve, sense in pieces
    ]
    curve = pen.new("IfcCompositeCurve", Segments=segments, SelfIntersect=False)
    return pen.new("IfcArbitraryClosedProfileDef", ProfileType="AREA", OuterCurve=curve)


def test_openings_in_the_slab_are_holes_that_name_the_opening(tmp_path: Path, pen: Pen) -> None:
    slab = pen.slab(6000.0, 4000.0)
    shaft = pen.void(slab, pen.box((1000.0, 1000.0, -500.0), (2000.0, 1600.0, 500.0)))
    pipe = pen.void(
        slab, pen.extrusion(pen.circle(150.0), 1000.0, pen.axes((4000.0, 2000.0, -500.0)))
    )
    with_storey(pen, slab)
    plan = plan_in(pen.save(tmp_path))
    by_handle = {obstacle.handle: obstacle for obstacle in plan.obstacles}
    assert by_handle[shaft.GlobalId].shape.equals(box(1000.0, 1000.0, 2000.0, 1600.0))
    assert by_handle[pipe.GlobalId].shape == Circle(4000.0, 2000.0, 150.0)
    assert {obstacle.kind for obstacle in plan.obstacles} == {Kind.HOLE}
    assert plan.floor.area == 24e6


@pytest.mark.parametrize(
    ("bottom_mm", "top_mm", "is_hole"),
    [(-50.0, 100.0, True), (-300.0, -50.0, False)],
    ids=["recess from above", "recess from below"],
)
def test_a_recess_is_a_hole_if_it_opens_the_floor(
    tmp_path: Path, pen: Pen, bottom_mm: float, top_mm: float, *, is_hole: bool
) -> None:
    slab = pen.slab(6000.0, 4000.0)
    pen.void(slab, pen.box((1000.0, 1000.0, bottom_mm), (2000.0, 1600.0, top_mm)))
    with_storey(pen, slab)
    assert [o.kind for o in plan_in(pen.save(tmp_path)).obstacles] == [Kind.HOLE] * is_hole


def test_a_void_in_the_slabs_profile_is_a_hole_of_the_slab(tmp_path: Path, pen: Pen) -> None:
    outline = [(0.0, 0.0), (6000.0, 0.0), (6000.0, 4000.0), (0.0, 4000.0)]
    shaft = [(1000.0, 1000.0), (1000.0, 2000.0), (2000.0, 2000.0), (2000.0, 1000.0)]
    body = pen.extrusion(pen.outline(outline, shaft), 200.0, pen.axes((0.0, 0.0, -200.0)))
    slab = pen.product("IfcSlab", body)
    with_storey(pen, slab)
    hole = only(plan_in(pen.save(tmp_path)))
    assert hole.shape.equals(box(1000.0, 1000.0, 2000.0, 2000.0))
    assert (hole.kind, hole.handle) == (Kind.HOLE, slab.GlobalId)


def test_a_thin_finish_does_not_close_a_hole_but_a_slab_does(tmp_path: Path, pen: Pen) -> None:
    slab = pen.slab(6000.0, 4000.0)
    pen.void(slab, pen.box((1000.0, 1000.0, -500.0), (2000.0, 2000.0, 500.0)))
    pen.void(slab, pen.box((3000.0, 1000.0, -500.0), (4000.0, 2000.0, 500.0)))
    finish = pen.product("IfcSlab", pen.box((0.0, 0.0, 0.0), (6000.0, 4000.0, 20.0)))
    infill = pen.product("IfcSlab", pen.box((3000.0, 1000.0, -150.0), (4000.0, 2000.0, 0.0)))
    with_storey(pen, slab, finish, infill)
    plan = plan_in(pen.save(tmp_path))
    assert only(plan).shape.equals(box(1000.0, 1000.0, 2000.0, 2000.0))


def test_openings_of_a_slab_without_a_body_are_holes(tmp_path: Path, pen: Pen) -> None:
    slab = pen.product("IfcSlab")
    opening = pen.void(slab, pen.box((1000.0, 1000.0, -500.0), (2000.0, 1600.0, 500.0)))
    space = pen.product("IfcSpace", pen.box((0.0, 0.0, 0.0), (6000.0, 4000.0, 2500.0)))
    with_storey(pen, slab)
    pen.part_of(pen.model.by_type("IfcBuildingStorey")[0], space)
    plan = plan_in(pen.save(tmp_path))
    assert plan.floor_source == "space"
    assert only(plan).shape.equals(box(1000.0, 1000.0, 2000.0, 1600.0))
    assert only(plan).handle == opening.GlobalId


def half_space(pen: Pen, at_mm: Point, normal: Point, *, agreement: bool) -> entity_instance:
    plane = pen.new("IfcPlane", Position=pen.axes(at_mm, z=normal, x=(0.0, 1.0, 0.0)))
    return pen.new("IfcHalfSpaceSolid", BaseSurface=plane, AgreementFlag=agreement)


def clipped(pen: Pen, body: entity_instance, half: entity_instance) -> entity_instance:
    return pen.new(
        "IfcBooleanClippingResult", Operator="DIFFERENCE", FirstOperand=body, SecondOperand=half
    )


@pytest.mark.parametrize("agreement", [True, False])
@pytest.mark.parametrize("by_mesh", [True, False])
def test_a_mitred_wall_ends_at_its_mitre(
    tmp_path: Path, pen: Pen, *, agreement: bool, by_mesh: bool
) -> None:
    # an upright plane at 45 degrees through (1000, 500): the half behind it is taken away
    body = pen.box((500.0, 500.0, 0.0), (5500.0, 700.0, 3000.0))
    cut = clipped(pen, body, half_space(pen, (1000.0, 500.0, 0.0), (1, 1, 0), agreement=agreement))
    standing = pen.product("IfcWall", cut, kind="Clipping")
    if by_mesh:
        pen.void(standing, pen.box((2000.0, 400.0, 2000.0), (2500.0, 800.0, 2500.0)))
        # a slanting opening above the band makes the whole wall a mesh, and changes nothing
        pen.void(
            standing,
            pen.extrusion(
                pen.rectangle(10.0, 10.0), 500.0, pen.axes((3000.0, 400.0, 2000.0), z=(0, 1, 1))
            ),
        )
    with_storey(pen, pen.slab(6000.0, 4000.0), standing)
    plan = plan_in(pen.save(tmp_path))
    assert ("mesh-section" in codes(plan)) == by_mesh
    left_mm2 = (500.0 + 300.0) / 2 * 200.0
    expected = WALL_MM2 - left_mm2 if agreement else left_mm2
    assert covered_mm2(plan) == pytest.approx(expected, rel=1e-9)


def test_a_roof_that_cuts_a_wall_above_the_band_changes_nothing(tmp_path: Path, pen: Pen) -> None:
    body = pen.box((500.0, 500.0, 0.0), (5500.0, 700.0, 3000.0))
    # keeps what is below the plane z = 2500 + x / 10
    roof = half_space(pen, (0.0, 0.0, 2500.0), (0.1, 0.0, -1.0), agreement=True)
    with_storey(pen, pen.slab(6000.0, 4000.0), pen.product("IfcWall", clipped(pen, body, roof)))
    plan = plan_in(pen.save(tmp_path))
    assert covered_mm2(plan) == WALL_MM2
    assert "mesh-section" not in codes(plan)


def test_a_roof_that_cuts_a_wall_within_the_band_is_cut_from_the_mesh(
    tmp_path: Path, pen: Pen
) -> None:
    body = pen.box((500.0, 500.0, 0.0), (5500.0, 700.0, 3000.0))
    # keeps what is below z = 3000 - x: nothing stands beyond x = 2999 just above the floor
    roof = half_space(pen, (0.0, 0.0, 3000.0), (-1.0, 0.0, -1.0), agreement=True)
    with_storey(pen, pen.slab(6000.0, 4000.0), pen.product("IfcWall", clipped(pen, body, roof)))
    plan = plan_in(pen.save(tmp_path))
    assert covered_mm2(plan) == pytest.approx(2499.0 * 200.0, rel=1e-6)
    assert "mesh-section" in codes(plan)


BOX_FACES = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]


def test_a_leaning_solid_covers_all_it_passes_over_in_the_band(tmp_path: Path, pen: Pen) -> None:
    # a prism that leans by 1 in 2 along x: between 1 and 1200 mm it passes over 599.5 mm more
    base = [(1000.0, 1000.0), (1200.0, 1000.0), (1200.0, 1300.0), (1000.0, 1300.0)]
    corners = [(x, y, 0.0) for x, y in base] + [(x + 1000.0, y, 2000.0) for x, y in base]
    leaning = pen.product("IfcMember", pen.brep(corners, BOX_FACES), kind="Brep")
    with_storey(pen, pen.slab(6000.0, 4000.0), leaning)
    plan = plan_in(pen.save(tmp_path))
    assert covered_mm2(plan) == pytest.approx((200.0 + 599.5) * 300.0, rel=1e-9)
    assert only(plan).shape.bounds == pytest.approx((1000.5, 1000.0, 1800.0, 1300.0), abs=1e-4)


def test_a_plate_thinner_than_any_spacing_of_cuts_is_seen(tmp_path: Path, pen: Pen) -> None:
    plate = [(1000.0, 1000.0), (2000.0, 1000.0), (2000.0, 1500.0), (1000.0, 1500.0)]
    corners = [(x, y, 613.0) for x, y in plate] + [(x, y, 613.1) for x, y in plate]
    shelf = pen.product("IfcPlate", pen.brep(corners, BOX_FACES), kind="Brep")
    with_storey(pen, pen.slab(6000.0, 4000.0), shelf)
    assert covered_mm2(plan_in(pen.save(tmp_path))) == pytest.approx(5e5, rel=1e-9)


def test_a_meshed_sphere_never_shrinks(tmp_path: Path, pen: Pen) -> None:
    sphere = pen.new("IfcSphere", Position=pen.axes((3000.0, 2000.0, 600.0)), Radius=500.0)
    with_storey(pen, pen.slab(6000.0, 4000.0), pen.product("IfcTank", sphere, kind="CSG"))
    plan = plan_in(pen.save(tmp_path))
    true = shapely.Point(3000.0, 2000.0).buffer(500.0, quad_segs=180)
    shape = only(plan).shape
    assert shape.covers(true)
    assert true.buffer(2 * GROWTH_MM).covers(shape)
    assert f"grown by {GROWTH_MM:g} mm" in plan.findings[0].message


def test_mapped_items_are_mirrored_turned_and_scaled(tmp_path: Path, pen: Pen) -> None:
    # a right triangle, mirrored at the y axis, twice as large, set down at (4000, 1000)
    corners = [(0.0, 0.0), (500.0, 0.0), (0.0, 250.0)]
    source = pen.new(
        "IfcRepresentationMap",
        MappingOrigin=pen.axes(),
        MappedRepresentation=pen.new(
            "IfcShapeRepresentation",
            ContextOfItems=pen.context,
            RepresentationIdentifier="Body",
            RepresentationType="SweptSolid",
            Items=[pen.extrusion(pen.outline(corners), 3000.0)],
        ),
    )
    target = pen.new(
        "IfcCartesianTransformationOperator3D",
        Axis1=pen.direction(-1, 0, 0),
        Axis2=pen.direction(0, 1, 0),
        Axis3=pen.direction(0, 0, 1),
        LocalOrigin=pen.point(4000.0, 1000.0, 0.0),
        Scale=2.0,
    )
    item = pen.new("IfcMappedItem", MappingSource=source, MappingTarget=target)
    with_storey(pen, pen.slab(6000.0, 4000.0), pen.product("IfcColumn", item))
    shape = only(plan_in(pen.save(tmp_path))).shape
    assert shape.equals(Polygon([(4000.0, 1000.0), (3000.0, 1000.0), (4000.0, 1500.0)]))


def test_doors_furniture_spaces_and_floorings_do_not_block(tmp_path: Path, pen: Pen) -> None:
    body = ((1000.0, 1000.0, 0.0), (2000.0, 2000.0, 1000.0))
    others = [
        pen.product("IfcDoor", pen.box(*body)),
        pen.product("IfcFurniture", pen.box(*body)),
        pen.product("IfcCovering", pen.box(*body), PredefinedType="FLOORING"),
        pen.product("IfcVirtualElement", pen.box(*body)),
    ]
    with_storey(pen, pen.slab(6000.0, 4000.0), *others)
    pen.product("IfcSpace", pen.box(*body))
    pen.product("IfcAnnotation", pen.box(*body))
    path = pen.save(tmp_path)
    assert not plan_in(path).obstacles
    assert only(plan_in(path, with_classes=("ifcdoor",))).layer == "IfcDoor"


@pytest.mark.parametrize("asked", ["IfcFurniture", "IfcFurnishingElement", "ifcelement"])
def test_a_class_that_is_asked_for_blocks_with_all_that_is_under_it(
    tmp_path: Path, pen: Pen, asked: str
) -> None:
    chair = pen.product("IfcFurniture", pen.box((1000.0, 1000.0, 0.0), (2000.0, 2000.0, 1000.0)))
    with_storey(pen, pen.slab(6000.0, 4000.0), chair)
    assert only(plan_in(pen.save(tmp_path), with_classes=(asked,))).kind is Kind.EQUIPMENT


@pytest.mark.parametrize("dropped", ["IfcColumn", "IfcBuildingElement", "IfcElement"])
def test_a_class_that_is_left_out_does_not_block_nor_does_what_is_under_it(
    tmp_path: Path, pen: Pen, dropped: str
) -> None:
    pillar = pen.product("IfcColumn", pen.box((1000.0, 1000.0, 0.0), (2000.0, 2000.0, 3000.0)))
    with_storey(pen, pen.slab(6000.0, 4000.0), pillar)
    assert not plan_in(pen.save(tmp_path), without_classes=(dropped,)).obstacles


def test_of_classes_with_and_without_the_more_special_one_counts(tmp_path: Path, pen: Pen) -> None:
    body = pen.box((1000.0, 1000.0, 0.0), (2000.0, 2000.0, 3000.0))
    pillar, door = pen.product("IfcColumn", body), pen.product("IfcDoor", body)
    with_storey(pen, pen.slab(6000.0, 4000.0), wall(pen), pillar, door)
    path = pen.save(tmp_path)
    walls_only = plan_in(path, with_classes=("IfcWall",), without_classes=("IfcElement",))
    assert only(walls_only).layer == "IfcWall"
    all_but = plan_in(path, with_classes=("IfcElement",), without_classes=("IfcDoor", "IfcWall"))
    assert only(all_but).layer == "IfcColumn"


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ("IfcDor", "'IfcDor' is no class of products of IFC4; give IfcDoor"),
        ("Column", "'Column' is no class of products of IFC4; give IfcColumn"),
        ("IfcLengthMeasure", "is no class of products"),
        ("", "give a name such as IfcDoor"),
    ],
)
def test_an_unknown_class_is_refused_with_names_like_it(
    tmp_path: Path, pen: Pen, asked: str, message: str
) -> None:
    with_storey(pen, pen.slab(6000.0, 4000.0))
    with pytest.raises(errors.InputError, match=message):
        plan_in(pen.save(tmp_path), without_classes=(asked,))


def test_a_class_both_with_and_without_is_refused(tmp_path: Path, pen: Pen) -> None:
    with_storey(pen, pen.slab(6000.0, 4000.0))
    with pytest.raises(errors.InputError, match="IfcWall is given --with and --without"):
        plan_in(pen.save(tmp_path), with_classes=("IfcWall",), without_classes=("ifcwall",))


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("IfcWallStandardCase", Kind.WALL),
        ("IfcWindow", Kind.WALL),
        ("IfcColumn", Kind.COLUMN),
        ("IfcFooting", Kind.COLUMN),
        ("IfcDiscreteAccessory", Kind.EMBEDDED),
        ("IfcMechanicalFastener", Kind.EMBEDDED),
        ("IfcStairFlight", Kind.EQUIPMENT),
        ("IfcPump", Kind.EQUIPMENT),
        ("IfcBuildingElementProxy", Kind.UNCLASSIFIED),
    ],
)
def test_every_class_has_its_kind(tmp_path: Path, pen: Pen, name: str, kind: Kind) -> None:
    thing = pen.product(name, pen.box((1000.0, 1000.0, 0.0), (1500.0, 1500.0, 500.0)))
    with_storey(pen, pen.slab(6000.0, 4000.0), thing)
    assert only(plan_in(pen.save(tmp_path))).kind is kind


def test_parts_of_a_wall_are_wall(tmp_path: Path, pen: Pen) -> None:
    whole = pen.product("IfcWall")
    layer = pen.product(
        "IfcBuildingElementPart", pen.box((500.0, 500.0, 0.0), (5500.0, 600.0, 3000.0))
    )
    pen.part_of(whole, layer)
    with_storey(pen, pen.slab(6000.0, 4000.0), whole)
    part = only(plan_in(pen.save(tmp_path)))
    assert (part.kind, part.layer) == (Kind.WALL, "IfcBuildingElementPart")
    assert part.handle == layer.GlobalId


@pytest.mark.parametrize(
    ("name", "top_mm", "n"),
    [
        ("IfcDiscreteAccessory", 0.0, 1),
        ("IfcDiscreteAccessory", -20.0, 0),
        ("IfcDiscreteAccessory", 15.0, 1),
        ("IfcBuildingElementProxy", 0.0, 0),
        ("IfcBuildingElementProxy", 15.0, 1),
    ],
)
def test_embedded_parts_block_where_they_meet_the_surface(
    tmp_path: Path, pen: Pen, name: str, top_mm: float, n: int
) -> None:
    plate = pen.product(name, pen.box((1000.0, 1000.0, top_mm - 100.0), (1400.0, 1400.0, top_mm)))
    with_storey(pen, pen.slab(6000.0, 4000.0), plate)
    assert len(plan_in(pen.save(tmp_path)).obstacles) == n


def test_what_stands_on_other_storeys_is_not_in_the_way(tmp_path: Path, pen: Pen) -> None:
    above = pen.slab(6000.0, 4000.0, top_mm=3000.0)
    lower, upper = pen.storey("Ground"), pen.storey("First", 3000.0)
    pen.contain(lower, pen.slab(6000.0, 4000.0), wall(pen))
    pen.contain(upper, above, wall(pen, z_mm=3000.0), wall(pen, z_mm=3000.0))
    path = pen.save(tmp_path)
    assert len(plan_in(path, storey="Ground").obstacles) == 1
    assert len(plan_in(path, storey="First").obstacles) == 2


def two_storeys(pen: Pen) -> None:
    pen.contain(pen.storey("First", 3000.0), pen.slab(5000.0, 4000.0, top_mm=3000.0))
    pen.contain(pen.storey("Ground"), pen.slab(6000.0, 4000.0))


@pytest.mark.parametrize("wanted", ["Ground", "ground ", "1"])
def test_a_storey_is_chosen_by_name_or_number(tmp_path: Path, pen: Pen, wanted: str) -> None:
    two_storeys(pen)
    assert plan_in(pen.save(tmp_path), storey=wanted).floor.area == 24e6


def test_a_storey_is_chosen_by_height_in_the_models_unit(tmp_path: Path) -> None:
    pen = Pen(unit="m")
    two_storeys(pen)
    assert plan_in(pen.save(tmp_path), floor_z=3.0).floor.area == 20e6


def test_several_storeys_have_to_be_chosen_from(tmp_path: Path, pen: Pen) -> None:
    two_storeys(pen)
    with pytest.raises(errors.InputError, match="1 'Ground' at 0 m, 2 'First' at 3 m"):
        plan_in(pen.save(tmp_path))
    with pytest.raises(errors.InputError, match="no storey 'Roof'; choose one of 1 'Ground'"):
        plan_in(pen.save(tmp_path), storey="Roof")


def test_the_placement_of_a_storey_goes_before_its_elevation(tmp_path: Path, pen: Pen) -> None:
    pen.contain(pen.storey("Level", 3000.0, elevation_mm=-3000.0), pen.slab(6e3, 4e3, top_mm=3e3))
    plan = plan_in(pen.save(tmp_path))
    assert plan.floor.area == 24e6
    assert codes(plan)[0] == "storey-elevation"


def test_elevations_are_used_where_no_storey_is_placed(tmp_path: Path, pen: Pen) -> None:
    pen.contain(pen.storey("First", elevation_mm=3e3), pen.slab(5e3, 4e3, top_mm=3e3))
    pen.contain(pen.storey("Ground", elevation_mm=0.0), pen.slab(6e3, 4e3))
    plan = plan_in(pen.save(tmp_path), storey="First")
    assert plan.floor.area == 20e6
    assert codes(plan)[0] == "storey-elevation"


def test_elevations_count_from_the_building(tmp_path: Path, pen: Pen) -> None:
    building = pen.placement((0.0, 0.0, 300e3))
    first = pen.storey("First", 3e3, elevation_mm=3e3, within=building)
    ground = pen.storey("Ground", elevation_mm=0.0, within=building)
    pen.contain(first, pen.slab(5e3, 4e3, top_mm=303e3))
    pen.contain(ground, pen.slab(6e3, 4e3, top_mm=300e3))
    plan = plan_in(pen.save(tmp_path), storey="First")
    assert plan.floor.area == 20e6
    assert "storey-elevation" not in codes(plan)


def test_elevations_are_used_at_the_buildings_height(tmp_path: Path, pen: Pen) -> None:
    building = pen.placement((0.0, 0.0, 300e3))
    first = pen.storey("First", elevation_mm=3e3, within=building)
    ground = pen.storey("Ground", elevation_mm=0.0, within=building)
    pen.contain(first, pen.slab(5e3, 4e3, top_mm=303e3))
    pen.contain(ground, pen.slab(6e3, 4e3, top_mm=300e3))
    plan = plan_in(pen.save(tmp_path), storey="First")
    assert plan.floor.area == 20e6
    assert codes(plan).count("storey-elevation") == 1


@pytest.mark.parametrize("band_mm", [-1.0, 0.0, math.nan, math.inf])
def test_a_band_without_height_is_refused(band_mm: float) -> None:
    with pytest.raises(errors.InputError, match="give a height above 0"):
        IfcOptions(band_mm=band_mm)


@pytest.mark.parametrize("floor_z", [math.nan, -math.inf])
def test_a_floor_at_no_height_is_refused(floor_z: float) -> None:
    with pytest.raises(errors.InputError, match="give a number"):
        IfcOptions(floor_z=floor_z)


def test_the_floor_lies_where_the_slabs_top_is(tmp_path: Path, pen: Pen) -> None:
    # a slab that was drawn on top of its storey: it is the floor, not an obstacle
    post = pen.product("IfcColumn", pen.box((1000.0, 1000.0, 200.0), (1300.0, 1300.0, 400.0)))
    with_storey(pen, pen.slab(6000.0, 4000.0, top_mm=200.0), post)
    plan = plan_in(pen.save(tmp_path))
    assert only(plan).layer == "IfcColumn"
    assert codes(plan) == ["floor-height"]


def test_a_step_higher_than_a_finish_is_an_obstacle(tmp_path: Path, pen: Pen) -> None:
    platform = pen.product("IfcSlab", pen.box((1000.0, 1000.0, 0.0), (2000.0, 2000.0, 200.0)))
    with_storey(pen, pen.slab(6000.0, 4000.0), platform)
    assert only(plan_in(pen.save(tmp_path))).handle == platform.GlobalId


def test_spaces_joined_by_their_doorway_are_a_floor(tmp_path: Path, pen: Pen) -> None:
    between = pen.product("IfcWall", pen.box((3000.0, 0.0, 0.0), (3200.0, 4000.0, 3000.0)))
    pen.void(between, pen.box((2900.0, 1000.0, 0.0), (3300.0, 2000.0, 2100.0)))
    with_storey(pen, between)
    pen.product("IfcSpace", pen.box((0.0, 0.0, 0.0), (3000.0, 4000.0, 2500.0)))
    pen.product("IfcSpace", pen.box((3200.0, 0.0, 0.0), (6000.0, 4000.0, 2500.0)))
    plan = plan_in(pen.save(tmp_path))
    assert plan.floor_source == "space"
    assert plan.floor.geom_type == "Polygon"
    assert plan.floor.area == 3e6 * 4 + 2.8e6 * 4 + 200.0 * 1000.0


def test_a_floor_is_inferred_from_walls_that_enclose_it(tmp_path: Path, pen: Pen) -> None:
    sides = [
        ((0.0, 0.0), (6000.0, 200.0)),
        ((0.0, 3800.0), (6000.0, 4000.0)),
        ((0.0, 200.0), (200.0, 3800.0)),
        ((5800.0, 200.0), (6000.0, 3800.0)),
    ]
    walls = [pen.product("IfcWall", pen.box((*a, 0.0), (*b, 3000.0))) for a, b in sides]
    with_storey(pen, *walls)
    plan = plan_in(pen.save(tmp_path))
    assert plan.floor_source == "inferred"
    assert plan.floor.area == pytest.approx(24e6, rel=1e-6)
    assert "floor-inferred" in codes(plan)


def test_slabs_that_meet_with_a_joint_are_one_floor(tmp_path: Path, pen: Pen) -> None:
    right = pen.product("IfcSlab", pen.box((6010.0, 0.0, -200.0), (9000.0, 4000.0, 0.0)))
    with_storey(pen, pen.slab(6000.0, 4000.0), right)
    plan = plan_in(pen.save(tmp_path))
    assert plan.floor.area == pytest.approx(36e6, rel=1e-12)
    assert "floor-joints" in codes(plan)


def test_a_model_without_storeys_has_its_floor_where_its_walls_stand(
    tmp_path: Path, pen: Pen
) -> None:
    pen.slab(6000.0, 4000.0, top_mm=3200.0)
    pen.slab(6000.0, 4000.0, top_mm=100.0)
    wall(pen, z_mm=100.0)
    plan = plan_in(pen.save(tmp_path))
    assert len(plan.obstacles) == 1
    assert codes(plan)[0] == "no-storey"


@pytest.mark.parametrize("shift_mm", [(568053449.0, 5774347227.0), (-4e4, 95e3)])
def test_a_shifted_building_gives_the_same_plan(
    tmp_path: Path, shift_mm: tuple[float, float]
) -> None:
    plans = []
    for offset_mm in ((0.0, 0.0), shift_mm):
        pen = Pen(unit="m")
        site = pen.placement((*offset_mm, 0.0), turn_rad=0.25)
        column = pen.product("IfcColumn", pen.extrusion(pen.circle(300.0), 3000.0))
        column.ObjectPlacement = pen.placement((2000.0, 2000.0, 0.0), within=site)
        slab = pen.slab(6000.0, 4000.0)
        slab.ObjectPlacement = pen.placement(within=site)
        with_storey(pen, slab, column)
        plans.append(plan_in(pen.save(tmp_path)))
    here, there = plans
    assert there.floor.equals_exact(here.floor, 1e-4)
    assert there.frame.to_drawing_mm((0.0, 0.0)) - here.frame.to_drawing_mm((0.0, 0.0)) == (
        pytest.approx(shift_mm)
    )
    assert only(there).shape.x_mm == pytest.approx(only(here).shape.x_mm, abs=1e-4)


def test_the_unit_of_length_comes_from_the_project(tmp_path: Path, pen: Pen) -> None:
    inch = pen.new(
        "IfcConversionBasedUnit",
        UnitType="LENGTHUNIT",
        Name="INCH",
        ConversionFactor=pen.new(
            "IfcMeasureWithUnit",
            ValueComponent=pen.value("IfcLengthMeasure", 0.0254),
            UnitComponent=pen.new("IfcSIUnit", UnitType="LENGTHUNIT", Name="METRE"),
        ),
    )
    pen.project.UnitsInContext.Units = [inch]
    with_storey(pen, pen.slab(100.0, 200.0))
    plan = plan_in(pen.save(tmp_path))
    assert plan.floor.area == pytest.approx(2540.0 * 5080.0, rel=1e-12)
    assert plan.frame.mm_per_unit == 25.4


def test_a_model_without_a_unit_is_refused_until_it_is_given(tmp_path: Path, pen: Pen) -> None:
    with_storey(pen, pen.slab(6000.0, 4000.0))
    pen.project.UnitsInContext = None
    path = pen.save(tmp_path)
    with pytest.raises(errors.UnitError, match="give --units mm for"):
        plan_in(path)
    assert plan_in(path, units="cm").floor.area == 24e8


def test_the_order_of_entities_does_not_matter(tmp_path: Path, pen: Pen) -> None:
    slab = pen.slab(6000.0, 4000.0)
    pen.void(slab, pen.box((3000.0, 3000.0, -500.0), (3400.0, 3400.0, 500.0)))
    with_storey(pen, slab, wall(pen), pen.product("IfcColumn", pen.extrusion(pen.circle(9.0), 9e3)))
    path = pen.save(tmp_path)
    lines = path.read_text().splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith("#"))
    last = max(i for i, line in enumerate(lines) if line.startswith("#"))
    entities = lines[first : last + 1]
    random.Random(1).shuffle(entities)
    shuffled = tmp_path / "shuffled.ifc"
    shuffled.write_text("\n".join([*lines[:first], *entities, *lines[last + 1 :]]))
    one, other = plan_in(path), plan_in(shuffled)
    assert (one.floor, one.obstacles, one.frame) == (other.floor, other.obstacles, other.frame)


def test_a_cyclic_placement_is_named_and_the_rest_is_read(tmp_path: Path, pen: Pen) -> None:
    lost = wall(pen)
    lost.ObjectPlacement.PlacementRelTo = lost.ObjectPlacement
    with_storey(pen, pen.slab(6000.0, 4000.0), lost, wall(pen))
    plan = plan_in(pen.save(tmp_path))
    (finding,) = plan.findings
    assert (finding.code, finding.handle) == ("element-unreadable", lost.GlobalId)
    assert "refers back to itself" in finding.message
    assert len(plan.obstacles) == 1


@pytest.mark.parametrize("number", ["nan", "NAN", "-inf"])
def test_a_number_that_is_none_is_named(tmp_path: Path, pen: Pen, number: str) -> None:
    lost = wall(pen, Name="nan, (nan)")
    with_storey(pen, pen.slab(6000.0, 4000.0), lost, wall(pen))
    path = pen.save(tmp_path)
    bad = lost.ObjectPlacement.RelativePlacement.Location.id()
    written = path.read_text()
    path.write_text(re.sub(rf"(#{bad}=IFCCARTESIANPOINT\(\()0\.", rf"\g<1>{number}", written))
    plan = plan_in(path)
    assert [(f.code, f.handle) for f in plan.findings] == [("element-unreadable", lost.GlobalId)]
    assert len(plan.obstacles) == 1


def test_a_reference_to_nothing_is_named(tmp_path: Path, pen: Pen) -> None:
    lost = wall(pen)
    with_storey(pen, pen.slab(6000.0, 4000.0), lost, wall(pen))
    path = pen.save(tmp_path)
    gone = lost.ObjectPlacement.RelativePlacement.id()
    lines = path.read_text().splitlines()
    path.write_text("\n".join(line for line in lines if not line.startswith(f"#{gone}=")))
    plan = plan_in(path)
    assert [(f.code, f.handle) for f in plan.findings] == [("element-unreadable", lost.GlobalId)]


def test_a_model_most_of_which_is_broken_is_refused(tmp_path: Path, pen: Pen) -> None:
    lost = [wall(pen) for _ in range(3)]
    for element in lost:
        element.ObjectPlacement.PlacementRelTo = element.ObjectPlacement
    with_storey(pen, pen.slab(6000.0, 4000.0), *lost)
    with pytest.raises(errors.DrawingError, match="3 of 4 elements cannot be read"):
        plan_in(pen.save(tmp_path))


def test_a_body_that_cannot_be_made_is_kept_clear_of_by_its_box(tmp_path: Path, pen: Pen) -> None:
    # faces of two corners each
    corners = [(1000.0, 1000.0, 0.0), (2000.0, 1500.0, 800.0)]
    broken = pen.product("IfcColumn", pen.brep(corners, [(0, 1), (1, 0)]), kind="Brep")
    with_storey(pen, pen.slab(6000.0, 4000.0), broken)
    plan = plan_in(pen.save(tmp_path))
    assert codes(plan) == ["box-for-body"]
    assert only(plan).shape.equals(box(1000.0, 1000.0, 2000.0, 1500.0))


def test_repeated_globalids_are_noted_and_all_read(tmp_path: Path, pen: Pen) -> None:
    twins = [wall(pen), pen.product("IfcWall", pen.box((0, 2e3, 0), (5e3, 2.2e3, 3e3)))]
    twins[1].GlobalId = twins[0].GlobalId
    with_storey(pen, pen.slab(6000.0, 4000.0), *twins)
    plan = plan_in(pen.save(tmp_path))
    assert len(plan.obstacles) == 2
    assert codes(plan) == ["repeated-globalid"]
