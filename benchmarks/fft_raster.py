"""The raster of a practitioner: footprints slid over an image of occupied cells by FFT.

At each node the occupied cells under a footprint are counted by a convolution with the image. A
footprint covers the cells whose centres it holds. Capsules turn about the disc, vehicles about
their own middle; what is free for a vehicle is shifted from there to the disc by whole cells, and
the swings of one arm are OR-ed. So 24 + 12 footprints serve for 312 poses, but each shift is wrong
by up to half a cell.
"""

import math
from typing import Final, Protocol, TypeAlias

import numpy as np
import numpy.typing as npt
import scipy.fft
import scipy.signal

from benchmarks.cells import in_capsule, in_vehicle
from satAOI_geo.lattice import Lattice
from satAOI_geo.plan import BoolArray, FloatArray
from satAOI_geo.robot import Robot

N_WORKERS: Final = 2
"""Threads of a transform."""

HALF_A_CELL: Final = 0.5
"""Counts are whole numbers but for the rounding of the transforms."""

Image: TypeAlias = npt.NDArray[np.float32]


class Slider(Protocol):
    """Slides footprints over an image."""

    def hits(self, footprint: BoolArray) -> BoolArray:
        """Cells, shape of the image, at which the footprint covers some set cell.

        The footprint is square, its middle the cell that it stands on.
        """

    def hits_both_ways(self, footprint: BoolArray) -> tuple[BoolArray, BoolArray]:
        """The same for the footprint and for its copy turned by 180°."""


class PlainSlider:
    """Two lines of scipy for each footprint.

    Args:
        image: Set cells.
        beyond: Whether the cells beyond the image's edge are set.
    """

    def __init__(self, image: BoolArray, *, beyond: bool) -> None:
        self._image, self._beyond = image.astype(np.float32), beyond

    def hits(self, footprint: BoolArray) -> BoolArray:
        """As in `Slider`."""
        rimmed = np.pad(self._image, footprint.shape[0] // 2, constant_values=self._beyond)
        mirrored = footprint[::-1, ::-1].astype(np.float32)
        with scipy.fft.set_workers(N_WORKERS):
            counts = scipy.signal.fftconvolve(rimmed, mirrored, mode="valid")
        found: BoolArray = counts > HALF_A_CELL
        return found

    def hits_both_ways(self, footprint: BoolArray) -> tuple[BoolArray, BoolArray]:
        """As in `Slider`."""
        return self.hits(footprint), self.hits(footprint[::-1, ::-1])


class TunedSlider:
    """The same with as few and as small transforms as the question allows.

    The image is transformed once. It lies on a torus, where one rim serves for both sides. A
    footprint turned by 180° has the conjugate transform.

    Args:
        image: Set cells.
        beyond: Whether the cells beyond the image's edge are set.
        rim: Cells that a footprint reaches from its middle, at most.
    """

    def __init__(self, image: BoolArray, *, beyond: bool, rim: int) -> None:
        self._shape = image.shape
        self._torus = [scipy.fft.next_fast_len(n + rim, real=True) for n in image.shape]
        on_torus: Image = np.full(self._torus, beyond, dtype=np.float32)
        on_torus[: image.shape[0], : image.shape[1]] = image
        self._image = scipy.fft.rfft2(on_torus, workers=N_WORKERS)

    def hits(self, footprint: BoolArray) -> BoolArray:
        """As in `Slider`."""
        return self._found(self._transform(footprint).conj())

    def hits_both_ways(self, footprint: BoolArray) -> tuple[BoolArray, BoolArray]:
        """As in `Slider`."""
        transform = self._transform(footprint)
        return self._found(transform.conj()), self._found(transform)

    def _transform(self, footprint: BoolArray) -> npt.NDArray[np.complex64]:
        """The footprint's transform, its middle at the torus's origin."""
        rim = footprint.shape[0] // 2
        around = np.arange(-rim, rim + 1)
        on_torus: Image = np.zeros(self._torus, dtype=np.float32)
        on_torus[np.ix_(around, around)] = footprint
        transform: npt.NDArray[np.complex64] = scipy.fft.rfft2(on_torus, workers=N_WORKERS)
        return transform

    def _found(self, factor: npt.NDArray[np.complex64]) -> BoolArray:
        factor *= self._image
        counts = scipy.fft.irfft2(factor, s=self._torus, workers=N_WORKERS, overwrite_x=True)
        n_rows, n_columns = self._shape
        found: BoolArray = counts[:n_rows, :n_columns] > HALF_A_CELL
        return found


def free_nodes(occupied: Slider, lattice: Lattice, robot: Robot) -> BoolArray:
    """Nodes at which some pose is free, shape (n_rows, n_columns)."""
    directions, off_mm = lattice.directions(), offsets_mm(robot, lattice)
    n_half = lattice.n_directions // 2
    half = directions[:n_half]
    ways = [occupied.hits_both_ways(in_capsule(off_mm, arm, robot)) for arm in half]
    capsules = [~hits for hits in (*(way[0] for way in ways), *(way[1] for way in ways))]
    # a rectangle looks the same from behind
    vehicles = [~occupied.hits(in_vehicle(off_mm, heading, robot)) for heading in half]
    free = np.zeros(lattice.shape, dtype=np.bool_)
    for a1, arm in enumerate(directions):
        stands = np.zeros_like(free)
        for turn in lattice.swings:
            yaw = (a1 + turn) % lattice.n_directions
            middle_mm = robot.arm_length_mm * arm + robot.pivot_offset_mm * directions[yaw]
            add_shifted(stands, vehicles[yaw % n_half], middle_mm / lattice.step_mm)
        stands &= capsules[a1]
        free |= stands
    return free


def troweled_cells(reached: Slider, lattice: Lattice, robot: Robot) -> BoolArray:
    """Cells that the disc covers from some reached node, shape (n_rows, n_columns)."""
    distances_mm = np.hypot(*np.moveaxis(offsets_mm(robot, lattice), -1, 0))
    return reached.hits(distances_mm <= robot.disc_radius_mm)


def offsets_mm(robot: Robot, lattice: Lattice) -> FloatArray:
    """Offsets of the cells around a cell, shape (n, n, 2), enough for arm and vehicle each."""
    rim = rim_of_footprints(robot, lattice)
    along_mm = np.arange(-rim, rim + 1) * lattice.step_mm
    return np.stack(np.meshgrid(along_mm, along_mm), axis=-1)


def rim_of_footprints(robot: Robot, lattice: Lattice) -> int:
    """Cells that arm and vehicle, each about its own middle, reach at most."""
    half_diagonal_mm = math.hypot(robot.vehicle_length_mm, robot.vehicle_width_mm) / 2
    return math.ceil(max(robot.arm_length_mm, half_diagonal_mm) / lattice.step_mm)


def add_shifted(cells: BoolArray, others: BoolArray, shift: FloatArray) -> None:
    """Set the cells from which a shift in cells, (x, y), rounded to whole ones, leads to others."""
    n_rows, n_columns = cells.shape
    dx, dy = np.rint(shift).astype(int).tolist()
    to = np.s_[max(0, -dy) : n_rows - max(0, dy), max(0, -dx) : n_columns - max(0, dx)]
    origin = np.s_[max(0, dy) : n_rows + min(0, dy), max(0, dx) : n_columns + min(0, dx)]
    cells[to] |= others[origin]
