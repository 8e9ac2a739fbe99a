"""The area of interest: the floor that the disc covers, as a raster and as an outline.

The outline bounds the union of the discs on the reached nodes, so it is made of arcs of the
disc's radius R only. Along a straight wall these are scallops as long as the lattice step and
step² / 8R high: 0.036 mm for the prototype. The *clean* outline draws them as straight lines.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import shapely
from shapely.geometry import Polygon

from satAOI_geo.cells import covered_cells
from satAOI_geo.discs import Arcs, boundary
from satAOI_geo.errors import InputError
from satAOI_geo.lattice import WORD_BITS, Lattice
from satAOI_geo.nodes import Nodes
from satAOI_geo.plan import BoolArray, FloatArray, IntArray

CLEAN_MM = 0.05
"""How far inside the exact outline the clean one may run: far less than a drawing can show."""


@dataclass(frozen=True, slots=True)
class Loop:
    """A closed chain of straight lines and circular arcs.

    Attributes:
        vertices: Shape (n, 3), x_mm, y_mm and the bulge of the piece that starts there; the last
            piece ends at the first vertex. A bulge is tan(angle / 4), positive when the arc runs
            counter-clockwise, 0 for a straight line, as in DXF.
    """

    vertices: FloatArray

    def area_mm2(self) -> float:
        """Area enclosed, positive when the loop runs counter-clockwise; arcs count exactly."""
        (area_mm2,) = _areas_mm2(self.vertices, np.array([0, len(self.vertices)]))
        return area_mm2

    def points_mm(self, sagitta_mm: float) -> FloatArray:
        """Corners of a polygon on the loop, shape (m, 2).

        Arcs are divided evenly, a quarter turn at most, so that no chord is farther than
        sagitta_mm (above 0) from its arc. All corners lie on the loop.
        """
        n_pieces = self._n_pieces(sagitta_mm)
        points_mm, _, _ = self._divided(n_pieces)
        return points_mm

    def equal_area_points_mm(self, sagitta_mm: float) -> FloatArray:
        """Corners of a polygon of the loop's own area, shape (m, 2), about sagitta_mm from it.

        The corners between the ends of an arc of angle θ, cut into k pieces of φ, move from the
        radius r to q·r, such that the fan of triangles sinφ (2q + (k - 2) q²) r²/2 has the area of
        the sector, θ r²/2.
        """
        n_pieces = np.maximum(self._n_pieces(sagitta_mm), np.where(self.vertices[:, 2] != 0, 2, 1))
        points_mm, arc, inner = self._divided(n_pieces)
        arc, k = arc[inner], n_pieces[arc[inner]]
        begin_mm = self.vertices[arc, :2]
        chord_mm = np.roll(self.vertices[:, :2], -1, axis=0)[arc] - begin_mm
        half_rad = 2 * np.arctan(self.vertices[arc, 2])
        left_mm = np.column_stack((-chord_mm[:, 1], chord_mm[:, 0]))
        centre_mm = begin_mm + (chord_mm + left_mm / np.tan(half_rad)[:, np.newaxis]) / 2
        target = 2 * half_rad / np.sin(2 * half_rad / k)
        # the root of (k - 2) q² + 2q = target, in a form that k = 2 does not divide by 0
        q = target / (1 + np.sqrt(1 + (k - 2) * target))
        points_mm[inner] = centre_mm + q[:, np.newaxis] * (points_mm[inner] - centre_mm)
        return points_mm

    def _n_pieces(self, sagitta_mm: float) -> IntArray:
        """Pieces of equal angle each arc is cut into, 1 for a straight line, shape (n,)."""
        chord_mm = np.roll(self.vertices[:, :2], -1, axis=0) - self.vertices[:, :2]
        half_rad = 2 * np.arctan(self.vertices[:, 2])
        return _n_pieces(np.hypot(*chord_mm.T), half_rad, sagitta_mm)

    def _divided(self, n_pieces: IntArray) -> tuple[FloatArray, IntArray, BoolArray]:
        """The loop with each piece cut evenly in angle.

        Returns:
            The points, shape (m, 2); for each the piece it lies on; whether it lies between the
            piece's ends.
        """
        begin_mm = self.vertices[:, :2]
        chord_mm = np.roll(begin_mm, -1, axis=0) - begin_mm
        half_rad = 2 * np.arctan(self.vertices[:, 2])
        which = np.repeat(np.arange(n_pieces.size), n_pieces)
        steps = np.arange(which.size) - np.repeat(np.cumsum(n_pieces) - n_pieces, n_pieces)
        share = steps / n_pieces[which]
        # A chord from the arc's begin makes the angle (1 - share) · half with the whole chord,
        # which it meets on its right, and is sin(share · half) / sin(half) times as long.
        half_rad, chord_mm = half_rad[which], chord_mm[which]
        aside_rad = (1 - share) * half_rad
        inner = steps > 0
        scale = np.zeros(which.size)
        scale[inner] = np.sin(share[inner] * half_rad[inner]) / np.sin(half_rad[inner])
        along, right = scale * np.cos(aside_rad), scale * np.sin(aside_rad)
        right_mm = np.column_stack((chord_mm[:, 1], -chord_mm[:, 0]))
        points_mm: FloatArray = (
            begin_mm[which] + along[:, np.newaxis] * chord_mm + right[:, np.newaxis] * right_mm
        )
        return points_mm, which, inner


@dataclass(frozen=True, slots=True)
class Outline:
    """One connected part of the area: exterior counter-clockwise, holes clockwise.

    Parts that touch in a point are two; a part may touch itself in a point, around a hole.
    """

    exterior: Loop
    holes: tuple[Loop, ...]

    def area_mm2(self) -> float:
        """Area of the part, arcs counted exactly."""
        return self.exterior.area_mm2() + sum(hole.area_mm2() for hole in self.holes)

    def polygon(self, sagitta_mm: float = 0.01) -> Polygon:
        """The part with chords for arcs: valid, inside it, and within sagitta_mm of it."""
        return Polygon(
            self.exterior.points_mm(sagitta_mm),
            [hole.points_mm(sagitta_mm) for hole in self.holes],
        )

    def equal_area_polygon(self, sagitta_mm: float = 0.01) -> Polygon:
        """The part with corners set about its arcs so that the polygon has the part's area."""
        return Polygon(
            self.exterior.equal_area_points_mm(sagitta_mm),
            [hole.equal_area_points_mm(sagitta_mm) for hole in self.holes],
        )


