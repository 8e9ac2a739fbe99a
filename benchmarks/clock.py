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
    """Medians over several runs.

    Attributes:
        clock_s: On the clock.
        cores_s: Of all cores together, in this process and the ones it has started; they tell
            more on a machine that has other things to do.
    """

    clock_s: float
    cores_s: float


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
    cores_before_s, begin_s = _cores_used_s(), time.perf_counter()
    job()
    return Times(time.perf_counter() - begin_s, _cores_used_s() - cores_before_s)


def _cores_used_s() -> float:
    """Processor time so far, of all threads and of the processes that have ended."""
    used = os.times()
    return used.user + used.system + used.children_user + used.children_system


def peak_mb() -> float:
    """The most memory that this process has held so far, in MB of 10⁶ bytes."""
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    # Linux counts in units of 1024 bytes, macOS in bytes
    return peak * (1 if sys.platform == "darwin" else 1024) / 1e6
