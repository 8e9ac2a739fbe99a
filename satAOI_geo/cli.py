"""The commands of satAOI-geo: parse, call, print, exit code.

Data goes to standard output, talk to standard error. What a command needs is imported when it
runs, so that `--help` answers at once.
"""

import math
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Final, Unpack

import rich_click as click

from satAOI_adapters.exit_codes import DONE, FINDINGS
from satAOI_geo import __version__
from satAOI_geo.errors import InputError, NoRouteError
from satAOI_geo.option_values import StartAt
from satAOI_geo.options import (
    AT,
    BATCH,
    EXACT_OUTLINE,
    IFC,
    INSPECTION,
    JSON,
    ONLY_DXF,
    ONLY_IFC,
    OUTPUTS,
    PLAN,
    QUESTION,
    QUIET,
    READING,
    ROUTE_OUTPUT,
    SHARING,
    STRICT,
    TO,
    Batch,
    HandingOn,
    Inspecting,
    Outputs,
    Question,
    Reading,
    Sharing,
    handed_on,
    taking,
)
from satAOI_geo.outputs import (
    refuse_drafts_early,
    refuse_early,
    refuse_targets,
    tell,
    tell_batch,
    tell_figures,
    tell_route,
    write,
    write_drafts,
)

if TYPE_CHECKING:
    from satAOI_adapters import Choices
    from satAOI_adapters.cluster import Workers
    from satAOI_geo.pipeline import Result
    from satAOI_geo.plan import FloorPlan
    from satAOI_geo.progress import Progress
    from satAOI_geo.route import Route
    from satAOI_geo.settings import Settings
    from satAOI_geo.start import StartMark

EPILOG: Final = (
    "Exit codes: 0 done; 1 findings, with --strict; 2 usage; 3 drawing unusable; "
    "4 start blocked or nothing reachable; 5 a limit was reached; 130 interrupted; "
    "128 + N ended by signal N."
)

BATCH_EPILOG: Final = (
    "Exit code: 0 when every plan is done, else that of the first plan in the table that is not; "
    "128 + N for a run that signal N ended."
)


class DefaultRun(click.RichGroup):
    """A group whose command `run` may be left out: `satAOI-geo PLAN` is `satAOI-geo run PLAN`."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Put `run` in front of arguments that name no command; without any, show the help."""
        own_words = {*self.commands, *ctx.help_option_names, "--version"}
        if not args:
            args = ["--help"]
        elif args[0] not in own_words:
            self._refuse_mistyped(args[0])
            args = ["run", *args]
        return super().parse_args(ctx, args)

    def _refuse_mistyped(self, word: str) -> None:
        """Refuse a word that is nearly a command, and no file."""
        from difflib import get_close_matches

        meant = get_close_matches(word, self.commands, n=1)
        if meant and not Path(word).exists():
            raise click.UsageError(
                f"there is neither a command nor a plan '{word}'; did you mean '{meant[0]}'?"
            )


@click.group(
    cls=DefaultRun,
    context_settings={"help_option_names": ["-h", "--help"]},
    subcommand_metavar="PLAN | COMMAND ...",
    epilog=EPILOG,
)
@click.version_option(__version__, prog_name="satAOI-geo", message="%(prog)s %(version)s")
def commands() -> None:
    """The part of a floor that a swing-arm troweling robot can trowel.

    satAOI-geo PLAN -o OUT finds the area of interest on a floor plan and draws it into a copy of
    the drawing. It is short for satAOI-geo run PLAN -o OUT; satAOI-geo run --help tells all
    options.
    """


class PlanOptions(Reading, Question):
    """All that concerns a plan and what is asked about it."""


class RunOptions(PlanOptions, Sharing, Outputs):
    """All that `run` can be asked."""

    exact_outline: bool
    strict: bool


