"""The lattice of disc centres and directions: the only code that turns points into nodes.

Nodes are the centres of square cells that cover the floor's bounds; node [row, column] is
[iy, ix], row 0 at the smallest y. Directions are multiples of 360° / n_directions.
"""

import math
from dataclasses import dataclass, replace
from typing import Final, TypeAlias

import numpy as np
import numpy.typing as npt

from satAOI_geo.errors import InputError, LimitError
from satAOI_geo.plan import FloatArray
from satAOI_geo.robot import Pose, Robot

MAX_NODES: Final = 1_000_000_000
"""100 000 m² at 10 mm: more is a wrong unit rather than a floor."""

WORD_BITS: Final = 64

Words: TypeAlias = npt.NDArray[np.uint64]
"""Nodes as bits, shape (..., n_rows, n_words): [iy, ix] is bit ix % 64 of word [iy, ix // 64]."""

CELL_SLACK: Final = 1e-9
"""Share of a cell that rounding may add to an extent that is a whole number of cells."""


@dataclass(frozen=True, slots=True)
class Lattice:
    """Disc centres and angles that are tried.

    Attributes:
        origin_mm: Lower left corner of cell [0, 0] in the plan's frame.
        step_mm: Side of a cell.
        n_rows: Cells in y.
        n_columns: Cells in x.
        n_directions: Directions a1 in a full turn, a multiple of 4.
        swings: The turns a2 of the vehicle against the arm, in whole directions, ascending.
        first_row: Which row of the lattice that this is a band of its row 0 is; y is counted from
            there, so that a node has the same coordinates in both to the last bit.
        swings_all_round: Whether the last swing is beside the first, as in a full turn. A range
            that lacks a few degrees of one may have as many swings, and ends between these two.
    """

    origin_mm: tuple[float, float]
    step_mm: float
    n_rows: int
    n_columns: int
    n_directions: int
    swings: tuple[int, ...]
    first_row: int = 0
    swings_all_round: bool = False

    @classmethod
    def over(
        cls,
        bounds_mm: tuple[float, float, float, float],
        robot: Robot,
        *,
        step_mm: float = 10.0,
        n_directions: int = 24,
    ) -> "Lattice":
        """The lattice over a floor's bounds (left, bottom, right, top).

        Raises:
            InputError: If the step is not positive or n_directions not a positive multiple of 4.
            LimitError: If there would be more than `MAX_NODES` nodes.
        """
        if not (math.isfinite(step_mm) and step_mm > 0):
            raise InputError(f"the lattice step is {step_mm:g} mm; give a length above 0")
        if n_directions < 4 or n_directions % 4:
            raise InputError(
                f"{n_directions} directions asked for; give a multiple of 4, for example 24"
            )
        left, bottom, right, top = bounds_mm
        n_columns = math.ceil((right - left) / step_mm - CELL_SLACK)
        n_rows = math.ceil((top - bottom) / step_mm - CELL_SLACK)
        if n_rows * n_columns > MAX_NODES:
            raise LimitError(
                f"a floor of {(right - left) / 1000:.0f} × {(top - bottom) / 1000:.0f} m at "
                f"{step_mm:g} mm has {n_rows * n_columns:,} nodes, more than {MAX_NODES:,}; check "
                "the unit or give a coarser --step",
                limit="nodes",
                value=n_rows * n_columns,
                allowed=MAX_NODES,
            )
        turn_rad = 2 * math.pi / n_directions
        least = math.ceil(-robot.swing_max_rad / turn_rad - CELL_SLACK)
        most = math.floor(-robot.swing_min_rad / turn_rad + CELL_SLACK)
        # a full turn of swing has both its ends at the same heading: keep one
        swings = tuple(range(least, min(most + 1, least + n_directions)))
        if not swings:
            raise InputError(
                f"the swing range of robot '{robot.name}' holds no multiple of "
                f"{math.degrees(turn_rad):g}°; give more --directions"
            )
        return cls(
            (left, bottom),
            step_mm,
            n_rows,
            n_columns,
            n_directions,
            swings,
            swings_all_round=robot.swings_all_round,
        )

    @property
    def shape(self) -> tuple[int, int]:
        """(rows, columns)."""
        return self.n_rows, self.n_columns

    def x_mm(self, ix: int) -> float:
        """x of the nodes in column ix."""
        return self.origin_mm[0] + (ix + 0.5) * self.step_mm

    def y_mm(self, iy: int) -> float:
        """y of the nodes in row iy."""
        return self.origin_mm[1] + (self.first_row + iy + 0.5) * self.step_mm

    def nearest_node(self, x_mm: float, y_mm: float) -> tuple[int, int] | None:
        """Node (iy, ix) of the cell that holds the point, or None outside the lattice."""
        ix = math.floor((x_mm - self.origin_mm[0]) / self.step_mm)
        iy = math.floor((y_mm - self.origin_mm[1]) / self.step_mm)
        if 0 <= iy < self.n_rows and 0 <= ix < self.n_columns:
            return iy, ix
        return None

    def window(self, rows: slice, columns: slice) -> "Lattice":
        """The part of the lattice in a window of rows and columns, both with start and stop."""
        x_mm = self.origin_mm[0] + columns.start * self.step_mm
        y_mm = self.origin_mm[1] + (self.first_row + rows.start) * self.step_mm
        return replace(
            self,
            origin_mm=(x_mm, y_mm),
            n_rows=rows.stop - rows.start,
            n_columns=columns.stop - columns.start,
            first_row=0,
        )

    def around(self, rows: slice, columns: slice, reach_mm: float) -> tuple[slice, slice]:
        """Rows and columns that hold a window and all of the lattice within reach of it.

        The columns begin and end with a word, or with the lattice.
        """
        pad = math.ceil(reach_mm / self.step_mm)
        left, beyond = max(0, columns.start - pad), columns.stop + pad
        return (
            slice(max(0, rows.start - pad), min(self.n_rows, rows.stop + pad)),
            slice(
                left // WORD_BITS * WORD_BITS,
                min(self.n_columns, -(-beyond // WORD_BITS) * WORD_BITS),
            ),
        )

    def band(self, rows: slice) -> "Lattice":
        """Some rows of the lattice, with start and stop, in the same axes."""
        first_row = self.first_row + rows.start
        return replace(self, n_rows=rows.stop - rows.start, first_row=first_row)

    def directions(self) -> FloatArray:
        """Unit vectors u(2πk / n_directions), shape (n_directions, 2).

        Turned by quarters and mirrored copies agree to the last bit, since all of them come from
        the first eighth of the circle.
        """
        quarter = self.n_directions // 4
        first = []
        for k in range(quarter):
            mirrored = 2 * k > quarter
            angle_rad = math.pi / 2 * (quarter - k if mirrored else k) / quarter
            cos, sin = math.cos(angle_rad), math.sin(angle_rad)
            if 2 * k == quarter:
                cos = sin = math.sqrt(0.5)
            first.append((sin, cos) if mirrored else (cos, sin))
        east = np.array(first)
        north = np.column_stack((-east[:, 1], east[:, 0]))
        return np.concatenate((east, north, -east, -north)) + 0.0

    def pose(self, iy: int, ix: int, a1: int, swing: int) -> Pose:
        """The pose at node (iy, ix) with direction number a1 and swing number `swing`."""
        turn_rad = 2 * math.pi / self.n_directions
        return Pose(self.x_mm(ix), self.y_mm(iy), a1 * turn_rad, self.swings[swing] * turn_rad)

    def no_nodes(self) -> Words:
        """No node at all: every bit clear but those beyond the last column, which are set.

        That way the complement of a set of blocked nodes holds nodes only.
        """
        words = np.zeros((self.n_rows, -(-self.n_columns // WORD_BITS)), dtype=np.uint64)
        used = self.n_columns % WORD_BITS
        if used:
            words[:, -1] = np.uint64(((1 << WORD_BITS) - 1) ^ ((1 << used) - 1))
        return words
