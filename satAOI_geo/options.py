"""The options of the command line: their names, their help, and what they hand on.

Options that belong together form a group; a command names the groups it takes and receives their
values as keywords, typed by the group's `TypedDict`.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any, Final, Literal, TypeAlias, TypedDict, TypeVar

import rich_click as click

from satAOI_geo.option_values import StartAt, direction, point, rectangle, start_at
from satAOI_geo.units import MM_PER_UNIT

CommandT = TypeVar("CommandT", bound=Callable[..., Any])
Group: TypeAlias = tuple[Callable[[Any], Any], ...]

FILE: Final = click.Path(path_type=Path)
POINT: Final = "X,Y"


def taking(*groups: Group) -> Callable[[CommandT], CommandT]:
    """A decorator that gives a command the options of some groups, in this order."""

    def decorate(command: CommandT) -> CommandT:
        for decorator in reversed([decorator for group in groups for decorator in group]):
            command = decorator(command)
        return command

    return decorate


WRITTEN: Final = "satAOI_geo.options.written"
"""Where a context keeps what each option was given, by the parameter's name."""


class HandingOn(click.RichCommand):
    """A command that hands options on to another one, as they were written."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Keep the options as they were written."""
        ctx.meta[WRITTEN], _, _ = self.make_parser(ctx).parse_args(args=list(args))
        return super().parse_args(ctx, args)


def handed_on(context: click.Context, *, besides: set[str]) -> list[str]:
    """The options a command was given, as arguments for another one.

    Args:
        context: Of a `HandingOn` command.
        besides: Parameters that the other command does not have.
    """
    written = context.meta[WRITTEN]
    arguments = []
    for option in context.command.params:
        if option.name in besides or option.name not in written:
            continue
        longest = max(option.opts, key=len)
        if getattr(option, "is_flag", False):
            arguments.append(longest)
        else:
            values = written[option.name] if option.multiple else [written[option.name]]
            arguments.extend(f"{longest}={value}" for value in values)
    return arguments


PLAN: Final[Group] = (click.argument("plan", type=FILE),)


class Batch(TypedDict):
    """Which plans, where their results go, and who runs them; None for what is not given."""

    plans: tuple[str, ...]
    out_dir: Path
    workers: int | None
    scheduler: str | None
    again: bool


class Sharing(TypedDict):
    """Who shares the work of a run; None for nobody."""

    workers: int | None
    scheduler: str | None


SHARING: Final[Group] = (
    click.option(
        "--workers",
        metavar="N",
        type=click.IntRange(min=1),
        panel="The search",
        help="Search the floor in bands of rows, so many at a time, each in a process of its own, "
        "e.g. --workers 4. The answer is the same. Needs Dask: pip install distributed.",
    ),
    click.option(
        "--scheduler",
        metavar="ADDRESS",
        panel="The search",
        help="Search the floor in bands of rows on the workers of a Dask scheduler, e.g. "
        "--scheduler tcp://192.168.1.20:8786",
    ),
)


BATCH: Final[Group] = (
    click.argument("plans", nargs=-1, required=True),
    click.option(
        "--out-dir",
        metavar="FOLDER",
        type=click.Path(file_okay=False, path_type=Path),
        required=True,
        panel="The batch",
        help="Where the results go, e.g. --out-dir results; it is made if there is none.",
    ),
    click.option(
        "--workers",
        metavar="N",
        type=click.IntRange(min=1),
        show_default="one after the other",
        panel="The batch",
        help="How many plans run at a time, e.g. --workers 4. Needs Dask, pip install distributed.",
    ),
    click.option(
        "--scheduler",
        metavar="ADDRESS",
        panel="The batch",
        help="Run the plans on the workers of a Dask scheduler, e.g. "
        "--scheduler tcp://192.168.1.20:8786. They find all files under the same names as this "
        "machine.",
    ),
    click.option(
        "--again",
        is_flag=True,
        panel="The batch",
        help="Run also the plans whose results are there.",
    ),
)


class Outputs(TypedDict):
    """Where the results go; none where nothing is asked for, `-` for standard output."""

    output: tuple[Path, ...]
    report: Path | None
    raster: Path | None


OUTPUTS: Final[Group] = (
    click.option(
        "-o",
        "--output",
        metavar="FILE.dxf|.ifc|.bcf",
        type=FILE,
        multiple=True,
        panel="Outputs",
        help="Draw the area of interest into a copy of the plan, e.g. --output aoi.dxf; of a plan "
        "from an IFC model also as zones in a copy of the model, or as BCF topics on what is not "
        "reached. May be given several times.",
    ),
    click.option(
        "--report",
        metavar="FILE.json",
        type=FILE,
        panel="Outputs",
        help="Write all figures and findings as JSON, e.g. --report figures.json; "
        "--report - writes to standard output.",
    ),
    click.option(
        "--raster",
        metavar="FILE.png|.npz",
        type=FILE,
        panel="Outputs",
        help="Write the area of interest cell by cell, e.g. --raster aoi.png as a picture or "
        "--raster aoi.npz as arrays.",
    ),
)


