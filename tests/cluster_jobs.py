"""Functions for workers in other processes, which find them by their names."""

import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import NoReturn, TypeVar

TaskT = TypeVar("TaskT")
AnswerT = TypeVar("AnswerT")


def squared(number: int) -> int:
    return number * number


def squared_later(number: int) -> int:
    """The first at once, the others not before a minute has gone by."""
    time.sleep(60 if number else 0)
    return number * number


def refused(number: int) -> int:
    raise ValueError(number)


def squared_the_second_time(mark_and_number: tuple[Path, int]) -> int:
    """End the process at the first try."""
    mark, number = mark_and_number
    if not mark.exists():
        mark.touch()
        die()
    return number * number


def dying_once(mark: Path, function: Callable[[TaskT], AnswerT], task: TaskT) -> AnswerT:
    """End the first process that comes here; do as asked in all others."""
    if not mark.exists():
        mark.touch()
        die()
    return function(task)


def deadly_if_one(number: int) -> int:
    if number == 1:
        die()
    return number * number


def die() -> NoReturn:
    """End the process, as when it is killed."""
    # Dask replaces a worker that dies, but not one that dies as it starts
    time.sleep(1.5)
    os._exit(9)
