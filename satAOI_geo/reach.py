"""Where the robot can get to: connected sets of nodes and of states.

The disc-connected sets are the paper's rule: neighbouring nodes are joined when each has some free
pose, whether or not a motion leads from the one pose to the other. They are an upper estimate.

The pose-connected sets join states (node, a1, swing) by moves whose whole sweep is free: what one
set holds, the robot can really get to from any of its states. A vehicle that turns on the spot can
follow any path through open free space as closely as wanted; how many manoeuvres that takes is
not bounded.
"""

from collections.abc import Callable
from dataclasses import dataclass
from threading import Lock
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt
import scipy.ndimage

from satAOI_geo.engine import Engine
from satAOI_geo.freespace import FreeSpace, Move, moves, run_threads
from satAOI_geo.lattice import Lattice
from satAOI_geo.plan import BoolArray
from satAOI_geo.robot import Robot
from satAOI_geo.runs import Meeting, Runs, SliceRuns, paint, roots, unite

EVERYTHING: Final = slice(None)


class State(NamedTuple):
    """A node with a pose: row, column, direction number, swing number."""

    iy: int
    ix: int
    a1: int
    swing: int


@dataclass(frozen=True, slots=True)
class DiscComponents:
    """The disc-connected sets.

    Attributes:
        labels: Shape (n_rows, n_columns): number of each node's set, or -1 where no pose is free.
        boxes: Shape (n, 4), least row, least column, greatest row, greatest column of each set.
    """

    labels: npt.NDArray[np.int32]
    boxes: npt.NDArray[np.int64]

    @classmethod
    def of(cls, free: BoolArray) -> "DiscComponents":
        """Sets of free nodes joined by their 8 neighbours: what Algorithm 2 searches."""
        labels, _ = scipy.ndimage.label(free, structure=np.ones((3, 3)))
        windows = scipy.ndimage.find_objects(labels)
        boxes = [(rows.start, cols.start, rows.stop - 1, cols.stop - 1) for rows, cols in windows]
        return cls(labels.astype(np.int32) - 1, np.array(boxes, dtype=np.int64).reshape(-1, 4))

    def at_node(self, iy: int, ix: int) -> list[int]:
        """The sets that hold a node: one, or none where no pose is free."""
        label = int(self.labels[iy, ix])
        return [] if label < 0 else [label]

    def nodes(self, label: int, rows: slice = EVERYTHING, columns: slice = EVERYTHING) -> BoolArray:
        """The nodes of one set, shape (n_rows, n_columns) or that of a window."""
        nodes: BoolArray = self.labels[rows, columns] == label
        return nodes


