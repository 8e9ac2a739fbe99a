"""Kernels: loops over arrays, written in Python and run as machine code.

    @kernel("int64(const uint64[:, :], const int64[:], int32[:, :])")
    def _links(allowed, first, found): ...

The string gives the types as C would: first of what is returned, then of each parameter, with a
colon for each axis of an array, and `const` where it is only read. Arrays are in the order of C.
A kernel allocates nothing and raises nothing; it is given room for its results, and what it calls
is a `helper`.

A kernel is made where it is first called on a machine, of the bitcode that comes with the program,
see `bitcode`. Its machine code is kept, and later runs load that, see `machine_code`: in the folder
that the environment's `NUMBA_CACHE_DIR` names, else beside Python's own compiled code of this
module.
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

from satAOI_geo import bitcode, kept
from satAOI_geo.machine_code import (
    Function,
    Parameter,
    Signature,
    loaded,
    machine,
    object_file,
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
        """What runs it, loaded or made first."""
        with _one_at_a_time:
            if self._run is None:
                address = self._loaded() or self._made_of(self.shipped()) or self._made_by_numba()
                self._run = self._signature.at(address)
            return self._run

    def is_kept(self) -> bool:
        """Whether its machine code is kept."""
        return os.path.exists(self._path())

    def shipped(self) -> bytes | None:
        """Its bitcode that comes with the program; None if there is none, or of another source."""
        try:
            return bitcode.shipped(self.bitcode_name)
        except OSError:
            # there is no source, only what Python has compiled
            return None

    def made_by_numba(self) -> bitcode.Made:
        """The kernel as numba compiles it now."""
        return bitcode.made(self._body, self._signature, HELPERS)

    def _loaded(self) -> int | None:
        """The address of kept machine code."""
        machine_code = kept.read(self._path())
        return None if machine_code is None else loaded(self._name, machine_code)

    def _made_of(self, of: bytes | None) -> int | None:
        """The address of machine code made of bitcode, which is kept where that is possible."""
        made = None if of is None else object_file(of, self._name)
        if made is None:
            return None
        kept.write(self._path(), made)
        _forget_outdated(self._path())
        return loaded(self._name, made)

    def _made_by_numba(self) -> int:
        """The address of machine code made by numba."""
        made = self.made_by_numba()
        address = self._made_of(made.bitcode)
        if address is None:
            self._callback, address = made.callback, int(made.callback.address)
        return address

    @property
    def bitcode_name(self) -> str:
        """Of its bitcode: the same for the same source, else another.

        Raises:
            OSError: If its source is not there.
        """
        return f"{self._full_name}-{self._digest_of(bitcode.text_of)}.bc"

    @cached_property
    def _name(self) -> str:
        """Of its machine code: the same for the same source on the same machine, else another."""
        return f"{self._full_name}-{_digest(machine())}-{self._digest_of(_compiled_by_python)}"

    @property
    def _full_name(self) -> str:
        return f"{self._body.__module__}.{self._body.__name__}"

    def _digest_of(self, told: Callable[[Function], str]) -> str:
        """Of all that it is made from, functions as they are told."""
        signature, options = self._signature, bitcode.OPTIONS
        return _digest(options, signature, signature.entry(), *_sources_of(self._body, told))

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


def _sources_of(function: Function, told: Callable[[Function], str]) -> Iterator[str]:
    """What a function is made from: itself, what the names in it stand for, and its helpers."""
    yield told(function)
    names = {name for code in _codes(function.__code__) for name in code.co_names}
    for name in sorted(names):
        value = function.__globals__.get(name)
        if isinstance(value, FunctionType) and value in HELPERS:
            yield from _sources_of(value, told)
        elif not isinstance(value, ModuleType):
            yield f"{name} = {value!r}"


def _compiled_by_python(function: Function) -> str:
    """A function as Python has compiled it."""
    return "\n".join(
        f"{code.co_code.hex()} {code.co_names} {code.co_varnames} "
        f"{[each for each in code.co_consts if not isinstance(each, CodeType)]}"
        for code in _codes(function.__code__)
    )


def _codes(code: CodeType) -> Iterator[CodeType]:
    """Compiled code, and that of the functions in it."""
    yield code
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _codes(constant)


def _digest(*parts: object) -> str:
    """A short name for some texts."""
    return hashlib.sha256("\n".join(map(str, parts)).encode()).hexdigest()[:12]


def _forget_outdated(path: str) -> None:
    """Remove machine code of the same kernel from other sources, but for the newest."""
    folder, name = os.path.split(path)
    of_this_machine = f"{name.rsplit('-', 1)[0]}-"
    with suppress(OSError):
        same = [entry for entry in os.scandir(folder) if entry.name.startswith(of_this_machine)]
        for outdated in sorted(same, key=lambda entry: -entry.stat().st_mtime)[N_KEPT:]:
            os.remove(outdated.path)
