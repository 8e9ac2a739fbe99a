"""Kernels as LLVM's bitcode: made of Python by numba, once, and for any processor of a sort.

To load numba takes longer than to search a small hall, and to go from Python to bitcode several
times as long as from there to machine code. So the bitcode of the program's kernels comes with it,
in the file `kernels.zip`; `python -m satAOI_adapters.bitcode_write` writes that. It was made with
the oldest LLVM that the program runs with, since later ones read it. What has changed since, or
does not fit this machine, is made by numba where it is needed.
"""

import os
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from typing import Any, Final

import llvmlite.binding as llvm

from satAOI_geo.machine_code import (
    ENTRY,
    Function,
    Signature,
    optimise,
    target_machine,
)

ARCHIVE: Final = os.path.join(os.path.dirname(__file__), "kernels.zip")
"""The bitcode that comes with the program, a file a kernel."""

OPTIONS: Final[dict[str, Any]] = {
    "error_model": "numpy",
    "no_cpython_wrapper": True,
    "no_cfunc_wrapper": True,
}
"""For numba: divide by zero as numpy does, instead of raising, and make nothing that Python or C
could call but the entry of a kernel. Else numba would be needed when the code is used."""


@dataclass(frozen=True, slots=True)
class Made:
    """A kernel that numba has compiled in this process.

    Attributes:
        bitcode: Its bitcode.
        callback: What numba has of it, with an `address`; in memory as long as somebody keeps it.
    """

    bitcode: bytes
    callback: Any


def shipped(name: str) -> bytes | None:
    """The bitcode of that name that comes with the program.

    None where there is none, or the archive has come to harm.
    """
    import zlib  # noqa: PLC0415  only where a kernel's machine code is not kept
    from zipfile import BadZipFile, ZipFile  # noqa: PLC0415  as above

    faults = (OSError, KeyError, ValueError, RuntimeError, EOFError, BadZipFile, zlib.error)
    with suppress(*faults), ZipFile(ARCHIVE) as archive:
        return archive.read(name)
    return None


def text_of(function: Function) -> str:
    """A function as it would be written without comments, the same for all versions of Python.

    Raises:
        OSError: If its source is not there.
    """
    import ast  # noqa: PLC0415  as above
    import inspect  # noqa: PLC0415  as above
    from textwrap import dedent  # noqa: PLC0415  as above

    (tree,) = ast.parse(dedent(inspect.getsource(function))).body
    if isinstance(tree, ast.FunctionDef):
        tree.decorator_list.clear()
        if ast.get_docstring(tree) is not None:
            del tree.body[0]
    return ast.unparse(tree)


def made(body: Function, signature: Signature, helpers: Iterable[Function]) -> Made:
    """Compile a kernel with numba.

    Args:
        body: The function; it allocates nothing and calls only the helpers.
        signature: What it takes and returns.
        helpers: Functions, which may call each other.
    """
    import numba  # noqa: PLC0415  only where it is needed

    for function in (body, *helpers):
        _make_known(function)
    scope = {"body": body, "carray": numba.carray}
    # numba takes no function of a varying number of arguments
    entry = eval(signature.entry(), scope)  # noqa: S307  of our own words
    callback = numba.cfunc(_in_numba(signature), **OPTIONS)(entry)
    return Made(_cut_loose(callback), callback)


@cache
def _make_known(function: Function) -> None:
    """Tell numba to compile a function where others that it compiles call it."""
    from numba.extending import register_jitable  # noqa: PLC0415  as above

    register_jitable(**OPTIONS)(function)


def _in_numba(signature: Signature) -> Any:  # noqa: ANN401  numba publishes no types
    """A signature of addresses, sizes and numbers."""
    from numba import from_dtype, types  # noqa: PLC0415  as above

    taken = []
    for parameter in signature.takes:
        element = from_dtype(parameter.dtype)
        taken.append(types.CPointer(element) if parameter.n_axes else element)
        taken += [types.int64] * parameter.n_axes
    returned = from_dtype(signature.returns.dtype) if signature.returns else types.void
    return returned(*taken)


def _cut_loose(callback: Any) -> bytes:  # noqa: ANN401  numba's, untyped
    """The bitcode of a compiled kernel, without what cannot be reached from its entry.

    That is all that numba has put in for errors, which its kernels do not raise, and for counting
    references to arrays, which are not its own: that is known once functions are put into those
    that call them, and for that they must not be visible from outside.
    """
    module = llvm.parse_assembly(callback.inspect_llvm())
    for value in (*module.functions, *module.global_variables):
        if not value.is_declaration:
            value.linkage = "internal"
    function = module.get_function(callback.native_name)
    function.linkage, function.name = "external", ENTRY
    target = target_machine("generic")
    # what is needless once functions are put into those that call them goes the second time
    for _ in range(2):
        optimise(module, target, for_processor=False)
    return bytes(module.as_bitcode())