@dataclass(frozen=True, slots=True)
class Aoi:
    """The area of interest.

    Attributes:
        cells: The cells whose centre lies within R, included, of a reached node.
        outlines: Its connected parts in the plan's frame, largest first.
        area_mm2: Area inside the outlines.
        raster_area_mm2: Area of the cells of the raster.
    """

    cells: Nodes
    outlines: tuple[Outline, ...]
    area_mm2: float
    raster_area_mm2: float

    @property
    def raster(self) -> BoolArray:
        """Whether each cell is one of them, shape (n_rows, n_columns)."""
        return self.cells.as_array()


def area(reached: Nodes, lattice: Lattice, disc_radius_mm: float, *, exact: bool = False) -> Aoi:
    """The area that discs of radius R cover from the reached nodes.

    Args:
        reached: The reached nodes.
        lattice: Where the nodes lie.
        disc_radius_mm: R.
        exact: Whether the outlines keep arcs that rise less than `CLEAN_MM` over their chord.

    Raises:
        InputError: If `reached` is not of the lattice's shape.
    """
    (only,) = areas([reached], [lattice], disc_radius_mm, exact=exact)
    return only


def areas(
    sets: Sequence[Nodes],
    windows: Sequence[Lattice],
    disc_radius_mm: float,
    *,
    exact: bool = False,
) -> list[Aoi]:
    """The areas of several sets of nodes, each in a window of its own; see `area`.

    What is done once for all of them is most of what a small one would take.
    """
    for reached, window in zip(sets, windows, strict=True):
        if reached.shape != window.shape:
            raise InputError(
                f"the reached nodes have the shape {reached.shape}, the lattice {window.shape}; "
                "give nodes of this lattice"
            )
    step_mm = windows[0].step_mm
    stack = _Stack.of(sets, disc_radius_mm / step_mm)
    cells = stack.parted(covered_cells(stack.nodes, disc_radius_mm / step_mm), windows)
    outlines = _outlines_of(stack, windows, disc_radius_mm, exact=exact)
    return [
        Aoi(covered, parts, area_mm2, covered.count() * step_mm**2)
        for covered, (parts, area_mm2) in zip(cells, outlines, strict=True)
    ]


