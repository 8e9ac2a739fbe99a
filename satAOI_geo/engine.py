"""What an engine of collision tests is asked; `intervals` and `collision` answer it."""

from dataclasses import dataclass
from typing import Protocol

from satAOI_geo.lattice import Words
from satAOI_geo.plan import IntArray
from satAOI_geo.robot import Part


@dataclass(frozen=True, slots=True)
class AtRest:
    """Where a part that stays as it is touches something.

    Attributes:
        blocked: Nodes at which it does, and every bit beyond the last column.
        barred: Steps on the way of which it does, though perhaps at neither end; shape (n, 3):
            0 for a step to the right or 1 for a step up, and row and column of the node it starts
            from. Steps that touch something at an end need not be among them.
    """

    blocked: Words
    barred: IntArray


class Engine(Protocol):
    """Tells where a part of the robot touches something."""

    def at_rest(self, part: Part) -> AtRest:
        """The nodes at which the part touches something, and the steps between them."""

    def band(self, rows: slice) -> "Engine":
        """An engine for some rows of the lattice, with start and stop."""

    def blocked(self, part: Part) -> Words:
        """Nodes at which the part touches something, and every bit beyond the last column."""
