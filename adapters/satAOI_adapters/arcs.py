"""Arcs found again in rings whose corners were set on them.

What is cut out of the floor arrives as polygons with chords for arcs: thousands of corners, where
a drawing or a model says the same with a few arcs. Points are complex numbers here, x_mm + 1j y_mm.
"""

import math
from typing import Final, TypeAlias

import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry import LinearRing, Polygon

from satAOI_geo.aoi import Loop, Outline
from satAOI_geo.plan import BoolArray

Points: TypeAlias = npt.NDArray[np.complex128]

RISE_MM: Final = 0.02
"""How far an arc may rise over the chords it replaces. Arcs of the area come with chords they rise
0.01 mm over; a polygon that was drawn as one, a pillar of eight corners, stays a polygon."""

ALIKE_MM: Final = 0.001
"""Corners share a circle when their centres are this close. They lie on it up to the rounding of
coordinates, which over chords so flat moves the centre by a ten-thousandfold."""

TRIANGLE: Final = 3
"""Corners that a ring must have."""


def outline_with_arcs(polygon: Polygon) -> Outline:
    """A polygon as an outline of straight lines and arcs, nowhere `RISE_MM` away from it.

    Spikes narrower than `ALIKE_MM` are left out. Where the polygon is narrower than the arcs rise,
    at the tip between two of them, the outline may cross itself.
    """
    exterior, *holes = map(loop_with_arcs, (polygon.exterior, *polygon.interiors))
    return Outline(exterior, tuple(holes))


def loop_with_arcs(ring: LinearRing) -> Loop:
    """A ring with an arc wherever three chords or more lie in one circle."""
    corners = _without_spikes(shapely.get_coordinates(ring)[:-1].view(np.complex128)[:, 0])
    before, after = _neighbours(corners)
    centres, bends_left = _circles(corners, before, after)
    inner = _within_arcs(corners, before, after, centres)
    for step in (1, -1):
        _run_on(corners, centres, bends_left, inner, step)
    if np.count_nonzero(inner) > inner.size - 2:
        # one circle: no bulge makes an arc that ends where it begins
        begin = int(inner.argmin())
        inner[[begin, begin - inner.size // 2]] = False
    (begins,) = np.nonzero(~inner)
    # all corners within an arc have its circle, so has the first of them
    first = (begins + 1) % inner.size
    curved = inner[first]
    first = first[curved]
    from_begin, to_end = (
        corners[at[curved]] - centres[first] for at in (begins, np.append(begins[1:], begins[0]))
    )
    spans_rad = np.angle(to_end / from_begin) % math.tau
    spans_rad = np.where(bends_left[first], spans_rad, spans_rad - math.tau)
    bulges = np.zeros(begins.size)
    bulges[curved] = np.tan(spans_rad / 4)
    return Loop(np.column_stack((corners[begins].real, corners[begins].imag, bulges)))


def _without_spikes(corners: Points) -> Points:
    """The corners but for those that repeat the one before, and those where the ring turns back.

    Cutting floor out of floor leaves both, and geometry kernels stumble over them.
    """
    before, after = _neighbours(corners)
    back, ahead = before - corners, after - corners
    lengths_mm = np.abs(back), np.abs(ahead)
    product = back.conj() * ahead
    # how far apart the two sides of a corner are where the shorter one ends
    width_mm = np.abs(product.imag) / np.maximum(np.maximum(*lengths_mm), ALIKE_MM)
    is_spike = (product.real > 0) & (width_mm <= ALIKE_MM)
    kept = corners[~is_spike & (lengths_mm[0] > ALIKE_MM)]
    if len(kept) == len(corners) or len(kept) < TRIANGLE:
        return corners
    # without its tip a spike may have another one
    return _without_spikes(kept)


def _neighbours(values: Points) -> tuple[Points, Points]:
    """What stands before and what stands after each value of a ring."""
    padded = np.concatenate((values[-1:], values, values[:1]))
    return padded[:-2], padded[2:]


def _circles(corners: Points, before: Points, after: Points) -> tuple[Points, BoolArray]:
    """The circle through each corner and its neighbours.

    Returns:
        Its centre, not finite where the three are in line; whether the ring bends left there.
    """
    back, ahead = before - corners, after - corners
    cross_mm2 = (ahead.conj() * back).imag
    with np.errstate(divide="ignore", invalid="ignore"):
        to_centre = back * ahead * (ahead - back).conj() / (2j * cross_mm2)
    return corners + to_centre, cross_mm2 > 0


def _within_arcs(corners: Points, before: Points, after: Points, centres: Points) -> BoolArray:
    """Which corners arcs run over: those that share their circle with a neighbour."""
    longest_mm = np.maximum(np.abs(before - corners), np.abs(after - corners))
    # a circle r rises c² / 8r over a chord c that is short against it
    centres = np.where(longest_mm**2 <= 8 * RISE_MM * np.abs(centres - corners), centres, np.nan)
    with np.errstate(invalid="ignore"):
        alike = np.abs(_neighbours(centres)[1] - centres) <= ALIKE_MM
    alike_before = np.roll(alike, 1)
    inner = alike | alike_before
    # where one circle follows another at once, the corner between them stays
    return inner & ~(alike & ~alike_before & np.roll(inner, 1))


def _run_on(
    corners: Points, centres: Points, bends_left: BoolArray, inner: BoolArray, step: int
) -> None:
    """Let arcs run on over one more chord, ahead (step 1) or back (-1), if that ends on the circle.

    The chords at the ends of an arc may be shorter than the others, or their corners a hair off.
    The corner run over joins `inner`, with the arc's circle.
    """
    ends = np.flatnonzero(~inner & np.roll(inner, step) & ~np.roll(inner, -step))
    within, beyond = (ends - step) % inner.size, (ends + step) % inner.size
    radii_mm = np.abs(corners[within] - centres[within])
    off_mm = np.abs(np.abs(corners[beyond] - centres[within]) - radii_mm)
    chords_mm = np.abs(corners[beyond] - corners[ends])
    runs_on = (off_mm <= RISE_MM) & (chords_mm**2 <= 8 * RISE_MM * radii_mm)
    ends, within = ends[runs_on], within[runs_on]
    inner[ends] = True
    centres[ends], bends_left[ends] = centres[within], bends_left[within]
