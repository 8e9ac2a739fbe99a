"""What a drawing may ask for at most: a stated end instead of an endless run.

Each limit is far above any floor plan seen and low enough to answer within seconds on an
ordinary machine.
"""

from typing import Final

from satAOI_geo.errors import LimitError

MAX_FILE_BYTES: Final = 256 * 1024 * 1024
"""Size of the file."""

MAX_ENTITIES: Final = 2_000_000
"""Entities after every block reference is resolved."""

MAX_NESTING: Final = 32
"""Block references inside block references."""

MAX_ARRAY: Final = 100_000
"""Copies in one array of block references (MINSERT)."""

MAX_VERTICES: Final = 5_000_000
"""Corners of all shapes together."""

MAX_CURVE_STEPS: Final = 100_000
"""Straight pieces that stand for one curve."""

MAX_COORDINATE: Final = 1e9
"""Drawing units between anything that is read and the middle of the drawing."""


def hold(limit: str, value: float, allowed: float, remedy: str) -> None:
    """Refuse what goes beyond a limit.

    Args:
        limit: What is counted, in words that follow a number.
        value: How much the drawing asks for.
        allowed: How much is allowed.
        remedy: What the user can do.

    Raises:
        LimitError: If the value is above what is allowed.
    """
    if value > allowed:
        raise LimitError(
            f"the drawing asks for {value:,.0f} {limit}, more than {allowed:,.0f}; {remedy}",
            limit=limit,
            value=value,
            allowed=allowed,
        )
