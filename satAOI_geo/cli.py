"""satAOI-geo: parse, call, print, exit code; the only module that knows the adapters.

Data goes to standard output, talk to standard error. What a command needs is imported when it
runs, so that `--help` answers at once.
"""

import math
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final, Unpack

import rich_click as click

from satAOI_geo import __version__
from satAOI_geo.errors import DrawingError, InputError, LimitError, SatAoiError, StartError
from satAOI_geo.options import (
    AT,
    EXACT_OUTLINE,
    OUTPUTS,
    PLAN,
    QUESTION,
    QUIET,
    READING,
    STRICT,
    Outputs,
    Question,
    Reading,
    taking,
)

if TYPE_CHECKING:
    from satAOI_geo.pipeline import Result

DONE: Final = 0
FINDINGS: Final = 1
USAGE: Final = 2
INTERRUPTED: Final = 130
EXIT_CODES: Final[dict[type[SatAoiError], int]] = {
    InputError: USAGE,
    DrawingError: 3,
    StartError: 4,
    LimitError: 5,
}

STANDARD_OUTPUT: Final = Path("-")

EPILOG: Final = (
    "Exit codes: 0 done; 1 findings, with --strict; 2 usage; 3 drawing unusable; "
    "4 start blocked or nothing reachable; 5 a limit was reached; 130 interrupted."
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program and return its exit code; a known error becomes one line of talk."""
    from satAOI_adapters.terminal import accept_any_text, say_error

    accept_any_text()
    try:
        return int(commands.main(arguments, prog_name="satAOI-geo", standalone_mode=False) or DONE)
    except click.ClickException as error:
        say_error(error.format_message())
        return error.exit_code
    except SatAoiError as error:
        say_error(str(error))
        return next(code for sort, code in EXIT_CODES.items() if isinstance(error, sort))
    except OSError as error:
        say_error(f"{error.filename or 'input or output'}: {error.strerror}")
        return USAGE
    except (click.Abort, KeyboardInterrupt):
        say_error("interrupted")
        return INTERRUPTED


class DefaultRun(click.RichGroup):
    """A group whose command `run` may be left out: `satAOI-geo PLAN` is `satAOI-geo run PLAN`."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Put `run` in front of arguments that name no command; without any, show the help."""
        own_words = {*self.commands, *ctx.help_option_names, "--version"}
        if not args:
            args = ["--help"]
        elif args[0] not in own_words:
            args = ["run", *args]
        return super().parse_args(ctx, args)


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


@commands.command(epilog=EPILOG)
@taking(PLAN, OUTPUTS, EXACT_OUTLINE, READING, QUESTION, STRICT, QUIET)
def run(
    *,
    plan: Path,
    output: Path | None,
    report: Path | None,
    raster: Path | None,
    exact_outline: bool,
    units: str | None,
    layers: Path | None,
    strict: bool,
    quiet: bool,
    **question: Unpack[Question],
) -> int:
    """Find the area of interest on a floor plan.

    Without --output, --report and --raster the figures are printed and nothing is written.
    """
    outputs = Outputs(output=output, report=report, raster=raster)
    read = [path for path in (plan, Path(question["robot"]), layers) if path is not None]
    refuse_early(outputs, read)
    result = answer(
        plan,
        Reading(units=units, layers=layers),
        question,
        exact_outline=exact_outline,
        quiet=quiet,
    )
    write(result, outputs)
    tell(result, outputs, quiet=quiet)
    return FINDINGS if strict and result.report.findings else DONE


@commands.command()
@taking(PLAN, AT, READING, QUESTION, QUIET)
def explain(
    *,
    plan: Path,
    at: tuple[float, float],
    units: str | None,
    layers: Path | None,
    quiet: bool,
    **question: Unpack[Question],
) -> int:
    """Say in one sentence why a point is, or is not, in the area of interest.

    satAOI-geo explain plan.dxf --at 3200,1500.5
    """
    from satAOI_geo.explain import explain as sentence_for

    result = answer(plan, Reading(units=units, layers=layers), question, quiet=quiet)
    x_mm, y_mm = result.plan.frame.to_local_mm(at).tolist()
    click.echo(sentence_for(result, (x_mm, y_mm)))
    return DONE


def answer(
    plan: Path,
    reading: Reading,
    question: Question,
    *,
    exact_outline: bool = False,
    quiet: bool,
) -> "Result":
    """Read a plan and find the area of interest on it."""
    from satAOI_adapters import kernel_cache, read_plan
    from satAOI_adapters.dxf_read import ReadOptions
    from satAOI_adapters.robot_read import robot_from
    from satAOI_adapters.terminal import progress, say_note

    compiled = kernel_cache.prepare()
    from satAOI_geo.pipeline import area_of_interest
    from satAOI_geo.search import Settings
    from satAOI_geo.start import StartMark

    robot = robot_from(question["robot"])
    align_deg = question["align"]
    settings = Settings(
        connectivity=question["connectivity"],
        step_mm=question["step"],
        n_directions=question["directions"],
        clearance_mm=question["clearance"],
        align_rad=None if align_deg is None else math.radians(align_deg),
        engine=question["engine"],
        exact_outline=exact_outline,
    )
    floor_plan = read_plan(plan, ReadOptions(**reading))
    mark = None
    if question["start"] is not None:
        x_mm, y_mm = floor_plan.frame.to_local_mm(question["start"]).tolist()
        mark = StartMark((x_mm, y_mm))
    if not (compiled or quiet):
        say_note("first run of this version: compiling takes some seconds, once")
    with progress(quiet=quiet) as told:
        return area_of_interest(floor_plan, robot, settings, start=mark, progress=told)


def refuse_early(outputs: Outputs, read: list[Path]) -> None:
    """Refuse outputs that could not be written, before any work is done for them.

    Raises:
        InputError: If one has a suffix that no writer knows, is an input, is asked for twice, or
            cannot be a file at all.
    """
    from satAOI_adapters import writer_of
    from satAOI_adapters.files import refuse_unfit_target

    for path in (outputs["output"], outputs["raster"]):
        if path is not None:
            writer_of(path)
    seen: list[Path] = []
    for path in files_of(outputs):
        refuse_unfit_target(path, read)
        if path.absolute() in seen:
            raise InputError(f"'{path}' is asked for twice; give each output a name of its own")
        seen.append(path.absolute())


def files_of(outputs: Outputs) -> list[Path]:
    """The files to be written."""
    asked = (outputs["output"], outputs["report"], outputs["raster"])
    return [path for path in asked if path not in {None, STANDARD_OUTPUT}]


def write(result: "Result", outputs: Outputs) -> None:
    """Write what was asked for, each file whole or not at all."""
    from satAOI_adapters import report_write, write_aoi

    for path in (outputs["output"], outputs["raster"]):
        if path is not None:
            write_aoi(path, result)
    if outputs["report"] == STANDARD_OUTPUT:
        click.echo(report_write.json_of(result.report), nl=False)
    elif outputs["report"] is not None:
        report_write.write(outputs["report"], result.report)


def tell(result: "Result", outputs: Outputs, *, quiet: bool) -> None:
    """Say the findings and the figures.

    The figures are talk beside an output, and the output itself where none is asked for.
    """
    from satAOI_adapters.report_write import lines_of
    from satAOI_adapters.terminal import say_findings, say_note, write_table

    alone = not any(outputs.values())
    if alone:
        write_table(lines_of(result.report), sys.stdout)
    if quiet:
        return
    say_findings(result.report.findings)
    if alone:
        say_note("no file was written; --output FILE.dxf draws the area into the plan")
    else:
        write_table(lines_of(result.report), sys.stderr)
    for path in files_of(outputs):
        say_note(f"wrote {path}")


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