class Reading(TypedDict):
    """How the plan is read; None where nothing is said."""

    units: str | None
    layers: Path | None
    encoding: str | None
    include_hidden: bool
    xref_dir: Path | None
    plan_number: int | None
    region: tuple[float, float, float, float] | None
    close_gaps: float | None
    storey: str | None
    floor_z: float | None
    band: float | None
    with_classes: tuple[str, ...]
    without_classes: tuple[str, ...]


IFC: Final = ".ifc"
"""Suffix of models, to which other options belong than to drawings."""

ONLY_DXF: Final = {
    "write_layers": "--write-layers",
    "layers": "--layers",
    "encoding": "--encoding",
    "include_hidden": "--include-hidden",
    "xref_dir": "--xref-dir",
    "plan_number": "--plan",
    "region": "--region",
    "close_gaps": "--close-gaps",
}
ONLY_IFC: Final = {
    "storey": "--storey",
    "floor_z": "--floor-z",
    "band": "--band",
    "with_classes": "--with",
    "without_classes": "--without",
}

READING: Final[Group] = (
    click.option(
        "--units",
        metavar="UNIT",
        type=click.Choice(list(MM_PER_UNIT)),
        panel="The plan",
        help="The plan's unit of length, whatever the file says, e.g. --units mm; "
        f"one of {', '.join(MM_PER_UNIT)}.",
    ),
    click.option(
        "--layers",
        metavar="FILE.toml",
        type=FILE,
        panel="The plan",
        help="DXF: which layers are walls, columns, floor and so on, e.g. --layers office.toml; "
        "satAOI-geo inspect tells how they are read.",
    ),
    click.option(
        "--encoding",
        metavar="NAME",
        panel="The plan",
        help="DXF: encoding of the names in the file, whatever it declares, e.g. --encoding cp1251",
    ),
    click.option(
        "--include-hidden",
        is_flag=True,
        panel="The plan",
        help="DXF: read layers that are frozen or switched off, too.",
    ),
    click.option(
        "--xref-dir",
        metavar="FOLDER",
        type=FILE,
        panel="The plan",
        help="DXF: folder in which external references are looked for, e.g. --xref-dir refs; "
        "without it none is followed.",
    ),
    click.option(
        "--plan",
        "plan_number",
        metavar="N",
        type=int,
        panel="The plan",
        help="DXF: which of several plans in one drawing, e.g. --plan 2; satAOI-geo inspect "
        "lists them.",
    ),
    click.option(
        "--region",
        metavar="LEFT,BOTTOM,RIGHT,TOP",
        callback=rectangle,
        panel="The plan",
        help="DXF: the part of the drawing that is read, in drawing units, "
        "e.g. --region 0,0,12000,9000",
    ),
    click.option(
        "--close-gaps",
        metavar="MM",
        type=float,
        show_default="1",
        panel="The plan",
        help="DXF: line ends this far apart are joined where walls and outlines are closed, "
        "e.g. --close-gaps 15",
    ),
    click.option(
        "--storey",
        metavar="NAME|N",
        panel="The plan",
        help="IFC: the storey by its name, or by its number with 1 for the lowest, e.g. --storey 2",
    ),
    click.option(
        "--floor-z",
        metavar="Z",
        type=float,
        panel="The plan",
        help="IFC: height of the finished floor in the model's unit, e.g. --floor-z 3.25",
    ),
    click.option(
        "--band",
        metavar="MM",
        type=float,
        show_default="1200",
        panel="The plan",
        help="IFC: what begins higher than this above the floor is out of the robot's way, "
        "e.g. --band 900",
    ),
    click.option(
        "--with",
        "with_classes",
        metavar="CLASS",
        multiple=True,
        panel="The plan",
        help="IFC: a class that blocks, with all classes under it, although by default doors, "
        "furniture and surroundings do not, e.g. --with IfcFurniture. May be given several times.",
    ),
    click.option(
        "--without",
        "without_classes",
        metavar="CLASS",
        multiple=True,
        panel="The plan",
        help="IFC: a class that does not block, with all classes under it, e.g. --without "
        "IfcRailing. May be given several times; of two classes the more special one counts.",
    ),
)


class Question(TypedDict):
    """What is asked about the plan; align in degrees."""

    start: StartAt | None
    robot: str
    connectivity: Literal["pose", "disc"]
    clearance: float
    step: float
    directions: int
    align: float | None
    engine: Literal["fast", "reference"]
    memory: float


