"""Numbers in findings: of things, grammatical also for one, and of places."""

import math


def counted(count: int, noun: str, nouns: str = "") -> str:
    """`1 space` or `3 spaces`; words whose plural has no s bring it along."""
    return f"{count} {noun}" if count == 1 else f"{count} {nouns or noun + 's'}"


def coordinate(value: float, mm_per_unit: float) -> str:
    """A coordinate in drawing units, to a tenth of a millimetre and no more digits."""
    return f"{round(value, max(0, 1 + round(math.log10(mm_per_unit)))):.12g}"


def are(count: int) -> str:
    """`is` or `are`."""
    return "is" if count == 1 else "are"
