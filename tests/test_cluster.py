"""Work shared out: the same answers whoever does it, and whatever happens to them."""

import asyncio
import itertools
import logging
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

import satAOI_geo
from satAOI_adapters.cluster import Dask, InTurn, Workers, _refuse_unfit_workers, workers
from satAOI_geo.errors import InputError, LimitError
from tests import cluster_jobs as jobs
from tests.command_line import ROOT, START, the_error

dask = pytest.importorskip("dask")
distributed = pytest.importorskip("distributed")
psutil = pytest.importorskip("psutil")

IN_TURN = "in turn"
EVERYWHERE = [IN_TURN, "here", "scheduler"]
HALL = ROOT / "samples" / "hall_complex.dxf"


@contextmanager
def two_workers() -> Iterator[Dask]:
    """Workers of this machine; a task that kills two of them is given up."""
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 1}),
        workers(n_workers=2) as crew,
    ):
        yield crew


@contextmanager
def served() -> Iterator[tuple[str, subprocess.Popen[bytes]]]:
    """A scheduler with a worker, each in a process of its own, and its address."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{free.getsockname()[1]}"
    port = address.rpartition(":")[2]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    command = [sys.executable, "-m"]
    local = ["--host", "127.0.0.1", "--no-dashboard"]
    paths = os.pathsep.join(filter(None, sys.path))
    server = subprocess.Popen(
        [*command, "distributed.cli.dask_scheduler", *local, "--port", port], **quiet
    )
    worker = subprocess.Popen(
        [*command, "distributed.cli.dask_worker", address, *local, "--no-nanny"],
        env={**os.environ, "PYTHONPATH": paths},
        **quiet,
    )
    try:
        yield address, server
    finally:
        for process in (worker, server):
            process.kill()
            process.wait()


@pytest.fixture(scope="module")
def crew() -> Iterator[Dask]:
    with two_workers() as working:
        yield working


@pytest.fixture(scope="module")
def scheduler(crew: Dask) -> str:
    """Address of a scheduler, to which these workers are somebody else's."""
    return crew._client.scheduler.address


@pytest.fixture
def mortal_crew() -> Iterator[Dask]:
    """Workers that may die: Dask replaces them, but not always."""
    with two_workers() as working:
        yield working


@pytest.fixture(params=EVERYWHERE)
def anybody(request: pytest.FixtureRequest) -> Iterator[Workers]:
    if request.param == IN_TURN:
        with workers() as working:
            assert isinstance(working, InTurn)
            yield working
    elif request.param == "here":
        yield request.getfixturevalue("crew")
    else:
        with workers(scheduler=request.getfixturevalue("scheduler")) as working:
            yield working


def test_every_task_gets_its_answer(anybody: Workers) -> None:
    outcomes = list(anybody.outcomes(jobs.squared, range(20)))
    assert sorted(outcome.number for outcome in outcomes) == list(range(20))
    assert all(outcome.value() == outcome.number**2 for outcome in outcomes)


def test_no_tasks_have_no_outcomes(anybody: Workers) -> None:
    assert list(anybody.outcomes(jobs.squared, [])) == []


def test_what_the_function_raises_is_the_outcome(anybody: Workers) -> None:
    outcomes = list(anybody.outcomes(jobs.refused, [7, 8]))
    assert sorted(str(outcome.error) for outcome in outcomes) == ["7", "8"]
    with pytest.raises(ValueError, match="7"):
        min(outcomes, key=lambda outcome: outcome.number).value()


def test_tasks_are_taken_as_their_outcomes_are_fetched(anybody: Workers) -> None:
    taken: list[int] = []

    def tasks() -> Iterator[int]:
        for number in range(30):
            taken.append(number)
            yield number

    for n_fetched, _ in enumerate(anybody.outcomes(jobs.squared, tasks()), start=1):
        # two are worked on, two wait to be fetched
        assert len(taken) - n_fetched <= 4
    assert len(taken) == 30


def test_outcomes_may_be_left_unfetched(anybody: Workers) -> None:
    outcomes = anybody.outcomes(jobs.squared, itertools.count())
    next(outcomes)
    outcomes.close()


def test_a_task_of_many_bytes_is_a_task(crew: Dask) -> None:
    # Dask warns of 10 MB, and here a warning is an error
    (outcome,) = crew.outcomes(len, [bytes(20_000_000)])
    assert outcome.value() == 20_000_000


def test_a_worker_that_dies_changes_no_answer(mortal_crew: Dask, tmp_path: Path) -> None:
    tasks = [(tmp_path / ("mark" if n in {1, 2} else f"mark {n}"), n) for n in range(4)]
    (tmp_path / "mark 0").touch()
    (tmp_path / "mark 3").touch()
    outcomes = list(mortal_crew.outcomes(jobs.squared_the_second_time, tasks))
    assert {outcome.number: outcome.value() for outcome in outcomes} == {0: 0, 1: 1, 2: 4, 3: 9}


def test_a_task_that_kills_every_worker_is_given_up_and_the_others_are_not(
    mortal_crew: Dask,
) -> None:
    outcomes = list(mortal_crew.outcomes(jobs.deadly_if_one, range(4)))
    by_number = {outcome.number: outcome for outcome in outcomes}
    assert [by_number[n].value() for n in (0, 2, 3)] == [0, 4, 9]
    with pytest.raises(LimitError, match="died, one after the other"):
        by_number[1].value()


