"""What programs can read back from the drawing: facts on entities and the run's settings."""

import itertools
import json
from collections.abc import Iterator, Mapping
from dataclasses import asdict, replace
from pathlib import PurePath
from typing import Final, TypeAlias

from ezdxf.document import Drawing
from ezdxf.entities import DXFEntity, XRecord

from satAOI_geo.pipeline import Result

APPID: Final = "SATAOI"
"""Owner of the extended data, and the name of the record in the drawing's root dictionary."""

SCHEMA: Final = "sataoi-dxf/1"

STRING_LIMIT: Final = 250
"""Bytes in one string: DXF allows 255, and some readers stop at a longer one."""

CODED: Final = len(r"\U+58C1")
"""Bytes of a character that the file's encoding may lack."""

SETTINGS: Final = ("robot", "lattice", "floor", "start", "aoi")
"""Sections of the report that go into the drawing besides the input."""

Facts: TypeAlias = Mapping[str, str | int | float]


def add_appid(document: Drawing) -> None:
    """Make the name known under which `attach` writes."""
    if APPID not in document.appids:
        document.appids.add(APPID)


def attach(entity: DXFEntity, facts: Facts) -> None:
    """Put facts on an entity as extended data: the schema, then name and value in turn."""
    entity.set_xdata(APPID, [(1000, SCHEMA), *_tags(facts)])


def record_run(document: Drawing, result: Result) -> None:
    """Put the run's settings into the root dictionary, as JSON cut into short strings.

    The strings of group code 300 are to be joined. What differs between two equal runs, the time
    they took and the folder they ran in, is left out.
    """
    text = json.dumps(_settings(result), sort_keys=True)
    chunks = [text[k : k + STRING_LIMIT] for k in range(0, len(text), STRING_LIMIT)]
    record = document.rootdict.get(APPID)
    if not isinstance(record, XRecord):
        record = document.rootdict.add_xrecord(APPID)
    record.reset([(1, SCHEMA), *((300, chunk) for chunk in chunks)])


def _settings(result: Result) -> dict[str, object]:
    report, frame = result.report, result.plan.frame
    name = PurePath(report.input.path).name
    return {
        **{section: asdict(getattr(report, section)) for section in SETTINGS},
        "input": asdict(replace(report.input, path=name)),
        "frame": {
            "origin_mm": frame.origin_mm,
            "turn_rad": frame.turn_rad,
            "mm_per_unit": frame.mm_per_unit,
        },
    }


def _tags(facts: Facts) -> Iterator[tuple[int, str | int | float]]:
    for name, value in facts.items():
        yield 1000, name
        if isinstance(value, str):
            yield 1000, _cut(one_line(value))
        else:
            yield (1071 if isinstance(value, int) else 1040), value


def _cut(text: str) -> str:
    """As much of a text as fits into one string in any encoding."""
    ends = itertools.accumulate(1 if character.isascii() else CODED for character in text)
    return text[: sum(end <= STRING_LIMIT for end in ends)]


def one_line(text: str) -> str:
    """Text without control characters: a line break inside a string would damage the file."""
    return "".join(c if c.isprintable() else " " for c in text)
