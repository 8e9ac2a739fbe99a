"""Many plans, one run each: what there is to do, doing it, and what came of it.

Each plan is run by the program itself in a process of its own: it gets the files that
`satAOI-geo run` writes, and nothing that becomes of it stops the rest.
"""

import contextlib
import glob
import hashlib
import json
import os
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import satAOI_geo
from satAOI_adapters import lifeline
from satAOI_adapters.batch_results import SUMMARIES, Row, printable, save
from satAOI_adapters.cluster import Outcome, Workers
from satAOI_adapters.exit_codes import DONE, LIMIT_REACHED, SIGNALLED, USAGE
from satAOI_geo.errors import InputError, LimitError

PROGRAM: Final = f"""
import sys
from {lifeline.__name__} import end_with_the_caller
from satAOI_geo.program import main
end_with_the_caller()
sys.exit(main())
"""

FAILED: Final = 1
"""The exit code of a worker that came to nothing, that of a traceback."""

RESULTS: Final = (".dxf", ".json")
"""What the names of a run's drawing and of its report end in."""


@dataclass(frozen=True, slots=True)
class Plan:
    """A plan of the batch.

    Attributes:
        given: Its name as the user gave it, or as a pattern found it.
        root: The folder it was sought in: that of the name, or the part of a pattern before the
            first wildcard.
    """

    given: str
    root: Path

    @property
    def file(self) -> Path:
        """Its whole name."""
        return _absolute(self.given)


@dataclass(frozen=True, slots=True)
class Task:
    """A plan to be run.

    Attributes:
        plan: As the user gave it.
        output: The drawing to write.
        report: The report to write.
        options: Of `satAOI-geo run`.
        folder: The folder that relative names start from.
        sha256: Digest of the plan's bytes, or an empty string where there are none to read.
        asked: Digest of the options and of what the files that they name hold.
    """

    plan: str
    output: str
    report: str
    options: tuple[str, ...]
    folder: str
    sha256: str
    asked: str

    def results(self) -> tuple[str, str]:
        """The files that a run writes."""
        return self.output, self.report


def plans_of(patterns: Sequence[str]) -> list[Plan]:
    """The plans that names and patterns stand for, each once.

    Raises:
        InputError: If a pattern stands for no file, or a name for a folder.
    """
    found: dict[Path, Plan] = {}
    for pattern in patterns:
        is_name = not glob.has_magic(pattern) or Path(pattern).exists()
        # a folder lists its files in any order
        # Path.glob takes no whole pattern, and none that begins at the root
        matches = [] if is_name else glob.glob(pattern, recursive=True)  # noqa: PTH207  may be absolute
        names = [pattern] if is_name else sorted(matches)
        files = [name for name in names if not Path(name).is_dir()]
        if not files:
            raise InputError(
                f"'{pattern}' names no file; give plans, or a pattern in quotes such as "
                "'plans/*.dxf'"
            )
        for name in files:
            plan = Plan(name, _fixed_part(name if is_name else pattern))
            found.setdefault(plan.file, plan)
    return list(found.values())


def names_in(out_dir: Path, plans: Sequence[Plan]) -> list[str]:
    """For each plan the name that its results begin with, all different.

    The folders below the one that all plans were sought in are those of the results. The plan's
    suffix is a part of the name where two plans would have the same without it.

    Raises:
        InputError: If the plans lie on several drives.
    """
    try:
        common = os.path.commonpath([plan.root for plan in plans])
    except ValueError as error:
        raise InputError("the plans lie on several drives; run a batch for each") from error
    files = [out_dir / plan.file.relative_to(common) for plan in plans]
    names = [file.with_suffix("") for file in files]
    # with its suffix a plan may be called as another one is without
    while alike := {name for name, n in Counter(names).items() if n > 1}:
        names = [file if name in alike else name for file, name in zip(files, names, strict=True)]
    return [str(name) for name in names]


def tasks_of(
    plans: Sequence[Plan], out_dir: Path, options: Sequence[str], named: Iterable[Path]
) -> list[Task]:
    """What there is to run.

    A drawing that an earlier batch wrote is left out: a pattern may find it.

    Args:
        plans: The plans.
        out_dir: Where the results go.
        options: Of `satAOI-geo run`.
        named: Files and folders that the options name.

    Raises:
        InputError: If results would be written over a plan.
    """
    names = names_in(out_dir, plans)
    written = {Path(f"{name}.aoi{suffix}").resolve() for name in names for suffix in RESULTS}
    written |= {(out_dir / name).resolve() for name in SUMMARIES}
    for plan in plans:
        if plan.file.resolve() in written and not _is_result(plan.file):
            raise InputError(
                f"'{plan.given}' is where results would be written; give another --out-dir"
            )
    of_named = [_state_of(each, besides=written) for each in named]
    asked = hashlib.sha256(json.dumps([list(options), *of_named]).encode()).hexdigest()
    return [
        Task(
            plan=plan.given,
            output=f"{name}.aoi.dxf",
            report=f"{name}.aoi.json",
            options=tuple(options),
            folder=str(Path.cwd()),
            sha256=_digest_of(plan.file),
            asked=asked,
        )
        for plan, name in zip(plans, names, strict=True)
        if plan.file.resolve() not in written
    ]


def rows_kept(tasks: Sequence[Task], earlier: Mapping[str, Row]) -> dict[int, Row]:
    """The rows of an earlier batch that tell what runs would give, by the task's number.

    Args:
        tasks: The plans.
        earlier: Rows by their plan.
    """
    return {
        number: row
        for number, task in enumerate(tasks)
        if (row := earlier.get(printable(task.plan))) is not None and _is_done(task, row)
    }