def outlines_of(reached: Nodes, lattice: Lattice, disc_radius_mm: float) -> tuple[Outline, ...]:
    """The outlines of the area alone; see `area`."""
    stack = _Stack.of([reached], disc_radius_mm / lattice.step_mm)
    ((outlines, _),) = _outlines_of(stack, [lattice], disc_radius_mm, exact=False)
    return outlines


class _Sized(NamedTuple):
    """A loop and the area that it encloses, negative for a hole."""

    loop: Loop
    area_mm2: float


@dataclass(frozen=True, slots=True)
class _Stack:
    """Sets of nodes in one window, above each other, too far apart for their discs to meet.

    Attributes:
        nodes: All of them.
        first_rows: Shape (n,), the row that row 0 of each set is.
    """

    nodes: Nodes
    first_rows: IntArray

    @classmethod
    def of(cls, sets: Sequence[Nodes], radius: float) -> "_Stack":
        """The sets with room for discs of a radius, in steps, between them."""
        apart = math.floor(2 * radius) + 1
        heights = [reached.words.shape[0] + apart for reached in sets]
        first_rows = np.cumsum([0, *heights[:-1]])
        if len(sets) == 1:
            return cls(sets[0], first_rows)
        width = max(reached.words.shape[1] for reached in sets)
        words = np.zeros((sum(heights), width), dtype=np.uint64)
        for reached, row in zip(sets, first_rows.tolist(), strict=True):
            n_rows, n_words = reached.words.shape
            words[row : row + n_rows, :n_words] = reached.words
        return cls(Nodes(words, WORD_BITS * width), first_rows)

    def parted(self, cells: Nodes, windows: Sequence[Lattice]) -> list[Nodes]:
        """Cells of the stack in the windows of its sets, what is beyond these cut off."""
        if len(windows) == 1:
            # a large set is the stack; its copies would be large, too
            return [cells]
        return [
            Nodes(
                cells.window(slice(row, row + window.n_rows), slice(0, window.n_columns)).words
                & ~window.no_nodes(),
                window.n_columns,
            )
            for window, row in zip(windows, self.first_rows.tolist(), strict=True)
        ]


def _outlines_of(
    stack: _Stack, windows: Sequence[Lattice], disc_radius_mm: float, *, exact: bool
) -> list[tuple[tuple[Outline, ...], float]]:
    """The outlines of the area of each set of a stack, and the area inside them in mm²."""
    step_mm = windows[0].step_mm
    arcs = boundary(stack.nodes, disc_radius_mm / step_mm)
    owner = np.searchsorted(stack.first_rows, arcs.nodes[:, 1], side="right") - 1
    begins = arcs.begins - np.column_stack((np.zeros(owner.size), stack.first_rows[owner]))
    origins_mm = np.array([window.origin_mm for window in windows])
    vertices = np.column_stack(
        (origins_mm[owner] + (begins + 0.5) * step_mm, _bulges(arcs.spans_rad))
    )
    owners = owner[arcs.loops[:-1]]
    loops = arcs.loops
    if not exact:
        vertices, loops = _cleaned(vertices, arcs, disc_radius_mm)
    owned: list[list[_Sized]] = [[] for _ in windows]
    for number, loop in _largest_first(vertices, loops, owners):
        owned[number].append(loop)
    return [_outlines(own) for own in owned]


