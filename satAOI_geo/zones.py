"""Zones: what each set-down of the robot can trowel, and how few set-downs are enough."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Final, Protocol

import numpy as np

from satAOI_geo.aoi import Aoi, Outline, areas
from satAOI_geo.cells import covered_cells
from satAOI_geo.kernels import helper, kernel
from satAOI_geo.lattice import WORD_BITS, Lattice, Words
from satAOI_geo.memory import give_back
from satAOI_geo.nodes import Nodes, n_bits
from satAOI_geo.plan import FloatArray, Int32Array, IntArray
from satAOI_geo.reach import PoseComponents, State

ZONE_MM2: Final = 500_000.0
"""Smaller zones are not worth a set-down: half a square metre is little more than one disc."""


BATCH_NODES: Final = 2**22
"""Of a window for several zones: half a megabyte of bits."""


class Components(Protocol):
    """Connected sets of nodes, numbered 0 .. n - 1."""

    @property
    def boxes(self) -> IntArray:
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
        area_mm2: Area inside the outlines.
        raster_area_mm2: Area of the cells that it covers.
        set_down: A state to set the robot down at, well inside.
    """

    label: int
    n_nodes: int
    outlines: tuple[Outline, ...]
    area_mm2: float
    raster_area_mm2: float
    set_down: State


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
    found: list[Zone] = []
    for covered in _covered(components, lattice, disc_mm, known, progress):
        large = {label: aoi for label, aoi in covered.items() if aoi.area_mm2 >= ZONE_MM2}
        states = _set_downs_of(components, list(large))
        found += [
            Zone(
                label,
                components.stretches.count(label),
                aoi.outlines,
                aoi.area_mm2,
                aoi.raster_area_mm2,
                state,
            )
            for (label, aoi), state in zip(large.items(), states, strict=True)
        ]
    return tuple(sorted(found, key=lambda zone: (-zone.raster_area_mm2, zone.label)))


