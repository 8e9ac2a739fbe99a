"""Many plans in one go: each gets what `run` gives it, and none stops the others."""

import contextlib
import csv
import json
import multiprocessing
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Generator, Iterable, Iterator
from pathlib import Path

import pytest

from satAOI_adapters import batch
from satAOI_adapters.batch_results import Row, earlier_rows
from satAOI_adapters.cluster import InTurn, Outcome, workers
from satAOI_geo.errors import InputError, LimitError
from satAOI_geo.program import main
from tests.command_line import drawn_room, the_error

COARSE = ["--step", "100", "--directions", "8"]
BAD = 3

WRITER = """
import json, pathlib, sys
output, report, _, _, plan = sys.argv[-5:]
text = pathlib.Path(plan).read_text()
if text == "bad":
    sys.exit("error: it is bad")
pathlib.Path(output.partition("=")[2]).write_text("sataoi-dxf/1")
figures = {"area_m2": len(text), "percent_of_free": 50}
source = {"sha256": __import__("hashlib").sha256(text.encode()).hexdigest()}
told = json.dumps({"aoi": figures, "findings": [1], "input": source})
pathlib.Path(report.partition("=")[2]).write_text(told)
"""
"""Stands for the program where only the batch is tried: the area is the length of the plan."""


class Noting(InTurn):
    """Does the work in this process and notes which plans it was given."""

    def __init__(self) -> None:
        self.done: list[str] = []

    def outcomes(
        self, function: Callable[[batch.Task], Row], tasks: Iterable[batch.Task]
    ) -> Generator[Outcome[Row], None, None]:
        given = list(tasks)
        self.done = [task.plan for task in given]
        return super().outcomes(function, given)


class Lost:
    """Comes to nothing."""

    def __init__(self, error: Exception) -> None:
        self._error = error

    def outcomes(self, function: object, tasks: object) -> Iterator[Outcome[Row]]:  # noqa: ARG002
        yield Outcome(0, None, self._error)


