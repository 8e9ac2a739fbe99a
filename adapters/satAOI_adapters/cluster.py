"""Work shared out: one function over many tasks, on workers of Dask here or on other machines.

    with workers(n_workers=4) as crew:
        for outcome in crew.outcomes(function, tasks):
            print(outcome.number, outcome.value())

Function, tasks and answers go from process to process, so they are pickled: the function by its
name in a module. Outcomes come in the order in which they are ready. Tasks are taken as workers
get free, so that memory is bounded. A task whose worker dies is given to another one, a few times
at most.
"""

import asyncio
import itertools
import logging
import signal
import sys
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import CancelledError, ThreadPoolExecutor
from contextlib import AbstractContextManager, ExitStack, contextmanager
from dataclasses import dataclass
from multiprocessing import resource_tracker
from typing import TYPE_CHECKING, Final, Generic, Protocol, TypeVar

import satAOI_geo
from satAOI_geo.errors import InputError, LimitError

if TYPE_CHECKING:
    from distributed import Client, Future, KilledWorker, LocalCluster

TaskT = TypeVar("TaskT")
AnswerT = TypeVar("AnswerT")

CONNECT_S: Final = 10
"""Longest wait for a scheduler, and then for its first worker."""

LOST_S: Final = 30
"""Where nothing gets done for so long it is asked whether there are still workers."""

END_S: Final = 1.0
"""Longest wait for workers whose answers nobody wants any more; then they are killed."""

CLIENT_CONFIG: Final[dict[str, object]] = {
    # A band is a task of many bytes. Dask warns of these and would have them scattered, but what
    # was scattered is lost with the worker that holds it.
    "distributed.admin.large-graph-warning-threshold": sys.maxsize,
}

LOCAL_CONFIG: Final[dict[str, object]] = {
    # what Dask puts here by itself, the number of threads of libraries, stays in this process's
    # environment; workers log from their first moment
    "distributed.nanny.pre-spawn-environ": {"DASK_LOGGING__DISTRIBUTED": "critical"},
    "distributed.scheduler.http.routes": [],
    "distributed.worker.http.routes": [],
}
"""Workers of this machine say nothing and show nothing."""


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
    """Workers for the time of a block; without arguments this process is the only one.

    Args:
        n_workers: Processes on this machine, 1 or more.
        scheduler: Address of a Dask scheduler whose workers are to do it instead.

    Raises:
        InputError: If both are given, Dask is not installed, workers cannot be started, or the
            scheduler has none, or of another version.
    """
    if n_workers is not None and scheduler is not None:
        raise InputError("a --scheduler has workers of its own; leave --workers out")
    if scheduler is not None:
        found = _connected(scheduler)
    elif n_workers is not None:
        found = _started(n_workers)
    else:
        yield InTurn()
        return
    with _dask_set(CLIENT_CONFIG), found as client:
        yield Dask(client)


def _dask_set(config: dict[str, object]) -> AbstractContextManager[object]:
    """Dask as it is wanted for the time of a block.

    Raises:
        InputError: If it is not installed.
    """
    try:
        import dask
        import distributed  # noqa: F401  brings its own part of the configuration
    except ImportError as error:
        raise InputError(
            "--workers and --scheduler need Dask; install it with: pip install distributed"
        ) from error
    config_set: AbstractContextManager[object] = dask.config.set(config)
    return config_set


class InTurn:
    """This process, which works on one task after the other."""

    def outcomes(
        self, function: Callable[[TaskT], AnswerT], tasks: Iterable[TaskT]
    ) -> Generator[Outcome[AnswerT], None, None]:
        """As in `Workers`."""
        for number, task in enumerate(tasks):
            try:
                outcome = Outcome(number, function(task))
            except Exception as error:  # noqa: BLE001  whatever the function raises is its outcome
                outcome = Outcome(number, None, error)
            yield outcome


class Dask:
    """The workers of a Dask scheduler, of this machine or of others.

    Args:
        client: Connected to it.
    """

    def __init__(self, client: "Client") -> None:
        self._client = client

    def outcomes(
        self, function: Callable[[TaskT], AnswerT], tasks: Iterable[TaskT]
    ) -> Generator[Outcome[AnswerT], None, None]:
        """As in `Workers`.

        Raises:
            LimitError: If all workers are lost, or the scheduler is.
        """
        try:
            yield from self._outcomes(function, tasks)
        except (CancelledError, OSError) as error:
            # what the function raises is an outcome; this is what becomes of a lost connection
            raise _all_lost() from error

    def _outcomes(
        self, function: Callable[[TaskT], AnswerT], tasks: Iterable[TaskT]
    ) -> Generator[Outcome[AnswerT], None, None]:
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
    return Outcome(number, None, _died(error) if isinstance(error, KilledWorker) else error)


