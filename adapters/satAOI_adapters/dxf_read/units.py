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

CONTRADICTION: Final = 5.0
"""A header this many times off the estimate is not believed: cm and inch are 2.5 times apart."""


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
        _check_plausible(header, guess, size, name)
        return Known(Unit(header, "header"))
    if guess is not None:
        return Known(Unit(guess.unit, "estimate"), (_estimated(guess, size),))
    raise UnitError(
        f"no unit of length in '{name}' ($INSUNITS is {code}), and nothing in it tells; "
        f"{_choices(size)}"
    )


def _check_plausible(
    header: str, guess: Estimate | None, size: tuple[float, float], name: str
) -> None:
    """Refuse a header that doors, walls and texts contradict."""
    if guess is None or header not in guess.against or _factor(guess.unit, header) <= CONTRADICTION:
        return
    raise UnitError(
        f"'{name}' says that its unit is {header}, which makes it {in_metres(size, header)}; its "
        f"{guess.reasons} say {guess.unit}, which makes it {in_metres(size, guess.unit)}; give "
        f"--units {guess.unit} or --units {header}"
    )


def _factor(one: str, other: str) -> float:
    """How many times the larger of two units is the smaller one."""
    ratio = MM_PER_UNIT[one] / MM_PER_UNIT[other]
    return max(ratio, 1 / ratio)


def _estimated(guess: Estimate, size: tuple[float, float]) -> Finding:
    return Finding(
        "unit-estimated",
        f"the drawing names no unit; its {guess.reasons} say {guess.unit}, which makes it "
        f"{in_metres(size, guess.unit)}",
        f"give --units {guess.unit} if that is right, another unit if not",
    )


def _choices(size: tuple[float, float]) -> str:
    """What to type, with the size that each usual unit gives the drawing."""
    offers = ", ".join(f"--units {unit} for {in_metres(size, unit)}" for unit in USUAL)
    return f"the drawing measures {size[0]:.6g} × {size[1]:.6g} units: give {offers}"


def in_metres(size: tuple[float, float], unit: str) -> str:
    """A size in drawing units as metres, were this its unit."""
    width_m, height_m = (length * MM_PER_UNIT[unit] / 1000 for length in size)
    return f"{width_m:.3g} × {height_m:.3g} m"
