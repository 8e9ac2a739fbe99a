"""How far a run has come and how long its stages took."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeAlias

Progress: TypeAlias = Callable[[str, float], None]
"""Called with the stage's name and the share of it that is done, 0 to 1."""


class Stopwatch:
    """Times stages and passes on how far each has come.

    Attributes:
        timing_s: Seconds each stage has taken so far, by name, in order.
    """

    def __init__(self, progress: Progress | None = None) -> None:
        self._progress = progress
        self._shares = (0.0, 1.0)
        self.timing_s: dict[str, float] = {}

    @contextmanager
    def part(self, begin: float, end: float) -> Iterator[None]:
        """Let the stages inside be parts of their kind only, from one share to another."""
        self._shares = begin, end
        yield
        self._shares = 0.0, 1.0

    @contextmanager
    def stage(self, name: str) -> Iterator[Callable[[float], None]]:
        """Time what happens inside under a name; what is yielded tells which share is done."""
        begin, end = self._shares

        def share(done: float) -> None:
            if self._progress is not None:
                self._progress(name, begin + (end - begin) * done)

        share(0.0)
        begin_s = time.perf_counter()
        yield share
        taken_s = time.perf_counter() - begin_s
        self.timing_s[name] = self.timing_s.get(name, 0.0) + taken_s
        share(1.0)
