r"""Lines, arcs and splines kept exact, and the polylines that stand for them on a stated side.

An arc is the image of a circular arc under an affine map,

    p(t) = centre + u·cos t + v·sin t,   0 ≤ t ≤ sweep,

with two vectors u and v: at right angles and of equal length for a circle, otherwise conjugate
radii of an ellipse. Scaling, shearing and mirroring map u and v and nothing else, so an arc in a
distorted block stays exact.

A polyline stands for a curve in one of two ways: by *chords*, inside the curve's convex side, or
by *tangents*, outside it. Both keep within `SAGITTA_MM` of the curve:

        _____          tangents touch the arc,
      ./ ___ \.       chords have their corners on it
      //     \\
"""

import math
from dataclasses import dataclass
from typing import Final, TypeAlias

import numpy as np

from satAOI_adapters.dxf_read import limits
from satAOI_geo.plan import FloatArray, IntArray

Point: TypeAlias = tuple[float, float]

SAGITTA_MM: Final = 0.01
"""Farthest a polyline may be from the curve it stands for: a hundredth of a drawn line's width."""

STRAIGHT_MM: Final = 1e-5
"""A spline's piece as straight as that need not be halved to bend to one side only."""

LARGEST_STEP_RAD: Final = math.pi / 8
"""A full turn has at least 16 pieces, however small it is."""

ROUND: Final = 1e-9
"""Share by which the radii of a circle may differ: rounding of a rotation, not an ellipse."""


@dataclass(frozen=True, slots=True)
class Line:
    """A straight piece."""

    start: Point
    end: Point

    def spots(self) -> tuple[Point, ...]:
        """Points whose box holds the piece."""
        return self.start, self.end

    def reversed(self) -> "Line":
        """The same piece, travelled the other way."""
        return Line(self.end, self.start)


@dataclass(frozen=True, slots=True)
class Arc:
    """A piece of a circle or an ellipse; see the module's text.

    Attributes:
        start: p(0), kept beside the centre so that pieces join without a gap.
        end: p(sweep).
        centre: Of the circle or ellipse.
        u: Radius at the start.
        v: Conjugate radius, on the side of travel.
        sweep_rad: How far it turns, above 0, at most 2π.
    """

    start: Point
    end: Point
    centre: Point
    u: Point
    v: Point
    sweep_rad: float

    @property
    def turns_left(self) -> bool:
        """Whether it is travelled counter-clockwise."""
        return self.u[0] * self.v[1] > self.u[1] * self.v[0]

    @property
    def is_round(self) -> bool:
        """Whether it is a piece of a circle."""
        u_mm, v_mm = math.hypot(*self.u), math.hypot(*self.v)
        across = self.u[0] * self.v[0] + self.u[1] * self.v[1]
        return abs(u_mm - v_mm) <= ROUND * u_mm and abs(across) <= ROUND * u_mm * v_mm

    @property
    def is_full(self) -> bool:
        """Whether it closes on itself."""
        return self.sweep_rad == math.tau

    def spots(self) -> tuple[Point, ...]:
        """Points whose box holds the piece: of a closed one exactly, else with its chords."""
        if not self.is_full:
            return tuple(self.chords())
        reach_x, reach_y = math.hypot(self.u[0], self.v[0]), math.hypot(self.u[1], self.v[1])
        x, y = self.centre
        return (x - reach_x, y - reach_y), (x + reach_x, y + reach_y)

    def reversed(self) -> "Arc":
        """The same piece, travelled the other way."""
        u, v = _radii_at(self.u, self.v, self.sweep_rad)
        return Arc(self.end, self.start, self.centre, u, (-v[0], -v[1]), self.sweep_rad)

    def steps(self) -> int:
        """In how many pieces chords and tangents keep within `SAGITTA_MM`."""
        radius_mm = _longest_radius(self.u, self.v)
        # a tangent's corner is the farther of the two: r·(1/cos(step/2) - 1)
        widest_rad = 2 * math.acos(radius_mm / (radius_mm + SAGITTA_MM))
        steps = math.ceil(self.sweep_rad / min(widest_rad, LARGEST_STEP_RAD) - ROUND)
        limits.hold(
            "straight pieces for one curve", steps, limits.MAX_CURVE_STEPS, "check the unit"
        )
        return max(steps, 1)

    def chords(self) -> list[Point]:
        """Start, corners on the arc, end."""
        steps = self.steps()
        turns_rad = np.asarray(np.arange(1.0, steps) * (self.sweep_rad / steps))
        return [self.start, *self._points(turns_rad, 1.0), self.end]

    def tangents(self) -> list[Point]:
        """Start, corners outside the arc, end; every side touches the arc."""
        steps = self.steps()
        turns_rad = np.asarray(np.arange(0.5, steps) * (self.sweep_rad / steps))
        outwards = 1 / math.cos(self.sweep_rad / steps / 2)
        return [self.start, *self._points(turns_rad, outwards), self.end]

    def inner(self) -> list[Point]:
        """Start, corners on the arc half-way between those of `chords`, end.

        With the tangents it bounds a sliver that holds the arc and has a width everywhere
        between its ends: the tangents touch the arc where the chords have their corners.
        """
        steps = self.steps()
        turns_rad = np.asarray(np.arange(0.5, steps) * (self.sweep_rad / steps))
        return [self.start, *self._points(turns_rad, 1.0), self.end]

    def rough(self) -> list[Point]:
        """Start, corners on the arc, a sixteenth of a turn or less apart, end."""
        steps = math.ceil(self.sweep_rad / LARGEST_STEP_RAD)
        turns_rad = np.asarray(np.arange(1.0, steps) * (self.sweep_rad / steps))
        return [self.start, *self._points(turns_rad, 1.0), self.end]

    def _points(self, turns_rad: FloatArray, outwards: float) -> list[Point]:
        cos, sin = np.cos(turns_rad) * outwards, np.sin(turns_rad) * outwards
        x_mm = self.centre[0] + self.u[0] * cos + self.v[0] * sin
        y_mm = self.centre[1] + self.u[1] * cos + self.v[1] * sin
        return list(zip(x_mm.tolist(), y_mm.tolist(), strict=True))


