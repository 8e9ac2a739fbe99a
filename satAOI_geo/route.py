"""Routes: how the robot gets from where it is set down to where it trowels a point.

Breadth first over the runs of the start's component, then along the states of each run. Every two
states in a row are joined by one move whose whole sweep is free, and every move is straight in
(x, y, a1, a2), so a route can be driven, and checked, by interpolation.
"""

import math
from dataclasses import dataclass
from enum import StrEnum
from itertools import pairwise

import numpy as np
import scipy.sparse
from scipy.sparse.csgraph import breadth_first_order

from satAOI_geo.errors import LimitError, NoRouteError
from satAOI_geo.freespace import Sweeps, free_space, moves
from satAOI_geo.lattice import Lattice
from satAOI_geo.meeting import Meeting
from satAOI_geo.plan import Int32Array, IntArray
from satAOI_geo.reach import State
from satAOI_geo.robot import Pose
from satAOI_geo.search import Search
from satAOI_geo.threads import run_threads


class MoveKind(StrEnum):
    """What leads from a state to the next."""

    STEP = "step"
    """The whole robot shifts to a neighbouring node."""
    TURN = "turn"
    """The whole robot turns about the disc's centre."""
    SWING = "swing"
    """The vehicle turns about the arm's pivot."""
    ORBIT = "orbit"
    """The arm turns about the disc's centre, the vehicle keeps its heading."""


@dataclass(frozen=True, slots=True)
class Route:
    """A way through free poses.

    Attributes:
        lattice: Nodes and directions.
        states: Where the robot stands, one move from each to the next.
        to_mm: The point that the disc covers at the last of them, in the plan's frame.
    """

    lattice: Lattice
    states: tuple[State, ...]
    to_mm: tuple[float, float]

    def poses(self) -> list[Pose]:
        """The poses of the states, a1 running on past a full turn where the robot does."""
        found: list[Pose] = []
        turn_rad = 2 * math.pi
        for state in self.states:
            pose = self.lattice.pose(*state)
            before_rad = found[-1].a1_rad if found else pose.a1_rad
            before_a2_rad = found[-1].a2_rad if found else pose.a2_rad
            a1_rad = pose.a1_rad + turn_rad * round((before_rad - pose.a1_rad) / turn_rad)
            a2_rad = pose.a2_rad + turn_rad * round((before_a2_rad - pose.a2_rad) / turn_rad)
            found.append(Pose(pose.x_mm, pose.y_mm, a1_rad, a2_rad))
        return found

    def moves(self) -> list[MoveKind]:
        """What leads from each state to the next: one fewer than there are states."""
        return [_kind(a, b) for a, b in pairwise(self.states)]

    @property
    def length_mm(self) -> float:
        """How far the disc's centre travels."""
        at_mm = np.array([(pose.x_mm, pose.y_mm) for pose in self.poses()])
        return float(np.hypot(*np.diff(at_mm, axis=0).T).sum())


