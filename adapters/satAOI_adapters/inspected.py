"""What is known of a plan's file before it is worked on, whatever its format."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Generic, Protocol, TypeVar

from shapely.geometry import LineString

from satAOI_geo.plan import Finding, FloorPlan, Frame, Kind, Source

if TYPE_CHECKING:
    from satAOI_adapters.meanings import LayerMap
    from satAOI_geo.errors import SatAoiError


class Figures(Protocol):
    """What every format tells."""

    @property
    def source(self) -> Source:
        """The file and its unit."""


Figures_co = TypeVar("Figures_co", bound=Figures, covariant=True)

Bounds = tuple[float, float, float, float]
"""Left, bottom, right, top."""


@dataclass(frozen=True, slots=True)
class Sketch:
    """All that is drawn, before it is a plan.

    Attributes:
        frame: Where it lies in the drawing; where the drawing's unit is not known, as if it were a
            millimetre.
        lines: By the kind of obstacle they are drawn as, None for those that are none; curves by
            chords, in the frame.
        parts_mm: Bounds of the parts that may be plans, in the frame, the likeliest first.
    """

    frame: Frame
    lines: Mapping[Kind | None, Sequence[LineString]]
    parts_mm: Sequence[Bounds]


@dataclass(frozen=True, slots=True)
class Inspected(Generic[Figures_co]):
    """How a file is read.

    Attributes:
        figures: What its format has to tell, as data.
        findings: What was skipped, guessed or repaired.
        plan: The plan as it is read; None where it cannot be, or was not asked for.
        error: Why the file cannot be used as it is.
        sketch: What is drawn (DXF).
        layers: Which layer is taken for what (DXF).
    """

    figures: Figures_co
    findings: Sequence[Finding] = ()
    plan: FloorPlan | None = None
    error: "SatAoiError | None" = None
    sketch: Sketch | None = None
    layers: "LayerMap | None" = None