@pytest.fixture(scope="module")
def rooms(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a batch of two rooms of the same name and a file that is no drawing.

    plans/east/room.dxf  plans/west/room.dxf  plans/west/torn.dxf
    """
    folder = tmp_path_factory.mktemp("rooms")
    for side, unit_mm in (("east", 1.0), ("west", 2.0)):
        (folder / "plans" / side).mkdir(parents=True)
        drawn_room(folder / "plans" / side / "room.dxf", unit_mm=unit_mm)
    (folder / "plans" / "west" / "torn.dxf").write_text("torn", encoding="utf-8")
    with contextlib.chdir(folder):
        assert batch_of("plans/**/*.dxf", "-q") == BAD
    return folder


@pytest.fixture
def texts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with two plans for the writer that stands for the program, and a bad one."""
    monkeypatch.setattr(batch, "PROGRAM", WRITER)
    monkeypatch.chdir(tmp_path)
    for name, text in (("a", "four"), ("b", "bad"), ("c", "eleven long")):
        (tmp_path / f"{name}.dxf").write_text(text, encoding="utf-8")
    (tmp_path / "layers.toml").touch()
    return tmp_path


def batch_of(*arguments: str) -> int:
    return main(["batch", *arguments, "--out-dir", "out", *COARSE])


def run_here(*options: str, again: bool = False) -> list[str]:
    """A batch of all texts in this process; the plans that were run."""
    plans, out_dir, here = batch.plans_of(["*.dxf"]), Path("out"), Noting()
    tasks = batch.tasks_of(plans, out_dir, options, [Path("layers.toml")])
    kept = {} if again else batch.rows_kept(tasks, earlier_rows(out_dir))
    batch.run_all(tasks, here, out_dir, kept=kept, told=lambda _: None)
    return here.done


def rows_of(folder: Path) -> dict[str, dict]:
    """The rows that were written, by the plan, but for the times."""
    results = json.loads((folder / "out" / "results.json").read_bytes())
    assert results["schema"] == "sataoi-batch/1"
    return {row["plan"]: {**row, "time_s": None} for row in results["rows"]}


def test_a_bad_plan_is_a_row_and_stops_no_other(rooms: Path) -> None:
    rows = rows_of(rooms)
    assert list(rows) == ["plans/east/room.dxf", "plans/west/room.dxf", "plans/west/torn.dxf"]
    assert [row["exit_code"] for row in rows.values()] == [0, 0, BAD]
    east, west, torn = rows.values()
    # the rooms are 4 × 4 m and 2 × 2 m in drawing units of 1 and of 2 mm
    assert west["area_m2"] < east["area_m2"] < 16
    assert torn["area_m2"] is None
    assert "not a DXF drawing" in torn["message"]


def test_plans_of_one_name_get_results_of_their_own_as_run_writes_them(
    rooms: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(rooms)
    drawing, report = tmp_path / "alone.dxf", tmp_path / "alone.json"
    outputs = ["-o", str(drawing), "--report", str(report), "--quiet"]
    for side in ("east", "west"):
        assert main(["run", f"plans/{side}/room.dxf", *outputs, *COARSE]) == 0
        assert Path(f"out/{side}/room.aoi.dxf").read_bytes() == drawing.read_bytes()
        together = json.loads(Path(f"out/{side}/room.aoi.json").read_bytes())
        alone = json.loads(report.read_bytes())
        del together["timing_s"], alone["timing_s"]
        assert together == alone


def test_a_batch_that_is_resumed_tells_a_person_and_programs_the_same(
    rooms: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(rooms)
    before = rows_of(rooms)
    assert batch_of("plans/**/*.dxf") == BAD
    assert rows_of(rooms) == before
    said = capsys.readouterr()
    assert [line.split()[0] for line in said.out.splitlines()] == ["plan", *before]
    assert "not a DXF drawing" in said.out.splitlines()[-1]
    assert said.err.splitlines() == [
        "note: results that were there already: 2; --again runs these plans, too",
        "note: wrote out/results.csv and out/results.json",
    ]
    with Path("out/results.csv").open(encoding="utf-8", newline="") as stream:
        table = {line["plan"]: line["area_m2"] for line in csv.DictReader(stream)}
    assert table == {plan: str(row["area_m2"] or "") for plan, row in before.items()}


def test_a_worker_killed_on_the_way_changes_no_result(
    rooms: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("distributed")
    psutil = pytest.importorskip("psutil")
    monkeypatch.chdir(rooms)
    before, killed = rows_of(rooms), []

    def works(worker: int) -> bool:
        """Whether it runs a plan; as it starts it may have other children."""
        with contextlib.suppress(psutil.NoSuchProcess):
            runs = [child.cmdline() for child in psutil.Process(worker).children()]
            return any(batch.PROGRAM in run for run in runs)
        return False

    def kill_the_first_that_works() -> None:
        while not killed:
            time.sleep(0.01)
            for process in multiprocessing.active_children():
                if works(process.pid):
                    process.kill()
                    killed.append(process.pid)

    killer = threading.Thread(target=kill_the_first_that_works, daemon=True)
    killer.start()
    assert batch_of("plans/**/*.dxf", "-q", "--again", "--workers", "1") == BAD
    assert killed
    assert rows_of(rooms) == before


def test_workers_of_a_scheduler_give_the_same_results(
    rooms: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("distributed")
    monkeypatch.chdir(rooms)
    before = rows_of(rooms)
    files = {file: file.read_bytes() for file in Path("out").rglob("*.dxf")}
    with workers(n_workers=2) as crew:
        address = crew._client.scheduler.address
        assert batch_of("plans/**/*.dxf", "-q", "--again", "--scheduler", address) == BAD
    assert rows_of(rooms) == before
    assert {file: file.read_bytes() for file in files} == files


@pytest.mark.usefixtures("texts")
def test_a_batch_without_workers_needs_no_dask(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert batch_of("*.dxf", "-q") == 1
    assert [row["exit_code"] for row in rows_of(Path()).values()] == [0, 1, 0]


def test_a_run_ends_with_the_process_that_started_it(tmp_path: Path) -> None:
    psutil = pytest.importorskip("psutil")
    run = """
import signal, time
# as where a script starts it in the background
signal.signal(signal.SIGINT, signal.SIG_IGN)
from satAOI_adapters.lifeline import end_with_the_caller
end_with_the_caller()
open("begun", "w").close()
time.sleep(60)
"""
    start = f"""
import sys
sys.path[:] = {sys.path}
from satAOI_adapters import batch
batch.PROGRAM = {run!r}
batch.run_plan(batch.Task("a", "b", "c", (), {str(tmp_path)!r}, "", ""))
"""
    caller = subprocess.Popen([sys.executable, "-c", start])
    while not (tmp_path / "begun").exists():
        assert caller.poll() is None
        time.sleep(0.05)
    runs = psutil.Process(caller.pid).children()
    caller.kill()
    caller.wait()
    assert psutil.wait_procs(runs, timeout=20) == (runs, [])


@pytest.mark.usefixtures("texts")
def test_only_what_is_not_done_is_run_when_a_batch_is_resumed(texts: Path) -> None:
    assert run_here() == ["a.dxf", "b.dxf", "c.dxf"]
    first = rows_of(texts)
    assert [row["area_m2"] for row in first.values()] == [4, None, 11]
    assert first["b.dxf"]["message"] == "it is bad"
    assert run_here() == ["b.dxf"]
    assert rows_of(texts) == first
    assert run_here(again=True) == ["a.dxf", "b.dxf", "c.dxf"]


def write(name: str, text: str) -> Callable[[], object]:
    return lambda: Path(name).write_text(text, encoding="utf-8")


@pytest.mark.parametrize(
    ("change", "run"),
    [
        (Path("out/a.aoi.dxf").unlink, ["a.dxf", "b.dxf"]),
        (write("out/a.aoi.json", ""), ["a.dxf", "b.dxf"]),
        (write("c.dxf", "other"), ["b.dxf", "c.dxf"]),
        (write("b.dxf", "mended"), ["b.dxf"]),
        (write("layers.toml", "other"), ["a.dxf", "b.dxf", "c.dxf"]),
        (write("out/results.json", "torn"), ["a.dxf", "b.dxf", "c.dxf"]),
        (Path("a.dxf").unlink, ["b.dxf"]),
    ],
    ids=[
        "a result",
        "an emptied result",
        "a plan",
        "the bad plan",
        "a settings file",
        "the results",
        "no plan",
    ],
)
@pytest.mark.usefixtures("texts")
def test_a_plan_is_run_again_when_something_changes(
    change: Callable[[], object], run: list[str]
) -> None:
    run_here("--step=20")
    change()
    assert run_here("--step=20") == run


@pytest.mark.usefixtures("texts")
def test_a_name_that_is_no_text_is_told_with_escapes() -> None:
    Path("a.dxf").rename("a\udcb6.dxf")
    assert run_here() == ["a\udcb6.dxf", "b.dxf", "c.dxf"]
    assert next(iter(rows_of(Path()))) == "a\\udcb6.dxf"
    assert run_here() == ["b.dxf"]


@pytest.mark.usefixtures("texts")
def test_another_option_or_version_is_another_question(monkeypatch: pytest.MonkeyPatch) -> None:
    run_here("--step=20")
    assert run_here("--step=10") == ["a.dxf", "b.dxf", "c.dxf"]
    monkeypatch.setattr("satAOI_geo.__version__", "99.0")
    assert run_here("--step=10") == ["a.dxf", "b.dxf", "c.dxf"]


@pytest.mark.usefixtures("texts")
def test_results_of_the_batch_are_no_plans() -> None:
    for _ in range(2):
        plans = batch.plans_of(["*.dxf"])
        tasks = batch.tasks_of(plans, Path(), [], [])
        assert [one.plan for one in tasks] == ["a.dxf", "b.dxf", "c.dxf"]
        batch.run_all(tasks, InTurn(), Path(), kept={}, told=lambda _: None)


@pytest.mark.usefixtures("texts")
def test_no_result_is_written_over_a_plan() -> None:
    Path("a.aoi.dxf").write_text("a plan", encoding="utf-8")
    Path("link").symlink_to(".")
    for given in (["*.dxf"], ["a.dxf", "a.aoi.dxf"]):
        for out_dir in (Path(), Path("link")):
            with pytest.raises(InputError, match=r"'a\.aoi\.dxf' is where results would be"):
                batch.tasks_of(batch.plans_of(given), out_dir, [], [])


@pytest.mark.usefixtures("texts")
def test_a_batch_goes_on_where_a_folder_that_an_option_names_holds_its_results() -> None:
    runs = []
    for _ in range(2):
        tasks = batch.tasks_of(batch.plans_of(["a.dxf", "c.dxf"]), Path("out"), [], [Path()])
        kept, here = batch.rows_kept(tasks, earlier_rows(Path("out"))), Noting()
        batch.run_all(tasks, here, Path("out"), kept=kept, told=lambda _: None)
        runs.append(here.done)
    assert runs == [["a.dxf", "c.dxf"], []]


@pytest.mark.usefixtures("texts")
def test_a_slip_in_the_options_costs_no_results(monkeypatch: pytest.MonkeyPatch) -> None:
    run_here()
    before = {file: file.read_bytes() for file in Path("out").glob("?.aoi.*")}
    assert len(before) == 4
    monkeypatch.setattr(batch, "PROGRAM", "import sys; sys.exit(2)")
    assert run_here("--step=0") == ["a.dxf", "b.dxf", "c.dxf"]
    assert {file: file.read_bytes() for file in before} == before


def test_options_are_handed_on_as_they_were_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    handed: list[str] = []

    def note(_plans: object, _out: object, options: list[str], _named: object) -> list[batch.Task]:
        handed.extend(options)
        return []

    monkeypatch.setattr(batch, "tasks_of", note)
    written = ["--start=-1.50,2,90,0", "--include-hidden", "--align", "auto", "--step", "20"]
    assert main(["batch", __file__, "-q", "--out-dir", str(tmp_path), "--again", *written]) == 0
    assert sorted(handed) == [
        "--align=auto",
        "--include-hidden",
        "--start=-1.50,2,90,0",
        "--step=20",
    ]


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["plans/*.ifc"], "'plans/*.ifc' names no file"),
        (["."], "'.' names no file"),
        (["a.dxf", "--robot", "nobody"], "nobody"),
        (["a.dxf", "--clearance", "-1"], "clearance"),
        (["a.dxf", "--layers", "none.toml"], "none.toml"),
        (["a.dxf", "--scheduler", "x", "--workers", "2"], "leave --workers out"),
    ],
    ids=["no match", "a folder", "no robot", "no clearance", "no layers", "two crews"],
)
@pytest.mark.usefixtures("texts")
def test_what_no_run_could_use_is_refused_at_once(
    arguments: list[str], complaint: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert batch_of(*arguments) == 2
    assert complaint in the_error(capsys)
    assert not Path("out").exists()


@pytest.mark.usefixtures("texts")
def test_names_differ_by_folder_and_where_need_be_by_suffix() -> None:
    for name in ("hall.dxf", "hall.ifc", "b/hall.dxf", "b/stairs.v2.dxf"):
        Path(name).parent.mkdir(exist_ok=True)
        Path(name).touch()
    out = Path("out")
    by_pattern = batch.names_in(out, batch.plans_of(["b/*.dxf", "./b/hall.dxf"]))
    assert by_pattern == ["out/hall", "out/stairs.v2"]
    all_plans = batch.plans_of(["hall.*", "b/hall.dxf"])
    assert batch.names_in(out, all_plans) == ["out/hall.dxf", "out/hall.ifc", "out/b/hall"]


@pytest.mark.usefixtures("texts")
def test_no_plan_is_called_what_another_one_is_called_with_its_suffix() -> None:
    for name in ("hall.dxf", "hall.ifc", "hall.dxf.ifc", "hall.dxf.ifc.dxf"):
        Path(name).touch()
    names = batch.names_in(Path("out"), batch.plans_of(["hall.*"]))
    assert len(set(names)) == 4


def task(plan: Path) -> batch.Task:
    return batch.Task(
        plan=plan.name,
        output="room.aoi.dxf",
        report="room.aoi.json",
        options=(),
        folder=str(plan.parent),
        sha256="",
        asked="",
    )


def test_a_run_that_a_signal_ends_is_a_row(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(batch, "PROGRAM", "import os; os.kill(os.getpid(), 9)")
    row = batch.run_plan(task(tmp_path / "room.dxf"))
    assert row.exit_code == 128 + 9
    assert "SIGKILL" in row.message
    assert "memory" in row.message


def test_a_run_that_fails_leaves_no_older_result(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    older = tmp_path / "room.aoi.dxf"
    older.touch()
    monkeypatch.setattr(batch, "PROGRAM", "raise ValueError('no such thing')")
    row = batch.run_plan(task(tmp_path / "room.dxf"))
    assert (row.exit_code, row.message) == (1, "ValueError: no such thing")
    assert not older.exists()


@pytest.mark.parametrize(
    ("error", "exit_code"),
    [(LimitError("all died", limit="x", value=1, allowed=0), 5), (OSError("lost"), 1)],
)
def test_a_worker_that_comes_to_nothing_is_a_row(
    tmp_path: Path, error: Exception, exit_code: int
) -> None:
    told: list[Row] = []
    rows = batch.run_all(
        [task(tmp_path / "room.dxf")], Lost(error), tmp_path, kept={}, told=told.append
    )
    assert [(row.exit_code, row.message) for row in rows] == [(exit_code, str(error))]
    assert told == rows == list(earlier_rows(tmp_path).values())


def test_plans_on_several_drives_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    def apart(_: object) -> None:
        raise ValueError("Paths don't have the same drive")

    monkeypatch.setattr("os.path.commonpath", apart)
    with pytest.raises(InputError, match="several drives"):
        batch.names_in(Path("out"), [batch.Plan("a.dxf", Path())])
