"""An area of interest in its model: all else untouched, the area the same to the digit."""

from hashlib import sha256
from pathlib import Path

import ifcopenshell
import ifcopenshell.geom
import ifcopenshell.util.element
import ifcopenshell.validate
import numpy as np
import pytest

from satAOI_adapters import ifc_write, read_plan
from satAOI_geo.errors import InputError, UnreadableError
from satAOI_geo.pipeline import Result, area_of_interest
from satAOI_geo.plan import FloatArray
from satAOI_geo.settings import Settings
from tests.ifc_models import Pen
from tests.results import furnished_result
from tests.test_ifc_read import plan_in

COARSE = Settings(step_mm=25.0, n_directions=8)


def hall(schema: str, unit: str) -> Pen:
    """A hall turned by 20 degrees and shifted, with 600 mm between two walls."""
    pen = Pen(schema=schema, unit=unit)
    site = pen.placement((1e6, -2e6, 300.0), turn_rad=np.radians(20.0))
    slab = pen.slab(6000.0, 4000.0)
    column = pen.product("IfcColumn", pen.extrusion(pen.circle(150.0), 3000.0))
    wall = pen.product("IfcWall", pen.box((5200.0, 0.0, 0.0), (5300.0, 4000.0, 3000.0)))
    outer = pen.product("IfcWall", pen.box((5900.0, 0.0, 0.0), (6000.0, 4000.0, 3000.0)))
    for element in (slab, wall, outer):
        element.ObjectPlacement = pen.placement(within=site)
    column.ObjectPlacement = pen.placement((2500.0, 3000.0, 0.0), within=site)
    pen.contain(pen.storey("Ground", 300.0), slab, column, wall, outer)
    if schema == "IFC2X3":
        sign(pen)
    return pen


def sign(pen: Pen) -> None:
    """IFC2X3 asks who owns each thing."""
    person = pen.new("IfcPerson", Id="p", FamilyName="p")
    organisation = pen.new("IfcOrganization", Name="o")
    owner = pen.new(
        "IfcOwnerHistory",
        OwningUser=pen.new(
            "IfcPersonAndOrganization", ThePerson=person, TheOrganization=organisation
        ),
        OwningApplication=pen.new(
            "IfcApplication",
            ApplicationDeveloper=organisation,
            Version="1",
            ApplicationFullName="a",
            ApplicationIdentifier="a",
        ),
        ChangeAction="ADDED",
        CreationDate=0,
    )
    for root in pen.model.by_type("IfcRoot"):
        root.OwnerHistory = owner


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("models")


@pytest.fixture(
    scope="module", params=[("IFC2X3", "mm"), ("IFC4", "m"), ("IFC4X3", "mm")], ids="-".join
)
def written(request: pytest.FixtureRequest, folder: Path) -> tuple[Path, Path, Result]:
    """A model, the model with its result, and the result."""
    schema, unit = request.param
    source = hall(schema, unit).save(folder, f"{schema}.ifc")
    result = area_of_interest(plan_in(source), settings=COARSE)
    target = folder / f"{schema}-aoi.ifc"
    ifc_write.write(target, result)
    return source, target, result


def zones(model: ifcopenshell.file, object_type: str) -> list[ifcopenshell.entity_instance]:
    name = "IfcBuildingElementProxy" if model.schema == "IFC2X3" else "IfcSpatialZone"
    return [zone for zone in model.by_type(name) if zone.ObjectType == object_type]


def properties(zone: ifcopenshell.entity_instance) -> dict[str, object]:
    return dict(ifcopenshell.util.element.get_pset(zone, "satAOI"))


def test_every_byte_of_the_model_is_kept(written: tuple[Path, Path, Result]) -> None:
    source, target, _ = written
    before, after = source.read_bytes(), target.read_bytes()
    added = after.index(ifc_write.BEGIN), after.index(ifc_write.END) + len(ifc_write.END)
    assert after[: added[0]] + after[added[1] :] == before


def test_the_model_is_valid_with_what_was_added(written: tuple[Path, Path, Result]) -> None:
    logs = []
    for path in written[:2]:
        logs.append(ifcopenshell.validate.json_logger())
        model = ifcopenshell.open(path)
        ifcopenshell.validate.validate(model, logs[-1])
    before, after = (len(log.statements) for log in logs)
    assert after == before


def triangles(zone: ifcopenshell.entity_instance) -> FloatArray:
    """The body as the kernel sees it, in metres: corners of triangles, shape (n, 3, 3)."""
    settings = ifcopenshell.geom.settings()
    settings.set("mesher-linear-deflection", 1e-5)
    settings.set("use-world-coords", v=True)
    shape = ifcopenshell.geom.create_shape(settings, zone).geometry
    return np.array(shape.verts).reshape(-1, 3)[np.array(shape.faces).reshape(-1, 3)]


