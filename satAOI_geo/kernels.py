"""Kernels: loops over arrays, written in Python and run as machine code.

    @kernel("int64(const uint64[:, :], const int64[:], int32[:, :])")
    def _links(allowed, first, found): ...

The string gives the types as C would: first of what is returned, then of each parameter, with a
colon for each axis of an array, and `const` where it is only read. Arrays are in the order of C.
A kernel allocates nothing and raises nothing; it is given room for its results, and what it calls
is a `helper`.

A kernel is compiled where it is first called on a machine. Its machine code is kept, and later
runs load that instead of a compiler, see `machine_code`: in the folder that the environment's
`NUMBA_CACHE_DIR` names, else beside Python's own compiled code of this module.
"""

import hashlib
import os
import re
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import cached_property, update_wrapper
from importlib.util import cache_from_source
from threading import Lock
from types import CodeType, FunctionType, ModuleType
from typing import Any, Final, Generic, ParamSpec, TypeVar

import numpy as np
import numpy.typing as npt

from satAOI_geo.machine_code import (
    OPTIONS,
    Function,
    Parameter,
    Signature,
    compiled,
    loaded,
    machine,
)

P = ParamSpec("P")
R = TypeVar("R")
FunctionT = TypeVar("FunctionT", bound=Function)
ScalarT = TypeVar("ScalarT", bound=np.generic)

VARIABLE: Final = "NUMBA_CACHE_DIR"
"""Numba's own: where it would keep what it compiles."""

HELPERS: Final[list[Function]] = []
"""All functions for kernels to call, of the modules imported so far."""

KERNELS: Final[list["Kernel[..., Any]"]] = []
"""All kernels of these."""

N_KEPT: Final = 5
"""For so many states of a kernel's source, since several copies of the program may be in use."""

_DIGEST_BYTES: Final = 32

_one_at_a_time = Lock()
"""Threads that need a kernel at the same time make it ready once."""


def helper(function: FunctionT) -> FunctionT:
    """A function that kernels may call."""
    HELPERS.append(function)
    return function


def kernel(signature: str) -> Callable[[Callable[P, R]], "Kernel[P, R]"]:
    """A function of the types that the signature gives, to be run as machine code."""

    def of(function: Callable[P, R]) -> "Kernel[P, R]":
        made = Kernel(function, _parsed(signature))
        KERNELS.append(made)
        return made

    return of


def filled(
    fill: Callable[[npt.NDArray[ScalarT]], int], room: npt.NDArray[ScalarT]
) -> npt.NDArray[ScalarT]:
    """The rows that a kernel writes to an array, where only the kernel knows how many there are.

    Args:
        fill: Writes as many as there is room for, and returns how many there are.
        room: Shape (m, n); where that is too little, all is done once more with enough.
    """
    n_rows = fill(room)
    if n_rows > len(room):
        room = np.empty((n_rows, *room.shape[1:]), dtype=room.dtype)
        fill(room)
    return room[:n_rows]


class Kernel(Generic[P, R]):
    """A function that is run as machine code; arguments go by position.

    Args:
        function: The function in Python.
        signature: What it takes and returns.
    """

    def __init__(self, function: Callable[P, R], signature: Signature) -> None:
        update_wrapper(self, function)
        self._body: Function = function
        self._signature = signature
        self._run: Function | None = None
        self._callback: object = None

    def __call__(self, *arguments: P.args, **_: P.kwargs) -> R:
        """Run it.

        Raises:
            TypeError: If an argument is not of its type.
        """
        run = self._run or self.ready()
        given = zip(self._signature.takes, arguments, strict=True)
        result: R = run(*[value for taken, argument in given for value in taken.as_c(argument)])
        return result

    def ready(self) -> Function:
        """What runs it, loaded or compiled first."""
        with _one_at_a_time:
            if self._run is None:
                self._run = self._signature.at(self._loaded() or self._compiled())
            return self._run

    def is_kept(self) -> bool:
        """Whether its machine code is kept."""
        return os.path.exists(self._path())

    def _loaded(self) -> int | None:
        """The address of kept machine code."""
        object_file = _read(self._path())
        return loaded(self._name, object_file) if object_file is not None else None

    def _compiled(self) -> int:
        """The address of machine code made now, which is kept where that is possible."""
        made = compiled(self._name, self._body, self._signature, HELPERS)
        if made.object_file is not None:
            _keep(self._path(), made.object_file)
        self._callback = made.callback
        return int(made.callback.address)

    @cached_property
    def _name(self) -> str:
        """Of its machine code: the same for the same source on the same machine, else another."""
        source = _source_of(self._body.__code__, self._body.__globals__)
        made_by = _digest(OPTIONS, self._signature, self._signature.entry(), *source)
        return f"{self._body.__module__}.{self._body.__name__}-{_digest(machine())}-{made_by}"

    def _path(self) -> str:
        folder = os.environ.get(VARIABLE) or os.path.dirname(cache_from_source(__file__))
        return os.path.join(folder, f"{self._name}.o")


def _parsed(signature: str) -> Signature:
    """A signature as `kernel` takes it."""
    returned, *taken = (
        Parameter(np.dtype(None if name == "void" else name), axes.count(":"), is_const=bool(const))
        for const, name, axes in re.findall(r"(const )?(\w+)(\[[:, ]*\])?", signature)
    )
    return Signature(tuple(taken), None if signature.startswith("void") else returned)


def _source_of(code: CodeType, known: dict[str, Any]) -> Iterator[str]:
    """What a function, with the names known to it, and its helpers are made from."""
    yield f"{code.co_code.hex()} {code.co_names} {code.co_varnames}"
    for constant in code.co_consts:
        yield from (
            _source_of(constant, known) if isinstance(constant, CodeType) else [repr(constant)]
        )
    for name in code.co_names:
        value = known.get(name)
        if isinstance(value, FunctionType) and value in HELPERS:
            yield from _source_of(value.__code__, value.__globals__)
        elif not isinstance(value, ModuleType):
            yield f"{name} = {value!r}"


def _digest(*parts: object) -> str:
    """A short name for some texts."""
    return hashlib.sha256("\n".join(map(str, parts)).encode()).hexdigest()[:12]


def _read(path: str) -> bytes | None:
    """A file that was kept; None where there is none, or it has come to harm."""
    try:
        with open(path, "rb") as file:
            digest, content = file.read(_DIGEST_BYTES), file.read()
    except OSError:
        return None
    return content if hashlib.sha256(content).digest() == digest else None


def _keep(path: str, content: bytes) -> None:
    """Keep a file, if it can be written, and the newest of the same from other sources.

    Processes may do so at the same time; each writes a file of its own and renames it.
    """
    folder, name = os.path.split(path)
    unfinished = f"{path}.{os.getpid()}"
    with suppress(OSError):
        os.makedirs(folder, exist_ok=True)
        with open(unfinished, "wb") as file:
            file.write(hashlib.sha256(content).digest() + content)
        os.replace(unfinished, path)
        of_this_machine = f"{name.rsplit('-', 1)[0]}-"
        same = [entry for entry in os.scandir(folder) if entry.name.startswith(of_this_machine)]
        for outdated in sorted(same, key=lambda entry: -entry.stat().st_mtime)[N_KEPT:]:
            os.remove(outdated.path)
