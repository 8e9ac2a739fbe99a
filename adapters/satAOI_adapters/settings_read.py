"""Settings files in TOML: read whole, checked key by key, a fault told in one line.

Pydantic, which checks them, takes longer to load than a small drawing to read: it is imported
when somebody's own file comes up.
"""

import json
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from satAOI_geo.errors import InputError

if TYPE_CHECKING:
    from pydantic import BaseModel, ValidationError
    from pydantic_core import ErrorDetails

FileT = TypeVar("FileT", bound="BaseModel")


def read_settings(
    path: Path, model: type[FileT], *, what: str, complaint: Callable[[str, "ErrorDetails"], str]
) -> FileT:
    """The keys of a TOML file, as a model that forbids all others.

    Args:
        path: The file.
        model: Its keys and their types.
        what: What the file is, for messages.
        complaint: Says of a key and pydantic's fault with it what is wrong and what to do;
            unknown keys are told without it.

    Raises:
        InputError: If the file cannot be read, is not TOML, or does not fit the model.
    """
    from pydantic import ValidationError

    keys = keys_of(path, what=what)
    try:
        return model.model_validate(keys)
    except ValidationError as error:
        raise InputError(f"{what} '{path}': {_first_fault(error, model, complaint)}") from error


def keys_of(path: Path, *, what: str) -> dict[str, Any]:
    """The keys of a TOML file, unchecked; arguments as for `read_settings`.

    Raises:
        InputError: If the file cannot be read or is not TOML.
    """
    try:
        with path.open("rb") as stream:
            return tomllib.load(stream)
    except OSError as error:
        raise InputError(f"{what} '{path}': {error.strerror}") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise InputError(f"{what} '{path}' is not TOML: {error}") from error


def _first_fault(
    error: "ValidationError",
    model: "type[BaseModel]",
    complaint: Callable[[str, "ErrorDetails"], str],
) -> str:
    """One key at fault and what is wrong with it, in one line."""
    faults = error.errors(include_url=False)
    # a misspelt key is also a missing one; the misspelling says more
    fault = min(faults, key=lambda fault: fault["type"] != "extra_forbidden")
    # pydantic marks a faulty key of a table with a last step '[key]'
    key = ".".join(str(step) for step in fault["loc"] if step != "[key]")
    if fault["type"] == "extra_forbidden":
        return f"unknown key '{key}'; known are {', '.join(model.model_fields)}"
    return complaint(key, fault)


def toml_string(text: str) -> str:
    """A text as a TOML string that is read as the same text."""
    # a JSON string is a TOML string, but for the one control character that JSON lets pass
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
