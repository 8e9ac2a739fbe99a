"""Work shared out: one function over many tasks, in processes here or on the workers of Dask.

    with workers(n_workers=4) as crew:
        for outcome in crew.outcomes(function, tasks):
            print(outcome.number, outcome.value())

Function, tasks and answers go from process to process, so they are pickled: the function by its
name in a module. Outcomes come in the order in which they are ready. Tasks are taken as workers
get free, and none when as many outcomes wait to be fetched, so that memory is bounded. A task
whose worker dies is given to another one, a few times at most.
"""

import itertools
import os
import queue
import signal
import threading
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import get_context
from typing import TYPE_CHECKING, Final, Generic, Protocol, Self, TypeVar

import satAOI_geo
from satAOI_geo.errors import InputError, LimitError

if TYPE_CHECKING:
    from distributed import Client, Future

TaskT = TypeVar("TaskT")
AnswerT = TypeVar("AnswerT")

MAX_ATTEMPTS: Final = 3
"""After so many processes that died of a task it is given up; Dask has a limit of its own."""

INTERRUPT_S: Final = 0.3
"""An interrupt reaches all processes; a worker that died of it is not to be replaced."""

CONNECT_S: Final = 10
"""Longest wait for a scheduler, and then for its first worker."""

LOST_S: Final = 30
"""Where nothing gets done for so long it is asked whether there are still workers."""


@dataclass(frozen=True, slots=True)
class Outcome(Generic[AnswerT]):
    """What became of a task.

    Attributes:
        number: Of the task, from 0 in the order in which they were given.
        answer: What the function returned, or None.
        error: What it raised, or a `LimitError` when its workers died; None when all went well.
    """

    number: int
    answer: AnswerT | None
    error: Exception | None = None

    def value(self) -> AnswerT:
        """The answer; where there is none, its error is raised."""
        if self.error is not None:
            raise self.error
        return self.answer  # type: ignore[return-value]  # None may be what the function returns


class Workers(Protocol):
    """Those who do the work."""

    def outcomes(
        self, function: Callable[[TaskT], AnswerT], tasks: Iterable[TaskT]
    ) -> Generator[Outcome[AnswerT], None, None]:
        """What becomes of each task, in the order in which they are done."""


