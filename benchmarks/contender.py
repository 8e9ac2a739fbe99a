"""One contender of `benchmarks.compare` on one drawing, in a process of its own.

    python -m benchmarks.contender images DRAWING IMAGES.npz
    python -m benchmarks.contender NAME DRAWING IMAGES.npz

`images` writes what the others are given and held to. Their figures go to standard output as
JSON.
"""

import argparse
import json
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Final

import numpy as np

from benchmarks.clock import peak_mb
from benchmarks.in_full import (
    disc_connected,
    in_full,
    plain_raster,
    pose_connected,
    tuned_raster,
    whole_answer,
)
from benchmarks.kdtree_loop import KdTreeArrays, KdTreeLoop
from benchmarks.node_by_node import paper, reference
from benchmarks.question import ROBOT, Contender, Images, Question
from satAOI_adapters import read_plan
from satAOI_geo.lattice import Lattice

CONTENDERS: Final[dict[str, Contender]] = {
    "paper": paper(KdTreeLoop),
    "paper, arrays": paper(KdTreeArrays),
    "reference": reference,
    "raster": in_full(plain_raster),
    "raster, tuned": in_full(tuned_raster),
    "disc-connected": in_full(disc_connected),
    "pose-connected": in_full(pose_connected),
    "whole answer": in_full(whole_answer),
}


def main() -> None:
    """Run one contender."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("name", choices=["images", *CONTENDERS])
    parser.add_argument("drawing", type=Path)
    parser.add_argument("images", type=Path)
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--sample", type=int, default=300)
    asked = parser.parse_args()
    plan = read_plan(asked.drawing)
    lattice = Lattice.over(plan.floor.bounds, ROBOT)
    if asked.name == "images":
        np.savez_compressed(asked.images, **asdict(Images.of(plan, lattice)))
        return
    with np.load(asked.images) as stored:
        images = Images(**stored)
    before_mb = peak_mb()
    figures = CONTENDERS[asked.name](Question(plan, lattice, images, asked.runs, asked.sample))
    memory = {"peak_mb": peak_mb(), "before_mb": before_mb}
    sys.stdout.write(json.dumps(asdict(figures) | memory) + "\n")


if __name__ == "__main__":
    main()