QUESTION: Final[Group] = (
    click.option(
        "--start",
        metavar="X,Y[,A1,A2]",
        callback=start_at,
        panel="The robot",
        help="Where the disc's centre is set down, in drawing units, e.g. --start 3200,1500.5. "
        "A1 and A2 choose the pose, in degrees counter-clockwise: A1 from the drawing's x axis to "
        "the arm, seen from the disc, A2 from the arm to the vehicle's heading, 0 when straight. "
        "Without it: the mark on layer SATAOI-START; without a mark, where the area is largest.",
    ),
    click.option(
        "--robot",
        metavar="NAME|FILE.toml",
        default="magicbim",
        show_default=True,
        panel="The robot",
        help="A robot of this build (satAOI-geo robots) or a file with its measures, "
        "e.g. --robot mine.toml",
    ),
    click.option(
        "--clearance",
        metavar="MM",
        type=float,
        default=0.0,
        show_default=True,
        panel="The robot",
        help="Distance the robot keeps from every obstacle, e.g. --clearance 20",
    ),
    click.option(
        "--connectivity",
        type=click.Choice(["pose", "disc"]),
        default="pose",
        show_default=True,
        panel="The search",
        help="What joins neighbouring disc positions: that the robot can move from the one to "
        "the other, or only that it can stand at each, an upper estimate, "
        "e.g. --connectivity disc",
    ),
    click.option(
        "--step",
        metavar="MM",
        type=float,
        default=10.0,
        show_default=True,
        panel="The search",
        help="Distance between neighbouring disc positions, e.g. --step 20",
    ),
    click.option(
        "--directions",
        metavar="N",
        type=int,
        default=24,
        show_default=True,
        panel="The search",
        help="Directions of arm and vehicle in a full turn, a multiple of 4, e.g. --directions 36",
    ),
    click.option(
        "--align",
        metavar="DEG|auto|none",
        show_default="auto",
        callback=direction,
        panel="The search",
        help="Direction of the rows of disc positions in the drawing: that of most of the walls, "
        "along the drawing's axes, or an angle in degrees, e.g. --align 33.3",
    ),
    click.option(
        "--engine",
        type=click.Choice(["fast", "reference"]),
        default="fast",
        show_default=True,
        panel="The search",
        help="How poses are tested: row intervals, or one pose at a time, for audits of small "
        "plans, e.g. --engine reference. Both give the same answer.",
    ),
    click.option(
        "--memory",
        metavar="GB",
        type=float,
        default=1.0,
        show_default=True,
        panel="The search",
        help="What the search may take in memory; a floor that would take more is searched in "
        "bands of rows, with the same answer, e.g. --memory 4",
    ),
)

EXACT_OUTLINE: Final[Group] = (
    click.option(
        "--exact-outline",
        is_flag=True,
        panel="Outputs",
        help="Keep the waves of up to 0.05 mm that the disc positions leave along the outline.",
    ),
)

STRICT: Final[Group] = (
    click.option("--strict", is_flag=True, help="End with exit code 1 when there are findings."),
)

QUIET: Final[Group] = (click.option("-q", "--quiet", is_flag=True, help="Say nothing but errors."),)

JSON: Final[Group] = (click.option("--json", is_flag=True, help="Write JSON rather than tables."),)


class Inspecting(Reading):
    """All that `inspect` can be asked."""

    picture: Path | None
    write_layers: Path | None


INSPECTION: Final[Group] = (
    click.option(
        "--picture",
        metavar="FILE.png|.svg",
        type=FILE,
        panel="Outputs",
        help="Draw the plan as it was understood, coloured by kind, with numbered findings, "
        "e.g. --picture plan.png",
    ),
    click.option(
        "--write-layers",
        metavar="FILE.toml",
        type=FILE,
        panel="Outputs",
        help="DXF: write which layer was taken for what, to be edited and given with --layers, "
        "e.g. --write-layers mine.toml",
    ),
)

TO: Final[Group] = (
    click.option(
        "--to",
        metavar=POINT,
        required=True,
        callback=point,
        help="The point to trowel, in drawing units, e.g. --to 3200,1500.5",
    ),
)

ROUTE_OUTPUT: Final[Group] = (
    click.option(
        "-o",
        "--output",
        metavar="FILE.dxf|.json",
        type=FILE,
        multiple=True,
        panel="Outputs",
        help="Draw the robot on its way into a copy of the plan, e.g. --output route.dxf, or "
        "write all its poses. May be given several times.",
    ),
)

AT: Final[Group] = (
    click.option(
        "--at",
        metavar=POINT,
        required=True,
        callback=point,
        help="The point asked about, in drawing units, e.g. --at 3200,1500.5",
    ),
)
