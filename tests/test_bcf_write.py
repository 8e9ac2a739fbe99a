"""Topics for reviewers: one for each patch that is not reached, in the form that BCF 2.1 asks."""

import re
import zipfile
from importlib.util import find_spec
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from satAOI_adapters import bcf_write
from satAOI_geo.errors import InputError
from satAOI_geo.pipeline import Result, area_of_interest
from tests.results import furnished_result
from tests.test_ifc_read import plan_in
from tests.test_ifc_write import COARSE, hall

GUID = re.compile(r"[a-f0-9]{8}(-[a-f0-9]{4}){3}-[a-f0-9]{12}")

ORDER = {
    "Markup": ["Header", "Topic", "Comment", "Viewpoints"],
    "Topic": [
        "ReferenceLink",
        "Title",
        "Priority",
        "Index",
        "Labels",
        "CreationDate",
        "CreationAuthor",
        "Description",
    ],
    "VisualizationInfo": ["Components", "OrthogonalCamera", "Lines", "ClippingPlanes"],
    "Components": ["ViewSetupHints", "Selection", "Visibility", "Coloring"],
    "OrthogonalCamera": [
        "CameraViewPoint",
        "CameraDirection",
        "CameraUpVector",
        "ViewToWorldScale",
    ],
    "ClippingPlane": ["Location", "Direction"],
    "Line": ["StartPoint", "EndPoint"],
}
"""Children in the order that the schemas of BCF 2.1 ask for."""


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Result]:
    folder = tmp_path_factory.mktemp("bcf")
    model = hall("IFC4", "m").save(folder)
    result = area_of_interest(plan_in(model), settings=COARSE)
    path = folder / "review.bcf"
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SOURCE_DATE_EPOCH", "1735689600")
        bcf_write.write(path, result)
    return path, result


def parsed(data: bytes) -> ET.Element:
    return ET.fromstring(data)  # noqa: S314 - written here


def topics(path: Path) -> list[tuple[ET.Element, ET.Element]]:
    """Markup and viewpoint of each topic, by index."""
    with zipfile.ZipFile(path) as archive:
        folders = {name.split("/")[0] for name in archive.namelist() if "/" in name}
        read = [
            (
                parsed(archive.read(f"{folder}/markup.bcf")),
                parsed(archive.read(f"{folder}/viewpoint.bcfv")),
            )
            for folder in folders
        ]
    return sorted(read, key=lambda pair: int(pair[0].findtext("Topic/Index", "")))


def test_each_large_patch_is_a_topic(written: tuple[Path, Result]) -> None:
    path, result = written
    large = [p for p in result.patches if not p.narrow and p.area_mm2 >= 0.5e6]
    large.sort(key=lambda patch: -patch.area_mm2)
    assert large
    titles = [markup.findtext("Topic/Title", "") for markup, _ in topics(path)]
    assert titles == [f"Not troweled: {p.area_mm2 / 1e6:.2f} m², {p.reason}" for p in large]


def test_elements_stand_in_the_order_of_the_schema(written: tuple[Path, Result]) -> None:
    for pair in topics(written[0]):
        for root in pair:
            for element in root.iter():
                order = ORDER.get(element.tag)
                if order is not None and len(element):
                    places = [order.index(child.tag) for child in element]
                    assert places == sorted(places), element.tag


def test_every_member_is_valid_by_the_schemas_of_buildingsmart(
    written: tuple[Path, Result],
) -> None:
    etree = pytest.importorskip("lxml.etree")
    package = find_spec("bcf_api_xml")
    if package is None or package.origin is None:
        pytest.skip("bcf-api-xml, which brings the schemas of BCF 2.1, is not installed")
    folder = Path(package.origin).parent / "Schemas"
    schemas = {".version": "version.xsd", ".bcf": "markup.xsd", ".bcfv": "visinfo.xsd"}
    with zipfile.ZipFile(written[0]) as archive:
        for name in archive.namelist():
            schema = etree.XMLSchema(etree.parse(folder / schemas[Path(name).suffix]))
            schema.assertValid(etree.fromstring(archive.read(name)))


def test_guids_have_the_form_of_guids_and_agree(written: tuple[Path, Result]) -> None:
    with zipfile.ZipFile(written[0]) as archive:
        assert parsed(archive.read("bcf.version")).get("VersionId") == "2.1"
        folders = {name.split("/")[0] for name in archive.namelist() if "/" in name}
    seen = set()
    for markup, viewpoint in topics(written[0]):
        topic = markup.find("Topic")
        assert topic is not None
        seen.add(topic.get("Guid"))
        listed = markup.find("Viewpoints")
        assert listed is not None
        assert listed.get("Guid") == viewpoint.get("Guid")
        assert GUID.fullmatch(viewpoint.get("Guid", ""))
    assert seen == folders


def test_the_camera_looks_down_on_the_patch_in_metres(written: tuple[Path, Result]) -> None:
    path, result = written
    large = max((p for p in result.patches if not p.narrow), key=lambda p: p.area_mm2)
    _, viewpoint = topics(path)[0]
    camera = [
        float(viewpoint.findtext(f"OrthogonalCamera/CameraViewPoint/{axis}", "")) for axis in "XYZ"
    ]
    corners_m = result.plan.frame.to_drawing_mm(np.array(large.region.envelope.boundary.coords))
    assert corners_m[:, 0].min() / 1e3 <= camera[0] <= corners_m[:, 0].max() / 1e3
    assert corners_m[:, 1].min() / 1e3 <= camera[1] <= corners_m[:, 1].max() / 1e3
    assert camera[2] == pytest.approx(0.3 + 10.0)
    assert viewpoint.findtext("OrthogonalCamera/CameraDirection/Z") == "-1.0"
    assert viewpoint.findtext("ClippingPlanes/ClippingPlane/Location/Z") == repr(1.8)


def test_the_blocking_element_is_selected(written: tuple[Path, Result]) -> None:
    path, result = written
    handles = {obstacle.handle for obstacle in result.plan.obstacles}
    selected = {
        component.get("IfcGuid")
        for _, viewpoint in topics(path)
        for component in viewpoint.iterfind("Components/Selection/Component")
    }
    assert selected
    assert selected <= handles


def test_the_model_is_named_with_its_project_and_storey(written: tuple[Path, Result]) -> None:
    path, result = written
    file = topics(path)[0][0].find("Header/File")
    assert file is not None
    assert file.findtext("Filename") == "model.ifc"
    assert file.get("IfcProject") == "0000000000000000000001"
    assert file.get("IfcSpatialStructureElement") == result.plan.source.storey


def test_the_same_day_gives_the_same_bytes(
    written: tuple[Path, Result], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, result = written
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1735689600")
    bcf_write.write(tmp_path / "twin.bcf", result)
    assert (tmp_path / "twin.bcf").read_bytes() == path.read_bytes()
    assert topics(path)[0][0].findtext("Topic/CreationDate") == "2025-01-01T00:00:00Z"


def test_a_plan_that_is_no_model_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="BCF speaks about the elements of an IFC model"):
        bcf_write.write(tmp_path / "review.bcf", furnished_result())