@dataclass(frozen=True, slots=True)
class Spline:
    """A spline as Bézier pieces; exact, since knots are only inserted.

    Attributes:
        start: First point.
        end: Last point.
        beziers: Control points (x·w, y·w, w) of each piece, shape (degree + 1, 3), w above 0.
    """

    start: Point
    end: Point
    beziers: tuple[FloatArray, ...]

    def spots(self) -> tuple[Point, ...]:
        """Points whose box holds the piece: its control points."""
        corners = np.concatenate([bezier[:, :2] / bezier[:, 2:] for bezier in self.beziers])
        return tuple((float(x), float(y)) for x, y in corners)

    def reversed(self) -> "Spline":
        """The same piece, travelled the other way."""
        backwards = tuple(bezier[::-1] for bezier in reversed(self.beziers))
        return Spline(self.end, self.start, backwards)

    def chords(self) -> list[Point]:
        """Start, corners on the spline, end."""
        corners = self.hulls()[:-1, -1].tolist()
        return [self.start, *((x, y) for x, y in corners), self.end]

    def hulls(self) -> FloatArray:
        """Control points of short pieces, shape (pieces, degree + 1, 2).

        Each piece lies in the convex hull of its points, none of which is farther than
        `SAGITTA_MM` from the piece's chord, and bends to one side only.
        """
        return _flat_pieces(np.stack(self.beziers))

    def beside(self, *, left: bool) -> list[Point]:
        """Corners after the start of a line that has the spline on its other side, and its end.

        Args:
            left: Whether the line keeps to the left of the spline, or to its right.
        """
        hulls = self.hulls()
        corners: list[Point] = []
        for hull, turn in zip(hulls.tolist(), _turns(hulls).tolist(), strict=True):
            # a piece that turns left has its control points on its right
            taken = hull[-1:] if (turn >= 0) == left else hull[1:]
            corners.extend((x, y) for x, y in taken)
        corners[-1] = self.end
        return corners


Piece: TypeAlias = Line | Arc | Spline


