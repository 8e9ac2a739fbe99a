"""Functions for workers in other processes, which find them by their names."""

import os
import time
from pathlib import Path


def squared(number: int) -> int:
    return number * number


def refused(number: int) -> int:
    raise ValueError(number)


def squared_the_second_time(mark_and_number: tuple[Path, int]) -> int:
    """End the process at the first try, as when it is killed."""
    mark, number = mark_and_number
    try:
        mark.touch(exist_ok=False)
    except FileExistsError:
        return number * number
    time.sleep(0.5)
    os._exit(9)


def deadly_if_one(number: int) -> int:
    if number == 1:
        # Dask replaces a worker that dies, but not one that dies as it starts
        time.sleep(0.5)
        os._exit(9)
    return number * number
