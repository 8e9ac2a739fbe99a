"""Settings of all tests.

Every run draws the same examples, however slow the machine; compiled kernels are kept where the
program keeps them, so that the tests that start it find them.
"""

from hypothesis import settings

from satAOI_adapters import kernel_cache

kernel_cache.prepare()

settings.register_profile("repeatable", derandomize=True, deadline=None)
settings.load_profile("repeatable")