def set_downs(
    components: PoseComponents,
    free: Nodes,
    lattice: Lattice,
    disc_mm: float,
    known: Mapping[int, State],
) -> tuple[SetDown, ...]:
    """Set-downs whose areas together cover what any pose can trowel, the greatest gain first.

    Greedy: each covers the most cells not covered yet.

    Args:
        components: The components.
        free: Nodes at which some pose is free.
        lattice: Nodes and directions.
        disc_mm: Radius of the disc.
        known: Where the robot is set down for some of them, by their numbers.
    """
    chosen = []
    radius, cell_mm2 = disc_mm / lattice.step_mm, lattice.step_mm**2
    todo = covered_cells(free, radius).words
    bounds_mm2 = _area_bounds_mm2(components.boxes, disc_mm, lattice.step_mm)
    gains = _Gains.of(components.boxes, bounds_mm2 / cell_mm2)
    while gains.at_most[label := gains.greatest(todo, radius)] > 0:
        rows, columns = _window(components.boxes[label], lattice, disc_mm)
        here = todo[rows, columns.start // WORD_BITS : -(-columns.stop // WORD_BITS)]
        gained = covered_cells(components.nodes(label, rows, columns), radius).words & here
        n_gained = int(np.bitwise_count(gained).sum())
        gains.at_most[label] = n_gained
        if n_gained and gains.greatest(todo, radius) == label:
            here &= ~gained
            gains.at_most[label] = 0
            state = known.get(label) or set_down(components, label)
            chosen.append(SetDown(state, label, n_gained * cell_mm2))
    return tuple(chosen)


@dataclass(frozen=True, slots=True)
class _Gains:
    """How many cells each set could gain at most; gains only shrink as more cells are covered.

    So an old gain is a bound, and need only be looked at again when it comes first.

    Attributes:
        boxes: See `Components`.
        at_most: Shape (n,), of each set. That of the first set may be lowered by whoever knows
            better.
        heap: Shape (n,), the sets: that at k comes before those at 2k + 1 and 2k + 2, but for the
            first, which is put in its place when it is asked for.
    """

    boxes: IntArray
    at_most: FloatArray
    heap: Int32Array

    @classmethod
    def of(cls, boxes: IntArray, at_most: FloatArray) -> "_Gains":
        """The sets in order."""
        return cls(boxes, at_most, np.argsort(-at_most, kind="stable").astype(np.int32))

    def greatest(self, todo: Words, radius: float) -> int:
        """The set that could gain the most of the cells to do, of equals that of lowest number."""
        _lower(self.heap, self.at_most, self.boxes, math.ceil(radius), todo)
        return int(self.heap[0])


def _covered(
    components: PoseComponents,
    lattice: Lattice,
    disc_mm: float,
    known: Mapping[int, Aoi],
    progress: Callable[[float], None] | None,
) -> Iterator[Mapping[int, Aoi]]:
    """What components that may be large enough for a zone cover, some at a time; see `zones`."""
    yield known
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
        yield dict(zip(batch, covered, strict=True))
        n_done += len(batch)
        if progress is not None:
            progress(n_done / labels.size)
        if n_done < labels.size:
            give_back()


def _batches(boxes: IntArray, labels: list[int]) -> Iterator[list[int]]:
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
    (state,) = _set_downs_of(components, [label])
    return state


def _set_downs_of(components: PoseComponents, labels: list[int]) -> list[State]:
    """Where the robot is set down for each of some components, see `set_down`."""
    sets = np.array(labels, dtype=np.int64)
    deepest = components.stretches.deepest(sets, components.lattice.n_columns)
    return [
        components.straightest(iy, ix, label)
        for (iy, ix), label in zip(deepest.tolist(), labels, strict=True)
    ]


@kernel("void(int32[:], float64[:], const int64[:, :], int64, const uint64[:, :])")
def _lower(
    heap: Int32Array, at_most: FloatArray, boxes: IntArray, margin: int, todo: Words
) -> None:
    """Lower bounds until the first set's is no more than what is left around its box.

    To count that is cheaper than to count what it covers.

    Args:
        heap: See `_Gains`, as are the next two.
        at_most: Of each set.
        boxes: Of each set.
        margin: How far around a box its set covers cells.
        todo: The cells that are left.
    """
    _sink(heap, at_most)
    while at_most[heap[0]] > 0:
        left = _n_in_box(todo, boxes[heap[0]], margin)
        if left >= at_most[heap[0]]:
            return
        at_most[heap[0]] = left
        _sink(heap, at_most)


@helper
def _sink(heap: Int32Array, at_most: FloatArray) -> None:
    """Put the first set in its place."""
    place = 0
    while True:
        child = 2 * place + 1
        if child + 1 < heap.size and _comes_before(at_most, heap[child + 1], heap[child]):
            child += 1
        if child >= heap.size or not _comes_before(at_most, heap[child], heap[place]):
            return
        heap[place], heap[child] = heap[child], heap[place]
        place = child


@helper
def _comes_before(at_most: FloatArray, label: int, other: int) -> bool:
    """Whether a set could gain more than another, or as much and has the lower number."""
    more: bool = at_most[label] > at_most[other]
    return more or (at_most[label] == at_most[other] and label < other)


@helper
def _n_in_box(cells: Words, box: IntArray, margin: int) -> int:
    """How many cells there are in a box and around it."""
    every = np.uint64(0xFFFFFFFFFFFFFFFF)
    left, right = max(0, box[1] - margin), min(64 * cells.shape[1] - 1, box[3] + margin)
    first_word, last_word = left >> 6, right >> 6
    n = 0
    for iy in range(max(0, box[0] - margin), min(cells.shape[0], box[2] + margin + 1)):
        for word in range(first_word, last_word + 1):
            bits = cells[iy, word]
            if word == first_word:
                bits &= every << np.uint64(left & 63)
            if word == last_word:
                bits &= every >> np.uint64(63 - (right & 63))
            n += n_bits(bits)
    return n


def _area_mm2(components: Components, label: int, lattice: Lattice, disc_mm: float) -> float:
    """What the disc covers from one component's nodes, by the raster."""
    rows, columns = _window(components.boxes[label], lattice, disc_mm)
    cells = covered_cells(components.nodes(label, rows, columns), disc_mm / lattice.step_mm)
    return cells.count() * lattice.step_mm**2


def _area_bounds_mm2(boxes: IntArray, disc_mm: float, step_mm: float) -> FloatArray:
    """No component covers more than the cells of its box grown by the disc: a rounded rectangle.

    That holds for the outline and for the raster, whose cells reach half a step beyond the disc.
    """
    sides_mm = (boxes[:, 2:] - boxes[:, :2] + 1) * step_mm + 2 * disc_mm
    bounds: FloatArray = sides_mm.prod(axis=1) - (4 - math.pi) * disc_mm**2
    return bounds


def _window(box: IntArray, lattice: Lattice, disc_mm: float) -> tuple[slice, slice]:
    """Rows and columns that hold a box of nodes and all that the disc covers from them."""
    low, left, high, right = box.tolist()
    return lattice.around(slice(low, high + 1), slice(left, right + 1), disc_mm)
