"""What the commands write and say: outputs refused early, written, told.

Data goes to standard output, talk to standard error.
"""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

import rich_click as click

from satAOI_geo.errors import InputError
from satAOI_geo.options import IFC, Inspecting, Outputs

if TYPE_CHECKING:
    from satAOI_adapters import Inspection
    from satAOI_adapters.batch_results import Row
    from satAOI_geo.pipeline import Result
    from satAOI_geo.route import Route

STANDARD_OUTPUT: Final = Path("-")
ONLY_FROM_IFC: Final = {".ifc", ".bcf"}
"""Outputs that add to the model that the plan was read from."""


def refuse_early(plan: Path, outputs: Outputs, read: list[Path | None]) -> None:
    """Refuse outputs that could not be written, before any work is done for them.

    Raises:
        InputError: If one has a suffix that no writer knows or that does not go with the plan's or
            the option, is an input, is asked for twice, or cannot be a file at all.
    """
    from satAOI_adapters import RASTERS, WRITERS, writer_of

    for path in areas_of(outputs):
        writer_of(path)
        if path.suffix.lower() in ONLY_FROM_IFC and plan.suffix.lower() != IFC:
            raise InputError(f"'{path}' adds to an IFC model, and '{plan}' is none; write a DXF")
    raster, report = outputs["raster"], outputs["report"]
    if raster is not None and raster.suffix.lower() not in RASTERS:
        raise InputError(
            f"'{raster}' is to be a raster; give a name that ends in {' or '.join(RASTERS)}"
        )
    if report is not None and report.suffix.lower() in WRITERS:
        raise InputError(f"'{report}' is to hold the figures; give a name that ends in .json")
    refuse_targets(files_of(outputs), read)


def refuse_targets(files: Sequence[Path], read: list[Path | None]) -> None:
    """Refuse files that could not be written.

    Raises:
        InputError: If one is an input, is asked for twice, or cannot be a file at all.
    """
    from satAOI_adapters.files import refuse_unfit_target

    seen: list[Path] = []
    for path in files:
        refuse_unfit_target(path, [one for one in read if one is not None])
        if path.resolve() in seen:
            raise InputError(f"'{path}' is asked for twice; give each output a name of its own")
        seen.append(path.resolve())


def areas_of(outputs: Outputs) -> list[Path]:
    """The files that the area of interest is written to."""
    raster = outputs["raster"]
    return [*outputs["output"], *([] if raster is None else [raster])]


def files_of(outputs: Outputs) -> list[Path]:
    """All files to be written."""
    report = outputs["report"]
    return [*areas_of(outputs), *([] if report in {None, STANDARD_OUTPUT} else [report])]


def write(result: "Result", outputs: Outputs) -> None:
    """Write what was asked for, each file whole or not at all."""
    from satAOI_adapters import report_write, write_aoi
    from satAOI_adapters.files import json_of

    for path in areas_of(outputs):
        write_aoi(path, result)
    if outputs["report"] == STANDARD_OUTPUT:
        click.echo(json_of(result.report), nl=False)
    elif outputs["report"] is not None:
        report_write.write(outputs["report"], result.report)


def tell(result: "Result", outputs: Outputs, *, quiet: bool) -> None:
    """Say the findings and the figures.

    The figures are talk beside an output, and the output itself where none is asked for.
    """
    from satAOI_adapters.report_write import lines_of
    from satAOI_adapters.terminal import say_findings, say_note, write_table

    alone = not areas_of(outputs) and outputs["report"] is None
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


def tell_route(result: "Result", found: "Route", output: tuple[Path, ...], *, quiet: bool) -> None:
    """Say the findings and a route's figures, the output itself where no other is asked for."""
    from satAOI_adapters.route_write import lines_of
    from satAOI_adapters.terminal import say_findings, say_note, write_table

    if not output:
        write_table(lines_of(found), sys.stdout)
    if quiet:
        return
    say_findings(result.report.findings)
    if output:
        write_table(lines_of(found), sys.stderr)
    else:
        say_note("no file was written; --output FILE.dxf draws the route into the plan")
    for path in output:
        say_note(f"wrote {path}")


def refuse_drafts_early(plan: Path, options: Inspecting) -> None:
    """Refuse what could not be written, before any work is done for it.

    Raises:
        InputError: If a name has a suffix that is not its format's, is an input, is asked for
            twice, or cannot be that of a file at all.
    """
    from satAOI_adapters import layers_writer_of, picture_writer_of

    picture, layers = options["picture"], options["write_layers"]
    if picture is not None:
        picture_writer_of(picture)
    if layers is not None:
        layers_writer_of(layers)
    refuse_targets(
        [file for file in (picture, layers) if file is not None], [plan, options["layers"]]
    )


def write_drafts(plan: Path, found: "Inspection", options: Inspecting) -> None:
    """Write what was asked for, as far as there is something to show; each file whole or not.

    A model that is no plan as it is has nothing to be drawn.
    """
    from satAOI_adapters import layers_writer_of, picture_writer_of
    from satAOI_adapters.terminal import say_note

    inputs = [file for file in (plan, options["layers"]) if file is not None]
    picture, layers = options["picture"], options["write_layers"]
    if layers is not None and found.layers is not None:
        layers_writer_of(layers)(layers, found.layers, inputs)
        say_note(f"wrote {layers}")
    if picture is not None and (found.plan is not None or found.sketch is not None):
        picture_writer_of(picture)(picture, found, inputs)
        say_note(f"wrote {picture}")


def tell_figures(found: "Inspection", *, json: bool) -> None:
    """Print an inspection's figures as tables or as JSON."""
    from satAOI_adapters import inspect_write
    from satAOI_adapters.files import json_of
    from satAOI_adapters.terminal import write_table

    if json:
        click.echo(json_of(found.figures), nl=False)
        return
    for number, table in enumerate(inspect_write.tables_of(found.figures)):
        click.echo("\n" * min(number, 1), nl=False)
        write_table(table, sys.stdout)


def tell_batch(rows: "list[Row]", out_dir: Path, *, n_kept: int, n_left_out: int) -> None:
    """Say what came of each plan of a batch."""
    from satAOI_adapters.batch_results import table_of
    from satAOI_adapters.terminal import say_note, write_table

    write_table(table_of(rows), sys.stdout)
    if n_kept:
        say_note(f"results that were there already: {n_kept}; --again runs these plans, too")
    if n_left_out:
        say_note(f"results of this batch are no plans; left out: {n_left_out}")
    say_note(f"wrote {out_dir / 'results.csv'} and {out_dir / 'results.json'}")
