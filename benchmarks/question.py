"""What all contenders are asked, and the figures by which they are compared.

At which nodes is some pose free, which of these does the paper's rule join with the start, and
what does the disc cover from there. The plan, the lattice and the image of occupied cells are
given and cost nobody time.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, TypeAlias

import numpy as np
import scipy.ndimage

from benchmarks.cells import occupied_cells
from satAOI_geo.freespace import free_space
from satAOI_geo.intervals import Intervals
from satAOI_geo.lattice import Lattice
from satAOI_geo.nodes import Nodes
from satAOI_geo.plan import BoolArray, FloorPlan
from satAOI_geo.reach import DiscComponents
from satAOI_geo.robot import PROTOTYPE

ROBOT: Final = PROTOTYPE


@dataclass(frozen=True, slots=True)
class Images:
    """A floor node by node, arrays of shape (n_rows, n_columns).

    Attributes:
        occupied: Cells whose centre lies in an obstacle: what the alternatives start from.
        free: Nodes at which some pose is free: the exact answer.
        reached: Those that the paper's rule joins with the start, the largest set: likewise.
    """

    occupied: BoolArray
    free: BoolArray
    reached: BoolArray

    @classmethod
    def of(cls, plan: FloorPlan, lattice: Lattice) -> "Images":
        """The images of a plan; the answer is found by row intervals."""
        free = free_space(Intervals.of(plan, ROBOT, lattice), ROBOT, lattice).free_nodes()
        return cls(occupied_cells(plan, lattice), free.as_array(), largest_set(free).as_array())

    def tried(self) -> BoolArray:
        """Nodes that a search from the start tries: the reached ones and all beside them."""
        tried: BoolArray = scipy.ndimage.binary_dilation(self.reached, np.ones((3, 3)))
        return tried


@dataclass(frozen=True, slots=True)
class Question:
    """What a contender is asked.

    Attributes:
        plan: The floor and its obstacles.
        lattice: Nodes and directions.
        images: The floor as an image, and the exact answer to judge by and to draw samples from.
        n_runs: Runs whose median counts.
        n_sampled: Nodes tried by a contender that would take hours for all.
    """

    plan: FloorPlan
    lattice: Lattice
    images: Images
    n_runs: int
    n_sampled: int


@dataclass(frozen=True, slots=True)
class Figures:
    """How a contender did.

    Attributes:
        clock_s: Seconds on the clock; from a sample, what all nodes would take.
        error_s: Standard error of that estimate, 0 where all nodes were tried.
        cores_s: Seconds of all cores together.
        n_nodes: Nodes whose answer was compared with the exact one.
        n_wrongly_free: Nodes said to be free where every pose touches something.
        n_wrongly_blocked: Nodes said to be blocked where some pose is free.
    """

    clock_s: float
    error_s: float
    cores_s: float
    n_nodes: int
    n_wrongly_free: int
    n_wrongly_blocked: int


Contender: TypeAlias = Callable[[Question], Figures]


def largest_set(free: Nodes) -> Nodes:
    """The largest disc-connected set of nodes."""
    sets = DiscComponents.of(free)
    label = np.bincount(sets.labels, sets.rows.end - sets.rows.begin + 1).argmax()
    return sets.nodes(int(label))
