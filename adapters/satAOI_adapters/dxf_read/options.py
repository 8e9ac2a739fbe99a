"""What a user can say about how a drawing is to be read."""

from dataclasses import dataclass
from pathlib import Path
from typing import Final

from satAOI_geo.errors import InputError

CLOSE_GAPS_MM: Final = 1.0
"""Line ends this close are meant to meet: no drawing is coarser, no opening finer."""

WIDEST_GAP_MM: Final = 500.0
"""Hardly a door is as narrow."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReadOptions:
    """How to read a drawing; every field has a default that suits a well-kept drawing.

    Attributes:
        units: Key of `units.MM_PER_UNIT`; goes before what the drawing says.
        layers: The user's own layer patterns (TOML).
        encoding: Of the names in the file; goes before what the file declares.
        xref_dir: Folder in which external references are looked for, as DXF; without it none is
            followed.
        include_hidden: Read layers that are frozen or switched off, too.
        plan: Which of several plans in one drawing, counted from 1 as `inspect` lists them.
        region: Left, bottom, right, top of the part to read, in drawing units.
        start: The start, in drawing units; of several plans the one that holds it is read.
        close_gaps_mm: Line ends this far apart are joined when walls and outlines are closed.

    Raises:
        InputError: If the gaps are negative, or as wide as openings.
    """

    units: str | None = None
    layers: Path | None = None
    encoding: str | None = None
    xref_dir: Path | None = None
    include_hidden: bool = False
    plan: int | None = None
    region: tuple[float, float, float, float] | None = None
    start: tuple[float, float] | None = None
    close_gaps_mm: float = CLOSE_GAPS_MM

    def __post_init__(self) -> None:
        if not 0 <= self.close_gaps_mm <= WIDEST_GAP_MM:
            raise InputError(
                f"gaps of {self.close_gaps_mm:g} mm are to be closed; give 0 to {WIDEST_GAP_MM:g}, "
                "wider ones are openings"
            )