@contextmanager
def _started(n_workers: int) -> Iterator["Client"]:
    """A client of a cluster on this machine, reached from this machine only.

    Raises:
        InputError: If it does not start.
    """
    from distributed import Client, LocalCluster

    with ExitStack() as stack:
        stack.enter_context(_dask_set(LOCAL_CONFIG))
        with _interrupts_blocked():
            try:
                cluster = stack.enter_context(
                    LocalCluster(
                        n_workers=n_workers,
                        threads_per_worker=1,
                        # a band may take what there is; --memory says how much that is
                        memory_limit=None,
                        silence_logs=logging.CRITICAL,
                        host="127.0.0.1",
                        dashboard_address=None,
                        # without an address this server, which shows nothing, takes a fixed port
                        scheduler_kwargs={"dashboard_address": "127.0.0.1:0"},
                    )
                )
            except (OSError, RuntimeError) as error:
                raise InputError(f"the workers do not start: {error}") from error
            client = stack.enter_context(Client(cluster))
        with _ended_at_once_by_errors(cluster):
            yield client


@contextmanager
def _interrupts_blocked() -> Iterator[None]:
    """Let threads and processes that begin in the block never hear of an interrupt.

    A terminal sends it to all processes; the one that was started there has the say.
    """
    if sys.platform == "win32":
        yield
        return
    # before its first process Python starts this one, and lets interrupts through again
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _ended_at_once_by_errors(cluster: "LocalCluster") -> Iterator[None]:
    """Wait for no task when the block ends with an error or an interrupt."""

    async def end() -> None:
        ends = [nanny.close(timeout=END_S) for nanny in cluster.workers.values()]
        # the error that ends the block is the one to tell
        await asyncio.gather(*ends, return_exceptions=True)

    try:
        yield
    except BaseException:
        cluster.sync(end)
        raise


@contextmanager
def _connected(scheduler: str) -> Iterator["Client"]:
    """A client of a scheduler whose workers run this version of the program.

    Raises:
        InputError: If there is no such scheduler.
    """
    from distributed import Client

    with _dask_silent():
        try:
            # in a thread of its own, since a notebook has a loop in this one
            with ThreadPoolExecutor(max_workers=1) as beside:
                beside.submit(asyncio.run, _shake_hands(scheduler)).result()
            client = Client(scheduler, timeout=CONNECT_S)
        except (OSError, ValueError, TypeError, ImportError) as error:
            raise InputError(
                f"no Dask scheduler answers at '{scheduler}'; give its address, for example "
                "tcp://192.168.1.20:8786"
            ) from error
        with client:
            _refuse_unfit_workers(client, scheduler)
            yield client


@contextmanager
def _dask_silent() -> Iterator[None]:
    """Let Dask log nothing: what is lost is told once, by the program."""
    # these have levels of their own
    loggers = [logging.getLogger(f"distributed{part}") for part in ("", ".client", ".core")]
    before = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        for logger, level in zip(loggers, before, strict=True):
            logger.setLevel(level)


async def _shake_hands(scheduler: str) -> None:
    """Connect once: a client would wait for ever for the hand of a server that is no scheduler.

    Raises:
        TimeoutError: If nothing answers as one.
    """
    from distributed import Security
    from distributed.comm import connect

    own = Security().get_connection_args("client")
    async with asyncio.timeout(CONNECT_S):
        comm = await connect(scheduler, timeout=CONNECT_S, **own)
        await comm.close()


def _refuse_unfit_workers(client: "Client", scheduler: str) -> None:
    """Refuse workers that would give another answer, or none.

    Raises:
        InputError: If there is no worker, or one that lacks this version of the program, or the
            scheduler is lost.
    """
    try:
        # one that died of the last task may be on its way back
        client.wait_for_workers(1, timeout=CONNECT_S)
        # what goes wrong there is returned
        versions = client.run(_version, on_error="return")
    except TimeoutError as error:
        raise InputError(
            f"the scheduler at '{scheduler}' has no workers; start some: dask worker {scheduler}"
        ) from error
    except (OSError, CancelledError) as error:
        raise InputError(f"the scheduler at '{scheduler}' is lost; start it again") from error
    for worker, version in versions.items():
        if not isinstance(version, str):
            raise InputError(f"worker {worker} lacks satAOI-geo; install satAOI-geo[cluster] there")
        if version != satAOI_geo.__version__:
            raise InputError(
                f"worker {worker} runs satAOI-geo {version}, this is {satAOI_geo.__version__}; "
                "install the same on all machines"
            )


def _version() -> str:
    """Version of the program where this runs."""
    return satAOI_geo.__version__


def _died(error: "KilledWorker") -> LimitError:
    return LimitError(
        "the processes that were given it died, one after the other; most often memory runs out: "
        "give a coarser --step or fewer --workers",
        limit="deaths",
        value=error.allowed_failures + 1,
        allowed=error.allowed_failures,
    )


def _all_lost() -> LimitError:
    return LimitError(
        "all workers are lost, or their scheduler is; run this again, with --scheduler after "
        "starting both",
        limit="workers",
        value=0,
        allowed=1,
    )
