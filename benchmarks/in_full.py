"""Contenders that try all nodes: this project and the rasters."""

from collections import deque
from collections.abc import Callable

from benchmarks.clock import timed
from benchmarks.fft_raster import (
    PlainSlider,
    TunedSlider,
    free_nodes,
    rim_of_footprints,
    troweled_cells,
)
from benchmarks.question import ROBOT, Contender, Figures, Question, largest_set
from satAOI_geo.aoi import area
from satAOI_geo.freespace import free_space
from satAOI_geo.intervals import Intervals
from satAOI_geo.nodes import Nodes
from satAOI_geo.pipeline import area_of_interest
from satAOI_geo.plan import BoolArray
from satAOI_geo.progress import Stopwatch
from satAOI_geo.search import search
from satAOI_geo.settings import DEFAULTS


def in_full(job: Callable[[Question], BoolArray]) -> Contender:
    """A contender that tries all nodes; the job returns the free ones."""

    def contender(question: Question) -> Figures:
        last: deque[BoolArray] = deque(maxlen=1)
        times = timed(lambda: last.append(job(question)), question.n_runs)
        found, free = last.pop(), question.images.free
        return Figures(
            clock_s=times.clock_s,
            error_s=0.0,
            cores_s=times.cores_s,
            n_nodes=free.size,
            n_wrongly_free=int((found & ~free).sum()),
            n_wrongly_blocked=int((free & ~found).sum()),
        )

    return contender


def disc_connected(question: Question) -> BoolArray:
    """This project, by the paper's rule: free space, connected sets, area with its outline."""
    lattice = question.lattice
    free = free_space(Intervals.of(question.plan, ROBOT, lattice), ROBOT, lattice).free_nodes()
    area(largest_set(free), lattice, ROBOT.disc_radius_mm)
    return free.as_array()


def pose_connected(question: Question) -> BoolArray:
    """This project: what motions join with the start, too."""
    found = search(question.plan, ROBOT, DEFAULTS, start=None, watch=Stopwatch())
    area(found.pose.nodes(found.start.pose_label), found.lattice, ROBOT.disc_radius_mm)
    return found.free.as_array()


def whole_answer(question: Question) -> BoolArray:
    """This project: zones, set-downs, reasons and the report, too."""
    return area_of_interest(question.plan, ROBOT).search.free.as_array()


def plain_raster(question: Question) -> BoolArray:
    """The raster as one writes it."""
    occupied = PlainSlider(question.images.occupied, beyond=True)
    free = free_nodes(occupied, question.lattice, ROBOT)
    reached = PlainSlider(largest_set(Nodes.of(free)).as_array(), beyond=False)
    troweled_cells(reached, question.lattice, ROBOT)
    return free


def tuned_raster(question: Question) -> BoolArray:
    """The raster with as few and as small transforms as possible."""
    rim = rim_of_footprints(ROBOT, question.lattice)
    occupied = TunedSlider(question.images.occupied, beyond=True, rim=rim)
    free = free_nodes(occupied, question.lattice, ROBOT)
    reached = TunedSlider(largest_set(Nodes.of(free)).as_array(), beyond=False, rim=rim)
    troweled_cells(reached, question.lattice, ROBOT)
    return free
