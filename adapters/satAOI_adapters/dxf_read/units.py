"""The drawing's unit of length: what the user says, else what the header says, else an error."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from ezdxf.document import Drawing

from satAOI_geo.errors import InputError, UnitError
from satAOI_geo.units import MM_PER_UNIT

HEADER_UNITS: Final[Mapping[int, str]] = {
    1: "in",
    2: "ft",
    3: "mi",
    4: "mm",
    5: "cm",
    6: "m",
    7: "km",
    10: "yd",
    13: "um",
    14: "dm",
}
"""$INSUNITS as the DXF reference numbers it, those that a building is drawn in."""

USUAL: Final = ("mm", "cm", "m", "in", "ft")
"""Units whose sizes an error message offers."""


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit of length and how it is known.

    Attributes:
        name: Key of `units.MM_PER_UNIT`.
        source: `option`, `header` or `estimate`.
    """

    name: str
    source: str

    @property
    def mm(self) -> float:
        """Millimetres in one drawing unit."""
        return MM_PER_UNIT[self.name]


def unit_of(document: Drawing, option: str | None, size: tuple[float, float], name: str) -> Unit:
    """The unit of a drawing.

    Args:
        document: The drawing.
        option: What the user says, a key of `units.MM_PER_UNIT`.
        size: Width and height of what is drawn, in drawing units.
        name: The file's name, for messages.

    Raises:
        InputError: If the user names an unknown unit.
        UnitError: If neither the user nor the header names one.
    """
    if option is not None:
        if option not in MM_PER_UNIT:
            raise InputError(f"unknown unit '{option}'; known are {', '.join(MM_PER_UNIT)}")
        return Unit(option, "option")
    code = document.header.get("$INSUNITS", 0)
    if code in HEADER_UNITS:
        return Unit(HEADER_UNITS[code], "header")
    raise UnitError(f"no unit of length in '{name}' ($INSUNITS is {code}); {choices(size)}")


def choices(size: tuple[float, float]) -> str:
    """What to type, with the size that each usual unit gives the drawing."""
    offers = ", ".join(f"--units {unit} for {in_metres(size, unit)}" for unit in USUAL)
    return f"the drawing measures {size[0]:.6g} × {size[1]:.6g} units: give {offers}"


def in_metres(size: tuple[float, float], unit: str) -> str:
    """A size in drawing units as metres, were this its unit."""
    width_m, height_m = (length * MM_PER_UNIT[unit] / 1000 for length in size)
    return f"{width_m:.3g} × {height_m:.3g} m"