@dataclass(frozen=True, slots=True)
class PoseComponents:
    """The pose-connected sets.

    Attributes:
        lattice: Nodes and directions.
        runs: The states, as runs.
        labels: Shape (n_runs,): number of each run's set.
        members: Shape (n_runs,): all runs, those of one set together, sets in order.
        first: Shape (n + 1,): the runs of a set are members[first[label] : first[label + 1]].
        boxes: Shape (n, 4), least row, least column, greatest row, greatest column of each set.
    """

    lattice: Lattice
    runs: Runs
    labels: npt.NDArray[np.int32]
    members: npt.NDArray[np.int64]
    first: npt.NDArray[np.int64]
    boxes: npt.NDArray[np.int64]

    @classmethod
    def of(
        cls,
        engine: Engine,
        robot: Robot,
        space: FreeSpace,
        progress: Callable[[float], None] | None = None,
    ) -> "PoseComponents":
        """Join all free states by all moves whose sweep is free."""
        lattice = space.lattice
        n_swings = len(lattice.swings)

        def gather(a1: int) -> list[SliceRuns]:
            return [
                SliceRuns.of(space.words[a1, swing], space.steps(a1, swing, rows_up=0))
                for swing in range(n_swings)
            ]

        share = _thirds(progress)
        runs = Runs.joined(run_threads(gather, lattice.n_directions, share[0]))
        joined = _Joined(engine, runs)

        def step_up(a1: int) -> None:
            for swing in range(n_swings):
                joined.by_steps_up(space, a1, swing)

        def move(a1: int) -> None:
            for each in moves(engine, robot, space, a1):
                joined.by_move(each)

        run_threads(step_up, lattice.n_directions, share[1])
        run_threads(move, lattice.n_directions, share[2])
        root = roots(joined.parents)
        is_root = root == np.arange(root.size)
        labels = (np.cumsum(is_root, dtype=np.int32) - 1)[root]
        return cls._gathered(lattice, runs, labels)

    @classmethod
    def _gathered(
        cls, lattice: Lattice, runs: Runs, labels: npt.NDArray[np.int32]
    ) -> "PoseComponents":
        """The sets from the label of each run, labels 0 .. n - 1 all in use."""
        members = np.argsort(labels, kind="stable")
        first = np.concatenate(([0], np.cumsum(np.bincount(labels)))).astype(np.int64)
        boxes = np.column_stack(
            [
                gather.reduceat(values[members], first[:-1])
                for gather, values in (
                    (np.minimum, runs.row),
                    (np.minimum, runs.begin),
                    (np.maximum, runs.row),
                    (np.maximum, runs.end),
                )
            ]
        ).astype(np.int64)
        return cls(lattice, runs, labels, members, first, boxes)

    def at(self, iy: int, ix: int, a1: int, swing: int) -> int | None:
        """The set that holds a state, or None when the state is not free."""
        run = self.runs.holding(iy, ix)[a1, swing]
        return None if run < 0 else int(self.labels[run])

    def at_node(self, iy: int, ix: int) -> list[int]:
        """The sets that hold some pose at a node, ascending."""
        runs = self.runs.holding(iy, ix)
        return [int(label) for label in np.unique(self.labels[runs[runs >= 0]])]

    def straightest(self, iy: int, ix: int, label: int) -> State:
        """The state of a set at one of its nodes whose arm is straightest behind the vehicle."""
        runs = self.runs.holding(iy, ix)
        a1, swing = np.nonzero((runs >= 0) & (self.labels[runs] == label))
        bend = np.abs(self.lattice.swings)[swing]
        best = np.lexsort((a1, swing, bend))[0]
        return State(iy, ix, int(a1[best]), int(swing[best]))

    def runs_of(self, label: int) -> npt.NDArray[np.int64]:
        """The numbers of the runs of one set."""
        return self.members[self.first[label] : self.first[label + 1]]

    def nodes(self, label: int, rows: slice = EVERYTHING, columns: slice = EVERYTHING) -> BoolArray:
        """The nodes at which the set has some pose, shape (n_rows, n_columns) or that of a window.

        A window of rows must hold the whole set.
        """
        begin, end, _ = rows.indices(self.lattice.n_rows)
        words = self.lattice.no_nodes()[begin:end]
        paint(words, self.runs, self.runs_of(label), begin)
        # in one piece: a kernel is compiled anew for arrays that lie scattered
        return np.ascontiguousarray(self.lattice.unpacked(words)[:, columns])


class _Joined:
    """Runs being joined into components, by several threads at once."""

    def __init__(self, engine: Engine, runs: Runs) -> None:
        self.parents = np.arange(runs.begin.size, dtype=np.int32)
        self._engine = engine
        self._runs = runs
        self._one_at_a_time = Lock()

    def by_steps_up(self, space: FreeSpace, a1: int, swing: int) -> None:
        """Join the runs of a pose that steps from row to row lead between."""
        allowed = space.steps(a1, swing, rows_up=1)
        self._unite(Meeting.upwards(self._runs, (a1, swing)).links(allowed))

    def by_move(self, move: Move) -> None:
        """Join the runs of two poses that a move leads between.

        What the vehicle sweeps is looked at only where that could still join two components.
        """
        meeting = Meeting.of(self._runs, (move.a1, move.swing), (move.to_a1, move.to_swing))
        if meeting.are_apart(self.parents, move.unless_vehicle):
            self._unite(meeting.links(move.allowed(self._engine)))

    def _unite(self, pairs: npt.NDArray[np.int32]) -> None:
        with self._one_at_a_time:
            unite(self.parents, pairs)


def _thirds(progress: Callable[[float], None] | None) -> list[Callable[[float], None] | None]:
    """What tells a progress of three equal stages the share that each of them has done."""

    def third(number: int) -> Callable[[float], None] | None:
        return progress and (lambda done: progress((number + done) / 3))

    return [third(number) for number in range(3)]
