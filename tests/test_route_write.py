"""Routes written: poses that can be driven, outlines of the robot, a drawing kept whole."""

import itertools
import json
import math
import os
import subprocess
import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from ezdxf.document import Drawing
from ezdxf.entities import DXFEntity, LWPolyline
from pydantic import TypeAdapter

from satAOI_adapters import read_plan, write_route
from satAOI_adapters.dxf_write.route import capsule_outline, shown, turned_rad, way
from satAOI_adapters.files import json_of
from satAOI_adapters.route_write import RouteFigures, n_moves
from satAOI_geo.aoi import Loop
from satAOI_geo.collision import Collider
from satAOI_geo.errors import InputError
from satAOI_geo.lattice import Lattice
from satAOI_geo.pipeline import Result, area_of_interest
from satAOI_geo.plan import FloorPlan
from satAOI_geo.program import main
from satAOI_geo.reach import State
from satAOI_geo.robot import PROTOTYPE, Pose
from satAOI_geo.route import MoveKind, Route, RouteMap
from satAOI_geo.settings import Settings
from satAOI_geo.start import StartMark
from tests import plans

ROOT = Path(__file__).parents[1]
DISC_MM, ARM_MM = PROTOTYPE.disc_radius_mm, PROTOTYPE.arm_length_mm
CAPSULE_MM2 = 2 * DISC_MM * (ARM_MM - DISC_MM) + math.pi * DISC_MM**2
VEHICLE_MM2 = PROTOTYPE.vehicle_length_mm * PROTOTYPE.vehicle_width_mm
COARSE = ("--step", "50", "--quiet")


def drawn_hall(file: Path) -> Path:
    """In metres, far from the origin, turned by 20°, two blocks and a wall between the ends.

    5 ┌──────────────┐
      │ ×   │        │
      │     │   ■    │    the wall leaves 2.2 m below it
      │              │
    0 └──────────────┘
      0     3        7.5
    """
    document = ezdxf.new("R2018", units=6)
    space = document.modelspace()
    cos, sin = math.cos(math.radians(20)), math.sin(math.radians(20))
    for layer, left, bottom, right, top in (
        ("FLOOR", 0.0, 0.0, 7.5, 5.0),
        ("WALL", 3.0, 2.2, 3.1, 5.0),
        ("COLUMN", 5.2, 2.4, 5.5, 2.7),
    ):
        corners = ((left, bottom), (right, bottom), (right, top), (left, top))
        points = [(500.0 + x * cos - y * sin, -80.0 + x * sin + y * cos) for x, y in corners]
        space.add_lwpolyline(points, close=True, dxfattribs={"layer": layer})
    space.add_text("HALL 墙", height=0.2).set_placement((500.5, -79.0))
    document.saveas(file)
    return file


def in_hall(x: float, y: float) -> tuple[float, float]:
    """A point of the hall in the drawing's units."""
    cos, sin = math.cos(math.radians(20)), math.sin(math.radians(20))
    return 500.0 + x * cos - y * sin, -80.0 + x * sin + y * cos


