"""What is drawn: outlines and lines, each with the entity it comes from."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from satAOI_adapters.dxf_read.curves import Arc, Line, Path, Piece, Point, Spline
from satAOI_adapters.dxf_read.expand import Placed


@dataclass(frozen=True, slots=True)
class Feature:
    """Something drawn.

    Attributes:
        placed: The entity it comes from.
        paths: Its lines; of an area, its outlines.
        is_area: Whether it is filled (even-odd) rather than drawn as lines.
        width_mm: Width of the lines; 0 for a line without width.
    """

    placed: Placed
    paths: tuple[Path, ...]
    is_area: bool = False
    width_mm: float = 0.0

    @property
    def is_pattern(self) -> bool:
        """Whether it is a hatch that draws a pattern of lines rather than filling."""
        is_hatch = self.is_area and self.placed.kind == "HATCH"
        return is_hatch and not self.placed.entity.dxf.solid_fill

    def box(self) -> tuple[float, float, float, float]:
        """Left, bottom, right, top of a box around its paths."""
        spots = [spot for path in self.paths for piece in path.pieces for spot in piece.spots()]
        x, y = zip(*spots, strict=True)
        return min(x), min(y), max(x), max(y)


def area(placed: Placed, corners: Sequence[Point]) -> Feature:
    """What is filled between corners."""
    return Feature(placed, straight(corners, is_closed=True), is_area=True)


def straight(points: Sequence[Point], *, is_closed: bool) -> tuple[Path, ...]:
    """A path from corner to corner, as `paths_of` has it."""
    ends = [*points[1:], *points[:1]] if is_closed else points[1:]
    return paths_of([Line(a, b) for a, b in zip(points, ends, strict=False)], is_closed=is_closed)


def paths_of(pieces: Sequence[Piece], *, is_closed: bool = False) -> tuple[Path, ...]:
    """One path, or none where nothing is left of it; ends that meet close it."""
    kept = [piece for piece in pieces if piece.start != piece.end or is_loop(piece)]
    if not kept:
        return ()
    meets = kept[0].start == kept[-1].end
    if is_closed and not meets:
        kept.append(Line(kept[-1].end, kept[0].start))
    encloses = len(kept) > 2 or not all(isinstance(piece, Line) for piece in kept)
    return (Path(tuple(kept), closed=(is_closed or meets) and encloses),)


def is_loop(piece: Piece) -> bool:
    """Whether a piece that ends where it starts is more than a point."""
    if isinstance(piece, Arc):
        return any((*piece.u, *piece.v))
    return isinstance(piece, Spline) and any(np.ptp(b[:, :2] / b[:, 2:]) for b in piece.beziers)
