"""A floor cut into bands, in turn or by workers of which one dies: the same answer bit for bit."""

import json
import tempfile
from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from shapely.geometry import box

from satAOI_adapters.cluster import Workers, workers
from satAOI_geo.bands import BandTask, Explored, Outcome
from satAOI_geo.errors import InputError, LimitError
from satAOI_geo.pipeline import Result, area_of_interest
from satAOI_geo.plan import FloorPlan
from satAOI_geo.program import main
from satAOI_geo.route import RouteMap
from satAOI_geo.settings import Settings
from tests import cluster_jobs as jobs
from tests import plans
from tests.command_line import program

SETTINGS = Settings(step_mm=25.0, n_directions=12)

TINY_GB = 0.0002
"""Too little for the free space of any of these floors."""


def assert_same(one: Result, other: Result) -> None:
    """All figures, outlines and poses are equal to the last bit; the times differ."""
    figures = [asdict(replace(result.report, timing_s={})) for result in (one, other)]
    assert figures[0] == figures[1]
    assert np.array_equal(one.aoi.cells.words, other.aoi.cells.words)
    assert np.array_equal(one.search.free.words, other.search.free.words)
    for zone, same in zip(one.zones, other.zones, strict=True):
        for part, equal in zip(zone.outlines, same.outlines, strict=True):
            assert np.array_equal(part.exterior.vertices, equal.exterior.vertices)
    assert [patch.region for patch in one.patches] == [patch.region for patch in other.patches]


@pytest.mark.parametrize("seed", range(81, 85))
def test_a_floor_searched_with_little_memory_has_the_same_answer(seed: int) -> None:
    plan = plans.random_plan(seed)
    cut = area_of_interest(plan, settings=replace(SETTINGS, memory_gb=TINY_GB))
    assert len(cut.search.pose.bands) > 1
    assert_same(area_of_interest(plan, settings=SETTINGS), cut)


@dataclass(frozen=True)
class MortalCrew:
    """Workers one of whom dies at the first band he is given."""

    crew: Workers
    mark: Path

    def outcomes(
        self, function: Callable[[BandTask], Explored], tasks: Iterable[BandTask]
    ) -> Iterator[Outcome[Explored]]:
        yield from self.crew.outcomes(partial(jobs.dying_once, self.mark, function), tasks)


def test_workers_of_whom_one_dies_find_the_same_answer(tmp_path: Path) -> None:
    pytest.importorskip("distributed")
    plan = plans.random_plan(86)
    mark = tmp_path / "died"
    with workers(n_workers=2) as crew:
        found = area_of_interest(plan, settings=SETTINGS, crew=MortalCrew(crew, mark))
    assert mark.exists()
    assert len(found.search.pose.bands) > 1
    assert_same(area_of_interest(plan, settings=SETTINGS), found)


def test_routes_are_not_looked_for_in_bands() -> None:
    plan = plans.random_plan(81)
    cut = area_of_interest(plan, settings=replace(SETTINGS, memory_gb=TINY_GB))
    with pytest.raises(LimitError, match="--memory"):
        RouteMap(cut.search)


def test_memory_for_hardly_a_row_is_refused_with_what_would_do() -> None:
    floor = FloorPlan(box(0, 0, 3000, 8000))
    with pytest.raises(LimitError, match=r"into 320 bands, more than 200; give --memory") as caught:
        area_of_interest(floor, settings=replace(SETTINGS, step_mm=25.0, memory_gb=1e-9))
    enough_gb = float(str(caught.value).split("--memory ")[1].split()[0])
    area_of_interest(floor, settings=replace(SETTINGS, step_mm=25.0, memory_gb=enough_gb))


def test_no_room_for_what_bands_hold_is_told_with_the_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "none"))
    with pytest.raises(LimitError, match=r"none'.*TMPDIR"):
        area_of_interest(plans.random_plan(81), settings=replace(SETTINGS, memory_gb=TINY_GB))


def test_memory_without_end_is_one_band() -> None:
    plan = plans.random_plan(81)
    found = area_of_interest(plan, settings=replace(SETTINGS, memory_gb=float("inf")))
    assert len(found.search.pose.bands) == 1


def test_the_command_line_shares_a_search_out(tmp_path: Path) -> None:
    pytest.importorskip("distributed")
    sample = Path(__file__).parents[1] / "samples" / "two_rooms_760.dxf"
    figures = []
    for name, options in (
        ("alone", []),
        ("shared", ["--workers", "2"]),
        ("cut", ["--memory", "0.001"]),
    ):
        report = tmp_path / f"{name}.json"
        asked = [str(sample), "--step", "50", "--quiet", "--report", str(report), *options]
        if name == "shared":
            done = program(*asked)
            assert (done.returncode, done.stderr) == (0, "")
        else:
            assert main(asked) == 0
        figures.append({**json.loads(report.read_text(encoding="utf-8")), "timing_s": {}})
    assert figures[0] == figures[1] == figures[2]


@pytest.mark.parametrize("memory_gb", [0.0, -1.0, float("nan")])
def test_no_memory_is_refused(memory_gb: float) -> None:
    with pytest.raises(InputError, match="memory"):
        Settings(memory_gb=memory_gb)
