"""What lies so far from the rest of a drawing that it is there by a slip of the keyboard."""

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np

from satAOI_adapters.dxf_read import limits
from satAOI_adapters.dxf_read.curves import Point
from satAOI_adapters.dxf_read.features import Feature
from satAOI_adapters.dxf_read.meaning import Seen
from satAOI_geo.plan import Finding, FloatArray

Box: TypeAlias = tuple[float, float, float, float]
"""Left, bottom, right, top."""


def without_strays(
    rough: Sequence[tuple[Seen, Feature]],
) -> tuple[list[tuple[Seen, Feature]], Box | None, Point, tuple[Finding, ...]]:
    """What lies together, its box and its middle, and what is said about the rest.

    Entities farther from the middle than `limits.MAX_COORDINATE` are strays of a slip of the
    keyboard; kept, they would take the digits that the plan needs.
    """
    if not rough:
        return [], None, (0.0, 0.0), ()
    boxes = np.array([feature.box() for _, feature in rough])
    middle = _middle(boxes[:, :2])
    is_near = np.abs(boxes - np.tile(middle, 2)).max(axis=1) <= limits.MAX_COORDINATE
    near = [pair for pair, keeps in zip(rough, is_near, strict=True) if keeps]
    far = [pair for pair, keeps in zip(rough, is_near, strict=True) if not keeps]
    left, bottom = boxes[is_near, :2].min(axis=0)
    right, top = boxes[is_near, 2:].max(axis=0)
    findings = tuple(
        Finding(
            "far-away",
            f"{entity.placed.kind} lies or reaches more than {limits.MAX_COORDINATE:,.0f} units "
            "from the rest of the drawing and is not read",
            "delete it if it is a stray",
            layer=entity.placed.layer,
            handle=entity.placed.handle,
        )
        for entity, _ in far
    )
    box = (float(left), float(bottom), float(right), float(top))
    return near, box, (float(middle[0]), float(middle[1])), findings


def _middle(corners: FloatArray) -> FloatArray:
    """The corner that has most of the others around it, of those in the middle of either axis.

    Between two corners the mean of them would have none around it.
    """
    candidates = [
        np.quantile(corners, 0.5, axis=0, method=method) for method in ("lower", "higher")
    ]
    n_near = [
        (np.abs(corners - candidate).max(axis=1) <= limits.MAX_COORDINATE).sum()
        for candidate in candidates
    ]
    return candidates[int(np.argmax(n_near))]
