"""Files kept from run to run, each with its digest: whole and unharmed, or not at all."""

import hashlib
import os
from contextlib import suppress
from typing import Final

_DIGEST_BYTES: Final = 32


def read(path: str) -> bytes | None:
    """What was kept; None where there is none, or it has come to harm."""
    try:
        with open(path, "rb") as file:
            digest, content = file.read(_DIGEST_BYTES), file.read()
    except OSError:
        return None
    return content if hashlib.sha256(content).digest() == digest else None


def write(path: str, content: bytes) -> None:
    """Keep something, if it can be written.

    Processes may do so at the same time; each writes a file of its own and renames it.
    """
    unfinished = f"{path}.{os.getpid()}"
    try:
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(unfinished, "wb") as file:
            file.write(hashlib.sha256(content).digest() + content)
        os.replace(unfinished, path)
    except OSError:
        with suppress(OSError):
            os.remove(unfinished)
