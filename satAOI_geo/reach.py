"""Where the robot can get to: connected sets of nodes and of states.

The disc-connected sets are the paper's rule: neighbouring nodes are joined when each has some free
pose, whether or not a motion leads from the one pose to the other. They are an upper estimate.

The pose-connected sets join states (node, a1, swing) by moves whose whole sweep is free: what one
set holds, the robot can really get to from any of its states. A vehicle that turns on the spot can
follow any path through open free space as closely as wanted; how many manoeuvres that takes is
not bounded.
"""

import mmap
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from itertools import pairwise
from tempfile import TemporaryFile, gettempdir
from threading import Lock
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from satAOI_geo.engine import Engine
from satAOI_geo.errors import LimitError
from satAOI_geo.forest import numbered, roots, unite
from satAOI_geo.freespace import FreeSpace, Move, Sweeps, moves
from satAOI_geo.lattice import WORD_BITS, Lattice
from satAOI_geo.meeting import Meeting, unite_poses, unite_upwards
from satAOI_geo.nodes import Nodes
from satAOI_geo.plan import Int32Array, IntArray
from satAOI_geo.robot import Robot
from satAOI_geo.runs import Runs, SliceRuns, rows_of
from satAOI_geo.stretches import Stretches, of_runs
from satAOI_geo.threads import run_threads

EVERYTHING: Final = slice(None)

OPEN_ROWS: Final = 16
"""Of so many rows one is looked at for places where nothing is near: hardly any part of the free
space is lower."""


class State(NamedTuple):
    """A node with a pose: row, column, direction number, swing number."""

    iy: int
    ix: int
    a1: int
    swing: int


@dataclass(frozen=True, slots=True)
class DiscComponents:
    """The disc-connected sets, numbered in the order of their first node by row and column.

    Attributes:
        shape: (rows, columns) of the lattice.
        rows: All free nodes, as stretches of rows.
        labels: Shape (n_stretches,): number of each stretch's set.
        stretches: The same, set by set.
        boxes: Shape (n, 4), least row, least column, greatest row, greatest column of each set.
    """

    shape: tuple[int, int]
    rows: SliceRuns
    labels: Int32Array
    stretches: Stretches
    boxes: IntArray

    @classmethod
    def of(cls, free: Nodes) -> "DiscComponents":
        """Sets of free nodes joined by their 8 neighbours: what Algorithm 2 searches."""
        rows = rows_of(free)
        row = rows.rows()
        # one number that puts row and column in order; rows are more than a step apart in it
        width = free.n_columns + 2
        begins, ends = row * width + rows.begin, row * width + rows.end
        # those of the row above that reach from a column left of a stretch to one right of it
        first = np.searchsorted(ends, begins + width - 1)
        n_above = np.searchsorted(begins, ends + width + 1, side="right") - first
        below = np.repeat(np.arange(row.size), n_above)
        above = np.arange(below.size) + np.repeat(first - np.cumsum(n_above) + n_above, n_above)
        parents = np.arange(row.size, dtype=np.int32)
        unite(parents, np.column_stack((below, above)).astype(np.int32))
        labels, n_sets = numbered(parents)
        stretches = Stretches.of(labels, row.astype(np.int32), rows.begin, rows.end, n_sets)
        return cls(free.shape, rows, labels, stretches, stretches.boxes())

    def labels_at(self, iy: npt.ArrayLike, ix: npt.ArrayLike) -> Int32Array:
        """The sets that hold some nodes, -1 for those where no pose is free; shape as iy and ix."""
        width = self.shape[1] + 1
        row = self.rows.rows()
        # one number that puts row and column in order
        node = np.asarray(iy, dtype=np.int64) * width + np.asarray(ix)
        stretch = np.searchsorted(row * width + self.rows.end, node)
        begins = np.append(row * width + self.rows.begin, np.iinfo(np.int64).max)
        labels = np.append(self.labels, np.int32(-1))
        return np.where(begins[stretch] <= node, labels[stretch], np.int32(-1))

    def nodes(self, label: int, rows: slice = EVERYTHING, columns: slice = EVERYTHING) -> Nodes:
        """The nodes of one set, of all of the lattice or of a window that holds the set."""
        return self.stretches.nodes(label, *_ranges(self.shape, rows, columns))


