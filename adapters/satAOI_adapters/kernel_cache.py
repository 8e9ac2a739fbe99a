"""Where compiled kernels are kept between runs: one folder a user and state of the program."""

import atexit
import contextlib
import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import satAOI_geo

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


def compile_beside() -> None:
    """Compile the kernels that come last in a process beside this one, which compiles the first.

    Numba compiles one kernel at a time in a process; what another one has compiled it loads.
    """
    command = [sys.executable, "-c", f"from {__name__} import compile_last; compile_last()"]
    silent = subprocess.DEVNULL
    own = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    with contextlib.suppress(OSError):
        # nobody waits for it: what it has not done in time is compiled here
        subprocess.Popen(  # noqa: S603  our own module, by our own interpreter
            command, stdin=silent, stdout=silent, stderr=silent, env=own
        )


def compile_last() -> None:
    """Compile the kernels of runs and of areas, on the smallest of them."""
    import numpy as np

    from satAOI_geo.discs import boundary, covered_cells
    from satAOI_geo.nodes import Nodes
    from satAOI_geo.runs import Meeting, Runs, paint, roots, rows_of, unite

    reached = Nodes.of(np.ones((3, 3), dtype=np.bool_))
    runs = Runs.joined([[rows_of(reached)]])
    parents = np.arange(3, dtype=np.int32)
    meeting = Meeting.upwards(runs, (0, 0))
    meeting.are_apart(parents, reached.words)
    unite(parents, meeting.links(reached.words))
    paint(reached.words, roots(parents), runs.begin, runs.end)
    boundary(reached, 1.5)
    covered_cells(reached, 1.5)
    runs.holding(1, 1)


def _own_folder() -> Path:
    """The user's folder for these kernels; where there can be none, one for this run.

    A shared name in the folder for temporary files would let others slip their code in.
    """
    try:
        caches = _user_caches() / "satAOI-geo"
        folder = caches / f"kernels-{satAOI_geo.__version__}-{_state_of_sources()}"
        if not folder.is_dir():
            folder.mkdir(parents=True, exist_ok=True)
            _drop_others_of_this_version(folder)
        if os.access(folder, os.W_OK):
            return folder
    except (OSError, RuntimeError):
        # the user has no home, or it cannot be written to
        pass
    folder = Path(tempfile.mkdtemp(prefix="satAOI-geo-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


def _state_of_sources() -> str:
    """A name for the sources of kernels; numba cannot read kernels whose types have changed."""
    sources = sorted(Path(satAOI_geo.__file__).parent.glob("*.py"))
    digest = hashlib.sha256()
    for text in (file.read_bytes() for file in sources):
        if b"import numba" in text or b"from numba" in text:
            digest.update(text)
    return digest.hexdigest()[:12]


def _drop_others_of_this_version(folder: Path) -> None:
    """Remove kernels of the same version compiled from sources that have changed since."""
    for other in folder.parent.glob(f"kernels-{satAOI_geo.__version__}-*"):
        if other != folder:
            shutil.rmtree(other, ignore_errors=True)


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
