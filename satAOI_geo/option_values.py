"""Values of options as they are typed, turned into numbers or refused with an example."""

import math
from collections.abc import Callable
from typing import Final, NamedTuple, TypeAlias

import rich_click as click


class StartAt(NamedTuple):
    """A start: place in drawing units, a1 and a2 of the pose in degrees or None for any pose."""

    place: tuple[float, float]
    angles_deg: tuple[float, float] | None = None


Parsed: TypeAlias = Callable[[click.Context, click.Parameter, str | None], tuple[float, ...] | None]
"""What turns the text of an option into numbers; None where it was not given."""

COUNTS: Final = {2: "two numbers with a comma", 4: "four numbers with commas"}
"""How many numbers an option may take, in words."""


def numbers(*examples: str) -> Parsed:
    """What takes finite numbers with commas between them, as many as one of the examples has."""
    by_count = {example.count(",") + 1: example for example in examples}
    wanted = ", nor ".join(f"{COUNTS[n]}, as in {by_count[n]}" for n in by_count)

    def parse(
        context: click.Context, parameter: click.Parameter, text: str | None
    ) -> tuple[float, ...] | None:
        if text is None:
            return None
        try:
            found = tuple(map(float, text.split(",")))
        except ValueError:
            found = ()
        if len(found) not in by_count or not all(map(math.isfinite, found)):
            raise click.BadParameter(f"'{text}' is not {wanted}", ctx=context, param=parameter)
        return found

    return parse


point: Final = numbers("3200,1500.5")
rectangle: Final = numbers("0,0,12000,9000")


def start_at(
    context: click.Context, parameter: click.Parameter, text: str | None
) -> StartAt | None:
    """A start written `X,Y` or `X,Y,A1,A2`."""
    found = numbers("3200,1500.5", "3200,1500.5,90,0")(context, parameter, text)
    if found is None:
        return None
    x, y, *angles_deg = found
    return StartAt((x, y), (angles_deg[0], angles_deg[1]) if angles_deg else None)


def direction(context: click.Context, parameter: click.Parameter, text: str | None) -> float | None:
    """The lattice's direction in degrees; None to find it."""
    if text is None or text == "auto":
        return None
    try:
        return 0.0 if text == "none" else float(text)
    except ValueError as error:
        message = f"'{text}' is neither an angle in degrees nor auto nor none"
        raise click.BadParameter(message, ctx=context, param=parameter) from error
