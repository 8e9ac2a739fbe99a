"""Tell BIM reviewers what is not reached: a BCF 2.1 file with a topic for each patch.

Each topic has a viewpoint from above, cut open just over the robot, with the patch outlined and
the element that is nearest in the way selected. Lengths are in metres in the model's axes, which
is what BCF asks for. Source: buildingSMART, BCF-XML 2.1.
"""

import itertools
import os
import re
import uuid
import zipfile
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import Final
from xml.etree import ElementTree as ET

import numpy as np
from shapely.geometry import Polygon

from satAOI_adapters.files import refuse_unfit_target, written_whole
from satAOI_adapters.wording import coordinate
from satAOI_geo.errors import InputError, UnreadableError
from satAOI_geo.pipeline import Result
from satAOI_geo.plan import FloatArray, polygons_in
from satAOI_geo.reasons import SENTENCES, Patch
from satAOI_geo.units import MM2_PER_M2, MM_PER_UNIT

VERSION: Final = "2.1"
AUTHOR: Final = "satAOI-geo"

LEAST_MM2: Final = 0.5 * MM2_PER_M2
"""Smaller patches are no topic: they are listed in the report."""

CUT_MM: Final = 1500.0
"""Height above the floor at which viewpoints are cut open: over the robot, under the lintels."""

CAMERA_MM: Final = 10_000.0
"""Height of the camera above the floor; an orthogonal one sees the same from any height."""

LEAST_VIEW_MM: Final = 4000.0
"""A view at least this wide shows what is around a small patch."""

MARGIN: Final = 1.5
"""How much wider than the patch the view is."""

OUTLINE_MM: Final = 10.0
"""How far the drawn outline may leave the patch's own: viewers draw each line apart."""

NAMESPACE: Final = uuid.UUID("5d1f6a3c-94c5-49f0-8d3b-a8b3c7e0f712")
"""Guids are hashed within it from model and topic: written again, they are the same."""

EARLIEST: Final = (1980, 1, 1, 0, 0, 0)
"""Date of the members of the archive, the earliest there can be, so that bytes repeat."""

PROJECT: Final = re.compile(rb"IFCPROJECT\s*\(\s*'([^']{22})'", re.IGNORECASE)


def write(path: Path, result: Result) -> None:
    """Write a topic for each patch of at least 0.5 m² that is not reached.

    The date in it is that of the environment variable SOURCE_DATE_EPOCH, else today's.

    Args:
        path: The BCF file to write.
        result: The area of interest and the plan it was found on.

    Raises:
        InputError: If the plan is not from an IFC model, or the file must not or cannot be written.
        UnreadableError: If the model is gone.
    """
    source = result.plan.source
    if source.format != "ifc":
        raise InputError(
            f"'{path}': BCF speaks about the elements of an IFC model, and this plan is none; give "
            "an output that ends in .dxf"
        )
    model = Path(source.path)
    refuse_unfit_target(path, [model])
    header, date = _header(result, _project(model)), _date()
    members = {"bcf.version": _version()}
    patches = [p for p in result.patches if not p.narrow and p.area_mm2 >= LEAST_MM2]
    patches.sort(key=lambda patch: (-patch.area_mm2, patch.label_mm))
    for number, patch in enumerate(patches, start=1):
        guid, view_guid = (_guid(result, f"{what} {number}") for what in ("topic", "viewpoint"))
        markup = ET.Element("Markup")
        markup.append(header)
        markup.append(_topic(result, patch, guid, number, date))
        view = ET.SubElement(markup, "Viewpoints", Guid=view_guid)
        ET.SubElement(view, "Viewpoint").text = "viewpoint.bcfv"
        members[f"{guid}/markup.bcf"] = _bytes(markup)
        members[f"{guid}/viewpoint.bcfv"] = _bytes(_viewpoint(result, patch, view_guid))
    with (
        written_whole(path, never_over=[model]) as stream,
        zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive,
    ):
        for name, content in members.items():
            archive.writestr(zipfile.ZipInfo(name, EARLIEST), content)


def _project(model: Path) -> str:
    """GlobalId of the model's project, or an empty string."""
    try:
        match = PROJECT.search(model.read_bytes())
    except OSError as error:
        raise UnreadableError(f"cannot read '{model}' again: {error.strerror or error}") from error
    return "" if match is None else match[1].decode("ascii", "replace")


def _date() -> str:
    epoch = os.environ.get("SOURCE_DATE_EPOCH")
    when = datetime.now(UTC) if epoch is None else datetime.fromtimestamp(int(epoch), UTC)
    return when.strftime("%Y-%m-%dT%H:%M:%SZ")


def _guid(result: Result, key: str) -> str:
    return str(uuid.uuid5(NAMESPACE, f"{result.plan.source.sha256} {key}"))


def _bytes(root: ET.Element) -> bytes:
    ET.indent(root)
    return bytes(ET.tostring(root, encoding="utf-8", xml_declaration=True))