def _is_done(task: Task, row: Row) -> bool:
    """Whether a row tells what a run of the task would give, and its files are there."""
    same = (row.output, row.sha256, row.asked, row.version) == (
        printable(task.output),
        task.sha256,
        task.asked,
        satAOI_geo.__version__,
    )
    return same and row.exit_code == DONE and all(map(_holds_something, task.results()))


def run_all(
    tasks: Sequence[Task],
    crew: Workers,
    out_dir: Path,
    *,
    kept: Mapping[int, Row],
    told: Callable[[Row], None],
) -> list[Row]:
    """Run the tasks without a row; the rows of all, in the order of the tasks.

    The results are saved after each, so that little is lost with an interrupt.

    Args:
        tasks: The plans.
        crew: Those who run them.
        out_dir: Where the results go.
        kept: Rows that are there already, by the task's number.
        told: Called with each new row.

    Raises:
        InputError: If the results cannot be saved.
    """
    rows = dict(kept)
    left = [number for number in range(len(tasks)) if number not in rows]
    for folder in {out_dir, *(Path(task.output).parent for task in tasks)}:
        folder.mkdir(parents=True, exist_ok=True)
    save(out_dir, list(rows.values()))
    for outcome in crew.outcomes(run_plan, [tasks[number] for number in left]):
        number = left[outcome.number]
        rows[number] = row_of(tasks[number], outcome)
        save(out_dir, [rows[number] for number in sorted(rows)])
        told(rows[number])
    return [rows[number] for number in sorted(rows)]


def row_of(task: Task, outcome: Outcome[Row]) -> Row:
    """What came of a task, also where the worker itself came to nothing."""
    if outcome.answer is not None:
        return outcome.answer
    exit_code = LIMIT_REACHED if isinstance(outcome.error, LimitError) else FAILED
    return failed(task, exit_code, f"{outcome.error}")


def run_plan(task: Task) -> Row:
    """Run the program on one plan; this is what workers do."""
    files = [f"--output={task.output}", f"--report={task.report}", "--quiet", "--", task.plan]
    begin_s = time.perf_counter()
    with lifeline.tied() as stdin:
        done = subprocess.run(  # noqa: S603  our own program, by our own interpreter
            [sys.executable, "-c", PROGRAM, "run", *task.options, *files],
            cwd=task.folder,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
            stdin=stdin,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            check=False,
        )
    time_s = time.perf_counter() - begin_s
    if done.returncode not in {DONE, USAGE}:
        # those of an earlier run with other options are no answer; a slip in these costs nothing
        for old in task.results():
            with contextlib.suppress(OSError):
                Path(task.folder, old).unlink()
    if done.returncode != DONE:
        return failed(task, *_how_it_ended(done.returncode, done.stderr), time_s=time_s)
    report = json.loads(Path(task.folder, task.report).read_bytes())
    return Row(
        plan=task.plan,
        exit_code=DONE,
        area_m2=report["aoi"]["area_m2"],
        percent_of_free=report["aoi"]["percent_of_free"],
        n_findings=len(report["findings"]),
        time_s=time_s,
        output=task.output,
        report=task.report,
        # the file may have changed since it was listed
        sha256=report["input"]["sha256"],
        asked=task.asked,
        version=satAOI_geo.__version__,
    )


def failed(task: Task, exit_code: int, message: str, *, time_s: float = 0.0) -> Row:
    """The row of a plan that gave no area."""
    return Row(
        plan=task.plan,
        exit_code=exit_code,
        message=message,
        time_s=time_s,
        output=task.output,
        report=task.report,
        sha256=task.sha256,
        asked=task.asked,
        version=satAOI_geo.__version__,
    )


def _how_it_ended(returncode: int, said: bytes) -> tuple[int, str]:
    """Exit code and last words of a run that failed."""
    if returncode < 0:
        name = signal.Signals(-returncode).name
        hint = "; most often memory runs out" if name == "SIGKILL" else ""
        return SIGNALLED - returncode, f"the run was ended by signal {name}{hint}"
    lines = said.decode("utf-8", "replace").strip().splitlines() or [f"exit code {returncode}"]
    return returncode, lines[-1].removeprefix("error: ")


def _absolute(name: str) -> Path:
    """The whole name, links left as they are."""
    return Path(os.path.abspath(name))  # noqa: PTH100  Path.absolute keeps '..'


def _fixed_part(pattern: str) -> Path:
    """The folder named before the first wildcard."""
    parts = _absolute(pattern).parts[:-1]
    n_fixed = next((n for n, part in enumerate(parts) if glob.has_magic(part)), len(parts))
    return Path(*parts[:n_fixed])


def _digest_of(file: Path) -> str:
    """SHA-256 of the file's bytes, an empty string where they cannot be read."""
    try:
        with file.open("rb") as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except OSError:
        return ""


def _state_of(named: Path, *, besides: Container[Path]) -> list[str]:
    """What a file or all files of a folder but some hold, in a form that changes with it."""
    files = sorted(filter(Path.is_file, named.rglob("*"))) if named.is_dir() else [named]
    return [f"{file} {_digest_of(file)}" for file in files if file.resolve() not in besides]


def _is_result(file: Path) -> bool:
    """Whether a drawing was written by this program."""
    from satAOI_adapters.dxf_write.metadata import SCHEMA

    try:
        return SCHEMA.encode() in file.read_bytes()
    except OSError:
        return False


def _holds_something(file: str) -> bool:
    """Whether there is such a file, and something in it."""
    return Path(file).is_file() and Path(file).stat().st_size > 0
