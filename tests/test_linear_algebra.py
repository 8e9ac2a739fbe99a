"""Numpy starts no threads of its own where the command line loads it."""

import os
import subprocess
import sys

import pytest

from satAOI_adapters.linear_algebra import VARIABLE, without_threads
from tests.command_line import ROOT


@pytest.mark.skipif(sys.platform != "linux", reason="threads are counted in /proc, which Linux has")
def test_where_the_command_line_loads_numpy_it_has_the_threads_of_python_and_no_more() -> None:
    code = (
        "import os, sys, threading; sys.path[:0] = ['.', 'adapters']; "
        "from satAOI_geo.program import main; main(['robots']); import numpy; "
        "print(threading.active_count(), len(os.listdir('/proc/self/task')))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=ROOT,
        env={name: value for name, value in os.environ.items() if name != VARIABLE},
        capture_output=True,
        text=True,
        check=True,
    )
    n_of_python, n_of_the_process = done.stdout.splitlines()[-1].split()
    assert n_of_the_process == n_of_python


def test_a_number_of_threads_that_the_user_chose_is_left_alone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv(VARIABLE, "4")
    without_threads()
    assert os.environ[VARIABLE] == "4"