def _version() -> bytes:
    root = ET.Element("Version", VersionId=VERSION)
    ET.SubElement(root, "DetailedVersion").text = VERSION
    return _bytes(root)


def _header(result: Result, project: str) -> ET.Element:
    """The model that all topics speak about."""
    header = ET.Element("Header")
    where = {"IfcProject": project, "IfcSpatialStructureElement": result.plan.source.storey}
    known = {name: handle for name, handle in where.items() if handle}
    file = ET.SubElement(header, "File", known, isExternal="true")
    ET.SubElement(file, "Filename").text = Path(result.plan.source.path).name
    return header


def _topic(result: Result, patch: Patch, guid: str, number: int, date: str) -> ET.Element:
    topic = ET.Element("Topic", Guid=guid, TopicType="Issue", TopicStatus="Open")
    area_m2 = patch.area_mm2 / MM2_PER_M2
    ET.SubElement(topic, "Title").text = f"Not troweled: {area_m2:.2f} m², {patch.reason}"
    ET.SubElement(topic, "Index").text = str(number)
    ET.SubElement(topic, "Labels").text = f"satAOI-geo {patch.reason}"
    ET.SubElement(topic, "CreationDate").text = date
    ET.SubElement(topic, "CreationAuthor").text = AUTHOR
    ET.SubElement(topic, "Description").text = _description(result, patch)
    return topic


def _description(result: Result, patch: Patch) -> str:
    frame = result.plan.frame
    x, y = (coordinate(v, frame.mm_per_unit) for v in frame.to_drawing(patch.label_mm).tolist())
    sentence = (
        f"The robot '{result.robot.name}' does not trowel {patch.area_mm2 / MM2_PER_M2:.2f} m² "
        f"around ({x}, {y}): {SENTENCES[patch.reason]}."
    )
    if patch.blocker is None:
        return sentence
    return f"{sentence} Nearest in the way: {patch.blocker.layer} {patch.blocker.handle}."


def _viewpoint(result: Result, patch: Patch, guid: str) -> ET.Element:
    floor_mm = result.plan.source.height_mm
    corners_mm = result.plan.frame.to_drawing_mm(_corners_mm(patch))
    least_mm, most_mm = corners_mm.min(axis=0), corners_mm.max(axis=0)
    centre_mm = (least_mm + most_mm) / 2
    view_mm = max(LEAST_VIEW_MM, MARGIN * float((most_mm - least_mm).max()))
    root = ET.Element("VisualizationInfo", Guid=guid)
    components = ET.SubElement(root, "Components")
    if patch.blocker is not None and patch.blocker.handle:
        selection = ET.SubElement(components, "Selection")
        ET.SubElement(selection, "Component", IfcGuid=patch.blocker.handle)
    ET.SubElement(components, "Visibility", DefaultVisibility="true")
    camera = ET.SubElement(root, "OrthogonalCamera")
    _point(camera, "CameraViewPoint", (*centre_mm, floor_mm + CAMERA_MM))
    _vector(camera, "CameraDirection", (0.0, 0.0, -1.0))
    _vector(camera, "CameraUpVector", (0.0, 1.0, 0.0))
    ET.SubElement(camera, "ViewToWorldScale").text = repr(view_mm / MM_PER_UNIT["m"])
    lines = ET.SubElement(root, "Lines")
    for start_mm, end_mm in _outlines_mm(result, patch):
        line = ET.SubElement(lines, "Line")
        _point(line, "StartPoint", (*start_mm, floor_mm))
        _point(line, "EndPoint", (*end_mm, floor_mm))
    plane = ET.SubElement(ET.SubElement(root, "ClippingPlanes"), "ClippingPlane")
    _point(plane, "Location", (*centre_mm, floor_mm + CUT_MM))
    # what lies in this direction is hidden
    _vector(plane, "Direction", (0.0, 0.0, 1.0))
    return root


def _corners_mm(patch: Patch) -> FloatArray:
    return np.concatenate(
        [np.asarray(part.exterior.coords) for part in polygons_in([patch.region])]
    )


def _outlines_mm(result: Result, patch: Patch) -> Iterator[tuple[FloatArray, FloatArray]]:
    """The straight pieces of the patch's outline in the model's axes."""
    for part in polygons_in([patch.region]):
        plain = part.simplify(OUTLINE_MM)
        ring = plain.exterior if isinstance(plain, Polygon) else part.exterior
        points_mm = result.plan.frame.to_drawing_mm(np.asarray(ring.coords))
        yield from itertools.pairwise(points_mm)


def _point(parent: ET.Element, name: str, point_mm: tuple[float, ...]) -> None:
    x_mm, y_mm, z_mm = point_mm
    metre_mm = MM_PER_UNIT["m"]
    _vector(parent, name, (x_mm / metre_mm, y_mm / metre_mm, z_mm / metre_mm))


def _vector(parent: ET.Element, name: str, vector: tuple[float, float, float]) -> None:
    element = ET.SubElement(parent, name)
    for axis, value in zip("XYZ", vector, strict=True):
        ET.SubElement(element, axis).text = repr(float(value))