def area_m2(corners: FloatArray) -> float:
    """Of all triangles that look up."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    return float(normals[normals[:, 2] > 0, 2].sum())


def test_the_body_has_the_area_of_interest(written: tuple[Path, Path, Result]) -> None:
    _, target, result = written
    # entities do not keep their model alive
    model = ifcopenshell.open(target)
    (zone,) = zones(model, ifc_write.AOI_TYPE)
    corners = triangles(zone)
    # the kernel's chords leave the arcs by a hundredth of a millimetre
    assert area_m2(corners) == pytest.approx(result.aoi.area_mm2 / 1e6, rel=1e-5)
    assert corners[..., 2].min() == pytest.approx(0.3)
    floor = result.plan.frame.to_drawing_mm(np.array(result.plan.floor.exterior.coords)) / 1000
    assert corners[..., 0].min() >= floor[:, 0].min()
    assert corners[..., 1].max() <= floor[:, 1].max()


def test_a_patch_has_a_body_of_its_area(written: tuple[Path, Path, Result]) -> None:
    model = ifcopenshell.open(written[1])
    for zone in zones(model, ifc_write.UNREACHED_TYPE):
        # its arcs are drawn up to 0.02 mm beside its edge, of a few metres
        assert area_m2(triangles(zone)) == pytest.approx(properties(zone)["Area"], abs=2e-4)


def test_figures_and_reasons_stand_in_property_sets(written: tuple[Path, Path, Result]) -> None:
    _, target, result = written
    model = ifcopenshell.open(target)
    (area,) = zones(model, ifc_write.AOI_TYPE)
    figures = properties(area)
    assert figures["Area"] == pytest.approx(result.report.aoi.area_m2)
    assert (figures["Robot"], figures["Connectivity"]) == ("magicbim", "pose")
    assert figures["ModelSha256"] == sha256(written[0].read_bytes()).hexdigest()
    patches = [patch for patch in result.patches if not patch.narrow]
    unreached = zones(model, ifc_write.UNREACHED_TYPE)
    assert len(unreached) == len(patches) > 0
    largest = properties(unreached[0])
    assert largest["Area"] == pytest.approx(max(patch.area_mm2 for patch in patches) / 1e6)
    handles = {o.handle for o in result.plan.obstacles}
    blockers = [properties(zone).get("BlockedBy") for zone in unreached]
    assert {blocker for blocker in blockers if blocker} <= handles


def test_zones_are_listed_in_the_storey(written: tuple[Path, Path, Result]) -> None:
    model = ifcopenshell.open(written[1])
    (storey,) = model.by_type("IfcBuildingStorey")
    relations = storey.ContainsElements if model.schema == "IFC2X3" else storey.ReferencesElements
    listed = {element for relation in relations for element in relation.RelatedElements}
    assert set(zones(model, ifc_write.AOI_TYPE)) <= listed


def test_a_result_is_no_obstacle_when_it_is_read_again(written: tuple[Path, Path, Result]) -> None:
    source, target, _ = written
    before, after = plan_in(source), plan_in(target)
    assert (after.floor, after.obstacles) == (before.floor, before.obstacles)


def test_a_result_written_again_replaces_the_old_one(
    written: tuple[Path, Path, Result], folder: Path
) -> None:
    _, target, _ = written
    again = folder / "again.ifc"
    ifc_write.write(again, area_of_interest(plan_in(target), settings=COARSE))
    assert len(zones(ifcopenshell.open(again), ifc_write.AOI_TYPE)) == 1
    assert again.read_bytes().count(ifc_write.BEGIN) == 1


def test_the_same_result_gives_the_same_bytes(
    written: tuple[Path, Path, Result], folder: Path
) -> None:
    _, target, result = written
    twin = folder / "twin.ifc"
    ifc_write.write(twin, result)
    assert twin.read_bytes() == target.read_bytes()


def test_a_model_of_another_spelling_keeps_it(tmp_path: Path) -> None:
    source = hall("IFC4X3", "mm").save(tmp_path)
    spelled = source.read_bytes().replace(b"IFC4X3_ADD2", b"IFC4X3").replace(b"Ground", b"Gr\xfcn")
    source.write_bytes(spelled)
    target = tmp_path / "aoi.ifc"
    ifc_write.write(target, area_of_interest(read_plan(source), settings=COARSE))
    assert ifc_write.BLOCK.sub(b"", target.read_bytes()) == spelled
    assert {finding.code for finding in read_plan(target).findings} == {"schema-alias", "encoding"}


def test_a_plan_that_is_no_model_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"give an output that ends in \.dxf"):
        ifc_write.write(tmp_path / "aoi.ifc", furnished_result())


def test_the_model_itself_is_never_written_over(written: tuple[Path, Path, Result]) -> None:
    source, _, result = written
    with pytest.raises(InputError, match="never written over"):
        ifc_write.write(source, result)


def test_a_model_that_was_changed_meanwhile_is_refused(tmp_path: Path) -> None:
    source = hall("IFC4", "mm").save(tmp_path)
    result = area_of_interest(plan_in(source), settings=COARSE)
    source.write_bytes(source.read_bytes() + b"\n")
    with pytest.raises(UnreadableError, match="changed since it was read"):
        ifc_write.write(tmp_path / "aoi.ifc", result)