@commands.command(epilog=EPILOG)
@taking(PLAN, OUTPUTS, EXACT_OUTLINE, READING, QUESTION, SHARING, STRICT, QUIET)
def run(*, plan: Path, quiet: bool, **options: Unpack[RunOptions]) -> int:
    """Find the area of interest on a floor plan (DXF or IFC).

    Without --output, --report and --raster the figures are printed and nothing is written.
    """
    refuse_early(plan, options, read=[plan, Path(options["robot"]), options["layers"]])
    with crew_of(options) as crew:
        exact = options["exact_outline"]
        result = answer(plan, options, exact_outline=exact, quiet=quiet, crew=crew)
    write(result, options)
    tell(result, options, quiet=quiet)
    return FINDINGS if options["strict"] and result.report.findings else DONE


class BatchOptions(PlanOptions, Batch):
    """All that `batch` can be asked."""

    exact_outline: bool


@commands.command(cls=HandingOn, epilog=BATCH_EPILOG)
@taking(BATCH, EXACT_OUTLINE, READING, QUESTION, QUIET)
@click.pass_context
def batch(context: click.Context, *, quiet: bool, **options: Unpack[BatchOptions]) -> int:
    """Find the areas of interest on many plans.

    satAOI-geo batch 'plans/*.dxf' --out-dir results

    Each plan is run as by satAOI-geo run: NAME.aoi.dxf and NAME.aoi.json go to the folder, what
    came of all plans goes to results.csv and results.json. A plan that fails is a row there and
    stops no other. One whose results are there, of the same bytes, options and version, is not
    run again.
    """
    from satAOI_adapters import kernel_cache
    from satAOI_adapters.batch import plans_of, rows_kept, run_all, tasks_of
    from satAOI_adapters.batch_results import earlier_rows
    from satAOI_adapters.cluster import workers
    from satAOI_adapters.layers import layer_table
    from satAOI_adapters.robot_read import robot_from
    from satAOI_adapters.terminal import counted

    kernel_cache.prepare()
    # what every run would refuse is refused once
    robot_from(options["robot"])
    layer_table(options["layers"])
    settings_of(options, exact_outline=options["exact_outline"])
    plans, out_dir = plans_of(options["plans"]), options["out_dir"]
    own = {*Batch.__annotations__, "quiet"}
    named = [Path(options["robot"]), options["layers"], options["xref_dir"]]
    tasks = tasks_of(plans, out_dir, handed_on(context, besides=own), filter(None, named))
    kept = {} if options["again"] else rows_kept(tasks, earlier_rows(out_dir))
    if options["scheduler"] is None:
        # else each of the runs would compile them, and none would say so
        kernel_cache.compile_missing(quiet=quiet)
    with (
        workers(n_workers=options["workers"], scheduler=options["scheduler"]) as crew,
        counted(len(tasks) - len(kept), quiet=quiet) as told,
    ):
        rows = run_all(tasks, crew, out_dir, kept=kept, told=lambda row: told(row.plan))
    if not quiet:
        tell_batch(rows, out_dir, n_kept=len(kept), n_left_out=len(plans) - len(tasks))
    return next((row.exit_code for row in rows if row.exit_code != DONE), DONE)


@commands.command()
@taking(PLAN, AT, READING, QUESTION, QUIET)
def explain(
    *, plan: Path, at: tuple[float, float], quiet: bool, **options: Unpack[PlanOptions]
) -> int:
    """Say in one sentence why a point is, or is not, in the area of interest.

    satAOI-geo explain plan.dxf --at 3200,1500.5
    """
    from satAOI_geo.explain import explain as sentence_for

    result = answer(plan, options, quiet=quiet)
    x_mm, y_mm = result.plan.frame.to_local_mm(at).tolist()
    click.echo(sentence_for(result, (x_mm, y_mm)))
    return DONE


@commands.command(epilog=EPILOG)
@taking(PLAN, TO, ROUTE_OUTPUT, READING, QUESTION, QUIET)
def route(
    *,
    plan: Path,
    to: tuple[float, float],
    output: tuple[Path, ...],
    quiet: bool,
    **options: Unpack[PlanOptions],
) -> int:
    """Find a way for the robot from where it is set down to where it trowels a point.

    satAOI-geo route plan.dxf --to 3200,1500.5 -o route.dxf

    Without --output the figures are printed and nothing is written.
    """
    from satAOI_adapters import route_writer_of, write_route

    if options["connectivity"] != "pose":
        raise InputError("a route is made of motions; leave --connectivity at pose")
    for path in output:
        route_writer_of(path)
    refuse_targets(output, read=[plan, Path(options["robot"]), options["layers"]])
    result = answer(plan, options, quiet=quiet)
    found = route_to(result, to)
    for path in output:
        write_route(path, result, found)
    tell_route(result, found, output, quiet=quiet)
    return DONE


