"""Python's collector of circular garbage, kept from looking where there is next to none.

A drawing is hundreds of thousands of small objects that all stay, and so is a loaded library. The
collector looks through them again and again, and once more when the program ends.
"""

import atexit
import gc
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

SELDOM: Final = (500_000, 10, 50)
"""When the collector looks: after so many new objects, at older ones every so many times."""


@contextmanager
def collector_at_rest() -> Iterator[None]:
    """While this lasts, no circular garbage is looked for; afterwards all is as it was."""
    was_at_work = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_at_work:
            gc.enable()


def look_seldom() -> None:
    """Let circular garbage be looked for seldom from now on.

    There is no way back: with the collector as busy as before, its next look would be at all that
    has come up meanwhile, where the program is about to end.
    """
    gc.set_threshold(*SELDOM)


def leave_at_once() -> None:
    """Let the program end without a last look for garbage: its memory goes with it.

    All that is done at the end is done all the same: files are closed, children are waited for.
    """
    atexit.register(gc.freeze)
