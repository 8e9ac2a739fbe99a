"""The area of interest: the floor that the disc covers, as a raster and as an outline."""

from dataclasses import dataclass

import numpy.typing as npt
import numpy as np
from typing import TypeAlias
from shapely.geometry import Polygon

from satAOI_geo.plan import FloatArray

BoolArray: TypeAlias = npt.NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Loop:
    """A closed chain of straight lines and circular arcs.

    Attributes:
        vertices: Shape (n, 3), x_mm, y_mm and the bulge of the piece that starts there; the last
            piece ends at the first vertex. A bulge is tan(angle / 4), positive when the arc runs
            counter-clockwise, 0 for a straight line, as in DXF.
    """

    vertices: FloatArray

    def area_mm2(
        self,
    ) -> float: ...  # signed: positive counter-clockwise; exact, arcs included
    def points_mm(self, sagitta_mm: float) -> FloatArray: ...  # flattened, shape (m, 2)


@dataclass(frozen=True, slots=True)
class Outline:
    """One connected part of the area: exterior counter-clockwise, holes clockwise."""

    exterior: Loop
    holes: tuple[Loop, ...]

    def area_mm2(self) -> float: ...
    def polygon(self, sagitta_mm: float = 0.01) -> Polygon: ...


@dataclass(frozen=True, slots=True)
class Aoi:
    raster: BoolArray  # [row, column], True where the cell centre lies within R of a reached node
    outlines: tuple[Outline, ...]  # largest first
    area_mm2: float  # property: of the outlines
    raster_area_mm2
