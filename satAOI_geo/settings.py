"""What a search is made with."""

import math
from dataclasses import dataclass
from typing import Final, Literal, TypeAlias

from satAOI_geo.errors import InputError

LEAST_STEP_MM: Final = 1e-3
MOST_CLEARANCE_MM: Final = 1e6
"""Beyond these numbers lose the digits that contact is told by."""

Connectivity: TypeAlias = Literal["disc", "pose"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Settings:
    """What a search is made with.

    Attributes:
        connectivity: `pose` for what motions join, `disc` for the paper's rule, an upper estimate.
        step_mm: Side of a lattice cell.
        n_directions: Directions in a full turn, a multiple of 4.
        clearance_mm: Distance to keep beyond contact, 0 or more.
        align_rad: Direction of the lattice in the drawing; None lays it along most of the walls.
        engine: `fast`, or `reference` to ask the exact collision test node by node.
        exact_outline: Keep the scallops between neighbouring discs in the outline.
        memory_gb: What the search may take besides Python, the libraries and the plan; a floor
            that would take more is searched in bands of rows, with the same answer.

    Raises:
        InputError: If the step, the clearance, the direction or the memory is not a usable
            number.
    """

    connectivity: Connectivity = "pose"
    step_mm: float = 10.0
    n_directions: int = 24
    clearance_mm: float = 0.0
    align_rad: float | None = None
    engine: Literal["fast", "reference"] = "fast"
    exact_outline: bool = False
    memory_gb: float = 1.0

    def __post_init__(self) -> None:
        if not LEAST_STEP_MM <= self.step_mm < math.inf:
            raise InputError(
                f"the lattice step is {self.step_mm:g} mm; give a length of at least "
                f"{LEAST_STEP_MM:g}"
            )
        if not 0 <= self.clearance_mm <= MOST_CLEARANCE_MM:
            raise InputError(
                f"the clearance is {self.clearance_mm:g} mm; give 0 to {MOST_CLEARANCE_MM:g}"
            )
        if self.align_rad is not None and not math.isfinite(self.align_rad):
            raise InputError(f"the lattice's direction is {self.align_rad:g}; give an angle")
        if not self.memory_gb > 0:
            raise InputError(f"the memory is {self.memory_gb:g} GB; give more than 0")


DEFAULTS: Final = Settings()
