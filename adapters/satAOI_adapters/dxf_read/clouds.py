"""Revision clouds: outlines of bows around what was changed in a drawing; they stand nowhere."""

import math
from typing import Final

from shapely.geometry import Polygon

from satAOI_adapters.dxf_read.curves import Arc, Path
from satAOI_adapters.dxf_read.shapes import by_chords

FEWEST_BOWS: Final = 8
"""A pier of four or six shafts has fewer."""

LEAST_TURN_RAD: Final = 2 * math.tau
"""What is round, or has round corners, turns once; every cusp of a cloud adds to that."""


def is_cloud(path: Path) -> bool:
    """Whether a closed path consists of bows outwards with cusps between them, and no line."""
    bows = [piece for piece in path.pieces if isinstance(piece, Arc)]
    if not path.closed or len(bows) < len(path.pieces) or len(bows) < FEWEST_BOWS:
        return False
    if len({bow.turns_left for bow in bows}) > 1:
        return False
    corners = Polygon([bow.start for bow in bows])
    is_outwards = by_chords(path).area > corners.area
    return is_outwards and sum(bow.sweep_rad for bow in bows) >= LEAST_TURN_RAD
