"""Zones: what each set-down of the robot can trowel, and how few set-downs are enough."""

import heapq
import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Final, Protocol

import numpy as np
import numpy.typing as npt

from satAOI_geo.aoi import Aoi, Outline, areas
from satAOI_geo.discs import covered_cells
from satAOI_geo.kernels import kernel
from satAOI_geo.lattice import WORD_BITS, Lattice
from satAOI_geo.memory import give_back
from satAOI_geo.nodes import Nodes
from satAOI_geo.plan import BoolArray
from satAOI_geo.reach import PoseComponents, State
from satAOI_geo.runs import Int32Array

ZONE_MM2: Final = 500_000.0
"""Smaller zones are not worth a set-down: half a square metre is little more than one disc."""


BATCH_NODES: Final = 2**22
"""Of a window for several zones: half a megabyte of bits."""


class Components(Protocol):
    """Connected sets of nodes, numbered 0 .. n - 1."""

    @property
    def boxes(self) -> npt.NDArray[np.int64]:
        """Shape (n, 4), least row, least column, greatest row, greatest column of each set."""

    def nodes(self, label: int, rows: slice, columns: slice) -> Nodes:
        """The nodes of one set in a window that holds all of it."""


@dataclass(frozen=True, slots=True)
class Zone:
    """A component and what it trowels.

    Attributes:
        label: Number of the component.
        n_nodes: Nodes at which it has some pose.
        outlines: The connected parts of what the disc covers, largest first.
        raster_area_mm2: Area of the cells that it covers.
        set_down: A state to set the robot down at, well inside.
    """

    label: int
    n_nodes: int
    outlines: tuple[Outline, ...]
    raster_area_mm2: float
    set_down: State

    @property
    def area_mm2(self) -> float:
        """Area inside the outlines."""
        return sum(outline.area_mm2() for outline in self.outlines)


@dataclass(frozen=True, slots=True)
class SetDown:
    """One of the set-downs that together cover all that any pose can trowel.

    Attributes:
        state: Where the robot is set down.
        label: Number of its component.
        gain_mm2: What it trowels beyond the set-downs before it, by the raster.
    """

    state: State
    label: int
    gain_mm2: float


def largest(components: Components, labels: Iterable[int], lattice: Lattice, disc_mm: float) -> int:
    """The component of the largest raster area among some; of equals the lowest number."""
    bounds_mm2 = _area_bounds_mm2(components.boxes, disc_mm, lattice.step_mm)
    best_label, best_mm2 = -1, -1.0
    for label in sorted(labels, key=lambda label: (-bounds_mm2[label], label)):
        if bounds_mm2[label] < best_mm2:
            break
        area_mm2 = _area_mm2(components, label, lattice, disc_mm)
        if (area_mm2, -label) > (best_mm2, -best_label):
            best_label, best_mm2 = label, area_mm2
    return best_label


def zones(
    components: PoseComponents,
    lattice: Lattice,
    disc_mm: float,
    known: Mapping[int, Aoi],
    progress: Callable[[float], None] | None = None,
) -> tuple[Zone, ...]:
    """All components of at least `ZONE_MM2`, the largest raster area first.

    Args:
        components: The components.
        lattice: Nodes and directions.
        disc_mm: Radius of the disc.
        known: What some of them cover, by their numbers.
        progress: Called with the share of them that is done.
    """
    found = [
        Zone(
            label,
            components.stretches.count(label),
            aoi.outlines,
            aoi.raster_area_mm2,
            set_down(components, label),
        )
        for label, aoi in _covered(components, lattice, disc_mm, known, progress)
        if aoi.area_mm2 >= ZONE_MM2
    ]
    return tuple(sorted(found, key=lambda zone: (-zone.raster_area_mm2, zone.label)))


