"""A route as JSON for programs and as lines for people."""

import math
from collections import Counter
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Literal

from satAOI_adapters.files import json_of, written_whole
from satAOI_geo.pipeline import Result
from satAOI_geo.report import InputFigures, LatticeFigures, PoseFigures, RobotFigures
from satAOI_geo.route import MoveKind, Route
from satAOI_geo.units import MM_PER_UNIT

Line = tuple[str, str]
"""A label and what is said under it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StateFigures(PoseFigures):
    """Where the robot stands, and the move that led there, null for the first.

    Angles run on past a full turn where the robot does, so that what lies between two states in
    a row is found by interpolation.
    """

    move: MoveKind | None


@dataclass(frozen=True, slots=True, kw_only=True)
class GoalFigures(PoseFigures):
    """Where the robot stands last, and the point that its disc trowels there."""

    point_mm: tuple[float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class RouteFigures:
    """A route; lengths and places in mm in the drawing's axes."""

    schema: Literal["sataoi-route/1"] = "sataoi-route/1"
    input: InputFigures
    robot: RobotFigures
    lattice: LatticeFigures
    start: PoseFigures
    goal: GoalFigures
    length_mm: float
    n_moves: dict[MoveKind, int]
    states: list[StateFigures]


def write(path: Path, result: Result, route: Route) -> None:
    """Write a route as JSON; the same route gives the same bytes.

    Args:
        path: The file to write.
        result: The area of interest and the plan it was found on.
        route: A route found on the result's search.

    Raises:
        InputError: If the file cannot be written or is the plan itself.
    """
    figures = figures_of(result, route)
    inputs = [Path(figures.input.path)] if figures.input.path else []
    with written_whole(path, never_over=inputs) as stream:
        stream.write(json_of(figures).encode())


def figures_of(result: Result, route: Route) -> RouteFigures:
    """The figures of a route."""
    report = result.report
    poses = _in_drawing(result, route)
    x_mm, y_mm = result.plan.frame.to_drawing_mm(route.to_mm).tolist()
    return RouteFigures(
        input=report.input,
        robot=report.robot,
        lattice=report.lattice,
        start=poses[0],
        goal=GoalFigures(**asdict(poses[-1]), point_mm=(x_mm, y_mm)),
        length_mm=route.length_mm,
        n_moves=n_moves(route),
        states=[
            StateFigures(**asdict(pose), move=move)
            for pose, move in zip(poses, [None, *route.moves()], strict=True)
        ],
    )


def n_moves(route: Route) -> dict[MoveKind, int]:
    """How many moves of each kind, all kinds named."""
    counts = Counter(route.moves())
    return {kind: counts[kind] for kind in MoveKind}


def lines_of(route: Route) -> list[Line]:
    """The figures a person asks for first."""
    counts = n_moves(route)
    n_turns = sum(counts.values()) - counts[MoveKind.STEP]
    kinds = ", ".join(f"{n} {kind}" for kind, n in counts.items() if kind is not MoveKind.STEP)
    return [
        ("length", f"{route.length_mm / MM_PER_UNIT['m']:.2f} m"),
        ("moves", str(sum(counts.values()))),
        ("turns", f"{n_turns} ({kinds})" if n_turns else "0"),
    ]


def _in_drawing(result: Result, route: Route) -> list[PoseFigures]:
    """The poses of a route in the drawing's axes, its first direction within a full turn."""
    frame, poses = result.plan.frame, route.poses()
    at_mm = frame.to_drawing_mm([(pose.x_mm, pose.y_mm) for pose in poses]).tolist()
    a1_deg = [math.degrees(pose.a1_rad + frame.turn_rad) for pose in poses]
    whole_turns_deg = 360.0 * math.floor(a1_deg[0] / 360.0)
    return [
        PoseFigures(
            xy_mm=(x_mm, y_mm),
            node=(state.iy, state.ix),
            a1_deg=direction_deg - whole_turns_deg,
            a2_deg=math.degrees(pose.a2_rad),
        )
        for (x_mm, y_mm), direction_deg, pose, state in zip(
            at_mm, a1_deg, poses, route.states, strict=True
        )
    ]
