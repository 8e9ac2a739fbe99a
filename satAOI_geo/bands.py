"""A floor searched in bands of rows: one after the other, or by several workers at once.

Each band has the first row of the next one, on which both have the same states; there their sets
are joined afterwards. The answer is the same to the last bit however the floor is cut.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Final, Protocol, TypeVar

import numpy as np

from satAOI_geo.engine import Engine
from satAOI_geo.errors import LimitError
from satAOI_geo.freespace import free_space
from satAOI_geo.lattice import WORD_BITS, Lattice
from satAOI_geo.memory import give_back
from satAOI_geo.nodes import Nodes
from satAOI_geo.progress import Stopwatch
from satAOI_geo.reach import Band
from satAOI_geo.robot import Robot

BYTES_PER_GB: Final = 1e9

SPACES_AT_ONCE: Final = 3
"""A free space, its runs, and what is in the hands of the threads take this many times its size."""

MOST_BANDS: Final = 200
"""Each has a file of its own, of which some systems open no more than 256 at a time."""

BANDS_FOR_A_CREW: Final = 8
"""Into at least so many bands a floor is cut for several workers to share."""

AnswerT_co = TypeVar("AnswerT_co", covariant=True)


class Outcome(Protocol[AnswerT_co]):
    """What became of a task of a crew."""

    @property
    def number(self) -> int:
        """Of the task, from 0 in the order in which they were given."""

    def value(self) -> AnswerT_co:
        """The answer; where there is none, what went wrong is raised."""


class Crew(Protocol):
    """Workers in other processes."""

    def outcomes(
        self, function: Callable[["BandTask"], "Explored"], tasks: Iterable["BandTask"]
    ) -> Iterable[Outcome["Explored"]]:
        """What becomes of each task, in the order in which they are done."""


@dataclass(frozen=True, slots=True)
class BandTask:
    """A band of a lattice that is to be searched.

    Attributes:
        engine: Tells where a part touches something in these rows.
        robot: The robot.
        lattice: The rows.
        n_own: How many of the rows are not the next band's, too.
    """

    engine: Engine
    robot: Robot
    lattice: Lattice
    n_own: int


@dataclass(frozen=True, slots=True)
class Explored:
    """What is found in a band.

    Attributes:
        free: Nodes at which some pose is free.
        n_states: How many (node, pose) pairs are free, those of the next band left out.
        band: The states.
    """

    free: Nodes
    n_states: int
    band: Band


def all_explored(
    engine: Engine,
    robot: Robot,
    lattice: Lattice,
    *,
    memory_gb: float,
    watch: Stopwatch,
    crew: Crew | None,
) -> tuple[Nodes, int, tuple[Band, ...]]:
    """Nodes at which some pose is free, how many states are, and the states band by band.

    Args:
        engine: Tells where a part touches something.
        robot: The robot.
        lattice: Nodes and directions.
        memory_gb: What the search of a band may take, `SPACES_AT_ONCE` times its free space.
        watch: Times the stages.
        crew: Workers that search the bands; without them they are searched here, in turn.

    Raises:
        LimitError: If so little memory cuts the floor into too many bands, or there is no room for
            what they find.
    """
    n_bands = 1 if crew is None else BANDS_FOR_A_CREW
    tasks = [
        BandTask(engine.band(rows), robot, lattice.band(rows), n_own)
        for rows, n_own in _cuts(lattice, memory_gb, n_bands)
    ]
    free = np.empty_like(lattice.no_nodes())
    n_states = 0
    bands: dict[int, Band] = {}
    found = _in_turn(tasks, watch) if crew is None else _by_crew(tasks, crew, watch)
    for number, part in found:
        own = tasks[number].lattice
        free[own.first_row : own.first_row + own.n_rows] = part.free.words
        n_states += part.n_states
        bands[number] = part.band.aside() if len(tasks) > 1 else part.band
        if len(tasks) > 1:
            give_back()
    return Nodes(free, lattice.n_columns), n_states, tuple(bands[k] for k in range(len(tasks)))


def explored(task: BandTask, watch: Stopwatch | None = None) -> Explored:
    """Search a band; the stages of the watch stand for all that is to be done."""
    watch = watch or Stopwatch()
    with watch.stage("free space") as share:
        space = free_space(task.engine, task.robot, task.lattice, share)
    with watch.stage("reach") as share:
        band = Band.of(task.engine, task.robot, space, share)
    return Explored(space.free_nodes(), band.runs.n_states(task.n_own), band)


def _in_turn(tasks: Sequence[BandTask], watch: Stopwatch) -> Iterator[tuple[int, Explored]]:
    """What is found in each band, with its number."""
    for number, task in enumerate(tasks):
        with watch.part(number / len(tasks), (number + 1) / len(tasks)):
            found = explored(task, watch)
        yield number, found


def _by_crew(
    tasks: Sequence[BandTask], crew: Crew, watch: Stopwatch
) -> Iterator[tuple[int, Explored]]:
    """What is found in each band, with its number, in whatever order it comes."""
    with watch.stage("search by workers") as share:
        for n_done, outcome in enumerate(crew.outcomes(explored, tasks), start=1):
            yield outcome.number, outcome.value()
            share(n_done / len(tasks))


def _cuts(lattice: Lattice, memory_gb: float, n_bands: int) -> Iterator[tuple[slice, int]]:
    """Rows of each band, at least some number of bands, and how many of them are its own.

    Raises:
        LimitError: If there would be more than `MOST_BANDS`.
    """
    n_poses = lattice.n_directions * len(lattice.swings)
    row_bytes = n_poses * -(-lattice.n_columns // WORD_BITS) * WORD_BITS // 8
    # there may be no end of memory
    n_fitting = min(memory_gb * BYTES_PER_GB / (SPACES_AT_ONCE * row_bytes), lattice.n_rows)
    n_own = max(1, min(int(n_fitting), -(-lattice.n_rows // n_bands)))
    if n_own * MOST_BANDS < lattice.n_rows:
        least_gb = -(-lattice.n_rows // MOST_BANDS) * SPACES_AT_ONCE * row_bytes / BYTES_PER_GB
        raise LimitError(
            f"a memory of {memory_gb:g} GB would cut this floor into "
            f"{-(-lattice.n_rows // n_own)} bands, more than {MOST_BANDS}; give --memory "
            f"{math.ceil(least_gb * 1e4) / 1e4:g} or more, or a coarser --step or fewer "
            "--directions",
            limit="bands",
            value=-(-lattice.n_rows // n_own),
            allowed=MOST_BANDS,
        )
    for begin in range(0, lattice.n_rows, n_own):
        end = min(begin + n_own, lattice.n_rows)
        yield slice(begin, min(end + 1, lattice.n_rows)), end - begin
