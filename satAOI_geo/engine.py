"""What an engine of collision tests is asked; `intervals` and `collision` answer it."""

from typing import Protocol

from satAOI_geo.lattice import Words
from satAOI_geo.plan import BoolArray, IntArray
from satAOI_geo.robot import Part


class Engine(Protocol):
    """Tells where a part of the robot touches something."""

    def block(self, words: Words, part: Part) -> IntArray:
        """Set the bits of the nodes at which the part touches something.

        Returns:
            The steps on the way of which the part, as it is, touches something, though perhaps at
            neither end; shape (n, 3): 0 for a step to the right or 1 for a step up, and row and
            column of the node it starts from. Steps that touch something at an end need not be
            among them.
        """

    def band(self, rows: slice) -> "Engine":
        """An engine for some rows of the lattice, with start and stop."""

    def blocked(self, part: Part, rows: BoolArray | None = None) -> Words:
        """Nodes at which the part touches something, and every bit beyond the last column.

        Args:
            part: The part.
            rows: Shape (n_rows,), whether a row is asked for; in others nodes may be missing.
        """
