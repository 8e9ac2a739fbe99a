"""Free space: which poses and which moves touch nothing, for every node of the lattice at once."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from satAOI_geo.engine import Engine
from satAOI_geo.lattice import WORD_BITS, Lattice, Words
from satAOI_geo.nodes import ONE, Nodes
from satAOI_geo.plan import BoolArray, IntArray
from satAOI_geo.robot import Part, Robot
from satAOI_geo.sweep import carried, turned
from satAOI_geo.threads import run_threads

ROUNDING_MM: Final = 0.001
"""More than all roundings of a sweep together, and far less than matters on a floor."""


@dataclass(frozen=True, slots=True)
class FreeSpace:
    """Which poses are free at which nodes.

    Attributes:
        lattice: Nodes and directions.
        words: Shape (n_directions, n_swings, n_rows, n_words); a bit is set where the pose is free.
        barred: For each direction the steps from a free node to a free neighbour that something
            between the two bars, shape (n, 4): a swing number, and what `Engine.block` tells.
    """

    lattice: Lattice
    words: Words
    barred: tuple[IntArray, ...]

    def is_free(self, iy: int, ix: int, a1: int, swing: int) -> bool:
        """Whether one pose is free at a node."""
        return Nodes(self.words[a1, swing], self.lattice.n_columns).has(iy, ix)

    def free_nodes(self) -> Nodes:
        """Nodes at which some pose is free."""
        return Nodes(np.bitwise_or.reduce(self.words, axis=(0, 1)), self.lattice.n_columns)

    def barred_steps(self, a1: int, *, rows_up: int) -> IntArray:
        """Nodes from which something bars a step up (rows_up 1) or right (0), the pose kept.

        Shape (n,), numbers of their bits among all of `words[a1]`, ascending.
        """
        swing, way, iy, ix = self.barred[a1].T
        _, _, n_rows, n_words = self.words.shape
        steps = ((swing * n_rows + iy) * n_words * WORD_BITS + ix)[way == rows_up]
        # asked for their places too, numpy does not load its masked arrays for it
        return np.unique(steps, return_index=True)[0]

    def steps_up(self, a1: int) -> Words:
        """Nodes from which the disc may step up: shape (n_swings, n_rows, n_words)."""
        free = self.words[a1]
        steps: Words = np.zeros_like(free)
        steps[:, :-1] = free[:, :-1] & free[:, 1:]
        barred = self.barred_steps(a1, rows_up=1)
        mask = ~(ONE << (barred % WORD_BITS).astype(np.uint64))
        np.bitwise_and.at(steps.reshape(-1), barred // WORD_BITS, mask)
        return steps


@dataclass(frozen=True, slots=True)
class Move:
    """One kind of move, for all nodes: from a pose to a neighbouring pose at the same node.

    Attributes:
        a1: Direction number of the pose it starts from.
        swing: Swing number of the pose it starts from.
        to_a1: Direction number of the pose it ends at.
        to_swing: Swing number of the pose it ends at.
        arm_free: Nodes at which the arm touches nothing on its way, of those at least at which both
            ends are free.
        sweep: What the vehicle sweeps.
    """

    a1: int
    swing: int
    to_a1: int
    to_swing: int
    arm_free: Words
    sweep: Part

    def allowed(self, engine: Engine, rows: BoolArray | None = None) -> Words:
        """Nodes at which it may be made, if both of its ends are free there.

        Where `rows`, shape (n_rows,), are asked for, those of the others mean nothing.
        """
        words = engine.blocked(self.sweep, rows)
        np.invert(words, out=words)
        words &= self.arm_free
        return words


def free_space(
    engine: Engine,
    robot: Robot,
    lattice: Lattice,
    progress: Callable[[float], None] | None = None,
) -> FreeSpace:
    """Try every pose at every node; progress is called with the share that is done."""
    n_words = -(-lattice.n_columns // WORD_BITS)
    n_swings = len(lattice.swings)
    words = np.empty((lattice.n_directions, n_swings, lattice.n_rows, n_words), dtype=np.uint64)
    directions = lattice.directions()

    def fill(a1: int) -> IntArray:
        capsule = lattice.no_nodes()
        of_capsule = engine.block(capsule, robot.capsule(directions[a1]))
        barred = []
        for swing, vehicle in enumerate(_vehicles(robot, lattice, a1)):
            # slice by slice, as long as the processor has it at hand
            nodes = words[a1, swing]
            nodes[:] = capsule
            of_vehicle = engine.block(nodes, vehicle)
            np.invert(nodes, out=nodes)
            barred += [(swing, of_capsule), (swing, of_vehicle)]
        return np.concatenate(
            [np.column_stack((np.full(len(steps), swing), steps)) for swing, steps in barred]
        )

    barred = run_threads(fill, lattice.n_directions, progress)
    return FreeSpace(lattice, words, tuple(barred))


@dataclass(frozen=True, slots=True)
class Sweeps:
    """What the parts of a robot sweep in its moves about a node.

    Attributes:
        arms: Of the arm as it turns from each direction to the next.
        turns: Of the vehicle as the robot turns about the disc, from each direction and, in each,
            from each swing.
        swings: Of the vehicle as it turns about its pivot, in the same order.
        orbits: Of the vehicle as its pivot turns about the disc, its heading kept.
        rounds: Of a disc that holds the vehicle at any heading, as the robot turns from each
            direction to the next: this holds all that the vehicle sweeps in moves from there.
    """

    arms: list[Part]
    turns: list[Part]
    swings: list[Part]
    orbits: list[Part]
    rounds: list[Part]

    @classmethod
    def of(cls, robot: Robot, lattice: Lattice) -> "Sweeps":
        """Those of all directions together, which takes little longer than those of one."""
        directions = lattice.directions()
        turn_rad, disc_mm = 2 * np.pi / lattice.n_directions, np.zeros(2)
        pivots_mm = robot.arm_length_mm * directions
        # by as much farther from the pivot as `turned` sets corners half-way
        around_mm = robot.vehicle_reach_mm / np.cos(turn_rad / 2) + ROUNDING_MM
        around = [Part(pivot_mm[np.newaxis], around_mm) for pivot_mm in pivots_mm]
        of_swings_mm = np.repeat(pivots_mm, len(lattice.swings), axis=0)
        vehicles = [
            vehicle for a1 in range(len(directions)) for vehicle in _vehicles(robot, lattice, a1)
        ]
        return cls(
            turned([robot.capsule(arm) for arm in directions], disc_mm, turn_rad),
            turned(vehicles, disc_mm, turn_rad),
            turned(vehicles, of_swings_mm, turn_rad),
            carried(vehicles, of_swings_mm, turn_rad),
            turned(around, disc_mm, turn_rad),
        )


def moves(engine: Engine, sweeps: Sweeps, space: FreeSpace, a1: int) -> Iterator[Move]:
    """All moves about a node from the poses of one direction.

    Each kind is listed once; the way back is the same move.
    """
    n_directions, n_swings = space.lattice.n_directions, len(space.lattice.swings)
    next_a1 = (a1 + 1) % n_directions
    arm_turns = ~engine.blocked(sweeps.arms[a1])
    for swing in range(n_swings):
        vehicle = a1 * n_swings + swing
        yield Move(a1, swing, next_a1, swing, arm_turns, sweeps.turns[vehicle])

        wider = _neighbour(space.lattice, swing + 1)
        if wider is not None:
            free = space.words[a1, swing]
            yield Move(a1, swing, a1, wider, free, sweeps.swings[vehicle])

        narrower = _neighbour(space.lattice, swing - 1)
        if narrower is not None:
            yield Move(a1, swing, next_a1, narrower, arm_turns, sweeps.orbits[vehicle])


def _vehicles(robot: Robot, lattice: Lattice, a1: int) -> list[Part]:
    """The vehicle at each swing of a direction."""
    directions = lattice.directions()
    headings = (a1 + np.array(lattice.swings)) % lattice.n_directions
    return robot.vehicles(directions[a1], directions[headings])


def _neighbour(lattice: Lattice, swing: int) -> int | None:
    """The swing number, taken all round, or None beyond the ends of a range."""
    n_swings = len(lattice.swings)
    if lattice.swings_all_round:
        return swing % n_swings
    return swing if 0 <= swing < n_swings else None
