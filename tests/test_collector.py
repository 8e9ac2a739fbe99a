"""The collector of circular garbage at rest, seldom at work, and as it was."""

import gc
import subprocess
import sys

import pytest

from satAOI_adapters.collector import collector_at_rest
from tests.command_line import ROOT


def test_after_an_error_the_collector_is_as_it_was() -> None:
    before = gc.isenabled()
    with pytest.raises(ZeroDivisionError), collector_at_rest():
        _ = 1 / 0
    assert gc.isenabled() == before


def test_a_command_ends_before_circular_garbage_was_looked_for() -> None:
    # one that needs no kernels: to compile them makes garbage
    code = (
        "import gc, sys; sys.path[:0] = ['.', 'adapters']; from satAOI_geo.cli import main; "
        "looks = []; gc.callbacks.append(lambda *look: looks.append(look)); "
        "assert not main(['robots']); print(len(looks))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert done.stdout.splitlines()[-1] == "0"


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
