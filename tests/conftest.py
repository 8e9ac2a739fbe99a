"""Settings of all tests.

Every run draws the same examples, however slow the machine; kernels are compiled beforehand and
kept where the program keeps them, so that no run of it says that it compiles.
"""

from hypothesis import settings

from satAOI_adapters import kernel_cache

kernel_cache.prepare()
kernel_cache.compile_all()

settings.register_profile("repeatable", derandomize=True, deadline=None)
settings.load_profile("repeatable")
