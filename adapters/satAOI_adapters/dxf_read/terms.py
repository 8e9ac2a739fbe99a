"""What all stages of one reading share."""

from dataclasses import dataclass

from satAOI_adapters.dxf_read.curves import Point
from satAOI_adapters.dxf_read.options import CLOSE_GAPS_MM
from satAOI_geo.plan import Frame


@dataclass(frozen=True, slots=True)
class Terms:
    """The terms of one reading.

    Attributes:
        frame: Where the plan's millimetres lie in the drawing, for positions in findings.
        gap_mm: Line ends this far apart are joined when outlines and walls are closed.
        is_named: Whether layers tell what stops the robot, rather than everything counting as
            walls.
        region_mm: Left, bottom, right, top of the part that is read, in the plan's frame.
        given_floors: Layers that the user's own file names as floors.
    """

    frame: Frame
    gap_mm: float = CLOSE_GAPS_MM
    is_named: bool = True
    region_mm: tuple[float, float, float, float] | None = None
    given_floors: frozenset[str] = frozenset()

    def place(self, spot: Point) -> Point:
        """A point of the plan in the drawing's axes, in millimetres."""
        ((x_mm, y_mm),) = self.frame.to_drawing_mm([spot])
        return float(x_mm), float(y_mm)