def route_to(result: "Result", at: tuple[float, float]) -> "Route":
    """A way from the start to a point in drawing units.

    Raises:
        NoRouteError: If there is none; it says why.
    """
    from satAOI_geo.explain import explain as sentence_for
    from satAOI_geo.route import RouteMap

    x_mm, y_mm = result.plan.frame.to_local_mm(at).tolist()
    try:
        return RouteMap(result.search).to((x_mm, y_mm))
    except NoRouteError as error:
        why = sentence_for(result, (x_mm, y_mm))
        message = f"no route leads to {at[0]:.12g},{at[1]:.12g}. {why}"
        raise NoRouteError(message, at_mm=error.at_mm) from error


@contextmanager
def crew_of(options: Sharing) -> Iterator["Workers | None"]:
    """Those who share the search, for the time of a block; None where nobody is asked to."""
    if options["workers"] is None and options["scheduler"] is None:
        yield None
        return
    from satAOI_adapters.cluster import workers

    with workers(n_workers=options["workers"], scheduler=options["scheduler"]) as crew:
        yield crew


def answer(
    path: Path,
    options: PlanOptions,
    *,
    exact_outline: bool = False,
    quiet: bool,
    crew: "Workers | None" = None,
) -> "Result":
    """Read a plan and find the area of interest on it."""
    from satAOI_adapters import kernel_cache
    from satAOI_adapters.robot_read import robot_from
    from satAOI_adapters.terminal import progress

    kernel_cache.prepare()
    # what is cheap to refuse comes first
    robot = robot_from(options["robot"])
    settings = settings_of(options, exact_outline=exact_outline)
    with progress(quiet=quiet) as told:
        plan = read(path, options, progress=told)
    # what is slow to load only once there is a plan
    from satAOI_geo.pipeline import area_of_interest

    mark = None if options["start"] is None else mark_of(options["start"], plan)
    kernel_cache.compile_missing(quiet=quiet)
    with progress(quiet=quiet) as told:
        return area_of_interest(plan, robot, settings, start=mark, progress=told, crew=crew)


def mark_of(start: StartAt, plan: "FloorPlan") -> "StartMark":
    """A start as the option gives it, in the plan's frame."""
    from satAOI_geo.start import StartMark

    frame = plan.frame
    x_mm, y_mm = frame.to_local_mm(start.place).tolist()
    if start.angles_deg is None:
        return StartMark((x_mm, y_mm))
    a1_rad, a2_rad = map(math.radians, start.angles_deg)
    return StartMark((x_mm, y_mm), angles_rad=(a1_rad - frame.turn_rad, a2_rad))


def settings_of(question: Question, *, exact_outline: bool) -> "Settings":
    """The settings that a question amounts to.

    Raises:
        InputError: If one is out of range.
    """
    from satAOI_geo.settings import Settings

    align_deg = question["align"]
    return Settings(
        connectivity=question["connectivity"],
        step_mm=question["step"],
        n_directions=question["directions"],
        clearance_mm=question["clearance"],
        align_rad=None if align_deg is None else math.radians(align_deg),
        engine=question["engine"],
        exact_outline=exact_outline,
        memory_gb=question["memory"],
    )


def read(path: Path, options: PlanOptions, *, progress: "Progress | None") -> "FloorPlan":
    """Read a plan as the options say."""
    from satAOI_adapters import read_plan

    start = options["start"]
    place = None if start is None else start.place
    return read_plan(path, *choices(path, options, start=place), progress=progress)


