"""Runs the geometry in a process of its own, with limits of time and memory.

An element that ends that process is named, and the rest is read again without it.
"""

import contextlib
import os
import queue
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import IO, Final, TypeVar

from satAOI_adapters.ifc_read.records import ANSWER, Begun, Failed, Inspected, Read, Request
from satAOI_geo import errors
from satAOI_geo.errors import DrawingError, LimitError, SatAoiError, UnreadableError
from satAOI_geo.progress import Progress

AnswerT = TypeVar("AnswerT", Inspected, Read)

WORKER: Final = "satAOI_adapters.ifc_read.worker"

OPENING_S: Final = 30.0
"""Longest silence before the first element, for loading the libraries; and then some."""

OPENING_S_PER_MB: Final = 0.5
"""Longer silence allowed for each megabyte to be opened, ten times what it takes."""

ELEMENT_S: Final = 15.0
"""Longest silence after an element was begun; the slowest one seen took two."""

MAX_RESTARTS: Final = 5
"""After so many elements that ended the process the model is given up."""


def answered(
    request: Request,
    expected: type[AnswerT],
    *,
    timeout_s: float,
    progress: Progress | None = None,
) -> AnswerT:
    """The answer to a request.

    Args:
        request: What to read.
        expected: Sort of answer to such a request.
        timeout_s: Longest time for all of it.
        progress: Told how far it is.

    Raises:
        SatAoiError: Whatever error of the program's own the process met.
        UnreadableError: If the model ends the process again and again.
        LimitError: If it takes longer than allowed.
    """
    deadline_s = time.monotonic() + timeout_s
    ended_by: list[str] = []
    for _ in range(MAX_RESTARTS):
        outcome = _one_run(request, deadline_s, progress)
        if isinstance(outcome, expected):
            return outcome
        if not isinstance(outcome, _Ended):
            raise TypeError(f"'{outcome.type}' is no answer to this request")
        if not outcome.handle:
            raise UnreadableError(
                f"'{request.path}' ends the process that opens it ({outcome.how}); repair the "
                "model and export it again"
            )
        ended_by.append(f"{outcome.layer} {outcome.handle}")
        request = request.model_copy(update={"skip": request.skip | {outcome.handle}})
    raise UnreadableError(
        f"'{request.path}': the geometry of {', '.join(ended_by)} each ended the process that "
        "reads it; repair the model and export it again"
    )


class _Ended:
    """The process ended without an answer.

    Args:
        how: In words.
        last: The element it had begun, or None.
    """

    def __init__(self, how: str, last: Begun | None) -> None:
        self.how = how
        self.handle = "" if last is None else last.handle
        self.layer = "" if last is None else last.layer


def _one_run(
    request: Request, deadline_s: float, progress: Progress | None
) -> Inspected | Read | _Ended:
    last: Begun | None = None
    silence_s = OPENING_S + OPENING_S_PER_MB * request.file_mb
    with tempfile.TemporaryFile() as said, _started(request, said) as (process, lines):
        while True:
            left_s = deadline_s - time.monotonic()
            try:
                line = lines.get(timeout=max(0.0, min(left_s, silence_s)))
            except queue.Empty:
                if left_s <= silence_s:
                    raise LimitError(
                        f"reading '{request.path}' took longer than allowed; raise the limit of "
                        "time, or export the storey alone",
                        limit="seconds",
                        value=silence_s,
                        allowed=left_s,
                    ) from None
                return _Ended(f"no answer within {silence_s:.0f} s", last)
            if line is None:
                return _Ended(_how_it_ended(process, said), last)
            answer = ANSWER.validate_json(line)
            if isinstance(answer, Begun):
                last, silence_s = answer, ELEMENT_S
                if progress is not None:
                    progress("reading", answer.share)
            elif isinstance(answer, Failed):
                raise as_error(answer)
            else:
                return answer


@contextmanager
def _started(
    request: Request, said: IO[bytes]
) -> Iterator[tuple["subprocess.Popen[str]", "queue.Queue[str | None]"]]:
    """The process with the request sent, and its lines as they come, None at the end."""
    process = subprocess.Popen(  # noqa: S603 - our own module, by our own interpreter
        [sys.executable, "-m", WORKER],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=said,
        text=True,
        encoding="utf-8",
        env=_environment(),
    )
    lines: queue.Queue[str | None] = queue.Queue()
    reader = threading.Thread(target=_converse, args=(process, request, lines))
    reader.start()
    try:
        yield process, lines
    finally:
        process.kill()
        process.wait()
        reader.join()


def _converse(
    process: "subprocess.Popen[str]", request: Request, lines: "queue.Queue[str | None]"
) -> None:
    """Send the request, then pass on what comes back until the process ends."""
    if process.stdin is not None and process.stdout is not None:
        # the process may end before it has read all of the request
        with contextlib.suppress(BrokenPipeError), process.stdin as stdin:
            stdin.write(request.model_dump_json() + "\n")
        with process.stdout as stdout:
            for line in stdout:
                lines.put(line)
    lines.put(None)


def _environment() -> dict[str, str]:
    """Ours, so that the process finds the same packages; with one thread for algebra."""
    # a thread of OpenBLAS reserves 40 MB of the address space that is limited
    return {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "OPENBLAS_NUM_THREADS": "1"}


def _how_it_ended(process: "subprocess.Popen[str]", said: IO[bytes]) -> str:
    code = process.wait()
    if code < 0:
        return f"signal {-code}"
    said.seek(0)
    words = said.read().decode("utf-8", "replace").strip().splitlines()
    return words[-1] if words else f"exit code {code}"


def as_error(failed: Failed) -> SatAoiError:
    """The exception that the process met."""
    kind = getattr(errors, failed.error)
    if issubclass(kind, DrawingError):
        error: SatAoiError = kind(failed.message, layer=failed.layer, handle=failed.handle)
    else:
        error = kind(failed.message)
    return error