def test_the_loss_of_all_workers_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("satAOI_adapters.cluster.LOST_S", 1)
    with workers(n_workers=1) as working:
        outcomes = working.outcomes(jobs.squared, range(1000))
        assert next(outcomes).value() == 0
        working._client.cluster.scale(0)
        with pytest.raises(LimitError, match="workers are lost"):
            list(outcomes)


def test_a_scheduler_is_reached_where_a_loop_runs_as_in_a_notebook(scheduler: str) -> None:
    async def in_a_cell() -> list[int]:
        with workers(scheduler=scheduler) as crew:
            return [outcome.value() for outcome in crew.outcomes(jobs.squared, [3])]

    assert asyncio.run(in_a_cell()) == [9]


def test_dask_logs_again_as_it_did_once_its_scheduler_is_left(scheduler: str) -> None:
    before = logging.getLogger("distributed.client").level
    with workers(scheduler=scheduler):
        assert not logging.getLogger("distributed.client").isEnabledFor(logging.ERROR)
    assert logging.getLogger("distributed.client").level == before


def test_the_loss_of_the_scheduler_is_an_error() -> None:
    with served() as (address, server), workers(scheduler=address) as working:
        outcomes = working.outcomes(jobs.squared_later, range(3))
        assert next(outcomes).value() == 0
        server.kill()
        with pytest.raises(LimitError, match="or their scheduler is"):
            list(outcomes)


def test_nothing_can_be_reached_from_other_machines(crew: Dask) -> None:
    assert list(crew.outcomes(jobs.squared, [3]))
    own = psutil.Process()
    addresses = {
        socket.laddr.ip
        for process in (own, *own.children(recursive=True))
        for socket in process.net_connections()
        if socket.status == psutil.CONN_LISTEN
    }
    assert addresses == {"127.0.0.1"}


def children(program: subprocess.Popen[bytes]) -> list[psutil.Process]:
    return psutil.Process(program.pid).children(recursive=True)


def cpu_s(process: psutil.Process) -> float:
    """What a process has worked, 0 when it is gone."""
    try:
        return process.cpu_times().user
    except psutil.NoSuchProcess:
        return 0.0


@pytest.mark.skipif(sys.platform == "win32", reason="a terminal's interrupt is sent in its own way")
@pytest.mark.parametrize("busy_s", [0.0, 2.0], ids=["as they start", "as they work"])
def test_an_interrupt_is_one_line_and_leaves_no_process(busy_s: float) -> None:
    # at this step the workers have many times that to do
    asked = [str(HALL), "--step", "2", "--workers", "2"]
    program = subprocess.Popen(
        [sys.executable, "-c", START, f"{ROOT}|{ROOT / 'adapters'}", *asked],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        start_new_session=True,
    )
    while not any(cpu_s(process) >= busy_s for process in children(program)):
        assert program.poll() is None, "it ended before anybody interrupted it"
        time.sleep(0.05)
    others = children(program)
    # as a terminal does
    os.killpg(program.pid, signal.SIGINT)
    _, said = program.communicate(timeout=60)
    assert said.decode().strip() == "error: interrupted"
    assert program.returncode == 130
    _, alive = psutil.wait_procs(others, timeout=10)
    assert alive == []


def test_workers_need_dask(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from satAOI_geo.program import main

    monkeypatch.setitem(sys.modules, "distributed", None)
    for option in (["--workers", "2"], ["--scheduler", "tcp://127.0.0.1:1"]):
        assert main([str(HALL), *option]) == 2
        assert "pip install distributed" in the_error(capsys)


def test_workers_here_and_elsewhere_are_refused() -> None:
    with (
        pytest.raises(InputError, match="leave --workers out"),
        workers(n_workers=1, scheduler="tcp://127.0.0.1:1"),
    ):
        pass


def test_workers_that_do_not_start_are_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(**_: object) -> None:
        raise RuntimeError("no room")

    monkeypatch.setattr(distributed, "LocalCluster", refuse)
    with pytest.raises(InputError, match="do not start: no room"), workers(n_workers=1):
        pass


def test_a_scheduler_without_workers_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("satAOI_adapters.cluster.CONNECT_S", 1)
    with (
        distributed.LocalCluster(n_workers=0, dashboard_address="127.0.0.1:0") as cluster,
        pytest.raises(InputError, match="has no workers"),
        workers(scheduler=cluster.scheduler_address),
    ):
        pass


def test_a_worker_that_lacks_the_program_is_refused() -> None:
    class Client:
        def wait_for_workers(self, *_: object, **__: object) -> None: ...

        def run(self, *_: object, **__: object) -> dict[str, object]:
            # what a worker raises comes back in this form
            return {"tcp://1": Exception("ModuleNotFoundError"), "tcp://2": satAOI_geo.__version__}

    with pytest.raises(InputError, match="worker tcp://1 lacks satAOI-geo"):
        _refuse_unfit_workers(Client(), "tcp://x")


def test_workers_of_another_version_are_refused(
    scheduler: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("satAOI_geo.__version__", "99.0")
    with (
        pytest.raises(InputError, match=r"runs satAOI-geo .*, this is 99\.0"),
        workers(scheduler=scheduler),
    ):
        pass


def test_a_scheduler_that_does_not_answer_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("satAOI_adapters.cluster.CONNECT_S", 1)
    with socket.create_server(("127.0.0.1", 0)) as mute:
        listening = f"tcp://127.0.0.1:{mute.getsockname()[1]}"
        for address in ("tcp://127.0.0.1:1", "nonsense://x", "tls://127.0.0.1:1", listening):
            with (
                pytest.raises(InputError, match="no Dask scheduler answers"),
                workers(scheduler=address),
            ):
                pass
