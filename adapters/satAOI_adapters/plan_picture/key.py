"""The key beside the plan: what the colours mean, and what was found."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import groupby
from typing import Final

import shapely
from shapely.geometry import LineString, box

from satAOI_adapters.inspected import Figures, Inspected, Sketch
from satAOI_adapters.plan_picture.fonts import wrapped
from satAOI_adapters.plan_picture.page import Area, Disc, Mark, Strokes, Text, printable
from satAOI_adapters.plan_picture.sheet import badge, start_sign
from satAOI_adapters.plan_picture.style import (
    BADGE,
    BLACK,
    BLUE,
    COLOURS,
    DOT,
    FLOOR_EDGE,
    FLOOR_FILL,
    GREY,
    KEY_WIDTH,
    LARGE,
    LINE,
    MEDIUM,
    NO_OBSTACLE,
    RED,
    SMALL,
    THICK,
    THIN,
    WHITE,
)
from satAOI_geo.plan import Finding, FloorPlan, Kind
from satAOI_geo.units import MM2_PER_M2

TOLD_OF_A_SORT: Final = 3
"""Findings of one sort that have a text of their own; a page of them would hide the others."""

INDENT: Final = 36.0
"""From the signs of the key to their texts."""

NONE: Final = "none"
"""Said of a kind of which there is nothing."""


@dataclass(frozen=True, slots=True)
class Told:
    """A finding, or several of one sort, as the key tells it.

    Attributes:
        text: What is said.
        label: Its number on the plan; empty where it has no place.
        places_mm: Where, in the drawing's axes.
    """

    text: str
    label: str = ""
    places_mm: tuple[tuple[float, float], ...] = ()


def told(findings: Iterable[Finding]) -> list[Told]:
    """The findings, those that have a place first and numbered, the first few of each sort."""
    in_order = sorted(findings, key=lambda finding: (finding.at_mm is None, finding.code))
    lines: list[Told] = []
    n_labels = 0
    for _, group in groupby(in_order, key=lambda finding: (finding.at_mm is None, finding.code)):
        same = list(group)
        for finding in same[:TOLD_OF_A_SORT]:
            n_labels += finding.at_mm is not None
            label = str(n_labels) if finding.at_mm is not None else ""
            lines.append(Told(_sentence(finding), label, _places_mm([finding])))
        rest = same[TOLD_OF_A_SORT:]
        if rest:
            text = f"and {len(rest)} more of '{rest[0].code}'"
            lines.append(Told(text, "", _places_mm(rest)))
    return lines


def _sentence(finding: Finding) -> str:
    remedy = f"; {finding.remedy}" if finding.remedy else ""
    return printable(finding.message + remedy)


def _places_mm(findings: Sequence[Finding]) -> tuple[tuple[float, float], ...]:
    return tuple(finding.at_mm for finding in findings if finding.at_mm is not None)


@dataclass(slots=True)
class Key:
    """The key while it is written, from the top down.

    Attributes:
        x: Its left edge.
        y: The middle of its next line.
        face: Typeface that its lines are measured in.
        marks: What was written.
    """

    x: float
    y: float
    face: str
    marks: list[Mark] = field(default_factory=list)

    def write(self, found: Inspected[Figures], findings: Sequence[Told]) -> None:
        """Write the whole key."""
        source = found.figures.source
        unit = (
            f"{source.unit} ({source.unit_source})" if source.unit else "a unit that is not known"
        )
        self._entry((), f"drawn in {unit}", GREY)
        if found.plan is None:
            self._kinds({kind: str(kind) for kind in COLOURS})
        else:
            self._floor(found.plan)
            self._kinds({kind: f"{kind}: {_amount(found.plan, kind)}" for kind in COLOURS})
        if found.sketch is not None:
            self._sketch(found.sketch, faded=found.plan is not None)
        if found.error is not None:
            self._heading("Cannot be used as it is")
            self._entry(badge(self.x + BADGE, self.y, "!", RED), printable(str(found.error)), RED)
        self._heading("Findings" if findings else "No findings")
        for line in findings:
            self._entry(self._sign_of(line), line.text)

    def _floor(self, plan: FloorPlan) -> None:
        area_m2 = plan.floor.area / MM2_PER_M2
        self._entry(
            self._swatch(FLOOR_FILL, FLOOR_EDGE), f"floor: {area_m2:.2f} m² ({plan.floor_source})"
        )
        if plan.start_mm is not None:
            self._entry(start_sign(self.x + BADGE, self.y), "start, as marked in the drawing")

    def _kinds(self, texts: Mapping[Kind, str]) -> None:
        for kind, text in texts.items():
            absent = text.endswith(NONE)
            self._entry(self._swatch(COLOURS[kind], COLOURS[kind]), text, GREY if absent else BLACK)

    def _sketch(self, sketch: Sketch, *, faded: bool) -> None:
        line = LineString([(self.x, self.y), (self.x + 2 * BADGE, self.y)])
        paler = "; paler colours: left out of this plan" if faded else ""
        self._entry([Strokes((line,), NO_OBSTACLE, THICK)], f"drawn, and no obstacle{paler}")
        if len(sketch.parts_mm) > 1:
            number = badge(self.x + BADGE, self.y, "N", BLUE)
            self._entry(number, "part that may be a plan, for --plan N")

    def _sign_of(self, line: Told) -> Iterable[Mark]:
        """The number of a finding, a dot for several places, a dash for none."""
        x = self.x + BADGE
        if line.label:
            return badge(x, self.y, line.label, RED)
        if line.places_mm:
            return [Disc(x, self.y, DOT, RED, WHITE)]
        return [Text(x, self.y, "–", SMALL, BLACK, centred=True)]

    def _swatch(self, fill: str, stroke: str) -> list[Mark]:
        shape = box(self.x, self.y - SMALL / 2, self.x + 2 * BADGE, self.y + SMALL / 2)
        return [Area(shape, fill, stroke, THIN)]

    def _heading(self, text: str) -> None:
        self.y += LARGE / 2
        self.marks.append(Text(self.x, self.y, text, MEDIUM, BLACK))
        self.y += LARGE * LINE

    def _entry(self, sign: Iterable[Mark], text: str, colour: str = BLACK) -> None:
        self.marks.extend(sign)
        for line in wrapped(text, self.face, SMALL, KEY_WIDTH - INDENT):
            self.marks.append(Text(self.x + INDENT, self.y, line, SMALL, colour))
            self.y += SMALL * LINE
        self.y += SMALL / 2


def _amount(plan: FloorPlan, kind: Kind) -> str:
    """How many obstacles of a kind there are, and how much of the floor they cover."""
    regions = [obstacle.region() for obstacle in plan.obstacles if obstacle.kind is kind]
    if not regions:
        return NONE
    area_m2 = shapely.union_all(regions).intersection(plan.floor).area / MM2_PER_M2
    pieces = "1 piece" if len(regions) == 1 else f"{len(regions)} pieces"
    return f"{pieces}, {area_m2:.2f} m² of the floor"
