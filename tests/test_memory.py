"""What is free goes back to the system."""

import ctypes
import gc
import sys
from pathlib import Path

import pytest

from satAOI_geo.memory import give_back

STATUS = Path("/proc/self/status")


def has_trim() -> bool:
    """Whether the C library of this process is GNU's."""
    return STATUS.exists() and hasattr(ctypes.CDLL(None), "malloc_trim")


def own_mb() -> float:
    """Memory of this process that no file is behind."""
    (line,) = [line for line in STATUS.read_text().splitlines() if line.startswith("RssAnon")]
    return int(line.split()[1]) / 1024


@pytest.mark.skipif(
    sys.platform != "linux" or not has_trim(), reason="the C library has no malloc_trim"
)
def test_what_is_free_between_pieces_in_use_goes_back() -> None:
    blocks = [bytes(60_000) for _ in range(4_000)]
    in_use = blocks[::40]
    del blocks
    gc.collect()
    before_mb = own_mb()
    give_back()
    assert own_mb() < before_mb - 100
    assert sum(map(len, in_use)) == 6_000_000