def set_downs(
    components: PoseComponents, free: Nodes, lattice: Lattice, disc_mm: float
) -> tuple[SetDown, ...]:
    """Set-downs whose areas together cover what any pose can trowel, the greatest gain first.

    Greedy: each covers the most cells not covered yet. Gains only shrink as more is covered, so a
    stale gain is an upper bound and need only be looked at again when it comes first.
    """
    chosen = []
    todo = covered_cells(free, disc_mm / lattice.step_mm).words
    bounds_mm2 = _area_bounds_mm2(components.boxes, disc_mm, lattice.step_mm)
    queue = [(-bound, label, False) for label, bound in enumerate(bounds_mm2)]
    heapq.heapify(queue)
    while queue:
        best, label, fresh = heapq.heappop(queue)
        rows, columns = _window(components.boxes[label], lattice, disc_mm)
        here = todo[rows, columns.start // WORD_BITS : -(-columns.stop // WORD_BITS)]
        # no more than is left to cover in its window: cheaper to count than what it covers
        left_mm2 = float(np.bitwise_count(here).sum()) * lattice.step_mm**2
        if left_mm2 == 0.0:
            continue
        if left_mm2 < -best:
            heapq.heappush(queue, (-left_mm2, label, False))
            continue
        nodes = components.nodes(label, rows, columns)
        gained = covered_cells(nodes, disc_mm / lattice.step_mm).words & here
        gain_mm2 = float(np.bitwise_count(gained).sum()) * lattice.step_mm**2
        if gain_mm2 == 0.0:
            continue
        if fresh and gain_mm2 == -best:
            here &= ~gained
            chosen.append(SetDown(set_down(components, label), label, gain_mm2))
        else:
            heapq.heappush(queue, (-gain_mm2, label, True))
    return tuple(chosen)


def _covered(
    components: PoseComponents,
    lattice: Lattice,
    disc_mm: float,
    known: Mapping[int, Aoi],
    progress: Callable[[float], None] | None,
) -> Iterator[tuple[int, Aoi]]:
    """What each component that may be large enough for a zone covers; see `zones`."""
    yield from known.items()
    boxes = components.boxes
    bounds_mm2 = _area_bounds_mm2(boxes, disc_mm, lattice.step_mm)
    labels = np.flatnonzero(bounds_mm2 >= ZONE_MM2)
    # the widest first, so that windows of a size make a batch
    labels = labels[np.argsort(boxes[labels, 1] - boxes[labels, 3], kind="stable")]
    n_done = 0
    for batch in _batches(boxes, [label for label in labels.tolist() if label not in known]):
        windows = [_window(boxes[label], lattice, disc_mm) for label in batch]
        sets = [
            components.nodes(label, *window) for label, window in zip(batch, windows, strict=True)
        ]
        covered = areas(sets, [lattice.window(*window) for window in windows], disc_mm)
        yield from zip(batch, covered, strict=True)
        n_done += len(batch)
        if progress is not None:
            progress(n_done / labels.size)
        if n_done < labels.size:
            give_back()


def _batches(boxes: npt.NDArray[np.int64], labels: list[int]) -> Iterator[list[int]]:
    """Sets whose windows, one above the other, are not too large; a large set has its own."""
    batch: list[int] = []
    n_rows = n_columns = 0
    for label in labels:
        height, width = (boxes[label, 2:] - boxes[label, :2] + 1).tolist()
        if batch and (n_rows + height) * max(n_columns, width) > BATCH_NODES:
            yield batch
            batch, n_rows, n_columns = [], 0, 0
        batch.append(label)
        n_rows, n_columns = n_rows + height, max(n_columns, width)
    if batch:
        yield batch


def set_down(components: PoseComponents, label: int) -> State:
    """The state deepest inside a component's nodes, arm as straight as possible."""
    rows, columns = (slice(int(a), int(b) + 1) for a, b in components.boxes[label].reshape(2, 2).T)
    iy, ix = _deepest(components.nodes(label, rows, columns).as_array())
    return components.straightest(iy + rows.start, ix + columns.start, label)


def _deepest(nodes: BoolArray) -> tuple[int, int]:
    """The first of the nodes that are in the middle of the largest square of nodes."""
    n_rows, n_columns = nodes.shape
    # a rim of no nodes
    depth = np.zeros((n_rows + 2, n_columns + 2), dtype=np.int32)
    iy, ix = divmod(_deepest_place(nodes, depth), n_columns)
    return iy, ix


@kernel("int64(const bool[:, :], int32[:, :])")
def _deepest_place(nodes: BoolArray, depth: Int32Array) -> int:
    """The first of the deepest nodes, as row · columns + column; see `_deepest`.

    The depth of a node is how many rings of nodes are around it, and one more. From the four
    neighbours before it in the raster's order, and from the four after it, it is one more at most.

    Args:
        nodes: Shape (n_rows, n_columns).
        depth: 0 at each of them and at a rim around them.
    """
    n_rows, n_columns = nodes.shape
    for iy in range(1, n_rows + 1):
        for ix in range(1, n_columns + 1):
            if nodes[iy - 1, ix - 1]:
                above = min(depth[iy - 1, ix - 1], depth[iy - 1, ix], depth[iy - 1, ix + 1])
                depth[iy, ix] = min(above, depth[iy, ix - 1]) + 1
    best, best_iy, best_ix = 0, 0, 0
    for iy in range(n_rows, 0, -1):
        for ix in range(n_columns, 0, -1):
            below = min(depth[iy + 1, ix - 1], depth[iy + 1, ix], depth[iy + 1, ix + 1])
            depth[iy, ix] = min(depth[iy, ix], min(below, depth[iy, ix + 1]) + 1)
            if depth[iy, ix] >= best:
                best, best_iy, best_ix = depth[iy, ix], iy, ix
    place: int = (best_iy - 1) * n_columns + best_ix - 1
    return place


def _area_mm2(components: Components, label: int, lattice: Lattice, disc_mm: float) -> float:
    """What the disc covers from one component's nodes, by the raster."""
    rows, columns = _window(components.boxes[label], lattice, disc_mm)
    cells = covered_cells(components.nodes(label, rows, columns), disc_mm / lattice.step_mm)
    return cells.count() * lattice.step_mm**2


def _area_bounds_mm2(
    boxes: npt.NDArray[np.int64], disc_mm: float, step_mm: float
) -> npt.NDArray[np.float64]:
    """No component covers more than its box grown by the disc: a rounded rectangle."""
    sides_mm = (boxes[:, 2:] - boxes[:, :2]) * step_mm + 2 * disc_mm
    bounds: npt.NDArray[np.float64] = sides_mm.prod(axis=1) - (4 - math.pi) * disc_mm**2
    return bounds


def _window(box: npt.NDArray[np.int64], lattice: Lattice, disc_mm: float) -> tuple[slice, slice]:
    """Rows and columns that hold a box of nodes and all that the disc covers from them."""
    low, left, high, right = box.tolist()
    return lattice.around(slice(low, high + 1), slice(left, right + 1), disc_mm)
