"""Work shared out: the same answers whoever does it, and whatever happens to them."""

import itertools
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from satAOI_adapters.cluster import Workers, workers
from satAOI_geo.errors import InputError, LimitError
from tests import cluster_jobs as jobs

WHERE = ["processes", "dask"]


@contextmanager
def dask_cluster(n_workers: int) -> Iterator[Any]:
    """A Dask scheduler with some workers on this machine, and what stops them."""
    distributed = pytest.importorskip("distributed")
    dask = pytest.importorskip("dask")
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 1}),
        distributed.LocalCluster(
            n_workers=n_workers, threads_per_worker=1, dashboard_address=":0", memory_limit=0
        ) as cluster,
    ):
        yield cluster


@pytest.fixture(scope="module")
def scheduler() -> Iterator[str]:
    with dask_cluster(n_workers=2) as cluster:
        yield cluster.scheduler_address


@pytest.fixture
def doomed_scheduler() -> Iterator[str]:
    """One whose workers may die: Dask replaces them, but not always."""
    with dask_cluster(n_workers=2) as cluster:
        yield cluster.scheduler_address


@contextmanager
def crew(
    where: str, request: pytest.FixtureRequest, scheduler: str = "scheduler"
) -> Iterator[Workers]:
    if where == "processes":
        with workers(n_workers=2) as working:
            yield working
    else:
        with workers(scheduler=request.getfixturevalue(scheduler)) as working:
            yield working


@pytest.mark.parametrize("where", WHERE)
def test_every_task_gets_its_answer(where: str, request: pytest.FixtureRequest) -> None:
    with crew(where, request) as working:
        outcomes = list(working.outcomes(jobs.squared, range(20)))
    assert sorted(outcome.number for outcome in outcomes) == list(range(20))
    assert all(outcome.value() == outcome.number**2 for outcome in outcomes)


@pytest.mark.parametrize("where", WHERE)
def test_no_tasks_have_no_outcomes(where: str, request: pytest.FixtureRequest) -> None:
    with crew(where, request) as working:
        assert list(working.outcomes(jobs.squared, [])) == []


@pytest.mark.parametrize("where", WHERE)
def test_what_the_function_raises_is_the_outcome(
    where: str, request: pytest.FixtureRequest
) -> None:
    with crew(where, request) as working:
        outcomes = list(working.outcomes(jobs.refused, [7, 8]))
    assert sorted(str(outcome.error) for outcome in outcomes) == ["7", "8"]
    with pytest.raises(ValueError, match="7"):
        min(outcomes, key=lambda outcome: outcome.number).value()


@pytest.mark.parametrize("where", WHERE)
def test_a_worker_that_dies_changes_no_answer(
    where: str, request: pytest.FixtureRequest, tmp_path: Path
) -> None:
    tasks = [(tmp_path / ("mark" if n in {1, 2} else f"mark {n}"), n) for n in range(4)]
    (tmp_path / "mark 0").touch()
    (tmp_path / "mark 3").touch()
    with crew(where, request, "doomed_scheduler") as working:
        outcomes = list(working.outcomes(jobs.squared_the_second_time, tasks))
    assert {outcome.number: outcome.value() for outcome in outcomes} == {0: 0, 1: 1, 2: 4, 3: 9}


@pytest.mark.parametrize("where", WHERE)
def test_a_task_that_kills_every_worker_is_given_up_and_the_others_are_not(
    where: str, request: pytest.FixtureRequest
) -> None:
    with crew(where, request, "doomed_scheduler") as working:
        outcomes = list(working.outcomes(jobs.deadly_if_one, range(4)))
    by_number = {outcome.number: outcome for outcome in outcomes}
    assert [by_number[n].value() for n in (0, 2, 3)] == [0, 4, 9]
    with pytest.raises(LimitError, match="died, one after the other"):
        by_number[1].value()


def test_the_loss_of_all_workers_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("satAOI_adapters.cluster.LOST_S", 1)
    with (
        dask_cluster(n_workers=1) as cluster,
        workers(scheduler=cluster.scheduler_address) as working,
    ):
        outcomes = working.outcomes(jobs.squared, range(1000))
        assert next(outcomes).value() == 0
        cluster.scale(0)
        with pytest.raises(LimitError, match="lost all its workers"):
            list(outcomes)


@pytest.mark.parametrize("where", WHERE)
def test_tasks_are_taken_as_their_outcomes_are_fetched(
    where: str, request: pytest.FixtureRequest
) -> None:
    taken: list[int] = []

    def tasks() -> Iterator[int]:
        for number in range(30):
            taken.append(number)
            yield number

    with crew(where, request) as working:
        outcomes = working.outcomes(jobs.squared, tasks())
        for n_fetched, _ in enumerate(outcomes, start=1):
            time.sleep(0.02)
            # two are worked on, two wait to be fetched, two workers wait for room
            assert len(taken) - n_fetched <= 6
    assert len(taken) == 30


@pytest.mark.parametrize("where", WHERE)
def test_outcomes_may_be_left_unfetched(where: str, request: pytest.FixtureRequest) -> None:
    with crew(where, request) as working:
        outcomes = working.outcomes(jobs.squared, itertools.count())
        next(outcomes)
        outcomes.close()


def test_workers_that_cannot_be_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    here_and_there = workers(n_workers=1, scheduler="tcp://127.0.0.1:1")
    with pytest.raises(InputError, match="leave --workers out"), here_and_there:
        pass
    monkeypatch.setitem(sys.modules, "distributed", None)
    with (
        pytest.raises(InputError, match=r"satAOI-geo\[cluster\]"),
        workers(scheduler="tcp://127.0.0.1:1"),
    ):
        pass


def test_a_scheduler_without_workers_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("satAOI_adapters.cluster.CONNECT_S", 1)
    with (
        dask_cluster(n_workers=0) as cluster,
        pytest.raises(InputError, match="has no workers"),
        workers(scheduler=cluster.scheduler_address),
    ):
        pass


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
    pytest.importorskip("distributed")
    monkeypatch.setattr("satAOI_adapters.cluster.CONNECT_S", 1)
    for address in ("tcp://127.0.0.1:1", "nonsense://x"):
        with (
            pytest.raises(InputError, match="no Dask scheduler answers"),
            workers(scheduler=address),
        ):
            pass
