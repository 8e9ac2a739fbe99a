"""Jobs shared out among threads; kernels, numpy and shapely release the interpreter's lock."""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

Answer = TypeVar("Answer")


def run_threads(
    job: Callable[[int], Answer], n_jobs: int, progress: Callable[[float], None] | None = None
) -> list[Answer]:
    """The answers of jobs 0 .. n_jobs - 1, a thread per core.

    Progress is called with the share that is done.
    """
    answers: list[Answer] = []
    with ThreadPoolExecutor(max_workers=n_cores()) as pool:
        for answer in pool.map(job, range(n_jobs)):
            answers.append(answer)
            if progress is not None:
                progress(len(answers) / n_jobs)
    return answers


def n_cores() -> int:
    """Cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
