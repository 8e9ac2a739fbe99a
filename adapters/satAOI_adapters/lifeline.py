"""A process that ends with the one that started it, whatever became of that.

A run of a batch loads this before all else, so it loads little itself.
"""

import contextlib
import os
import signal
import sys
import threading
from collections.abc import Iterator


@contextlib.contextmanager
def tied() -> Iterator[int]:
    """An input for another process that holds nothing and ends when this process does."""
    read_end, write_end = os.pipe()
    try:
        yield read_end
    finally:
        os.close(read_end)
        os.close(write_end)


def end_with_the_caller() -> None:
    """In a run: interrupt it when the process that started it is gone, whatever became of that.

    Another worker may have been given the same plan since.
    """

    def wait() -> None:
        os.read(sys.stdin.fileno(), 1)
        os.kill(os.getpid(), signal.SIGINT)

    if sys.platform != "win32":
        # workers are deaf to interrupts, and so is what they start
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    # a shell that starts something in the background has it ignore interrupts
    signal.signal(signal.SIGINT, signal.default_int_handler)
    threading.Thread(target=wait, daemon=True).start()
