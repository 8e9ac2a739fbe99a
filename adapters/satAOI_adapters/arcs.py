"""Arcs found again in rings whose corners were set on them.

What is cut out of the floor arrives as polygons with chords for arcs: thousands of corners, where
a drawing or a model says the same with a few arcs. Points are complex numbers here, x_mm + 1j y_mm.
All rings are looked at together: they are many, and most are short.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, TypeAlias

import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry import LinearRing, Polygon

from satAOI_geo.aoi import Loop, Outline
from satAOI_geo.plan import BoolArray, IntArray

Points: TypeAlias = npt.NDArray[np.complex128]

RISE_MM: Final = 0.04
"""How far an arc may rise over the chords it replaces. Arcs of the area come with chords they rise
0.03 mm over; a polygon that was drawn as one, a pillar of eight corners, stays a polygon."""

ALIKE_MM: Final = 0.001
"""Corners share a circle when their centres are this close. They lie on it up to the rounding of
coordinates, which over chords so flat moves the centre by a ten-thousandfold."""

TRIANGLE: Final = 3
"""Corners that a ring must have."""


def outlines_with_arcs(polygons: Sequence[Polygon]) -> list[Outline]:
    """Polygons as outlines of straight lines and arcs, nowhere `RISE_MM` away from them.

    Spikes narrower than `ALIKE_MM` are left out. Where a polygon is narrower than the arcs rise, at
    the tip between two of them, the outline may cross itself.
    """
    rings, of_polygon = shapely.get_rings(polygons, return_index=True)
    loops: list[list[Loop]] = [[] for _ in polygons]
    for k, loop in zip(of_polygon.tolist(), loops_with_arcs(rings), strict=True):
        loops[k].append(loop)
    return [Outline(exterior, tuple(holes)) for exterior, *holes in loops]


def loops_with_arcs(rings: Sequence[LinearRing]) -> list[Loop]:
    """Rings with an arc wherever three chords or more lie in one circle."""
    if not len(rings):
        return []
    chain = _without_spikes(_Chain.of_rings(rings))
    corners, before, after = chain.corners, chain.before, chain.after
    centres, bends_left = _circles(chain)
    inner = _within_arcs(chain, centres)
    _run_on(corners, centres, bends_left, inner, behind=before, ahead=after)
    _run_on(corners, centres, bends_left, inner, behind=after, ahead=before)
    _open_circles(chain, inner)
    begins = np.flatnonzero(~inner)
    of_rings = np.searchsorted(begins, chain.firsts)
    ends = np.roll(begins, -1)
    # the last piece of a ring ends where its first one begins
    ends[of_rings - 1] = begins[np.roll(of_rings, 1)]
    # all corners within an arc have its circle, so has the first of them
    first = after[begins]
    curved = inner[first]
    first = first[curved]
    from_begin, to_end = (corners[at[curved]] - centres[first] for at in (begins, ends))
    spans_rad = np.angle(to_end / from_begin) % math.tau
    spans_rad = np.where(bends_left[first], spans_rad, spans_rad - math.tau)
    bulges = np.zeros(begins.size)
    bulges[curved] = np.tan(spans_rad / 4)
    vertices = np.column_stack((corners[begins].real, corners[begins].imag, bulges))
    return [Loop(own) for own in np.split(vertices, of_rings[1:])]


@dataclass(frozen=True, slots=True)
class _Chain:
    """Rings one after another.

    Attributes:
        corners: Of all rings, shape (n,).
        sizes: Corners of each ring, shape (m,).
        firsts: Which corner is the first of each ring, shape (m,).
        before: Which corner stands before each in its ring, shape (n,).
        after: Which one stands after it, shape (n,).
    """

    corners: Points
    sizes: IntArray
    firsts: IntArray
    before: IntArray
    after: IntArray

    @classmethod
    def of_rings(cls, rings: Sequence[LinearRing]) -> "_Chain":
        """Rings as shapely has them, with the first corner repeated at the end."""
        points_mm = shapely.get_coordinates(rings).view(np.complex128)[:, 0]
        n_points = shapely.get_num_coordinates(rings).astype(np.int64)
        corners: Points = np.delete(points_mm, np.cumsum(n_points) - 1)
        return cls.of(corners, n_points - 1)

    @classmethod
    def of(cls, corners: Points, sizes: IntArray) -> "_Chain":
        """Rings of so many corners each."""
        lasts = np.cumsum(sizes) - 1
        firsts = lasts + 1 - sizes
        before, after = np.arange(corners.size) - 1, np.arange(corners.size) + 1
        before[firsts], after[lasts] = lasts, firsts
        return cls(corners, sizes, firsts, before, after)

    def count(self, chosen: BoolArray) -> IntArray:
        """How many of the chosen corners each ring has, shape (m,)."""
        return np.add.reduceat(chosen, self.firsts, dtype=np.int64)


def _without_spikes(chain: _Chain) -> _Chain:
    """The corners but for those that repeat the one before, and those where the ring turns back.

    Cutting floor out of floor leaves both, and geometry kernels stumble over them.
    """
    # without its tip a spike may have another one
    while not (kept := _without_tips(chain)).all():
        chain = _Chain.of(chain.corners[kept], chain.count(kept))
    return chain


def _without_tips(chain: _Chain) -> BoolArray:
    """Which corners to keep: all but repeated ones and those where the ring turns back."""
    corners = chain.corners
    back, ahead = corners[chain.before] - corners, corners[chain.after] - corners
    lengths_mm = np.abs(back), np.abs(ahead)
    product = back.conj() * ahead
    # how far apart the two sides of a corner are where the shorter one ends
    width_mm = np.abs(product.imag) / np.maximum(np.maximum(*lengths_mm), ALIKE_MM)
    is_spike = (product.real > 0) & (width_mm <= ALIKE_MM)
    kept = ~is_spike & (lengths_mm[0] > ALIKE_MM)
    # a ring that would vanish stays as it is
    return kept | np.repeat(chain.count(kept) < TRIANGLE, chain.sizes)


def _circles(chain: _Chain) -> tuple[Points, BoolArray]:
    """The circle through each corner and its neighbours.

    Returns:
        Its centre, not finite where the three are in line; whether the ring bends left there.
    """
    corners = chain.corners
    back, ahead = corners[chain.before] - corners, corners[chain.after] - corners
    cross_mm2 = (ahead.conj() * back).imag
    with np.errstate(divide="ignore", invalid="ignore"):
        to_centre = back * ahead * (ahead - back).conj() / (2j * cross_mm2)
    return corners + to_centre, cross_mm2 > 0


def _within_arcs(chain: _Chain, centres: Points) -> BoolArray:
    """Which corners arcs run over: those that share their circle with a neighbour."""
    corners, before, after = chain.corners, chain.before, chain.after
    longest_mm = np.maximum(np.abs(corners[before] - corners), np.abs(corners[after] - corners))
    # a circle r rises c² / 8r over a chord c that is short against it
    centres = np.where(longest_mm**2 <= 8 * RISE_MM * np.abs(centres - corners), centres, np.nan)
    with np.errstate(invalid="ignore"):
        alike = np.abs(centres[after] - centres) <= ALIKE_MM
    alike_before = alike[before]
    inner = alike | alike_before
    # where one circle follows another at once, the corner between them stays
    return inner & ~(alike & ~alike_before & inner[before])


def _run_on(
    corners: Points,
    centres: Points,
    bends_left: BoolArray,
    inner: BoolArray,
    *,
    behind: IntArray,
    ahead: IntArray,
) -> None:
    """Let arcs run on over one more chord, if that ends on the circle.

    The chords at the ends of an arc may be shorter than the others, or their corners a hair off.
    The corner run over joins `inner`, with the arc's circle. Arcs run from the corners `behind`
    theirs to those `ahead`.
    """
    ends = np.flatnonzero(~inner & inner[behind] & ~inner[ahead])
    within, beyond = behind[ends], ahead[ends]
    radii_mm = np.abs(corners[within] - centres[within])
    off_mm = np.abs(np.abs(corners[beyond] - centres[within]) - radii_mm)
    chords_mm = np.abs(corners[beyond] - corners[ends])
    runs_on = (off_mm <= RISE_MM) & (chords_mm**2 <= 8 * RISE_MM * radii_mm)
    ends, within = ends[runs_on], within[runs_on]
    inner[ends] = True
    centres[ends], bends_left[ends] = centres[within], bends_left[within]


def _open_circles(chain: _Chain, inner: BoolArray) -> None:
    """Let two corners stay of a ring that is one circle.

    No bulge makes an arc that ends where it begins.
    """
    for ring in np.flatnonzero(chain.count(~inner) < 2):
        own = inner[chain.firsts[ring] :][: chain.sizes[ring]]
        begin = int(own.argmin())
        own[[begin, begin - own.size // 2]] = False
