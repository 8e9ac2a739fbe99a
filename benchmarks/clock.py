"""How long a job takes, and how much memory this process has needed."""

import os
import resource
import statistics
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

Job: TypeAlias = Callable[[], object]


@dataclass(frozen=True, slots=True)
class Times:
    """Times of a job.

    Attributes:
        clock_s: On the clock.
        cores_s: Of all cores together, in this process and the ones it has started that have
            ended; they tell more on a machine that has other things to do.
    """

    clock_s: float
    cores_s: float

    def __add__(self, other: "Times") -> "Times":
        """Times of both jobs, one after the other."""
        return Times(self.clock_s + other.clock_s, self.cores_s + other.cores_s)

    def __mul__(self, factor: float) -> "Times":
        """Times of so many such jobs."""
        return Times(self.clock_s * factor, self.cores_s * factor)


def timed(job: Job, n_runs: int) -> Times:
    """Median times of a job; a first run, which compiles, does not count."""
    job()
    runs = [timed_once(job) for _ in range(n_runs)]
    return Times(
        statistics.median(run.clock_s for run in runs),
        statistics.median(run.cores_s for run in runs),
    )


def timed_once(job: Job) -> Times:
    """Times of one run."""
    begin = now()
    job()
    return since(begin)


def now() -> Times:
    """Times so far, to be counted from."""
    used = os.times()
    ended_children_s = used.children_user + used.children_system
    return Times(time.perf_counter(), time.process_time() + ended_children_s)


def since(begin: Times) -> Times:
    """Times from then to now."""
    return now() + begin * -1


def peak_mb() -> float:
    """The most memory that this process has held so far, in MB of 10⁶ bytes."""
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    # Linux counts in units of 1024 bytes, macOS in bytes
    return peak * (1 if sys.platform == "darwin" else 1024) / 1e6
