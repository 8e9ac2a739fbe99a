"""Write a route into a DXF drawing.

The input is kept, or drawn, underneath as for an area of interest. On top come:

    SATAOI-ROBOT   the robot at intervals: arm and disc, the vehicle, an arrow along its heading
    SATAOI-ROUTE   the way of the disc's centre from a small ring at the start, the disc at the
                   end, and a cross at the point that was asked for
    SATAOI-START   the disc where the robot is set down
    SATAOI-NOTE    legend and figures beside the plan

Whatever this program drew before is replaced.
"""

import math
from pathlib import Path, PurePath
from typing import Final

import numpy as np
from ezdxf.layouts import Modelspace

from satAOI_adapters.dxf_write.layers import ROBOT, ROUTE, ROUTE_STYLES, START
from satAOI_adapters.dxf_write.legend import Row, Swatch, point_in_words
from satAOI_adapters.dxf_write.metadata import attach
from satAOI_adapters.dxf_write.output import drawing
from satAOI_adapters.dxf_write.pen import Pen
from satAOI_adapters.dxf_write.scene import draw_start
from satAOI_adapters.route_write import lines_of
from satAOI_geo.aoi import Loop
from satAOI_geo.pipeline import Result
from satAOI_geo.plan import FloatArray
from satAOI_geo.robot import Part, Pose, Robot, unit
from satAOI_geo.route import MoveKind, Route

ARROW: Final = ((0.1, -0.2), (0.4, 0.0), (0.1, 0.2))
"""The arrow in the vehicle: ahead and to the left of its centre, in its lengths and widths."""

RING: Final = 1 / 8
"""Of the mark where the way begins, in radii of the disc."""


def write(path: Path, result: Result, route: Route) -> None:
    """Write the input drawing with a route drawn into it.

    The same route gives the same bytes.

    Args:
        path: The DXF file to write.
        result: The area of interest and the plan it was found on.
        route: A route found on the result's search.

    Raises:
        InputError: If the file must not or cannot be written.
        UnreadableError: If the input drawing is gone or was changed since it was read.
    """
    with drawing(path, result, ROUTE_STYLES, note_rows(result, route)) as space:
        draw_robots(space, result, route)
        draw_way(space, result, route)
        draw_start(space, result)


def draw_robots(space: Modelspace, result: Result, route: Route) -> None:
    """Draw the robot at intervals: arm and disc as one loop, the vehicle as another."""
    pen, robot, poses = Pen(space, result.plan.frame, ROBOT.name), result.robot, route.poses()
    for number in shown(route, result.robot):
        pose = poses[number]
        arm, heading = unit(pose.a1_rad), unit(pose.a1_rad + pose.a2_rad)
        vehicle = robot.vehicle(arm, heading).moved(pose.x_mm, pose.y_mm)
        for part, entity in (
            ("arm", pen.loop(capsule_outline(robot, pose))),
            ("vehicle", pen.ring(np.vstack((vehicle.corners_mm, vehicle.corners_mm[:1])))),
            ("heading", pen.chain(arrow(robot, vehicle, heading))),
        ):
            attach(entity, {"part": part, "state": number})


def draw_way(space: Modelspace, result: Result, route: Route) -> None:
    """Draw the way of the disc's centre, where it begins, where it ends, and what for."""
    pen, disc_mm = Pen(space, result.plan.frame, ROUTE.name), result.robot.disc_radius_mm
    corners_mm = way(route)
    if len(corners_mm) > 1:
        facts = {"length_mm": route.length_mm, "n_moves": len(route.moves())}
        attach(pen.chain(corners_mm), facts)
    pen.circle(corners_mm[0], RING * disc_mm)
    pen.circle(corners_mm[-1], disc_mm)
    x_mm, y_mm = route.to_mm
    arm_mm = RING * disc_mm
    pen.chain([(x_mm - arm_mm, y_mm - arm_mm), (x_mm + arm_mm, y_mm + arm_mm)])
    pen.chain([(x_mm - arm_mm, y_mm + arm_mm), (x_mm + arm_mm, y_mm - arm_mm)])


