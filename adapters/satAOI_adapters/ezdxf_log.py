"""What ezdxf logs, kept as data and off the screen."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager


class _Ear(logging.Handler):
    """A handler that keeps what is said.

    Attributes:
        said: The messages, in order.
    """

    def __init__(self, level: int) -> None:
        super().__init__(level)
        self.said: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        """Keep a message."""
        self.said.append(record.getMessage())


@contextmanager
def heard() -> Iterator[list[str]]:
    """What ezdxf logs as a warning or worse while this lasts."""
    ear = _Ear(logging.WARNING)
    logger = logging.getLogger("ezdxf")
    propagates, logger.propagate = logger.propagate, False
    logger.addHandler(ear)
    try:
        yield ear.said
    finally:
        logger.removeHandler(ear)
        logger.propagate = propagates