@dataclass(frozen=True, slots=True)
class Band:
    """The states of some rows of the lattice, and the sets that moves among these rows join.

    Attributes:
        lattice: The rows, as a band of the whole lattice.
        runs: The states, as runs.
        labels: Shape (n_runs,): number of each run's set.
        lowest: Shape (n_sets,), a number for each set that puts sets in the order of their first
            states by row, pose and column, the same however a lattice is cut into bands.
        stretches: The nodes of each set: label, row of the whole lattice, first and last column;
            nothing once they are gathered from all bands.
        pages: Of the file that the runs are in, if they are.
    """

    lattice: Lattice
    runs: Runs
    labels: Int32Array
    lowest: IntArray
    stretches: tuple[Int32Array, ...]
    pages: mmap.mmap | None = None

    @classmethod
    def of(
        cls,
        engine: Engine,
        robot: Robot,
        space: FreeSpace,
        progress: Callable[[float], None] | None = None,
    ) -> "Band":
        """Join all free states by all moves whose sweep is free."""
        lattice = space.lattice
        n_directions, n_swings, n_rows, n_words = space.words.shape

        def gather(a1: int) -> SliceRuns:
            free, barred = space.words[a1], space.barred_steps(a1, rows_up=0)
            return SliceRuns.of(free.reshape(-1, n_words), barred)

        share = _thirds(progress)
        with ThreadPoolExecutor(max_workers=1) as beside:
            waiting = beside.submit(Sweeps.of, robot, lattice)
            parts = run_threads(gather, n_directions, share[0])
            runs = Runs.joined(parts, (n_directions, n_swings, n_rows))
            sweeps = waiting.result()
        joined = _Joined(engine, runs, sweeps)

        def step_up(a1: int) -> None:
            # no other direction has these runs, so threads need not wait for each other
            barred = space.barred_steps(a1, rows_up=1)
            unite_upwards(joined.parents, runs, a1, barred, n_words * WORD_BITS)

        def move(a1: int) -> None:
            for each in moves(engine, sweeps, space, a1):
                joined.by_move(each)

        run_threads(step_up, n_directions, share[1])
        run_threads(joined.in_the_open, n_directions)
        # runs whose parents are roots are compared quickly
        roots(joined.parents)
        run_threads(move, n_directions, share[2])
        labels, n_sets = numbered(joined.parents)
        (label, iy, begin, end), states = of_runs(runs, labels, n_sets)
        stretches = (label, iy + np.int32(lattice.first_row), begin, end)
        iy, pose, ix = states.astype(np.int64).T
        n_poses = n_directions * n_swings
        lowest = ((lattice.first_row + iy) * n_poses + pose) * lattice.n_columns + ix
        return cls(lattice, runs, labels, lowest, stretches)

    def aside(self) -> "Band":
        """The same band with its runs in a file that the system maps into memory as needed.

        The file has no name and is gone with the last array that shows it.

        Raises:
            LimitError: If there is no room for it.
        """
        columns = [self.runs.begin, self.runs.end, self.labels]
        if not self.labels.size:
            return self
        try:
            with TemporaryFile() as file:
                for column in columns:
                    file.write(np.ascontiguousarray(column).data)
                file.flush()
                pages = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
        except OSError as error:
            raise LimitError(
                f"the runs of a band do not go into the folder '{gettempdir()}' for temporary "
                f"files: {error.strerror or error}; name another one by TMPDIR, or give more "
                "--memory",
                limit="scratch",
                value=sum(column.nbytes for column in columns),
                allowed=0,
            ) from error
        begin, end, labels = np.frombuffer(pages, dtype=np.int32).reshape(len(columns), -1)
        runs = replace(self.runs, begin=begin, end=end)
        return replace(self, runs=runs, labels=labels, pages=pages)

    def at(self, iy: int, ix: int) -> Int32Array:
        """The set that holds each pose at a node, row iy of the whole lattice, or -1.

        Shape (n_directions, n_swings).
        """
        runs = self.runs.holding(iy - self.lattice.first_row, ix)
        sets = np.full(runs.shape, -1, dtype=np.int32)
        sets[runs >= 0] = self.labels[runs[runs >= 0]]
        self._let_go()
        return sets

    def on_row(self, iy: int) -> Int32Array:
        """The sets of the runs on one of its rows, pose after pose."""
        first = self.runs.first.reshape(-1, self.runs.first.shape[-1])
        spans = zip(first[:, iy].tolist(), first[:, iy + 1].tolist(), strict=True)
        sets = np.concatenate([self.labels[begin:end] for begin, end in spans])
        self._let_go()
        return sets

    def _let_go(self) -> None:
        """Let what was read of files not count as memory of this process any more."""
        if self.pages is not None and hasattr(mmap, "MADV_DONTNEED"):
            self.pages.madvise(mmap.MADV_DONTNEED)


