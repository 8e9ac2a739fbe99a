"""The drawing's unit of length: what the user says, else what the header says, else an error."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from satAOI_adapters.dxf_read.estimate import Estimate
from satAOI_geo.errors import InputError, UnitError
from satAOI_geo.plan import Finding
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

SMALLEST_M: Final = 2.0
LARGEST_M: Final = 2000.0
"""No plan is shorter or longer than this."""


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


@dataclass(frozen=True, slots=True)
class Known:
    """A unit and what is to be said about it."""

    unit: Unit
    findings: tuple[Finding, ...] = ()


def unit_of(
    code: int,
    option: str | None,
    guess: Estimate | None,
    size: tuple[float, float],
    name: str,
) -> Known:
    """The unit of a drawing: what the user says, what the header says, what the estimate says.

    Args:
        code: $INSUNITS.
        option: What the user says, a key of `units.MM_PER_UNIT`.
        guess: What doors, walls and columns speak for.
        size: Width and height of what is drawn, in drawing units.
        name: The file's name, for messages.

    Raises:
        InputError: If the user names an unknown unit.
        UnitError: If nothing tells the unit, or the header and the estimate contradict each other.
    """
    if option is not None:
        if option not in MM_PER_UNIT:
            raise InputError(f"unknown unit '{option}'; known are {', '.join(MM_PER_UNIT)}")
        return Known(Unit(option, "option"))
    header = HEADER_UNITS.get(code)
    if header is not None:
        return Known(Unit(header, "header"), _doubts(header, guess, size, name))
    if guess is not None and len(guess.units) == 1:
        return Known(Unit(guess.units[0], "estimate"), (_estimated(guess, size),))
    tells = "nothing in it tells" if guess is None else _told(guess, size)
    raise UnitError(
        f"no unit of length in '{name}' ($INSUNITS is {code}), and {tells}; the drawing measures "
        f"{size[0]:.6g} × {size[1]:.6g} units: give {_offers(size)}"
    )


def hold_size(unit: Unit, size_mm: tuple[float, float] | None, name: str) -> None:
    """Refuse a plan that is no building's size, unless the user says what its unit is.

    Args:
        unit: Of the drawing.
        size_mm: Width and height of what stands in the plan that is read, or is its floor; None if
            there is nothing of this.
        name: The file's name, for messages.

    Raises:
        UnitError: If the plan is too small or too large.
    """
    if size_mm is None or unit.source == "option":
        return
    if SMALLEST_M <= max(size_mm) / 1000 <= LARGEST_M:
        return
    size = (size_mm[0] / unit.mm, size_mm[1] / unit.mm)
    raise UnitError(
        f"'{name}' is read in {unit.name}, which makes the plan in it {in_metres(size, unit.name)}"
        f"; give {_offers(size)}"
    )


def _doubts(
    header: str, guess: Estimate | None, size: tuple[float, float], name: str
) -> tuple[Finding, ...]:
    """What doors, walls and texts have against a header.

    Raises:
        UnitError: If they rule it out.
    """
    if guess is None or header not in guess.doubted:
        return ()
    says = f"says that its unit is {header}, which makes it {in_metres(size, header)}"
    but = f"but {_told(guess, size)}"
    options = " or ".join(f"--units {unit}" for unit in guess.units)
    if header in guess.against:
        raise UnitError(f"'{name}' {says}, {but}; give {options} or --units {header}")
    return (
        Finding(
            "unit-doubtful",
            f"the drawing {says}, {but}; the header is believed",
            f"give {options} if the header is wrong, --units {header} if it is right",
        ),
    )


def _told(guess: Estimate, size: tuple[float, float]) -> str:
    """What a drawing tells of its unit."""
    sizes = " or ".join(in_metres(size, unit) for unit in guess.units)
    return f"its {guess.reasons} say {' or '.join(guess.units)}, which makes it {sizes}"


def _estimated(guess: Estimate, size: tuple[float, float]) -> Finding:
    return Finding(
        "unit-estimated",
        f"the drawing names no unit; {_told(guess, size)}",
        f"give --units {guess.units[0]} if that is right, another unit if not",
    )


def _offers(size: tuple[float, float]) -> str:
    """What to type, with the size that each usual unit makes of one in drawing units."""
    return ", ".join(f"--units {unit} for {in_metres(size, unit)}" for unit in USUAL)


def in_metres(size: tuple[float, float], unit: str) -> str:
    """A size in drawing units as metres, were this its unit."""
    width, height = (_three_digits(length * MM_PER_UNIT[unit] / 1000) for length in size)
    return f"{width} × {height} m"


def _three_digits(number: float) -> str:
    """A number to three digits, as people write it."""
    rounded = float(f"{number:.3g}")
    return f"{rounded:.0f}" if rounded >= 1000 else f"{rounded:g}"
