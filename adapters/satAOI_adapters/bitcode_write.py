"""Write the bitcode of all kernels, which comes with the program.

    python -m satAOI_adapters.bitcode_write

That is to be done when a kernel has changed; a test tells. LLVM reads what an earlier LLVM wrote,
so use the oldest releases of numba and llvmlite that `pyproject.toml` allows.
"""

import os
from importlib import import_module
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

SETTINGS = {"NUMBA_OPT": "0", "NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""}
"""For numba: leave it to LLVM to make code faster, and know nothing of this processor."""


def write() -> None:
    """Write the archive anew; the same kernels give the same bytes."""
    # numba reads these once, when it is loaded
    os.environ.update(SETTINGS)
    import_module("satAOI_geo.pipeline")
    from satAOI_geo.bitcode import ARCHIVE
    from satAOI_geo.kernels import KERNELS

    found = {kernel.bitcode_name: kernel.made_by_numba().bitcode for kernel in KERNELS}
    with ZipFile(ARCHIVE, "w") as archive:
        for name, bitcode in sorted(found.items()):
            archive.writestr(ZipInfo(name), bitcode, ZIP_DEFLATED, 9)


if __name__ == "__main__":
    write()
