"""Free space by row intervals is the free space of the reference, state by state."""

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
from shapely.affinity import rotate, translate
from shapely.geometry import LineString, MultiPolygon, Point, Polygon, box

from satAOI_geo.collision import Collider, Reference
from satAOI_geo.freespace import FreeSpace, free_space, run_threads
from satAOI_geo.intervals import Intervals
from satAOI_geo.lattice import Lattice
from satAOI_geo.plan import BoolArray, Circle, FloorPlan, Kind, Obstacle, Shape
from satAOI_geo.robot import ROBOTS, Robot
from tests import plans
from tests.oracle import Oracle

PROTOTYPE = ROBOTS["magicbim"]

DRAWN = [plans.random_plan(seed) for seed in range(100, 110)]
"""Ten random plans, beside the named ones."""

STATES = 1200
"""States compared on each plan; with 10 random and 9 named plans 22 800."""


@dataclass(frozen=True)
class Setting:
    """All that a free space depends on besides the plan."""

    robot: Robot = PROTOTYPE
    step_mm: float = 10.0
    n_directions: int = 24
    clearance_mm: float = 0.0

    def lattice(self, plan: FloorPlan) -> Lattice:
        return Lattice.over(
            plan.floor.bounds, self.robot, step_mm=self.step_mm, n_directions=self.n_directions
        )

    def fast(self, plan: FloorPlan) -> FreeSpace:
        lattice = self.lattice(plan)
        return free_space(
            Intervals(plan, self.robot, lattice, self.clearance_mm), self.robot, lattice
        )


def at_boundary(free: BoolArray) -> BoolArray:
    """Nodes with a neighbour in row or column of which the opposite is true."""
    changed = np.zeros_like(free)
    for axis in (0, 1):
        flips = np.diff(free, axis=axis)
        before, after = [(0, 1), (0, 0)], [(1, 0), (0, 0)]
        changed |= np.pad(flips, before if axis == 0 else before[::-1])
        changed |= np.pad(flips, after if axis == 0 else after[::-1])
    return changed


def sampled(space: FreeSpace, n_states: int, seed: int) -> tuple[list[tuple[int, ...]], int]:
    """States (iy, ix, a1, swing) drawn at random, and how many lie beside the boundary.

    Of each pose drawn, two nodes beside the boundary of its free nodes are taken and one anywhere.
    """
    draw = np.random.default_rng(seed)
    lattice = space.lattice
    states: list[tuple[int, ...]] = []
    n_beside = 0
    while len(states) < n_states:
        a1 = int(draw.integers(lattice.n_directions))
        swing = int(draw.integers(len(lattice.swings)))
        beside = at_boundary(lattice.unpacked(space.words[a1, swing]))
        anywhere = draw.integers(lattice.shape)
        chosen = [anywhere]
        if beside.any():
            candidates = np.argwhere(beside)
            chosen += list(draw.choice(candidates, size=min(10, len(candidates))))
            chosen += list(draw.integers(lattice.shape, size=(4, 2)))
        n_beside += sum(bool(beside[tuple(node)]) for node in chosen)
        states += [(int(iy), int(ix), a1, swing) for iy, ix in chosen]
    return states, n_beside


def mismatches(
    space: FreeSpace, collider: Collider, states: list[tuple[int, ...]]
) -> list[tuple[int, ...]]:
    """The states about which the two disagree."""
    lattice = space.lattice
    return [
        state
        for state in states
        if space.is_free(*state) != collider.is_free(lattice.pose(*state))
    ]


@pytest.mark.parametrize("name", sorted(plans.CASES))
def test_every_state_tried_on_a_named_plan_is_as_the_reference_says(name: str) -> None:
    plan = plans.CASES[name]().plan
    space = Setting().fast(plan)
    states, n_beside = sampled(space, STATES, seed=1)
    assert n_beside >= len(states) / 2
    assert mismatches(space, Collider(plan, PROTOTYPE), states) == []


@pytest.mark.parametrize("plan", DRAWN)
def test_every_state_tried_on_a_random_plan_is_as_the_reference_says(plan: FloorPlan) -> None:
    space = Setting().fast(plan)
    states, n_beside = sampled(space, STATES, seed=2)
    assert n_beside >= len(states) / 2
    assert mismatches(space, Collider(plan, PROTOTYPE), states) == []
