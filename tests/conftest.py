"""Settings of all tests.

Every run draws the same examples, however slow the machine; kernels are compiled beforehand and
kept where the program keeps them, so that no run of it says that it compiles. A run that is
interrupted stops even where the tests were started in the background, which a shell lets no
interrupt reach.
"""

import signal

from hypothesis import settings

import satAOI_geo.pipeline  # noqa: F401  its modules have the kernels
from satAOI_adapters import kernel_cache
from satAOI_geo.kernels import KERNELS

signal.signal(signal.SIGINT, signal.default_int_handler)
kernel_cache.prepare()
for kernel in KERNELS:
    kernel.ready()

settings.register_profile("repeatable", derandomize=True, deadline=None)
settings.load_profile("repeatable")