def shown(route: Route, robot: Robot) -> list[int]:
    """The states to draw the robot at, by number: the first, the last and some between them.

    One follows another when the disc has travelled the robot's reach, so that robots on a straight
    way hardly overlap, or when arm or vehicle stand a quarter of a turn from where they were drawn
    last.
    """
    poses, moves = route.poses(), route.moves()
    # angles are whole directions: half of one decides whatever the rounding
    quarter_rad = math.pi / 2 - math.pi / route.lattice.n_directions
    numbers, n_steps = [0], 0
    for number, move in enumerate(moves, start=1):
        n_steps += move is MoveKind.STEP
        travelled = n_steps * route.lattice.step_mm >= robot.reach_mm
        if travelled or turned_rad(poses[numbers[-1]], poses[number]) > quarter_rad:
            numbers.append(number)
            n_steps = 0
    return numbers if numbers[-1] == len(moves) else [*numbers, len(moves)]


def turned_rad(a: Pose, b: Pose) -> float:
    """How far arm or vehicle have turned, whichever more."""
    arm_rad = b.a1_rad - a.a1_rad
    return max(abs(arm_rad), abs(arm_rad + b.a2_rad - a.a2_rad))


def way(route: Route) -> FloatArray:
    """Corners of the disc's way, its ends included, shape (n, 2); one where it stays in place."""
    nodes = np.array([(state.ix, state.iy) for state in route.states])
    moved = np.diff(nodes, axis=0).any(axis=1)
    nodes = nodes[np.append(True, moved)]
    steps = np.diff(nodes, axis=0)
    # all steps are one cell long, so those that differ have different directions
    is_corner = np.ones(len(nodes), dtype=np.bool_)
    is_corner[1:-1] = (steps[1:] != steps[:-1]).any(axis=1)
    lattice = route.lattice
    return np.array([(lattice.x_mm(ix), lattice.y_mm(iy)) for ix, iy in nodes[is_corner]])


def capsule_outline(robot: Robot, pose: Pose) -> Loop:
    """The outline of arm and disc, counter-clockwise: two straight lines and two half circles."""
    arm = unit(pose.a1_rad)
    begin_mm, end_mm = robot.capsule(arm).moved(pose.x_mm, pose.y_mm).corners_mm
    left_mm = robot.disc_radius_mm * np.array((-arm[1], arm[0]))
    corners_mm = (begin_mm - left_mm, end_mm - left_mm, end_mm + left_mm, begin_mm + left_mm)
    half_circle = 1.0
    return Loop(np.column_stack((corners_mm, (0.0, half_circle, 0.0, half_circle))))


def arrow(robot: Robot, vehicle: Part, heading: FloatArray) -> FloatArray:
    """An arrow head in the vehicle that points where it is heading, shape (3, 2)."""
    ahead_mm = robot.vehicle_length_mm * heading
    left_mm = robot.vehicle_width_mm * np.array((-heading[1], heading[0]))
    shape = np.array(ARROW) @ np.stack((ahead_mm, left_mm))
    points_mm: FloatArray = vehicle.corners_mm.mean(axis=0) + shape
    return points_mm


def note_rows(result: Result, route: Route) -> list[Row]:
    """The legend and the figures, from the top."""
    source, frame = result.report.input, result.plan.frame
    x_mm, y_mm = frame.to_drawing_mm(route.to_mm).tolist()
    begin, end = (
        point_in_words(at_mm, frame.mm_per_unit, source.unit)
        for at_mm in (result.report.start.xy_mm, (x_mm, y_mm))
    )
    samples = {"length": Swatch(ROUTE.colour, ROUTE.lineweight)}
    return [
        Row("Route of the robot"),
        *(Row(label.capitalize(), value, samples.get(label)) for label, value in lines_of(route)),
        Row("Start of the disc", begin, Swatch(START.colour, START.lineweight, is_round=True)),
        Row("To trowel", end),
        Row("Robot", result.robot.name, Swatch(ROBOT.colour, ROBOT.lineweight)),
        Row("Drawn every", f"{result.robot.reach_mm:.0f} mm or quarter of a turn"),
        Row("Drawing", PurePath(source.path).name or source.format),
    ]
