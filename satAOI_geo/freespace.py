"""Free space: which poses and which moves touch nothing, for every node of the lattice at once."""

import os
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Protocol, TypeVar

import numpy as np

from satAOI_geo.lattice import WORD_BITS, Lattice, Words
from satAOI_geo.plan import BoolArray
from satAOI_geo.robot import Part, Robot
from satAOI_geo.sweep import carried, stepped, turned

Answer = TypeVar("Answer")


class Engine(Protocol):
    """Tells where a part of the robot touches something."""

    def blocked(self, part: Part) -> Words:
        """Nodes at which the part touches something, and every bit beyond the last column."""


@dataclass(frozen=True, slots=True)
class FreeSpace:
    """Which poses are free at which nodes.

    Attributes:
        lattice: Nodes and directions.
        words: Shape (n_directions, n_swings, n_rows, n_words); a bit is set where the pose is free.
    """

    lattice: Lattice
    words: Words

    def is_free(self, iy: int, ix: int, a1: int, swing: int) -> bool:
        """Whether one pose is free at a node."""
        word = int(self.words[a1, swing, iy, ix // WORD_BITS])
        return bool(word >> int(ix) % WORD_BITS & 1)

    def free_nodes(self) -> BoolArray:
        """Nodes at which some pose is free, shape (n_rows, n_columns)."""
        return self.lattice.unpacked(np.bitwise_or.reduce(self.words, axis=(0, 1)))

    def n_states(self) -> int:
        """How many (node, pose) pairs are free."""
        return int(np.bitwise_count(self.words).sum())


@dataclass(frozen=True, slots=True)
class Move:
    """One kind of move, for all nodes: from a pose to a neighbouring pose.

    Attributes:
        a1: Direction number of the pose it starts from.
        swing: Swing number of the pose it starts from.
        to_a1: Direction number of the pose it ends at.
        to_swing: Swing number of the pose it ends at.
        rows_up: 1 when it ends one row higher, else 0.
        allowed: Nodes it may start from: both ends and all between them touch nothing.
    """

    a1: int
    swing: int
    to_a1: int
    to_swing: int
    rows_up: int
    allowed: Words


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

    def fill(a1: int) -> None:
        arm = directions[a1]
        capsule = engine.blocked(robot.capsule(arm))
        for swing, turn in enumerate(lattice.swings):
            heading = directions[(a1 + turn) % lattice.n_directions]
            vehicle = engine.blocked(robot.vehicle(arm, heading))
            words[a1, swing] = ~(capsule | vehicle)

    run_threads(fill, lattice.n_directions, progress)
    return FreeSpace(lattice, words)


def steps_right(engine: Engine, robot: Robot, space: FreeSpace, a1: int) -> Iterator[Words]:
    """For each swing: nodes from which the disc may step one node to the right, pose kept."""
    lattice = space.lattice
    step_mm = np.array((lattice.step_mm, 0.0))
    directions = lattice.directions()
    arm = directions[a1]
    capsule = engine.blocked(stepped(robot.capsule(arm), step_mm))
    for swing, turn in enumerate(lattice.swings):
        heading = directions[(a1 + turn) % lattice.n_directions]
        vehicle = engine.blocked(stepped(robot.vehicle(arm, heading), step_mm))
        free = space.words[a1, swing]
        yield ~(capsule | vehicle) & free & _from_right(free)


def moves(engine: Engine, robot: Robot, space: FreeSpace, a1: int) -> Iterator[Move]:
    """All moves from the poses of one direction but the steps to the right.

    Each kind is listed once; the way back is the same move.
    """
    lattice = space.lattice
    directions = lattice.directions()
    n_directions, n_swings = lattice.n_directions, len(lattice.swings)
    turn_rad = 2 * np.pi / n_directions
    step_mm = np.array((0.0, lattice.step_mm))
    arm, next_a1 = directions[a1], (a1 + 1) % n_directions
    pivot_mm = robot.arm_length_mm * arm
    disc_mm = np.zeros(2)
    capsule = robot.capsule(arm)
    capsule_up = engine.blocked(stepped(capsule, step_mm))
    capsule_turned = engine.blocked(turned(capsule, disc_mm, turn_rad))

    for swing, turn in enumerate(lattice.swings):
        free = space.words[a1, swing]
        vehicle = robot.vehicle(arm, directions[(a1 + turn) % n_directions])

        up = ~(capsule_up | engine.blocked(stepped(vehicle, step_mm))) & free
        up[:-1] &= free[1:]
        up[-1] = 0
        yield Move(a1, swing, a1, swing, 1, up)

        about_disc = ~(capsule_turned | engine.blocked(turned(vehicle, disc_mm, turn_rad)))
        about_disc &= free & space.words[next_a1, swing]
        yield Move(a1, swing, next_a1, swing, 0, about_disc)

        # a swing range of a full turn is a ring: its last swing is beside its first
        wider = _neighbour(swing + 1, n_swings, ring=n_swings == n_directions)
        if wider is not None:
            about_pivot = ~engine.blocked(turned(vehicle, pivot_mm, turn_rad))
            about_pivot &= free & space.words[a1, wider]
            yield Move(a1, swing, a1, wider, 0, about_pivot)

        narrower = _neighbour(swing - 1, n_swings, ring=n_swings == n_directions)
        if narrower is not None:
            orbit = ~(capsule_turned | engine.blocked(carried(vehicle, pivot_mm, turn_rad)))
            orbit &= free & space.words[next_a1, narrower]
            yield Move(a1, swing, next_a1, narrower, 0, orbit)


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


def _from_right(words: Words) -> Words:
    """Each node's bit becomes that of its right neighbour."""
    shifted = words >> np.uint64(1)
    shifted[:, :-1] |= words[:, 1:] << np.uint64(WORD_BITS - 1)
    return shifted
