"""Closed curves in IFC, arcs kept as arcs."""

from collections.abc import Iterator
from typing import Final

import ifcopenshell
import numpy as np
from ifcopenshell import entity_instance

from satAOI_geo.aoi import Loop
from satAOI_geo.plan import FloatArray

SAGITTA_MM: Final = 0.5
"""How far chords may leave arcs where a curve must be a polyline: in IFC2X3. The area stays.
Each chord is a face of the body, and over thousands of them geometry kernels take minutes."""


def closed_curve(
    model: ifcopenshell.file, vertices: FloatArray, mm_per_unit: float
) -> entity_instance:
    """A loop of straight lines and arcs, shape (n, 3) as in `aoi.Loop`, in the model's unit."""
    if model.schema == "IFC2X3":
        # composite curves of trimmed circles are read differently by different programs
        points_mm = Loop(vertices).equal_area_points_mm(SAGITTA_MM)
        return _closed_polyline(model, points_mm / mm_per_unit)
    bulges = vertices[:, 2]
    corners_mm = vertices[:, :2]
    middles_mm = _middles_mm(vertices)[bulges != 0]
    points = np.concatenate((corners_mm, middles_mm)) / mm_per_unit
    listed = model.create_entity("IfcCartesianPointList2D", CoordList=points.tolist())
    segments = [model.create_entity(name, indices) for name, indices in _segments(bulges)]
    return model.create_entity(
        "IfcIndexedPolyCurve", Points=listed, Segments=segments, SelfIntersect=False
    )


def _closed_polyline(model: ifcopenshell.file, points: FloatArray) -> entity_instance:
    """Straight lines through points, shape (n, 2), in the model's unit, and back to the first."""
    made = [model.create_entity("IfcCartesianPoint", point) for point in points.tolist()]
    return model.create_entity("IfcPolyline", [*made, made[0]])


def _segments(bulges: FloatArray) -> Iterator[tuple[str, list[int]]]:
    """Class and indices, from 1, of arcs and of runs of straight lines.

    The middles of the arcs are listed after all n corners, in the order of the arcs.
    """
    n = len(bulges)
    middle = n
    run = [1]
    for corner, bulge in enumerate(bulges, start=1):
        after = corner % n + 1
        if not bulge:
            run.append(after)
            continue
        if len(run) > 1:
            yield "IfcLineIndex", run
        middle += 1
        yield "IfcArcIndex", [corner, middle, after]
        run = [after]
    if len(run) > 1:
        yield "IfcLineIndex", run


def _middles_mm(vertices: FloatArray) -> FloatArray:
    """The middle of each piece: its height is the bulge times half the chord, to the right."""
    chords_mm = np.roll(vertices[:, :2], -1, axis=0) - vertices[:, :2]
    right_mm = np.column_stack((chords_mm[:, 1], -chords_mm[:, 0]))
    middles_mm: FloatArray = vertices[:, :2] + (chords_mm + vertices[:, 2:] * right_mm) / 2
    return middles_mm
