"""Memory handed back while a large floor is worked on."""

import ctypes
from collections.abc import Callable
from functools import cache


def give_back() -> None:
    """Hand memory that is free back to the system, where the C library has a call for it.

    Between large pieces of work: what small results lie scattered among is otherwise kept, and
    grows to several times what is in use.
    """
    trim = _trim()
    if trim is not None:
        trim(0)


@cache
def _trim() -> Callable[[int], int] | None:
    """The C library's `malloc_trim`, or None: only that of GNU has it."""
    try:
        found: Callable[[int], int] = ctypes.CDLL(None).malloc_trim
    except (AttributeError, OSError, TypeError):
        # another C library; no name stands for the running program on Windows
        return None
    return found
