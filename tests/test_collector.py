"""The collector of circular garbage at rest, at leisure, and as it was."""

import gc
import subprocess
import sys
from collections.abc import Callable
from contextlib import AbstractContextManager

import pytest

from satAOI_adapters.collector import collector_at_leisure, collector_at_rest


@pytest.mark.parametrize("block", [collector_at_rest, collector_at_leisure])
def test_after_an_error_the_collector_is_as_it_was(
    block: Callable[[], AbstractContextManager[None]],
) -> None:
    before = gc.isenabled(), gc.get_threshold()
    with pytest.raises(ZeroDivisionError), block():
        _ = 1 / 0
    assert (gc.isenabled(), gc.get_threshold()) == before


def test_at_leisure_it_looks_seldom() -> None:
    looks_after, *_ = gc.get_threshold()
    with collector_at_leisure():
        assert gc.get_threshold()[0] > 10 * looks_after


def test_leaving_at_once_loses_no_line_and_no_farewell() -> None:
    source = (
        "import atexit; from satAOI_adapters.collector import leave_at_once;"
        "atexit.register(print, 'farewell'); leave_at_once(); print('line')"
    )
    done = subprocess.run(
        [sys.executable, "-c", f"import sys; sys.path[:0] = {sys.path!r}; {source}"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.split() == ["line", "farewell"]
