"""What goes where on the page: the plan at the left, its key at the right.

┌──────────────────────────────┬────────────┐
│ plan.dxf                     │            │
│ ┌──────────────────────────┐ │ ■ floor    │
│ │                          │ │ ■ wall     │
│ │ plan, numbered findings  │ │ ■ ...      │
│ └──────────────────────────┘ │ ① finding  │
│ ├──── 5 m ────┤              │ ② finding  │
│ ┌──────────────────────────┐ │            │
│ │ drawing, numbered plans  │ │            │
│ └──────────────────────────┘ │            │
└──────────────────────────────┴────────────┘
"""

from pathlib import Path

from shapely.geometry import LineString

from satAOI_adapters.inspected import Figures, Inspected
from satAOI_adapters.plan_picture.fonts import face_for
from satAOI_adapters.plan_picture.key import Key, told
from satAOI_adapters.plan_picture.page import Page, Strokes, Text, printable
from satAOI_adapters.plan_picture.sheet import (
    Sheet,
    floor_bounds_mm,
    part_marks,
    place_marks,
    plan_marks,
    scale_bar,
    sketch_bounds_mm,
)
from satAOI_adapters.plan_picture.style import (
    BLACK,
    GREY,
    KEY_WIDTH,
    LARGE,
    MARGIN,
    OVERVIEW_HEIGHT,
    PLAN_HEIGHT,
    SMALL,
    THIN,
)
from satAOI_geo.errors import DrawingError


def page_of(found: Inspected[Figures]) -> Page:
    """The page that shows what was understood of a plan.

    Args:
        found: With a plan or with a sketch, or with both.
    """
    findings = told(found.findings)
    sheets = _sheets(found)
    sheet = sheets[0]
    key_x = sheet.x + max(each.width for each in sheets) + MARGIN
    key = Key(key_x, sheet.y + SMALL, face_for(line.text for line in findings))
    key.write(found, findings)
    places_mm = [(at_mm, line.label) for line in findings for at_mm in line.places_mm]
    if isinstance(found.error, DrawingError) and found.error.at_mm is not None:
        places_mm.append((found.error.at_mm, "!"))
    name = printable(Path(found.figures.source.path).name)
    marks = [Text(MARGIN, MARGIN + LARGE / 2, name, LARGE, BLACK), *key.marks]
    for each in sheets:
        marks.append(Strokes((LineString(each.rim.exterior.coords),), GREY, THIN))
        marks.extend(plan_marks(found, each))
        marks.extend(
            scale_bar(each) if found.figures.source.unit else scale_bar(each, "units", 1.0)
        )
    marks.extend(place_marks(places_mm, sheet))
    if found.sketch is not None and len(found.sketch.parts_mm) > 1:
        marks.extend(part_marks(found.sketch, sheets[-1]))
    lowest = sheets[-1].y + sheets[-1].height + 2 * MARGIN
    return Page(key_x + KEY_WIDTH + MARGIN, max(lowest, key.y) + MARGIN, tuple(marks))


def _sheets(found: Inspected[Figures]) -> list[Sheet]:
    """One for the plan, and one for the whole drawing where it holds more."""
    y = 2 * MARGIN + LARGE
    sheets = []
    if found.plan is not None:
        bounds_mm = floor_bounds_mm(found.plan)
        sheets.append(Sheet.over(bounds_mm, x=MARGIN, y=y, height=PLAN_HEIGHT))
        y += sheets[0].height + 3 * MARGIN
    if found.sketch is not None and (found.plan is None or len(found.sketch.parts_mm) > 1):
        height = PLAN_HEIGHT if found.plan is None else OVERVIEW_HEIGHT
        bounds_mm = sketch_bounds_mm(found.sketch)
        sheets.append(Sheet.over(bounds_mm, x=MARGIN, y=y, height=height))
    return sheets
