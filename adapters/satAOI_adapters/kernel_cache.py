"""Where compiled kernels are kept between runs: one folder a user and version."""

import atexit
import os
import shutil
import sys
import tempfile
from pathlib import Path

from satAOI_geo import __version__

VARIABLE = "NUMBA_CACHE_DIR"
"""Read by numba when it is imported; a value that the user set is left alone."""


def prepare() -> bool:
    """Choose the folder, before numba is imported; whether kernels are in it already.

    The program's own folder may belong to somebody else, and numba refuses to start when it
    finds no place to write to.
    """
    if VARIABLE not in os.environ:
        os.environ[VARIABLE] = str(_own_folder())
    # numba names its index files after the function and the Python they are for
    python = f"py{sys.version_info.major}{sys.version_info.minor}"
    indices = Path(os.environ[VARIABLE]).rglob("*.nbi")
    return any(python in index.name for index in indices)


def _own_folder() -> Path:
    """The user's folder for kernels of this version; where there can be none, one for this run.

    A shared name in the folder for temporary files would let others slip their code in.
    """
    try:
        folder = _user_caches() / "satAOI-geo" / f"kernels-{__version__}"
        folder.mkdir(parents=True, exist_ok=True)
        if os.access(folder, os.W_OK):
            return folder
    except (OSError, RuntimeError):
        # the user has no home, or it cannot be written to
        pass
    folder = Path(tempfile.mkdtemp(prefix="satAOI-geo-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


def _user_caches() -> Path:
    """The user's folder for files that can be made again.

    Raises:
        RuntimeError: If the user has no home.
    """
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
