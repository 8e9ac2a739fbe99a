"""satAOI-geo: parse, call, print, exit code; the only module that knows the adapters.

Data goes to standard output, talk to standard error. What a command needs is imported when it
runs, so that `--help` answers at once.
"""

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal

import rich_click as click

from satAOI_geo import __version__
from satAOI_geo.errors import DrawingError, InputError, LimitError, SatAoiError, StartError
from satAOI_geo.units import MM_PER_UNIT

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

EPILOG = (
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


def point(
    context: click.Context, parameter: click.Parameter, text: str | None
) -> tuple[float, float] | None:
    """The two numbers of a point written `X,Y`."""
    if text is None:
        return None
    try:
        x, y = (float(number) for number in text.split(","))
    except ValueError as error:
        message = f"'{text}' is not two numbers with a comma, as in 3200,1500.5"
        raise click.BadParameter(message, ctx=context, param=parameter) from error
    return x, y


def direction(context: click.Context, parameter: click.Parameter, text: str | None) -> float | None:
    """The lattice's direction in degrees; None to find it."""
    if text is None or text == "auto":
        return None
    try:
        return 0.0 if text == "none" else float(text)
    except ValueError as error:
        message = f"'{text}' is neither an angle in degrees nor auto nor none"
        raise click.BadParameter(message, ctx=context, param=parameter) from error


@dataclass(frozen=True, slots=True, kw_only=True)
class Outputs:
    """Where the results go; None where one is not asked for.

    Attributes:
        drawing: The area of interest drawn into the plan.
        report: The figures as JSON; `-` is standard output.
        raster: The area of interest as a picture or an array.
    """

    drawing: Path | None = None
    report: Path | None = None
    raster: Path | None = None

    @property
    def asked(self) -> list[Path]:
        """Those that are asked for."""
        return [path for path in (self.drawing, self.report, self.raster) if path is not None]

    @property
    def files(self) -> list[Path]:
        """Those that go to a file."""
        return [path for path in self.asked if path != STANDARD_OUTPUT]


@click.group(
    cls=DefaultRun,
    context_settings={"help_option_names": ["-h", "--help"]},
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
@click.argument("plan", type=click.Path(path_type=Path))
@click.option(
    "-o",
    "--output",
    metavar="FILE.dxf",
    type=click.Path(path_type=Path),
    help="Draw the area of interest into a copy of the plan, e.g. --output aoi.dxf",
)
@click.option(
    "--report",
    metavar="FILE.json",
    type=click.Path(path_type=Path, allow_dash=True),
    help="Write all figures and findings as JSON, e.g. --report figures.json; "
    "--report - writes to standard output.",
)
@click.option(
    "--raster",
    metavar="FILE.png|.npz",
    type=click.Path(path_type=Path),
    help="Write the area of interest cell by cell, e.g. --raster aoi.png as a picture or "
    "--raster aoi.npz as arrays.",
)
@click.option(
    "--start",
    metavar="X,Y",
    callback=point,
    help="Where the disc's centre is set down, in drawing units, e.g. --start 3200,1500.5. "
    "Without it: the mark on layer SATAOI-START; without a mark, where the area is largest.",
)
@click.option(
    "--robot",
    metavar="NAME|FILE.toml",
    default="magicbim",
    show_default=True,
    help="A robot of this build (satAOI-geo robots) or a file with its measures, "
    "e.g. --robot mine.toml",
)
@click.option(
    "--connectivity",
    type=click.Choice(["pose", "disc"]),
    default="pose",
    show_default=True,
    help="What joins neighbouring disc positions: that the robot can move from the one to the "
    "other, or that it can stand at each, which is an upper estimate, e.g. --connectivity disc",
)
@click.option(
    "--clearance",
    metavar="MM",
    type=float,
    default=0.0,
    show_default=True,
    help="Distance the robot keeps from every obstacle, in mm, e.g. --clearance 20",
)
@click.option(
    "--step",
    metavar="MM",
    type=float,
    default=10.0,
    show_default=True,
    help="Distance between neighbouring disc positions, in mm, e.g. --step 20",
)
@click.option(
    "--directions",
    metavar="N",
    type=int,
    default=24,
    show_default=True,
    help="Directions of arm and vehicle in a full turn, a multiple of 4, e.g. --directions 36",
)
@click.option(
    "--align",
    metavar="DEG|auto|none",
    show_default="auto",
    callback=direction,
    help="Direction of the disc positions' rows in the drawing: that of most of the walls, along "
    "the drawing's axes, or an angle in degrees, e.g. --align 33.3",
)
@click.option(
    "--units",
    metavar="UNIT",
    type=click.Choice(list(MM_PER_UNIT)),
    help="The drawing's unit of length, whatever its header says, e.g. --units mm; "
    f"one of {', '.join(MM_PER_UNIT)}.",
)
@click.option(
    "--layers",
    metavar="FILE.toml",
    type=click.Path(path_type=Path),
    help="Which layers are walls, columns, floor ..., e.g. --layers office.toml; "
    "satAOI-geo inspect tells how layers are read.",
)
@click.option(
    "--engine",
    type=click.Choice(["fast", "reference"]),
    default="fast",
    show_default=True,
    help="How poses are tested: row intervals, or one pose at a time, for audits of small plans, "
    "e.g. --engine reference. Both give the same answer.",
)
@click.option(
    "--exact-outline",
    is_flag=True,
    help="Keep the waves of up to 0.05 mm that the disc positions leave along the outline.",
)
@click.option("--strict", is_flag=True, help="End with exit code 1 when there are findings.")
@click.option("-q", "--quiet", is_flag=True, help="Say nothing but errors.")
def run(  # noqa: PLR0913  one parameter an option
    *,
    plan: Path,
    output: Path | None,
    report: Path | None,
    raster: Path | None,
    start: tuple[float, float] | None,
    robot: str,
    connectivity: Literal["pose", "disc"],
    clearance: float,
    step: float,
    directions: int,
    align: float | None,
    units: str | None,
    layers: Path | None,
    engine: Literal["fast", "reference"],
    exact_outline: bool,
    strict: bool,
    quiet: bool,
) -> int:
    """Find the area of interest on a floor plan.

    Without --output, --report and --raster the figures are printed and nothing is written.
    """
    from satAOI_adapters import kernel_cache, read_plan
    from satAOI_adapters.dxf_read import ReadOptions
    from satAOI_adapters.robot_read import robot_from
    from satAOI_adapters.terminal import progress, say_note

    compiled = kernel_cache.prepare()
    from satAOI_geo.pipeline import area_of_interest
    from satAOI_geo.search import Settings
    from satAOI_geo.start import StartMark

    outputs = Outputs(drawing=output, report=report, raster=raster)
    refuse_early(outputs, read=[plan, Path(robot), *([layers] if layers else [])])
    chosen_robot = robot_from(robot)
    settings = Settings(
        connectivity=connectivity,
        step_mm=step,
        n_directions=directions,
        clearance_mm=clearance,
        align_rad=None if align is None else math.radians(align),
        engine=engine,
        exact_outline=exact_outline,
    )
    floor_plan = read_plan(plan, ReadOptions(units=units, layers=layers))
    mark = None
    if start is not None:
        x_mm, y_mm = floor_plan.frame.to_local_mm(start).tolist()
        mark = StartMark((x_mm, y_mm))
    if not (compiled or quiet):
        say_note("first run of this version: compiling takes some seconds, once")
    with progress(quiet=quiet) as told:
        result = area_of_interest(floor_plan, chosen_robot, settings, start=mark, progress=told)
    write(result, outputs)
    tell(result, outputs, quiet=quiet)
    return FINDINGS if strict and result.report.findings else DONE


def refuse_early(outputs: Outputs, *, read: list[Path]) -> None:
    """Refuse outputs that could not be written before any work is done for them.

    Raises:
        InputError: If one has a suffix that no writer knows, is an input, is asked for twice, or
            cannot be a file at all.
    """
    from satAOI_adapters import writer_of
    from satAOI_adapters.files import refuse_unfit_target

    for path in (outputs.drawing, outputs.raster):
        if path is not None:
            writer_of(path)
    written: list[Path] = []
    for path in outputs.files:
        refuse_unfit_target(path, read)
        if path.absolute() in written:
            raise InputError(f"'{path}' is asked for twice; give each output a name of its own")
        written.append(path.absolute())


def write(result: "Result", outputs: Outputs) -> None:
    """Write what was asked for, each file whole or not at all."""
    from satAOI_adapters import report_write, write_aoi

    for path in (outputs.drawing, outputs.raster):
        if path is not None:
            write_aoi(path, result)
    if outputs.report == STANDARD_OUTPUT:
        sys.stdout.write(report_write.json_of(result.report))
    elif outputs.report is not None:
        report_write.write(outputs.report, result.report)


def tell(result: "Result", outputs: Outputs, *, quiet: bool) -> None:
    """Say the findings and the figures.

    The figures are talk beside an output, and the output itself where none is asked for.
    """
    from satAOI_adapters.report_write import lines_of
    from satAOI_adapters.terminal import say_findings, say_note, write_table

    if not quiet:
        say_findings(result.report.findings)
    if not outputs.asked:
        write_table(lines_of(result.report), sys.stdout)
    if quiet:
        return
    if outputs.asked:
        write_table(lines_of(result.report), sys.stderr)
    for path in outputs.files:
        say_note(f"wrote {path}")
    if not outputs.asked:
        say_note("no file was written; --output FILE.dxf draws the area into the plan")


@commands.command()
@click.option(
    "-o",
    "--output",
    metavar="FILE.dxf",
    type=click.Path(path_type=Path),
    help="Draw the area of interest into a copy of the plan, e.g. --output demo.dxf",
)
@click.pass_context
def demo(context: click.Context, output: Path | None) -> int:
    """Find the area of interest on a plan that comes with the program.

    satAOI-geo demo -o demo.dxf
    """
    from importlib.resources import as_file, files

    with as_file(files("satAOI_adapters") / "demo" / "hall_medium.dxf") as plan:
        code: int = context.invoke(run, plan=plan, output=output)
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
        sys.stdout.write(toml_of(robot_from(name)))
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