def choices(path: Path, options: Reading, *, start: tuple[float, float] | None = None) -> "Choices":
    """What the options say to the reader of the plan's format.

    A start in drawing units tells which of several plans in one drawing is meant.

    Raises:
        InputError: If an option was given that belongs to another format.
    """
    from satAOI_adapters import Choices

    refuse_options_of_other_formats(path, options)
    if path.suffix.lower() == IFC:
        from satAOI_adapters.ifc_read.options import BAND_MM, IfcOptions

        ifc = IfcOptions(
            units=options["units"],
            storey=options["storey"],
            floor_z=options["floor_z"],
            band_mm=BAND_MM if options["band"] is None else options["band"],
            with_classes=options["with_classes"],
            without_classes=options["without_classes"],
        )
        return Choices(ifc=ifc)
    from satAOI_adapters.dxf_read.options import CLOSE_GAPS_MM, ReadOptions

    close_gaps_mm = options["close_gaps"]
    dxf = ReadOptions(
        units=options["units"],
        layers=options["layers"],
        encoding=options["encoding"],
        include_hidden=options["include_hidden"],
        xref_dir=options["xref_dir"],
        plan=options["plan_number"],
        region=options["region"],
        close_gaps_mm=CLOSE_GAPS_MM if close_gaps_mm is None else close_gaps_mm,
        start=start,
    )
    return Choices(dxf=dxf)


def refuse_options_of_other_formats(path: Path, options: Reading) -> None:
    """Refuse what would say nothing about a plan of this format.

    Raises:
        InputError: If an option was given that belongs to another format.
    """
    is_ifc = path.suffix.lower() == IFC
    foreign = ONLY_DXF if is_ifc else ONLY_IFC
    said = dict(options)
    given = [
        option
        for name, option in foreign.items()
        # not given, a flag is False, a list empty, another command's option absent; 0 is a value
        if not (said.get(name) is None or said[name] is False or said[name] == ())
    ]
    if given:
        format_name = "IFC" if is_ifc else "DXF"
        raise InputError(f"{given[0]} says nothing about a plan in {format_name}; leave it out")


@commands.command()
@taking(OUTPUTS)
@click.pass_context
def demo(context: click.Context, **outputs: Unpack[Outputs]) -> int:
    """Find the area of interest on a plan that comes with the program.

    satAOI-geo demo -o demo.dxf
    """
    from importlib.resources import as_file, files

    with as_file(files("satAOI_adapters") / "demo" / "hall_medium.dxf") as plan:
        code: int = context.invoke(run, plan=plan, **outputs)
    return code


@commands.command(epilog=EPILOG)
@taking(PLAN, INSPECTION, READING, JSON)
def inspect(*, plan: Path, json: bool, **options: Unpack[Inspecting]) -> int:
    """Tell how a plan is read: unit, size, layers or storeys, and what is odd about it.

    satAOI-geo inspect plan.dxf --picture plan.png

    A drawing that cannot be used as it is, since its unit is not known for example, is told of as
    far as that goes.
    """
    from satAOI_adapters import inspect_plan
    from satAOI_adapters.terminal import say_findings

    refuse_drafts_early(plan, options)
    with_plan = options["picture"] is not None
    found = inspect_plan(plan, *choices(plan, options), with_plan=with_plan)
    tell_figures(found, json=json)
    if not json:
        say_findings(found.findings)
    write_drafts(plan, found, options)
    if found.error is not None:
        raise found.error
    return DONE


@commands.command()
@click.argument("name", required=False)
def robots(name: str | None) -> int:
    """List the robots of this build, or print one as a file to start your own from.

    satAOI-geo robots magicbim > mine.toml
    """
    from satAOI_adapters.robot_read import robot_from, toml_of
    from satAOI_adapters.terminal import write_table
    from satAOI_geo.robot import ROBOTS

    if name is not None:
        click.echo(toml_of(robot_from(name)), nl=False)
        return DONE
    heads = ("name", "vehicle mm", "pivot offset mm", "arm mm", "disc radius mm")
    rows = [
        (
            robot.name,
            f"{robot.vehicle_length_mm:g} × {robot.vehicle_width_mm:g}",
            f"{robot.pivot_offset_mm:g}",
            f"{robot.arm_length_mm:g}",
            f"{robot.disc_radius_mm:g}",
        )
        for robot in ROBOTS.values()
    ]
    write_table([heads, *rows], sys.stdout)
    return DONE