def _bulges(spans_rad: FloatArray) -> FloatArray:
    """tan(span / 4) for spans up to π, where this form gives 1 exactly."""
    bulges: FloatArray = np.sin(spans_rad / 2) / (1 + np.cos(spans_rad / 2))
    return bulges


def _cleaned(
    vertices: FloatArray, arcs: Arcs, disc_radius_mm: float
) -> tuple[FloatArray, IntArray]:
    """The vertices without scallops, and where each loop begins in them.

    An arc that rises at most `CLEAN_MM` over its chord becomes the chord, and chords in line
    become one. A chord lies in its disc, so inside the union. No two chords cross: where another
    disc q reaches over the chord of an arc about p, it does so by a cap that p covers, and the
    arcs about q, which are not covered, cut off other parts of q than this cap. All this is the
    same for a turned or mirrored set of nodes, since nothing depends on where a loop begins.
    """
    after, before = _neighbours(arcs.loops)
    rises_mm = disc_radius_mm * (1 - np.cos(arcs.spans_rad / 2))
    # the quarter turn keeps discs round that are themselves of the size of CLEAN_MM
    flat = (rises_mm <= CLEAN_MM) & (arcs.spans_rad <= math.pi / 2)
    vertices = vertices.copy()
    vertices[flat, 2] = 0.0
    to_node = arcs.nodes - arcs.nodes[before]
    from_node = arcs.nodes[after] - arcs.nodes
    # between two equal steps from node to node the chord is that same step
    equal = (to_node == from_node).all(axis=1) & to_node.any(axis=1)
    in_line = flat & equal
    kept = ~(in_line & in_line[before])
    return vertices[kept], np.concatenate(([0], np.cumsum(kept)))[arcs.loops]


def _neighbours(loops: IntArray) -> tuple[IntArray, IntArray]:
    """Index of the arc after and of the arc before each arc in its loop, shape (n,) each."""
    indices = np.arange(loops[-1])
    after, before = indices + 1, indices - 1
    after[loops[1:] - 1] = loops[:-1]
    before[loops[:-1]] = loops[1:] - 1
    return after, before


def _largest_first(
    vertices: FloatArray, loops: IntArray, owners: IntArray
) -> Iterator[tuple[int, _Sized]]:
    """The loops, each from its lowest, then leftmost vertex on, and their owners.

    They come in the order of size to the square millimetre, then lowest, then leftmost.
    """
    begins = loops[:-1]
    which = np.repeat(np.arange(begins.size), np.diff(loops))
    lowest = np.lexsort((vertices[:, 0], vertices[:, 1], which))[begins]
    vertices = vertices[_rolled(loops, lowest)]
    # those of all loops: a small array each would take more memory than what is in it
    vertices.flags.writeable = False
    areas_mm2 = _areas_mm2(vertices, loops)
    x_mm, y_mm, _ = vertices[begins].T
    order = np.lexsort((x_mm, y_mm, -np.rint(np.abs(areas_mm2))))
    spans = list(pairwise(loops.tolist()))
    for k, owner in zip(order.tolist(), owners[order].tolist(), strict=True):
        yield owner, _Sized(Loop(vertices[slice(*spans[k])]), areas_mm2[k])


def _rolled(loops: IntArray, firsts: IntArray) -> IntArray:
    """For each vertex the one to take its place for loops to begin at others, shape (n,)."""
    n_vertices = np.diff(loops)
    begin, end = np.repeat(loops[:-1], n_vertices), np.repeat(loops[1:], n_vertices)
    taken = np.arange(loops[-1]) - begin + np.repeat(firsts, n_vertices)
    return np.where(taken < end, taken, taken - end + begin)


