"""Free space: which poses and which moves touch nothing, for every node of the lattice at once."""

import os
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from satAOI_geo.engine import Engine
from satAOI_geo.kernels import kernel
from satAOI_geo.lattice import WORD_BITS, Lattice, Words
from satAOI_geo.nodes import Nodes
from satAOI_geo.plan import BoolArray, IntArray
from satAOI_geo.robot import Part, Robot
from satAOI_geo.sweep import carried, turned

Answer = TypeVar("Answer")


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

    def steps(self, a1: int, *, rows_up: int) -> Words:
        """Nodes from which the disc may step up (rows_up 1) or right (0), the pose kept.

        Shape (n_swings, n_rows, n_words).
        """
        steps: Words = np.empty_like(self.words[a1])
        _steps(self.words[a1], self.barred[a1], rows_up, steps)
        return steps


@dataclass(frozen=True, slots=True)
class Move:
    """One kind of move, for all nodes: from a pose to a neighbouring pose at the same node.

    Attributes:
        a1: Direction number of the pose it starts from.
        swing: Swing number of the pose it starts from.
        to_a1: Direction number of the pose it ends at.
        to_swing: Swing number of the pose it ends at.
        unless_vehicle: Nodes at which it touches nothing but perhaps with the vehicle on its way:
            those in all three.
        sweep: What the vehicle sweeps.
    """

    a1: int
    swing: int
    to_a1: int
    to_swing: int
    unless_vehicle: tuple[Words, Words, Words]
    sweep: Part

    def allowed(self, engine: Engine, rows: BoolArray | None = None) -> Words:
        """Nodes at which it may be made: both ends and all between them touch nothing.

        Where `rows`, shape (n_rows,), are asked for, only their nodes.
        """
        words = engine.blocked(self.sweep, rows)
        asked = np.ones(len(words), dtype=np.bool_) if rows is None else rows
        _allow(words, *self.unless_vehicle, asked)
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


def moves(engine: Engine, robot: Robot, space: FreeSpace, a1: int) -> Iterator[Move]:
    """All moves about a node from the poses of one direction.

    Each kind is listed once; the way back is the same move.
    """
    lattice = space.lattice
    n_directions, n_swings = lattice.n_directions, len(lattice.swings)
    turn_rad = 2 * np.pi / n_directions
    arm, next_a1 = lattice.directions()[a1], (a1 + 1) % n_directions
    pivot_mm, disc_mm = robot.arm_length_mm * arm, np.zeros(2)
    (arm_turned,) = turned([robot.capsule(arm)], disc_mm, turn_rad)
    arm_turns = ~engine.blocked(arm_turned)

    vehicles = _vehicles(robot, lattice, a1)
    about_disc = turned(vehicles, disc_mm, turn_rad)
    about_pivot = turned(vehicles, pivot_mm, turn_rad)
    orbits = carried(vehicles, pivot_mm, turn_rad)

    # a swing range of a full turn is a ring: its last swing is beside its first
    is_ring = n_swings == n_directions
    for swing in range(n_swings):
        free, next_free = space.words[a1, swing], space.words[next_a1]
        ends = free, next_free[swing], arm_turns
        yield Move(a1, swing, next_a1, swing, ends, about_disc[swing])

        wider = _neighbour(swing + 1, n_swings, ring=is_ring)
        if wider is not None:
            ends = free, free, space.words[a1, wider]
            yield Move(a1, swing, a1, wider, ends, about_pivot[swing])

        narrower = _neighbour(swing - 1, n_swings, ring=is_ring)
        if narrower is not None:
            ends = free, next_free[narrower], arm_turns
            yield Move(a1, swing, next_a1, narrower, ends, orbits[swing])


def _vehicles(robot: Robot, lattice: Lattice, a1: int) -> list[Part]:
    """The vehicle at each swing of a direction."""
    directions = lattice.directions()
    return [
        robot.vehicle(directions[a1], directions[(a1 + turn) % lattice.n_directions])
        for turn in lattice.swings
    ]


def run_threads(
    job: Callable[[int], Answer], n_jobs: int, progress: Callable[[float], None] | None = None
) -> list[Answer]:
    """The answers of jobs 0 .. n_jobs - 1, a thread per core.

    The kernels release the interpreter's lock. Progress is called with the share that is done.
    """
    answers: list[Answer] = []
    with ThreadPoolExecutor(max_workers=_cores()) as pool:
        for answer in pool.map(job, range(n_jobs)):
            answers.append(answer)
            if progress is not None:
                progress(len(answers) / n_jobs)
    return answers


@kernel(
    "void(uint64[:, :], const uint64[:, :], const uint64[:, :], const uint64[:, :], const bool[:])"
)
def _allow(words: Words, a: Words, b: Words, c: Words, rows: BoolArray) -> None:
    """Turn what is blocked into what three sets have besides, in some rows; none in the others."""
    n_rows, n_words = words.shape
    for iy in range(n_rows):
        for word in range(n_words):
            both = a[iy, word] & b[iy, word] & c[iy, word] if rows[iy] else np.uint64(0)
            words[iy, word] = both & ~words[iy, word]


@kernel("void(const uint64[:, :, :], const int64[:, :], int64, uint64[:, :, :])")
def _steps(free: Words, barred: IntArray, rows_up: int, steps: Words) -> None:
    """Write the nodes from which a step leads to a free neighbour; see `FreeSpace.steps`."""
    n_swings, n_rows, n_words = free.shape
    for swing in range(n_swings):
        for iy in range(n_rows):
            row, beyond = free[swing, iy], steps[swing, iy]
            for word in range(n_words):
                if rows_up:
                    beyond[word] = free[swing, iy + 1, word] if iy + 1 < n_rows else np.uint64(0)
                else:
                    beyond[word] = row[word] >> np.uint64(1)
                    if word + 1 < n_words:
                        beyond[word] |= row[word + 1] << np.uint64(WORD_BITS - 1)
                beyond[word] &= row[word]
    for k in range(barred.shape[0]):
        if barred[k, 1] == rows_up:
            swing, iy, ix = barred[k, 0], barred[k, 2], barred[k, 3]
            steps[swing, iy, ix // WORD_BITS] &= ~(np.uint64(1) << np.uint64(ix % WORD_BITS))


def _cores() -> int:
    """Cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _neighbour(swing: int, n_swings: int, *, ring: bool) -> int | None:
    """The swing number, taken round a ring, or None beyond the ends of a range."""
    if ring:
        return swing % n_swings
    return swing if 0 <= swing < n_swings else None
