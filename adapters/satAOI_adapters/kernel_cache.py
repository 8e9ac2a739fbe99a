"""Where compiled kernels are kept between runs: one folder a user and version of the program.

What Python compiles for dataclasses lies beside them, see `class_code`.
"""

import atexit
import os
import shutil
import sys
import tempfile
from importlib import import_module
from pathlib import Path

import satAOI_geo
from satAOI_adapters.terminal import say_note

VARIABLE = "NUMBA_CACHE_DIR"
"""Read by `satAOI_geo.kernels`; a value that the user set is left alone."""


def prepare() -> None:
    """Choose the folder; the program's own may belong to somebody else."""
    if not os.environ.get(VARIABLE):
        os.environ[VARIABLE] = str(_own_folder())


def place() -> Path | None:
    """Where they are kept, or would be; None where there is no place that lasts."""
    try:
        named = os.environ.get(VARIABLE)
        # an empty name would be that of the folder one happens to work in
        return Path(named) if named else _users_folder()
    except RuntimeError:
        return None


def compile_missing(*, quiet: bool) -> None:
    """Compile all kernels that are not in the folder, and say so first.

    Those of other commands, too: one that is left to be compiled would be said again each time.
    """
    # it imports the modules that have kernels
    import_module("satAOI_geo.pipeline")
    from satAOI_geo.kernels import KERNELS

    missing = [kernel for kernel in KERNELS if not kernel.is_kept()]
    if missing and not quiet:
        say_note("first run of this version: compiling takes some seconds, once")
    for kernel in missing:
        kernel.ready()


def _own_folder() -> Path:
    """The user's folder for these kernels; where there can be none, one for this run.

    A shared name in the folder for temporary files would let others slip their code in.
    """
    try:
        folder = _users_folder()
        folder.mkdir(parents=True, exist_ok=True)
        if os.access(folder, os.W_OK):
            return folder
    except (OSError, RuntimeError):
        # the user has no home, or it cannot be written to
        pass
    folder = Path(tempfile.mkdtemp(prefix="satAOI-geo-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


def _users_folder() -> Path:
    """The user's folder for these kernels.

    Raises:
        RuntimeError: If the user has no home.
    """
    return _user_caches() / "satAOI-geo" / f"kernels-{satAOI_geo.__version__}"


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