@pytest.fixture(scope="module")
def hall(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return drawn_hall(tmp_path_factory.mktemp("hall") / "hall.dxf")


@pytest.fixture(scope="module")
def found(hall: Path) -> tuple[Result, Route]:
    """A route from the left part of the hall around the wall to the right one."""
    plan = read_plan(hall)
    x_mm, y_mm = plan.frame.to_local_mm(in_hall(1.0, 4.0)).tolist()
    result = area_of_interest(plan, settings=Settings(step_mm=50.0), start=StartMark((x_mm, y_mm)))
    to_mm = result.plan.frame.to_local_mm(in_hall(6.8, 4.5)).tolist()
    return result, RouteMap(result.search).to(tuple(to_mm))


def on_layer(document: Drawing, layer: str) -> list[DXFEntity]:
    return [entity for entity in document.modelspace() if entity.dxf.layer == layer]


def facts_of(entity: DXFEntity) -> dict[str, object]:
    _, *tags = entity.get_xdata("SATAOI")
    values = [tag.value for tag in tags]
    return dict(zip(values[::2], values[1::2], strict=True))


def outlines(document: Drawing, part: str) -> list[LWPolyline]:
    """The polylines that show a part of the robot."""
    robots = on_layer(document, "SATAOI-ROBOT")
    return [entity for entity in robots if facts_of(entity)["part"] == part]


def area_mm2(outline: LWPolyline, mm_per_unit: float) -> float:
    assert outline.closed
    return Loop(np.array(outline.get_points("xyb"))).area_mm2() * mm_per_unit**2


@pytest.fixture
def drawing(found: tuple[Result, Route], tmp_path: Path) -> Drawing:
    write_route(tmp_path / "route.dxf", *found)
    return ezdxf.readfile(tmp_path / "route.dxf")


@pytest.fixture
def figures(found: tuple[Result, Route], tmp_path: Path) -> dict:
    write_route(tmp_path / "route.json", *found)
    return json.loads((tmp_path / "route.json").read_text(encoding="utf-8"))


# --- the poses -------------------------------------------------------------------------------


def test_poses_driven_again_touch_nothing(figures: dict, hall: Path) -> None:
    plan = read_plan(hall)
    collider = Collider(plan, PROTOTYPE)
    poses = np.array([_in_plan(plan, state) for state in figures["states"]])
    n_tried = 0
    for begin, end in itertools.pairwise(poses):
        way_mm, turn_rad = math.dist(begin[:2], end[:2]), np.abs(end - begin)[2:].max()
        n = max(math.ceil(way_mm / 5.0), math.ceil(turn_rad / math.radians(1)))
        for share in np.linspace(0, 1, n + 1):
            assert collider.is_free(Pose(*(begin + share * (end - begin)).tolist()))
            n_tried += 1
    assert n_tried > len(poses)


def _in_plan(plan: FloorPlan, state: dict) -> tuple[float, float, float, float]:
    """x_mm, y_mm, a1_rad and a2_rad in the frame of a plan, from a pose in the drawing's axes."""
    xy = np.array(state["xy_mm"]) / plan.frame.mm_per_unit
    x_mm, y_mm = plan.frame.to_local_mm(xy).tolist()
    a1_rad = math.radians(state["a1_deg"]) - plan.frame.turn_rad
    return x_mm, y_mm, a1_rad, math.radians(state["a2_deg"])


def test_the_last_disc_covers_the_point_that_was_asked_for(figures: dict) -> None:
    asked_mm = [1000.0 * value for value in in_hall(6.8, 4.5)]
    assert figures["goal"]["point_mm"] == pytest.approx(asked_mm, abs=1e-6)
    assert math.dist(figures["goal"]["xy_mm"], asked_mm) <= DISC_MM + 1e-6


def test_the_ends_are_those_of_the_states(figures: dict, found: tuple[Result, Route]) -> None:
    first, last = figures["states"][0], figures["states"][-1]
    assert first == {**figures["start"], "move": None}
    assert {**last, "point_mm": figures["goal"]["point_mm"]} == {
        **figures["goal"],
        "move": last["move"],
    }
    report = json.loads(json_of(found[0].report.start))
    assert {key: report[key] for key in figures["start"]} == figures["start"]


def test_each_move_is_what_changes(figures: dict) -> None:
    step_mm, turn_deg = 50.0, 360.0 / 24
    change = {
        "step": (step_mm, 0.0, 0.0),
        "turn": (0.0, turn_deg, 0.0),
        "swing": (0.0, 0.0, turn_deg),
        "orbit": (0.0, turn_deg, turn_deg),
    }
    for a, b in itertools.pairwise(figures["states"]):
        moved_mm = math.dist(a["xy_mm"], b["xy_mm"])
        turned_deg = [abs(b[angle] - a[angle]) for angle in ("a1_deg", "a2_deg")]
        assert (moved_mm, *turned_deg) == pytest.approx(change[b["move"]], abs=1e-6)


def test_the_length_is_that_of_the_steps(figures: dict) -> None:
    moves = Counter(state["move"] for state in figures["states"][1:])
    assert figures["n_moves"] == {kind.value: moves[kind.value] for kind in MoveKind}
    assert figures["length_mm"] == pytest.approx(50.0 * moves["step"], rel=1e-12)


def test_the_json_is_of_its_schema(found: tuple[Result, Route], tmp_path: Path) -> None:
    file = tmp_path / "route.json"
    write_route(file, *found)
    read = TypeAdapter(RouteFigures).validate_json(file.read_bytes())
    assert read.schema == "sataoi-route/1"
    assert read.input.sha256 == found[0].plan.source.sha256


# --- moves and outlines ----------------------------------------------------------------------


def turning() -> Route:
    """Three steps up, a full turn of arm and vehicle on the spot, a swing, an orbit, one step."""
    lattice = Lattice.over((0.0, 0.0, 8000.0, 8000.0), PROTOTYPE, step_mm=50.0)
    up = [State(iy, 40, 0, 6) for iy in (40, 41, 42, 43)]
    round_about = [State(43, 40, k % 24, 6) for k in range(1, 25)]
    rest = [State(43, 40, 0, 7), State(43, 40, 1, 6), State(43, 41, 1, 6)]
    return Route(lattice, (*up, *round_about, *rest), (0.0, 0.0))


def test_moves_have_the_kinds_of_their_changes() -> None:
    kinds = [MoveKind.STEP] * 3 + [MoveKind.TURN] * 24
    assert turning().moves() == [*kinds, MoveKind.SWING, MoveKind.ORBIT, MoveKind.STEP]
    assert n_moves(turning()) == {"step": 4, "turn": 24, "swing": 1, "orbit": 1}


def test_a_robot_that_turns_on_the_spot_is_drawn_every_quarter() -> None:
    assert shown(turning(), PROTOTYPE) == [0, 9, 15, 21, 27, 30]


def test_the_way_has_its_corners_only() -> None:
    assert way(turning()).tolist() == [[2025, 2025], [2025, 2175], [2075, 2175]]


def test_a_robot_that_stays_in_place_has_a_way_of_one_point() -> None:
    route = replace(turning(), states=turning().states[3:10])
    assert way(route).tolist() == [[2025, 2175]]


def test_an_arm_as_long_as_the_disc_s_radius_is_outlined_as_a_disc() -> None:
    stub = replace(PROTOTYPE, arm_length_mm=DISC_MM)
    outline = capsule_outline(stub, Pose(0.0, 0.0, 1.0, 0.0))
    assert outline.area_mm2() == pytest.approx(math.pi * DISC_MM**2, rel=1e-12)


# --- the drawing -----------------------------------------------------------------------------


def test_outlines_have_the_areas_of_the_robot_s_parts(drawing: Drawing) -> None:
    arms, vehicles = outlines(drawing, "arm"), outlines(drawing, "vehicle")
    assert len(arms) == len(vehicles) > 4
    for arm, vehicle in zip(arms, vehicles, strict=True):
        # coordinates of 500 m in doubles leave 1e-10 m
        assert area_mm2(arm, 1000.0) == pytest.approx(CAPSULE_MM2, rel=1e-9)
        assert area_mm2(vehicle, 1000.0) == pytest.approx(VEHICLE_MM2, rel=1e-9)


def test_robots_are_drawn_at_the_first_and_last_state_and_not_far_apart(
    drawing: Drawing, found: tuple[Result, Route]
) -> None:
    _, route = found
    states = [facts_of(arm)["state"] for arm in outlines(drawing, "arm")]
    assert states[0] == 0
    assert states[-1] == len(route.states) - 1
    poses = route.poses()
    for a, b in itertools.pairwise(states):
        steps = route.moves()[a:b].count(MoveKind.STEP)
        assert steps * 50.0 < PROTOTYPE.reach_mm + 50.0
        assert turned_rad(poses[a], poses[b]) < math.pi / 2 + 1e-9


def test_robots_stand_where_their_states_say(drawing: Drawing, figures: dict) -> None:
    for arm in outlines(drawing, "arm"):
        state = figures["states"][facts_of(arm)["state"]]
        corners_mm = 1000.0 * np.array(arm.get_points("xy"))
        # the first and the last corner end the disc's diameter
        assert (corners_mm[0] + corners_mm[3]) / 2 == pytest.approx(state["xy_mm"], abs=1e-4)


def test_arrows_lie_in_their_vehicles_and_point_ahead(drawing: Drawing, figures: dict) -> None:
    headings = outlines(drawing, "heading")
    for arrow, vehicle in zip(headings, outlines(drawing, "vehicle"), strict=True):
        state = figures["states"][facts_of(arrow)["state"]]
        yaw_rad = math.radians(state["a1_deg"] + state["a2_deg"])
        tail, tip, other_tail = np.array(arrow.get_points("xy"))
        ahead = tip - (tail + other_tail) / 2
        assert math.atan2(ahead[1], ahead[0]) == pytest.approx(
            math.remainder(yaw_rad, 2 * math.pi), abs=1e-6
        )
        centre = np.mean(vehicle.get_points("xy"), axis=0)
        assert np.hypot(*(tip - centre)) == pytest.approx(0.4 * 0.875, rel=1e-6)


def test_the_way_leads_from_the_start_to_the_disc_at_the_end(
    drawing: Drawing, figures: dict
) -> None:
    path, ring, disc, *cross = on_layer(drawing, "SATAOI-ROUTE")
    corners_mm = 1000.0 * np.array(path.get_points("xy"))
    assert corners_mm[0] == pytest.approx(figures["start"]["xy_mm"], abs=1e-4)
    assert corners_mm[-1] == pytest.approx(figures["goal"]["xy_mm"], abs=1e-4)
    length_mm = np.hypot(*np.diff(corners_mm, axis=0).T).sum()
    assert length_mm == pytest.approx(figures["length_mm"], rel=1e-6)
    assert 1000.0 * np.array(ring.dxf.center)[:2] == pytest.approx(corners_mm[0], abs=1e-4)
    assert 1000.0 * np.array(disc.dxf.center)[:2] == pytest.approx(corners_mm[-1], abs=1e-4)
    assert disc.dxf.radius == pytest.approx(DISC_MM / 1000.0)
    for line in cross:
        middle_mm = 1000.0 * np.mean(line.get_points("xy"), axis=0)
        assert middle_mm == pytest.approx(figures["goal"]["point_mm"], abs=1e-4)


def test_the_note_tells_length_moves_and_turns(drawing: Drawing, figures: dict) -> None:
    texts = [entity.text for entity in on_layer(drawing, "SATAOI-NOTE") if "text" in dir(entity)]
    n_turns = sum(figures["n_moves"].values()) - figures["n_moves"]["step"]
    assert texts[texts.index("Length") + 1] == f"{figures['length_mm'] / 1000:.2f} m"
    assert texts[texts.index("Moves") + 1] == str(len(figures["states"]) - 1)
    assert texts[texts.index("Turns") + 1].split()[0] == str(n_turns)


def test_the_input_is_kept_whole_underneath(drawing: Drawing, hall: Path) -> None:
    before = [entity.dxf.handle for entity in ezdxf.readfile(hall).modelspace()]
    after = [entity.dxf.handle for entity in drawing.modelspace()]
    assert after[: len(before)] == before
    assert {entity.dxf.layer for entity in drawing.modelspace()} == {
        *("FLOOR", "WALL", "COLUMN", "0"),
        *("SATAOI-ROUTE", "SATAOI-ROBOT", "SATAOI-START", "SATAOI-NOTE"),
    }


def test_the_drawing_audits_clean_and_is_of_a_version_with_true_colours(drawing: Drawing) -> None:
    auditor = drawing.audit()
    assert (auditor.errors, auditor.fixes) == ([], [])
    assert drawing.dxfversion >= "AC1024"


def test_read_again_it_is_the_same_plan_with_the_start_marked(
    found: tuple[Result, Route], hall: Path, tmp_path: Path
) -> None:
    write_route(tmp_path / "route.dxf", *found)
    plan, again = read_plan(hall), read_plan(tmp_path / "route.dxf")
    assert again.floor.equals(plan.floor)
    assert [obstacle.shape for obstacle in again.obstacles] == [o.shape for o in plan.obstacles]
    start_mm = again.frame.to_drawing_mm(again.start_mm)
    assert start_mm == pytest.approx(found[0].report.start.xy_mm, abs=1e-4)


def test_a_route_in_a_plan_without_a_drawing_is_drawn_on_a_plan(tmp_path: Path) -> None:
    result = area_of_interest(plans.room().plan, settings=Settings(step_mm=100.0))
    route = RouteMap(result.search).to((3000.0, 1000.0))
    write_route(tmp_path / "route.dxf", result, route)
    assert len(on_layer(ezdxf.readfile(tmp_path / "route.dxf"), "FLOOR")) == 1


def test_the_input_is_never_written_over(found: tuple[Result, Route], hall: Path) -> None:
    before = hall.read_bytes()
    with pytest.raises(InputError, match="is an input"):
        write_route(hall, *found)
    assert hall.read_bytes() == before


# --- the command line ------------------------------------------------------------------------


def at(x: float, y: float) -> str:
    return ",".join(f"{value:.6f}" for value in in_hall(x, y))


def test_two_runs_write_the_same_bytes(hall: Path, tmp_path: Path) -> None:
    for seed in ("1", "2"):
        (tmp_path / seed).mkdir()
        code = "import sys; from satAOI_geo.program import main; sys.exit(main(sys.argv[1:]))"
        drawing, poses = (str(tmp_path / seed / name) for name in ("route.dxf", "route.json"))
        asked = ["route", str(hall), "--to", at(6.8, 4.5), *COARSE, "-o", drawing, "-o", poses]
        path = os.pathsep.join((str(ROOT), str(ROOT / "adapters")))
        subprocess.run(
            [sys.executable, "-W", "error", "-c", code, *asked],
            check=True,
            env={**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": path},
        )
    for name in ("route.dxf", "route.json"):
        assert (tmp_path / "1" / name).read_bytes() == (tmp_path / "2" / name).read_bytes()


def test_the_figures_are_the_output_where_no_other_is_asked_for(
    hall: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["route", str(hall), "--to", at(6.8, 4.5), *COARSE]) == 0
    said = capsys.readouterr()
    assert [line.split()[0] for line in said.out.splitlines()] == ["length", "moves", "turns"]
    assert said.err == ""


def test_what_was_written_is_told(
    hall: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = tmp_path / "route.json"
    told = ["route", str(hall), "--to", at(6.8, 4.5), "--step", "50", "-o", str(output)]
    assert main(told) == 0
    said = capsys.readouterr()
    assert said.out == ""
    assert f"wrote {output}" in said.err
    assert list(tmp_path.iterdir()) == [output]


@pytest.mark.parametrize(
    ("arguments", "code", "complaint"),
    [
        (["--to", at(5.35, 2.55)], 4, "This point lies in column"),
        (["--to", at(0.01, 0.01)], 4, "This point is left over"),
        (["--to", at(-3.0, 0.0)], 4, "This point is not on the floor"),
        (["--to", "nan,inf"], 2, "'nan,inf' is not two numbers"),
        (["--to", at(6.8, 4.5), "--start", at(5.35, 2.55)], 4, "in the way"),
        (["--to", "7"], 2, "'7' is not two numbers with a comma"),
        ([], 2, "--to"),
        (["--to", at(6.8, 4.5), "-o", "route.png"], 2, "must end in .dxf or .json"),
        (["--to", at(6.8, 4.5), "-o", "r.dxf", "-o", "r.dxf"], 2, "asked for twice"),
        (["--to", at(6.8, 4.5), "-o", "nowhere/r.dxf"], 2, "no folder 'nowhere'"),
        (["--to", at(6.8, 4.5), "--connectivity", "disc"], 2, "made of motions"),
    ],
)
def test_bad_input_is_one_line_and_an_exit_code(
    arguments: list[str],
    code: int,
    complaint: str,
    hall: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["route", str(hall), *COARSE, *arguments]) == code
    said = capsys.readouterr()
    (line,) = said.err.splitlines()
    assert line.startswith("error: ")
    assert complaint in line
    assert said.out == ""
    assert list(tmp_path.iterdir()) == []