def _areas_mm2(vertices: FloatArray, loops: IntArray) -> list[float]:
    """The area that each loop encloses, positive when it runs counter-clockwise.

    Args:
        vertices: Those of all loops, see `Loop`.
        loops: Where each begins, and where the last one ends.
    """
    # from the first vertex, so that coordinates far from the origin cost no digits, and the line
    # back to it no area
    origins_mm = np.repeat(vertices[loops[:-1], :2], np.diff(loops), axis=0)
    x_mm, y_mm = (vertices[:, :2] - origins_mm).T
    crosses_mm2 = x_mm[:-1] * y_mm[1:] - x_mm[1:] * y_mm[:-1]
    begins = np.flatnonzero(vertices[:, 2])
    after, _ = _neighbours(loops)
    ends = after[begins]
    chords_mm = np.hypot(x_mm[ends] - x_mm[begins], y_mm[ends] - y_mm[begins])
    angles_rad = 4 * np.arctan(vertices[begins, 2])
    # of both signs, squared below
    radii_mm = chords_mm / (2 * np.sin(angles_rad / 2))
    segments_mm2 = radii_mm**2 * (angles_rad - np.sin(angles_rad)) / 2
    first_arcs = np.searchsorted(begins, loops)
    return [
        float(crosses_mm2[begin : end - 1].sum() / 2 + segments_mm2[first:beyond].sum())
        for (begin, end), (first, beyond) in zip(
            pairwise(loops.tolist()), pairwise(first_arcs.tolist()), strict=True
        )
    ]


def _outlines(loops: list[_Sized]) -> tuple[tuple[Outline, ...], float]:
    """Loops gathered into parts, the counter-clockwise ones with the holes inside; their area."""
    exteriors = [loop for loop in loops if loop.area_mm2 > 0]
    holes = [loop for loop in loops if loop.area_mm2 <= 0]
    owned: list[list[_Sized]] = [[] for _ in exteriors]
    for hole, owner in zip(holes, _owners(exteriors, holes), strict=True):
        owned[owner].append(hole)
    outlines = tuple(
        Outline(exterior.loop, tuple(hole.loop for hole in inside))
        for exterior, inside in zip(exteriors, owned, strict=True)
    )
    area_mm2 = sum(
        exterior.area_mm2 + sum(hole.area_mm2 for hole in inside)
        for exterior, inside in zip(exteriors, owned, strict=True)
    )
    return outlines, area_mm2


def _owners(exteriors: list[_Sized], holes: list[_Sized]) -> IntArray:
    """Index of the exterior that each hole lies in; exteriors ordered largest first.

    The smallest that is larger than the hole and contains a point of it: loops may touch but do
    not cross, so of those larger than the hole each contains all of it or nothing.
    """
    owners = np.zeros(len(holes), dtype=np.int64)
    if len(exteriors) == 1:
        return owners
    sagitta_mm = 0.01
    tree = shapely.STRtree(
        [Polygon(hole.loop.points_mm(sagitta_mm)).representative_point() for hole in holes]
    )
    hole_areas_mm2 = np.array([-hole.area_mm2 for hole in holes])
    for index, exterior in enumerate(exteriors):
        polygon = Polygon(exterior.loop.points_mm(sagitta_mm))
        inside = tree.query(polygon, predicate="contains")
        owners[inside[hole_areas_mm2[inside] < exterior.area_mm2]] = index
    return owners


def _n_pieces(chords_mm: FloatArray, half_rad: FloatArray, sagitta_mm: float) -> IntArray:
    """Into how many chords each piece of a loop is divided, shape (n,); straight ones into 1."""
    n_pieces = np.ones(chords_mm.size, dtype=np.int64)
    curved = half_rad != 0
    radii_mm = chords_mm[curved] / (2 * np.sin(np.abs(half_rad[curved])))
    # a chord over the angle t rises r·(1 - cos(t / 2)) = 2r·sin²(t / 4)
    rise = np.sqrt(sagitta_mm / (2 * radii_mm))
    allowed_rad = 4 * np.arcsin(np.minimum(rise, math.sin(math.pi / 8)))
    # what rounding adds to a whole number of pieces is no reason for one more
    n_pieces[curved] = np.ceil(2 * np.abs(half_rad[curved]) / allowed_rad - 1e-9)
    return np.maximum(n_pieces, 1)