@dataclass(frozen=True, slots=True)
class Path:
    """Pieces end to end; `closed` when the last one ends where the first one starts."""

    pieces: tuple[Piece, ...]
    closed: bool

    @property
    def start(self) -> Point:
        """Where it begins."""
        return self.pieces[0].start

    @property
    def end(self) -> Point:
        """Where it ends."""
        return self.pieces[-1].end

    @property
    def is_straight(self) -> bool:
        """Whether all its pieces are lines."""
        return all(isinstance(piece, Line) for piece in self.pieces)

    def rough(self) -> list[Point]:
        """Its corners, curves by few: enough to tell what lies near what."""
        points = [self.start]
        for piece in self.pieces:
            points.extend(piece.rough()[1:] if isinstance(piece, Arc) else piece.spots()[1:])
        return points

    def chords(self) -> list[Point]:
        """Its corners, curves by chords; a closed path repeats the first one at the end."""
        points = [self.start]
        for piece in self.pieces:
            points.extend((piece.end,) if isinstance(piece, Line) else piece.chords()[1:])
        if self.closed:
            points[-1] = points[0]
        return points


def arc_about(centre: Point, radii: tuple[Point, Point], start_rad: float, sweep_rad: float) -> Arc:
    """The arc centre + a·cos t + b·sin t from t = start over a sweep of either sign.

    Args:
        centre: Of the circle or ellipse.
        radii: The vectors a and b.
        start_rad: t at the start.
        sweep_rad: How far t goes, up to a full turn; negative goes backwards.
    """
    u, v = _radii_at(*radii, start_rad)
    if sweep_rad < 0:
        v = (-v[0], -v[1])
    turn_rad = min(abs(sweep_rad), math.tau)
    end_u, _ = _radii_at(u, v, turn_rad)
    start = (centre[0] + u[0], centre[1] + u[1])
    end = start if turn_rad == math.tau else (centre[0] + end_u[0], centre[1] + end_u[1])
    return Arc(start, end, centre, u, v, turn_rad)


def arc_of_bulge(start: Point, end: Point, bulge: float) -> Line | Arc:
    """The circular arc between two points that DXF writes as tan(sweep / 4), left turns positive.

    A bulge too small to leave the chord by a millionth of a millimetre is a line.
    """
    chord = (end[0] - start[0], end[1] - start[1])
    if abs(bulge) * math.hypot(*chord) / 2 < 1e-6:
        return Line(start, end)
    # the centre lies on the chord's bisector, (1 - b²) / 4b chords to the left of its middle
    offset = (1 - bulge * bulge) / (4 * bulge)
    u = (offset * chord[1] - chord[0] / 2, -offset * chord[0] - chord[1] / 2)
    centre = (start[0] - u[0], start[1] - u[1])
    v = (-u[1], u[0]) if bulge > 0 else (u[1], -u[0])
    return Arc(start, end, centre, u, v, 4 * math.atan(abs(bulge)))


def beziers_of(degree: int, knots: list[float], points: FloatArray) -> tuple[FloatArray, ...]:
    """The Bézier pieces of a B-spline.

    Args:
        degree: Of its polynomials.
        knots: n + degree + 1 values, not descending.
        points: Control points (x·w, y·w, w), shape (n, 3).
    """
    pieces = []
    for span in range(degree, len(points)):
        low, high = knots[span], knots[span + 1]
        if low < high:
            pieces.append(
                np.array(
                    [
                        _blossom(degree, knots, points, span, [low] * (degree - j) + [high] * j)
                        for j in range(degree + 1)
                    ]
                )
            )
    return tuple(pieces)


def _blossom(
    degree: int, knots: list[float], points: FloatArray, span: int, at: list[float]
) -> FloatArray:
    """The polar form of one polynomial piece at `degree` parameters (de Boor's triangle)."""
    row = points[span - degree : span + 1]
    for level in range(1, degree + 1):
        low = np.array(knots[span - degree + level : span + 1])
        high = np.array(knots[span + 1 : span + degree + 2 - level])
        share = ((at[level - 1] - low) / (high - low))[:, np.newaxis]
        row = (1 - share) * row[:-1] + share * row[1:]
    return np.asarray(row[0], dtype=np.float64)