@contextmanager
def workers(*, n_workers: int | None = None, scheduler: str | None = None) -> Iterator[Workers]:
    """Workers for the time of a block.

    Args:
        n_workers: Processes on this machine, 1 or more; without it half as many as it has cores,
            since most work uses several.
        scheduler: Address of a Dask scheduler whose workers are to do it instead.

    Raises:
        InputError: If both are given, the scheduler has no workers, or they are of another
            version.
    """
    if scheduler is None:
        yield Processes(n_workers or max(1, (os.cpu_count() or 1) // 2))
        return
    if n_workers is not None:
        raise InputError("a --scheduler has workers of its own; leave --workers out")
    with _connected(scheduler) as client:
        yield Dask(client)


class Processes:
    """Processes of this machine, each with a thread here that keeps it busy.

    A pool of one process each, rather than one pool of many, so that when a process dies it is
    known of which task.

    Args:
        n_workers: How many.
    """

    def __init__(self, n_workers: int) -> None:
        self._n_workers = n_workers

    def outcomes(
        self, function: Callable[[TaskT], AnswerT], tasks: Iterable[TaskT]
    ) -> Generator[Outcome[AnswerT], None, None]:
        """As in `Workers`."""
        source = _Source(tasks)
        # None says that a thread has ended
        ready: queue.Queue[Outcome[AnswerT] | None] = queue.Queue(self._n_workers)

        def keep_busy() -> None:
            try:
                with _OneProcess(source.closed) as process:
                    while (numbered := source.next()) is not None:
                        ready.put(process.outcome(function, *numbered))
            finally:
                ready.put(None)

        with ThreadPoolExecutor(self._n_workers) as threads:
            lanes = [threads.submit(keep_busy) for _ in range(self._n_workers)]
            n_busy = len(lanes)
            try:
                while n_busy:
                    outcome = ready.get()
                    if outcome is None:
                        n_busy -= 1
                    else:
                        yield outcome
            finally:
                source.closed.set()
                # a thread may wait for room
                while n_busy:
                    n_busy -= ready.get() is None
        for lane in lanes:
            lane.result()


class _Source(Generic[TaskT]):
    """Tasks with their numbers, taken by several threads.

    Attributes:
        closed: Set when no more are to be taken.
    """

    def __init__(self, tasks: Iterable[TaskT]) -> None:
        self._numbered = enumerate(tasks)
        self._one_at_a_time = threading.Lock()
        self.closed = threading.Event()

    def next(self) -> tuple[int, TaskT] | None:
        """The next task, None after the last."""
        with self._one_at_a_time:
            return None if self.closed.is_set() else next(self._numbered, None)


class _OneProcess:
    """A process that is replaced when it dies.

    Args:
        closed: Set when it is not to be replaced any more.
    """

    def __init__(self, closed: threading.Event) -> None:
        self._closed = closed
        self._pool = self._started()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._pool.shutdown()

    def outcome(
        self, function: Callable[[TaskT], AnswerT], number: int, task: TaskT
    ) -> Outcome[AnswerT]:
        """Work on a task, in as many processes as it takes."""
        for _ in range(MAX_ATTEMPTS):
            try:
                return Outcome(number, self._pool.submit(function, task).result())
            except BrokenProcessPool:
                self._pool.shutdown()
                if self._closed.wait(INTERRUPT_S):
                    break
                self._pool = self._started()
            except Exception as error:  # noqa: BLE001  whatever the function raises is its outcome
                return Outcome(number, None, error)
        return Outcome(number, None, _died())

    def _started(self) -> ProcessPoolExecutor:
        # a copy of this process, made by fork, could hold locks of threads that it lacks
        context = get_context("spawn")
        return ProcessPoolExecutor(1, mp_context=context, initializer=_end_when_interrupted)


def _end_when_interrupted() -> None:
    """End a worker at an interrupt without a word: the process that started it has the say."""
    signal.signal(signal.SIGINT, lambda *_: os._exit(130))


class Dask:
    """The workers of a Dask scheduler.

    Args:
        client: Connected to it.
    """

    def __init__(self, client: "Client") -> None:
        self._client = client

    def outcomes(
        self, function: Callable[[TaskT], AnswerT], tasks: Iterable[TaskT]
    ) -> Generator[Outcome[AnswerT], None, None]:
        """As in `Workers`."""
        numbered = enumerate(tasks)
        numbers: dict[Future, int] = {}
        while True:
            # A worker may come or go. No task waits behind another one: where a worker dies, Dask
            # blames all tasks that it had.
            n_idle = max(1, sum(self._client.nthreads().values())) - len(numbers)
            for number, task in itertools.islice(numbered, max(0, n_idle)):
                numbers[self._client.submit(function, task, pure=False)] = number
            if not numbers:
                return
            for future in self._done(list(numbers)):
                yield _outcome_of(numbers.pop(future), future)

    def _done(self, futures: list["Future"]) -> list["Future"]:
        """Those that are done, as soon as one is.

        Raises:
            LimitError: If all workers are lost.
        """
        from distributed import wait

        while True:
            try:
                done, _ = wait(futures, timeout=LOST_S, return_when="FIRST_COMPLETED")
            except TimeoutError:
                if not self._client.nthreads():
                    raise _all_lost() from None
            else:
                return list(done)


def _outcome_of(number: int, future: "Future") -> Outcome[AnswerT]:
    from distributed import KilledWorker

    error = future.exception()
    if error is None:
        return Outcome(number, future.result())
    return Outcome(number, None, _died() if isinstance(error, KilledWorker) else error)


@contextmanager
def _connected(scheduler: str) -> Iterator["Client"]:
    """A client of a scheduler whose workers run this version of the program.

    Raises:
        InputError: If there is no such scheduler.
    """
    try:
        from distributed import Client
    except ImportError as error:
        raise InputError(
            "--scheduler needs Dask; install it with pip install 'satAOI-geo[cluster]'"
        ) from error
    try:
        client = Client(scheduler, timeout=CONNECT_S)
    except (OSError, ValueError) as error:
        raise InputError(
            f"no Dask scheduler answers at '{scheduler}'; give its address, for example "
            "tcp://192.168.1.20:8786"
        ) from error
    with client:
        _refuse_unfit_workers(client, scheduler)
        yield client


def _refuse_unfit_workers(client: "Client", scheduler: str) -> None:
    """Refuse workers that would give another answer, or none.

    Raises:
        InputError: If there is no worker, or one that lacks this version of the program.
    """
    try:
        # one that died of the last task may be on its way back
        client.wait_for_workers(1, timeout=CONNECT_S)
        versions = client.run(_version)
    except TimeoutError as error:
        raise InputError(
            f"the scheduler at '{scheduler}' has no workers; start some: dask worker {scheduler}"
        ) from error
    except ImportError as error:
        raise InputError(
            f"a worker of '{scheduler}' lacks satAOI-geo; install satAOI-geo[cluster] there"
        ) from error
    for worker, version in versions.items():
        if version != satAOI_geo.__version__:
            raise InputError(
                f"worker {worker} runs satAOI-geo {version}, this is {satAOI_geo.__version__}; "
                "install the same on all machines"
            )


def _version() -> str:
    """Version of the program where this runs."""
    return satAOI_geo.__version__


def _died() -> LimitError:
    return LimitError(
        "the processes that were given it died, one after the other; most often memory runs out: "
        "give a coarser --step or fewer --workers",
        limit="attempts",
        value=MAX_ATTEMPTS,
        allowed=MAX_ATTEMPTS,
    )


def _all_lost() -> LimitError:
    return LimitError(
        "the scheduler has lost all its workers; start some and run this again",
        limit="workers",
        value=0,
        allowed=1,
    )
