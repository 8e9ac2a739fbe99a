"""Contenders that try node after node and would take hours: some nodes stand for all."""

import itertools
import math
import statistics
from collections import deque
from collections.abc import Callable
from typing import Final

import numpy as np

from benchmarks.clock import Times, now, since, timed_once
from benchmarks.kdtree_loop import KdTreeLoop, Node
from benchmarks.question import ROBOT, Contender, Figures, Question
from satAOI_geo.aoi import area
from satAOI_geo.collision import Collider
from satAOI_geo.lattice import Lattice
from satAOI_geo.nodes import Nodes
from satAOI_geo.plan import BoolArray, FloorPlan

NEIGHBOURS: Final = [step for step in itertools.product((-1, 0, 1), repeat=2) if step != (0, 0)]


def paper(program: type[KdTreeLoop]) -> Contender:
    """The paper's program."""

    def contender(question: Question) -> Figures:
        images = question.images
        begin = now()
        loop = program(images.occupied, question.lattice, ROBOT)
        built = since(begin)
        nodes = drawn(images.reached, question.n_sampled)
        troweled: set[int] = set()

        def trowel() -> None:
            for node in nodes:
                loop.trowel(node, troweled)

        n_times = int(images.reached.sum()) / len(nodes)
        return extrapolated(question, loop.fits, built + timed_once(trowel) * n_times)

    return contender


def reference(question: Question) -> Figures:
    """The exact reference of this project."""
    lattice, reached = question.lattice, question.images.reached
    fits = ReferenceLoop(question.plan, lattice).fits
    troweled = timed_once(lambda: area(Nodes.of(reached), lattice, ROBOT.disc_radius_mm))
    return extrapolated(question, fits, troweled)


class ReferenceLoop:
    """Asks the exact collision test about all poses at a node.

    Args:
        plan: The floor and its obstacles.
        lattice: Nodes and directions.
    """

    def __init__(self, plan: FloorPlan, lattice: Lattice) -> None:
        self._touched, self._lattice = Collider(plan, ROBOT).touched, lattice
        directions = lattice.directions()
        self._capsules = [ROBOT.capsule(arm) for arm in directions]
        self._vehicles = [
            [
                ROBOT.vehicle(arm, directions[(a1 + turn) % lattice.n_directions])
                for turn in lattice.swings
            ]
            for a1, arm in enumerate(directions)
        ]

    def fits(self, node: Node) -> bool:
        """Whether some pose is free; vehicles are tried only before an arm that is."""
        at_mm = self._lattice.x_mm(node[1]), self._lattice.y_mm(node[0])
        return any(
            not self._touched(vehicle.moved(*at_mm))
            for capsule, vehicles in zip(self._capsules, self._vehicles, strict=True)
            if not self._touched(capsule.moved(*at_mm))
            for vehicle in vehicles
        )


def extrapolated(question: Question, fits: Callable[[Node], bool], rest: Times) -> Figures:
    """What a search that tries node after node would take, from some of its nodes.

    Args:
        question: What is asked.
        fits: Whether the contender finds a free pose at a node.
        rest: What it needs besides the search.
    """
    images = question.images
    tried = images.tried()
    each: list[Times] = []
    n_wrongly_free = n_wrongly_blocked = 0
    for node in drawn(tried, question.n_sampled):
        begin = now()
        free = fits(node)
        each.append(since(begin))
        n_wrongly_free += free and not images.free[node]
        n_wrongly_blocked += not free and bool(images.free[node])
    # the search itself, with answers that cost nothing
    start = drawn(images.reached, 1)[0]
    walk = timed_once(lambda: flooded(start, lambda node: bool(images.free[node])))
    n_times = int(tried.sum()) / len(each)
    times = sum(each, start=Times(0.0, 0.0)) * n_times + walk + rest
    deviation_s = statistics.stdev(one.clock_s for one in each)
    return Figures(
        clock_s=times.clock_s,
        error_s=n_times * deviation_s * math.sqrt(len(each)),
        cores_s=times.cores_s,
        n_nodes=len(each),
        n_wrongly_free=n_wrongly_free,
        n_wrongly_blocked=n_wrongly_blocked,
    )


def drawn(nodes: BoolArray, n: int) -> list[Node]:
    """Some of the nodes at random, the same on every run."""
    chosen = np.random.default_rng(0).choice(np.argwhere(nodes), n)
    return [(iy, ix) for iy, ix in chosen.tolist()]


def flooded(start: Node, fits: Callable[[Node], bool]) -> set[Node]:
    """The nodes that Algorithm 2 of the paper reaches, in breadth-first order.

    No node at the edge of the lattice fits, so that no neighbour lies beyond it.
    """
    closed, waiting = {start}, deque([start])
    blocked: set[Node] = set()
    while waiting:
        iy, ix = waiting.popleft()
        for dy, dx in NEIGHBOURS:
            node = iy + dy, ix + dx
            if node in closed or node in blocked:
                continue
            if fits(node):
                closed.add(node)
                waiting.append(node)
            else:
                blocked.add(node)
    return closed
