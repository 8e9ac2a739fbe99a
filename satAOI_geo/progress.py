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
        timing_s: Seconds each finished stage took, by name, in order.
    """

    def __init__(self, progress: Progress | None = None) -> None:
        self._progress = progress
        self._stage = ""
        self.timing_s: dict[str, float] = {}

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Time what happens inside under a name."""
        self._stage = name
        self.share(0.0)
        begin_s = time.perf_counter()
        yield
        self.timing_s[name] = time.perf_counter() - begin_s
        self.share(1.0)

    def share(self, done: float) -> None:
        """Tell which share of the running stage is done."""
        if self._progress is not None:
            self._progress(self._stage, done)
