"""What came of a batch: a table for people, CSV and JSON for programs."""

import csv
import io
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Final, Literal, TypeAlias

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError

from satAOI_adapters.files import written_whole

JSON_NAME: Final = "results.json"
CSV_NAME: Final = "results.csv"
SUMMARIES: Final = (JSON_NAME, CSV_NAME)


def printable(name: str) -> str:
    """A name as text for files: bytes in it that are no text are written as escapes."""
    return name.encode("utf-8", "backslashreplace").decode()


Text: TypeAlias = Annotated[str, BeforeValidator(printable)]


class Row(BaseModel):
    """What came of a plan; figures are None where there is no area.

    Attributes:
        plan: As the user gave it, printable.
        exit_code: That of its run, 128 + N when signal N ended it.
        area_m2: Area of interest.
        percent_of_free: The same in percent of the free floor.
        n_findings: Findings in its report.
        time_s: What the run took.
        message: Why there is no area, or an empty string.
        output: The drawing with the area.
        report: The report.
        sha256: Digest of the plan's bytes.
        asked: Digest of the options and of what the files that they name hold.
        version: Of the program.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    plan: Text
    exit_code: int
    area_m2: float | None = None
    percent_of_free: float | None = None
    n_findings: int | None = None
    time_s: float
    message: Text = ""
    output: Text
    report: Text
    sha256: str
    asked: str
    version: str


class Results(BaseModel):
    """All rows of a batch, in the order of its plans."""

    model_config = ConfigDict(frozen=True, extra="forbid", populate_by_name=True)

    schema_name: Literal["sataoi-batch/1"] = Field(alias="schema")
    rows: list[Row]


def save(out_dir: Path, rows: list[Row]) -> None:
    """Write the rows to a folder as JSON and as CSV.

    Raises:
        InputError: If they cannot be written.
    """
    text = (
        Results(schema="sataoi-batch/1", rows=rows).model_dump_json(by_alias=True, indent=2) + "\n"
    )
    with written_whole(out_dir / JSON_NAME) as stream:
        stream.write(text.encode())
    table = io.StringIO()
    writer = csv.writer(table)
    writer.writerow(Row.model_fields)
    writer.writerows(row.model_dump().values() for row in rows)
    with written_whole(out_dir / CSV_NAME) as stream:
        stream.write(table.getvalue().encode())


def earlier_rows(out_dir: Path) -> dict[str, Row]:
    """The rows of the batch that a folder holds by their plan; none that cannot be understood."""
    try:
        text = (out_dir / JSON_NAME).read_bytes()
        return {row.plan: row for row in Results.model_validate_json(text).rows}
    except (FileNotFoundError, ValidationError):
        return {}


def table_of(rows: Sequence[Row]) -> list[tuple[str, ...]]:
    """The rows as a person reads them."""
    heads = ("plan", "area", "of free", "time", "exit", "")
    return [heads, *(_line_of(row) for row in rows)]


def _line_of(row: Row) -> tuple[str, ...]:
    """A row as text."""
    area = "" if row.area_m2 is None else f"{row.area_m2:.2f} m²"
    share = "" if row.percent_of_free is None else f"{row.percent_of_free:.1f} %"
    message = row.message
    if row.n_findings:
        message = f"{row.n_findings} finding{'s' * (row.n_findings > 1)}"
    return row.plan, area, share, f"{row.time_s:.1f} s", str(row.exit_code), message