@dataclass(frozen=True, slots=True)
class PoseComponents:
    """The pose-connected sets, numbered in the order of their first state by row and pose.

    Attributes:
        lattice: Nodes and directions.
        bands: The states, from the lowest rows up; the last row of a band is the first of the
            next one.
        numbers: For each band the number of each of its sets.
        stretches: The nodes of each set.
        boxes: Shape (n, 4), least row, least column, greatest row, greatest column of each set.
    """

    lattice: Lattice
    bands: tuple[Band, ...]
    numbers: tuple[Int32Array, ...]
    stretches: Stretches
    boxes: IntArray

    @classmethod
    def of(cls, lattice: Lattice, bands: Sequence[Band]) -> "PoseComponents":
        """The sets of the whole lattice from those of its bands, lowest first."""
        first = np.cumsum([0, *(band.lowest.size for band in bands)])
        parents = np.arange(first[-1], dtype=np.int32)
        for k, (below, above) in enumerate(pairwise(bands)):
            # the row that two bands share has the same runs in both
            upper = below.on_row(below.lattice.n_rows - 1) + first[k]
            lower = above.on_row(0) + first[k + 1]
            unite(parents, np.column_stack((upper, lower)).astype(np.int32))
        joined, n_sets = numbered(parents)
        lowest = np.full(n_sets, np.iinfo(np.int64).max)
        np.minimum.at(lowest, joined, np.concatenate([band.lowest for band in bands]))
        place = np.empty(n_sets, dtype=np.int32)
        place[np.argsort(lowest)] = np.arange(n_sets)
        numbers = tuple(np.split(place[joined], first[1:-1]))
        # on the row that two bands share both have the same stretches
        parts = [
            (own[band.stretches[0]], *band.stretches[1:])
            for band, own in zip(bands, numbers, strict=True)
        ]
        labels, row, begin, end = (np.concatenate(part) for part in zip(*parts, strict=True))
        stretches = Stretches.of(labels, row, begin, end, n_sets)
        # they are all in one now
        kept = tuple(replace(band, stretches=()) for band in bands)
        return cls(lattice, kept, numbers, stretches, stretches.boxes())

    def at(self, iy: int, ix: int, a1: int, swing: int) -> int | None:
        """The set that holds a state, or None when the state is not free."""
        label = int(self._labels_at(iy, ix)[a1, swing])
        return None if label < 0 else label

    def at_node(self, iy: int, ix: int) -> list[int]:
        """The sets that hold some pose at a node, ascending."""
        return sorted(set(self._labels_at(iy, ix).ravel().tolist()) - {-1})

    def straightest(self, iy: int, ix: int, label: int) -> State:
        """The state of a set at one of its nodes whose arm is straightest behind the vehicle."""
        a1, swing = np.nonzero(self._labels_at(iy, ix) == label)
        bend = np.abs(self.lattice.swings)[swing]
        best = np.lexsort((a1, swing, bend))[0]
        return State(iy, ix, int(a1[best]), int(swing[best]))

    def nodes(self, label: int, rows: slice = EVERYTHING, columns: slice = EVERYTHING) -> Nodes:
        """Where the set has some pose, in all of the lattice or in a window that holds the set."""
        return self.stretches.nodes(label, *_ranges(self.lattice.shape, rows, columns))

    def first_nodes(self) -> Int32Array:
        """Row and column of the first node of each set, shape (n, 2)."""
        first = self.stretches.first[:-1]
        return np.column_stack((self.stretches.row[first], self.stretches.begin[first]))

    def _labels_at(self, iy: int, ix: int) -> Int32Array:
        """The set that holds each pose at a node, or -1; shape (n_directions, n_swings)."""
        tops = [band.lattice.first_row + band.lattice.n_rows for band in self.bands]
        number = int(np.searchsorted(tops, iy, side="right"))
        sets = self.bands[number].at(iy, ix)
        sets[sets >= 0] = self.numbers[number][sets[sets >= 0]]
        return sets


def _ranges(shape: tuple[int, int], rows: slice, columns: slice) -> tuple[range, range]:
    """Rows and columns of a window of a lattice."""
    return range(*rows.indices(shape[0])), range(*columns.indices(shape[1]))


class _Joined:
    """Runs being joined into components, by several threads at once."""

    def __init__(self, engine: Engine, runs: Runs, sweeps: Sweeps) -> None:
        self.parents = np.arange(runs.begin.size, dtype=np.int32)
        self._engine = engine
        self._runs = runs
        self._sweeps = sweeps
        self._one_at_a_time = Lock()

    def in_the_open(self, a1: int) -> None:
        """Join poses of a direction with the next one's where nothing is near, in some rows.

        All moves would do so, one by one; most are then spared what their vehicle sweeps.
        """
        n_directions, n_swings, n_ends = self._runs.first.shape
        rows = np.arange(n_ends - 1) % OPEN_ROWS == 0
        round_free = ~self._engine.blocked(self._sweeps.rounds[a1], rows)
        arm_turns = ~self._engine.blocked(self._sweeps.arms[a1], rows)
        here, there = (a1, slice(n_swings)), ((a1 + 1) % n_directions, slice(n_swings))
        narrower, wider = (a1, slice(n_swings - 1)), (a1, slice(1, n_swings))
        with self._one_at_a_time:
            unite_poses(self.parents, self._runs, here, there, round_free & arm_turns, rows)
            unite_poses(self.parents, self._runs, narrower, wider, round_free, rows)

    def by_move(self, move: Move) -> None:
        """Join the runs of two poses that a move leads between.

        What the vehicle sweeps is looked at only where that could still join two components.
        """
        meeting = Meeting.of(self._runs, (move.a1, move.swing), (move.to_a1, move.to_swing))
        rows = meeting.rows_apart(self.parents, move.arm_free)
        if rows is not None:
            allowed = move.allowed(self._engine, rows)
            with self._one_at_a_time:
                meeting.join(self.parents, allowed, rows)


def _thirds(progress: Callable[[float], None] | None) -> list[Callable[[float], None] | None]:
    """What tells a progress of three equal stages the share that each of them has done."""

    def third(number: int) -> Callable[[float], None] | None:
        return progress and (lambda done: progress((number + done) / 3))

    return [third(number) for number in range(3)]
