"""Where the robot is set down, and what is said where it cannot be."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapely.geometry import box

from satAOI_geo.errors import StartBlockedError
from satAOI_geo.lattice import Lattice
from satAOI_geo.nodes import Nodes
from satAOI_geo.pipeline import area_of_interest
from satAOI_geo.plan import FloorPlan, Frame, Kind, Obstacle
from satAOI_geo.robot import PROTOTYPE
from satAOI_geo.settings import Settings
from satAOI_geo.start import StartMark, _nearest_free_mm, _nearest_state


@given(
    seed=st.integers(0, 10**6),
    share=st.sampled_from([0.02, 0.3, 0.9]),
    # multiples of half a step make ties
    at=st.tuples(st.integers(-40, 260), st.integers(-40, 160)),
)
def test_no_free_node_is_nearer_than_the_nearest(
    seed: int, share: float, at: tuple[int, int]
) -> None:
    chosen = np.random.default_rng(seed).random((11, 90)) < share
    chosen[4, 77] = True
    lattice = Lattice((-50.0, 30.0), 10.0, *chosen.shape, 4, (0,))
    at_mm = (at[0] * 5.0, at[1] * 5.0)
    by_row_and_column = [
        (lattice.x_mm(ix), lattice.y_mm(iy)) for iy, ix in np.argwhere(chosen).tolist()
    ]
    nearest_mm = min(by_row_and_column, key=lambda node_mm: math.dist(node_mm, at_mm))
    assert _nearest_free_mm(Nodes.of(chosen), lattice, at_mm) == nearest_mm


@pytest.mark.parametrize("mm_per_unit", [1.0, 1000.0])
def test_the_start_that_is_named_instead_of_a_blocked_one_is_one(mm_per_unit: float) -> None:
    # a survey's coordinates: six digits would lie up to 5 km away
    frame = Frame(origin_mm=(3456789_012.0, 5432109_876.0), mm_per_unit=mm_per_unit)
    column = Obstacle(box(1000, 1000, 1400, 1400), Kind.COLUMN, "C", "1E")
    plan = FloorPlan(box(0, 0, 5000, 4000), (column,), frame=frame)
    settings = Settings(step_mm=25.0, n_directions=8)
    with pytest.raises(StartBlockedError) as caught:
        area_of_interest(plan, settings=settings, start=StartMark((1200.0, 1200.0)))
    named = re.search(r"--start (\S+),(\S+)$", str(caught.value))
    assert named is not None
    x_mm, y_mm = frame.to_local_mm([float(part) for part in named.groups()]).tolist()
    found = area_of_interest(plan, settings=settings, start=StartMark((x_mm, y_mm)))
    assert caught.value.nearest_mm is not None
    assert found.report.start.xy_mm == pytest.approx(caught.value.nearest_mm, abs=0.01)


@pytest.mark.parametrize(("asked_deg", "got_deg"), [(179, -180), (173, -180), (172, 165), (-2, 0)])
def test_the_pose_nearest_to_an_angle_is_sought_all_round(asked_deg: int, got_deg: int) -> None:
    robot = replace(PROTOTYPE, swing_min_rad=-math.pi, swing_max_rad=math.pi)
    lattice = Lattice.over((0, 0, 3000, 3000), robot)
    state = _nearest_state(lattice, (5, 5), (0.0, math.radians(asked_deg)))
    assert lattice.swings[state.swing] * 15 == got_deg