class RouteMap:
    """The runs of the start's component and what links them, for any number of routes.

    Raises:
        LimitError: If the floor is so large that it was searched in bands.
    """

    def __init__(self, found: Search) -> None:
        if len(found.pose.bands) > 1:
            raise LimitError(
                "this floor is searched in bands of rows, and routes are found on floors that are "
                f"searched at once; give more --memory than {found.settings.memory_gb:g} GB, a "
                "coarser --step or a smaller --region",
                limit="bands",
                value=len(found.pose.bands),
                allowed=1,
            )
        self._search = found
        (self._band,) = found.pose.bands
        self._rows = self._band.runs.rows()
        label = found.pose.numbers[0].tolist().index(found.start.pose_label)
        # numbers of the component's runs, ascending; below, a run is its place in this list
        self._runs = np.flatnonzero(self._band.labels == label)
        pairs = self._links()
        n_runs = self._runs.size
        keys = pairs[:, 0].astype(np.int64) * n_runs + pairs[:, 1]
        self._keys, first = np.unique(keys, return_index=True)
        self._columns = pairs[first, 2]
        graph = scipy.sparse.csr_array(
            (np.ones(first.size, dtype=np.bool_), (pairs[first, 0], pairs[first, 1])),
            shape=(n_runs, n_runs),
        )
        iy, ix, a1, swing = found.start.state
        start_run = self._band.runs.holding(iy, ix)[a1, swing]
        self._start = int(np.searchsorted(self._runs, start_run))
        order, self._before = breadth_first_order(graph, self._start, directed=True)
        self._rank = np.empty(n_runs, dtype=np.int64)
        self._rank[order] = np.arange(order.size)

    def to(self, at_mm: tuple[float, float]) -> Route:
        """A way from the start to a pose whose disc covers a point of the plan.

        Of the runs that cover the point, the one fewest moves between runs away is taken, and of
        its nodes the one nearest to where it is entered.

        Raises:
            NoRouteError: If no state of the start's component covers the point.
        """
        begin, end = self._covering_columns(at_mm)
        reaching = np.flatnonzero(begin <= end)
        if not reaching.size:
            x_mm, y_mm = self._search.plan.frame.to_drawing_mm(at_mm).tolist()
            raise NoRouteError(
                f"the point ({x_mm:.1f}, {y_mm:.1f}) mm is not in the area that the robot can "
                "trowel from its start; 'explain' tells why",
                at_mm=(x_mm, y_mm),
            )
        goal = int(reaching[self._rank[reaching].argmin()])
        chain = [goal]
        while chain[-1] != self._start:
            chain.append(int(self._before[chain[-1]]))
        chain.reverse()

        state = self._search.start.state
        states = [state]
        for run, next_run in pairwise(chain):
            column = int(
                self._columns[np.searchsorted(self._keys, run * self._runs.size + next_run)]
            )
            states.extend(_walk(state, column))
            state = self._state(next_run, column)
            states.append(state)
        states.extend(_walk(state, min(max(state.ix, int(begin[goal])), int(end[goal]))))
        return Route(self._search.lattice, tuple(states), at_mm)

    def _links(self) -> IntArray:
        """What links the component's runs, both ways: a run, another, a column; shape (n, 3)."""
        found = self._search
        inside = np.zeros(self._rows.size, dtype=np.bool_)
        inside[self._runs] = True
        space = free_space(found.engine, found.robot, found.lattice)
        sweeps = Sweeps.of(found.robot, found.lattice)

        def gather(a1: int) -> Int32Array:
            runs = self._band.runs
            pairs = [
                Meeting.upwards(runs, (a1, swing)).links(allowed)
                for swing, allowed in enumerate(space.steps_up(a1))
            ]
            for move in moves(found.engine, sweeps, space, a1):
                ends = (move.a1, move.swing), (move.to_a1, move.to_swing)
                pairs.append(Meeting.of(runs, *ends).links(move.allowed(found.engine)))
            return np.concatenate([some[inside[some[:, 0]]] for some in pairs])

        pairs = np.concatenate(run_threads(gather, found.lattice.n_directions)).astype(np.int64)
        pairs[:, :2] = np.searchsorted(self._runs, pairs[:, :2])
        return np.concatenate((pairs, pairs[:, (1, 0, 2)]))

    def _covering_columns(self, at_mm: tuple[float, float]) -> tuple[IntArray, IntArray]:
        """For each run its first and last column whose disc covers a point; none: first > last."""
        lattice, runs = self._search.lattice, self._band.runs
        step_mm = lattice.step_mm
        x = (at_mm[0] - lattice.origin_mm[0]) / step_mm - 0.5
        y = (at_mm[1] - lattice.origin_mm[1]) / step_mm - 0.5
        radius = self._search.robot.disc_radius_mm / step_mm
        rise = self._rows[self._runs] - y
        # where the disc's row does not come near the point the half width is not a number
        half = np.sqrt(np.where(np.abs(rise) <= radius, radius**2 - rise**2, np.nan))
        nowhere = np.isnan(half)
        first = np.where(nowhere, 1, np.ceil(x - half)).astype(np.int64)
        last = np.where(nowhere, 0, np.floor(x + half)).astype(np.int64)
        return (
            np.where(nowhere, first, np.maximum(first, runs.begin[self._runs])),
            np.where(nowhere, last, np.minimum(last, runs.end[self._runs])),
        )

    def _state(self, run: int, ix: int) -> State:
        """The state of a run at a column."""
        runs = self._band.runs
        number = int(self._runs[run])
        pose = int(np.searchsorted(runs.first[:, :, 0].ravel(), number, side="right")) - 1
        return State(int(self._rows[number]), ix, *divmod(pose, runs.first.shape[1]))


def _kind(a: State, b: State) -> MoveKind:
    """The one move that leads from a state to another."""
    if (a.iy, a.ix) != (b.iy, b.ix):
        return MoveKind.STEP
    if a.swing == b.swing:
        return MoveKind.TURN
    return MoveKind.SWING if a.a1 == b.a1 else MoveKind.ORBIT


def _walk(state: State, column: int) -> list[State]:
    """The states after one on the way along its run to a column, the last included."""
    towards = 1 if column > state.ix else -1
    columns = range(state.ix, column + towards, towards)[1:]
    return [state._replace(ix=ix) for ix in columns]