def _flat_pieces(beziers: FloatArray) -> FloatArray:
    """Halve Bézier pieces until their control points keep to the chord.

    Args:
        beziers: Control points (x·w, y·w, w), shape (pieces, degree + 1, 3).

    Returns:
        Control points (x, y) in the order of travel, shape (more pieces, degree + 1, 2).
    """
    pending, places, step = beziers, np.arange(float(len(beziers))), 1.0
    flat_hulls: list[FloatArray] = []
    flat_places: list[FloatArray] = []
    n_pieces = len(beziers)
    while len(pending):
        hulls = pending[..., :2] / pending[..., 2:]
        off_mm = _off_chords(hulls)
        is_flat = (off_mm <= SAGITTA_MM) & ((off_mm <= STRAIGHT_MM) | (_turns(hulls) != 0))
        flat_hulls.append(hulls[is_flat])
        flat_places.append(places[is_flat])
        pending, places, step = _halves(pending[~is_flat]), places[~is_flat], step / 2
        # the second half of a piece comes half of its share of the way later
        places = np.concatenate((places, places + step))
        n_pieces += len(pending) // 2
        limits.hold(
            "straight pieces for one curve", n_pieces, limits.MAX_CURVE_STEPS, "check the unit"
        )
    order = np.argsort(np.concatenate(flat_places))
    return np.asarray(np.concatenate(flat_hulls)[order])


def _off_chords(hulls: FloatArray) -> FloatArray:
    """How far the control points of each piece are from the segment between its ends."""
    chords_mm = hulls[:, -1:] - hulls[:, :1]
    from_start_mm = hulls - hulls[:, :1]
    length2_mm2 = (chords_mm**2).sum(axis=-1)
    along_mm2 = (from_start_mm * chords_mm).sum(axis=-1)
    shares = np.divide(along_mm2, length2_mm2, out=np.zeros_like(along_mm2), where=length2_mm2 > 0)
    nearest_mm = np.clip(shares, 0.0, 1.0)[..., np.newaxis] * chords_mm
    off_mm = np.hypot(*np.moveaxis(from_start_mm - nearest_mm, -1, 0))
    return np.asarray(off_mm.max(axis=-1))


def _turns(hulls: FloatArray) -> IntArray:
    """To which side each piece turns: 1 to the left, -1 to the right, 0 to both or to neither."""
    sides_mm = np.diff(hulls, axis=1)
    before, after = sides_mm[:, :-1], sides_mm[:, 1:]
    crosses = before[..., 0] * after[..., 1] - before[..., 1] * after[..., 0]
    turns_left, turns_right = (crosses > 0).any(axis=-1), (crosses < 0).any(axis=-1)
    return np.asarray(turns_left.astype(np.int64) - turns_right)


def _halves(beziers: FloatArray) -> FloatArray:
    """Bézier pieces cut at the middle parameter (de Casteljau): first halves, then second ones."""
    rows = [beziers]
    while rows[-1].shape[1] > 1:
        rows.append((rows[-1][:, :-1] + rows[-1][:, 1:]) / 2)
    first = np.stack([row[:, 0] for row in rows], axis=1)
    second = np.stack([row[:, -1] for row in reversed(rows)], axis=1)
    return np.concatenate((first, second))


def _radii_at(u: Point, v: Point, turn_rad: float) -> tuple[Point, Point]:
    """The conjugate radii a turn further along; a turn of zero changes no bit."""
    cos, sin = math.cos(turn_rad), math.sin(turn_rad)
    return (
        (u[0] * cos + v[0] * sin, u[1] * cos + v[1] * sin),
        (v[0] * cos - u[0] * sin, v[1] * cos - u[1] * sin),
    )


def _longest_radius(u: Point, v: Point) -> float:
    """Half the major axis of the ellipse: the greater singular value of the matrix [u v]."""
    total = (u[0] ** 2 + u[1] ** 2 + v[0] ** 2 + v[1] ** 2) / 2
    area = u[0] * v[1] - u[1] * v[0]
    return math.sqrt(total + math.sqrt(max(total * total - area * area, 0.0)))
