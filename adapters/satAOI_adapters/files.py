"""Files that appear whole or not at all."""

import contextlib
import json
import os
import shutil
from collections.abc import Iterable, Iterator
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from satAOI_geo.errors import InputError

if TYPE_CHECKING:
    from _typeshed import DataclassInstance


@contextlib.contextmanager
def written_whole(path: Path, *, never_over: Iterable[Path] = ()) -> Iterator[BinaryIO]:
    """A stream whose bytes appear under a name at once, when the block ends without an error.

    The bytes go to a temporary file in the same folder, to the disk, and only then to the name:
    a reader sees the old file or the new one, and after an error the old one and nothing else.

    Args:
        path: The file to write; an ordinary file of that name is replaced.
        never_over: Files that were read and must survive; those that do not exist are no matter.

    Raises:
        InputError: If the name is that of an input, a link or a folder, its folder does not
            exist, or the file cannot be written.
    """
    refuse_unfit_target(path, never_over)
    # short, since a file's name may be as long as one can be
    temporary = path.with_name(f".{os.urandom(8).hex()}.tmp")
    try:
        with temporary.open("xb") as stream:
            yield stream
            stream.flush()
            os.fsync(stream.fileno())
        if path.exists():
            shutil.copymode(path, temporary)
        temporary.replace(path)
    except OSError as error:
        raise InputError(f"cannot write '{path}': {error.strerror or error}") from error
    finally:
        # gone already when all went well; and what went wrong is the error to tell
        with contextlib.suppress(OSError):
            temporary.unlink()


def refuse_unfit_target(path: Path, never_over: Iterable[Path] = ()) -> None:
    """Say early that a file must not be written.

    Raises:
        InputError: As in `written_whole`, except for what only shows when writing.
    """
    if path.is_symlink():
        raise InputError(f"'{path}' is a symbolic link; name the file itself")
    if path.exists() and not path.is_file():
        raise InputError(f"'{path}' is not an ordinary file; give another name")
    if not path.parent.is_dir():
        raise InputError(f"there is no folder '{path.parent}'; create it or give another name")
    if any(_same_file(path, read) for read in never_over):
        raise InputError(f"'{path}' is an input and is never written over; give another name")


def _same_file(one: Path, other: Path) -> bool:
    """Whether two names lead to one file that exists."""
    return one.exists() and other.exists() and one.samefile(other)


def json_of(figures: "DataclassInstance") -> str:
    r"""A dataclass as JSON, key by key: the same figures give the same text.

    Floats stand with all their digits, so that reading them back gives the same numbers. Bytes in
    a file's name that are no text are written as they are in Python, `\udc80` and so on.
    """
    text = json.dumps(asdict(figures), indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    return text.encode("utf-8", "backslashreplace").decode()
