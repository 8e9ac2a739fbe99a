"""The collector of circular garbage at rest, seldom at work, and as it was."""

import gc
import subprocess
import sys

import pytest

from satAOI_adapters.collector import collector_at_rest


def test_after_an_error_the_collector_is_as_it_was() -> None:
    before = gc.isenabled()
    with pytest.raises(ZeroDivisionError), collector_at_rest():
        _ = 1 / 0
    assert gc.isenabled() == before


def test_a_hundred_thousand_objects_that_stay_are_never_looked_through() -> None:
    # in a process of its own, as there is no way back
    code = (
        f"import gc, sys; sys.path[:0] = {sys.path!r};"
        "from satAOI_adapters.collector import look_seldom\n"
        "looks = []; gc.callbacks.append(lambda when, _: looks.append(when))\n"
        "def looks_while_made(): looks.clear(); [[] for _ in range(100_000)]; return len(looks)\n"
        "busy = looks_while_made(); look_seldom(); print(busy > 0, looks_while_made())"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["True", "0"]


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
