"""Sizes and colours of a page; the only place they are chosen."""

from typing import Final

from satAOI_geo.plan import Kind

MARGIN: Final = 24.0
KEY_WIDTH: Final = 430.0
PLAN_WIDTH: Final = 1100.0
"""The greatest width of a plan on the page, and below it its greatest height."""
PLAN_HEIGHT: Final = 1100.0
OVERVIEW_HEIGHT: Final = 400.0

SMALL: Final = 13.0
MEDIUM: Final = 16.0
LARGE: Final = 20.0
LINE: Final = 1.4
"""From one line of text to the next, in sizes of its letters."""

THIN: Final = 0.8
THICK: Final = 1.6
BADGE: Final = 9.0
"""Radius of a numbered marker."""
DOT: Final = 2.5
"""Radius of the dot at the place of a finding."""

BLACK: Final = "#1a1a1a"
GREY: Final = "#8c8c8c"
WHITE: Final = "#ffffff"
RED: Final = "#c1121f"
GREEN: Final = "#00855a"
BLUE: Final = "#2f5fd0"
FLOOR_FILL: Final = "#edf3e8"
FLOOR_EDGE: Final = "#6b8f5e"
NO_OBSTACLE: Final = "#b4b4b4"

COLOURS: Final = {
    Kind.WALL: "#4d4d4d",
    Kind.UNCLASSIFIED: "#e3c800",
    Kind.EQUIPMENT: "#e08214",
    Kind.COLUMN: "#0072b2",
    Kind.HOLE: "#d1495b",
    Kind.EMBEDDED: "#8e44ad",
}
"""Colour of each kind, in the order they are drawn: what is small lies on top."""

PALE: Final = {
    Kind.WALL: "#9c9c9c",
    Kind.UNCLASSIFIED: "#efe07a",
    Kind.EQUIPMENT: "#efc08a",
    Kind.COLUMN: "#7fb8d8",
    Kind.HOLE: "#e8a4ad",
    Kind.EMBEDDED: "#c6a1d6",
}
"""Colour of what is drawn as a kind and does not stand on the floor that is read."""
