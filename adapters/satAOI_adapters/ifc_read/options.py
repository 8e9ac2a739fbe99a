"""What a user can choose when a storey of an IFC model is read."""

import math
from dataclasses import dataclass
from typing import Final

from satAOI_geo.errors import InputError

BAND_MM: Final = 1200.0
"""Height of the robot: what begins above it does not stand in its way."""


@dataclass(frozen=True, slots=True, kw_only=True)
class IfcOptions:
    """How a model becomes a plan.

    Attributes:
        storey: Name or number (from 1, lowest first) of the storey; None if there is but one.
        floor_z: Height of the floor in the model's unit of length; overrides the storey's own.
        band_mm: Height above the floor up to which things are in the way.
        units: Key of `units.MM_PER_UNIT`; overrides the model's unit assignment.
        with_classes: IFC classes that block although they do not by default; of two classes that
            an element is of, here or in `without_classes`, the more special one counts.
        without_classes: IFC classes that do not block although they do by default.
        timeout_s: Longest time the geometry may take.
        memory_mb: Most memory the geometry may take; None for an allowance by the file's size.

    Raises:
        InputError: If the band or the floor's height is not a usable number.
    """

    storey: str | None = None
    floor_z: float | None = None
    band_mm: float = BAND_MM
    units: str | None = None
    with_classes: tuple[str, ...] = ()
    without_classes: tuple[str, ...] = ()
    timeout_s: float = 600.0
    memory_mb: int | None = None

    def __post_init__(self) -> None:
        if not 0 < self.band_mm < math.inf:
            raise InputError(f"the band is {self.band_mm:g} mm high; give a height above 0")
        if self.floor_z is not None and not math.isfinite(self.floor_z):
            raise InputError(f"the floor's height is {self.floor_z:g}; give a number")
