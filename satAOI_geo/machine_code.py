"""Machine code of kernels: made with numba once, put into memory without numba ever after.

    numba     turns a Python function into the language of LLVM, a compiler
    llvmlite  is LLVM for Python, which numba stands on: it makes that an object file, as a C
              compiler would, and puts object files into memory
    ctypes    calls what is there, the interpreter's lock released meanwhile

To load numba takes longer than to search a small hall, to load llvmlite a twentieth of a second.

LLVM ends the process when an object file calls a function that it cannot find. So an object file
is made only of code that calls none but `C_FUNCTIONS`, and put into memory only where all of
these are found. Calls that LLVM puts in by itself are to functions it has found for numba before.
"""

import ctypes
import os
import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from typing import Any, Final

import llvmlite.binding as llvm
import numpy as np

Function = Callable[..., Any]

OPTIONS: Final[dict[str, Any]] = {"error_model": "numpy", "no_cpython_wrapper": True}
"""For numba: divide by zero as numpy does, instead of raising, and make nothing that Python could
call. Either would need numba when the code is used."""

C_FUNCTIONS: Final = frozenset(
    "acos acosh asin asinh atan atan2 atanh ceil copysign cos cosh erf erfc exp expm1 "  # noqa: SIM905  easier read
    "fabs floor fmod hypot lgamma log log10 log1p memcpy memmove memset pow round sin "
    "sinh sqrt tan tanh tgamma trunc".split()
)
"""Functions of C that code may call, or LLVM's operations of that name become."""

_place_of: Final[Callable[[Any], Any]] = (ctypes.c_char * 0).from_buffer
"""Where an array lies that may be written to."""


@dataclass(frozen=True, slots=True)
class Parameter:
    """What a kernel takes or returns: a number, or an array in the order of C.

    Attributes:
        dtype: Of the number, or of the array's elements.
        n_axes: 0 for a number.
        is_const: Whether the kernel only reads the array.
    """

    dtype: np.dtype[Any]
    n_axes: int = 0
    is_const: bool = False

    def as_c(self, argument: Any) -> tuple[Any, ...]:  # noqa: ANN401  whatever was passed
        """What C is given for an argument: for an array where it lies, and its sizes.

        Of an array that is only read this may be a copy, which lives as long as what is returned.

        Raises:
            TypeError: If it is not such an array; numbers are up to ctypes.
        """
        if not self.n_axes:
            return (argument.item() if isinstance(argument, np.generic) else argument,)
        if not isinstance(argument, np.ndarray):
            raise TypeError(f"an array is expected, not {argument!r}")
        if argument.dtype != self.dtype or argument.ndim != self.n_axes:
            raise TypeError(
                f"an array of {self.dtype} with {self.n_axes} axes is expected, not of "
                f"{argument.dtype} with {argument.ndim}"
            )
        flags = argument.flags
        if flags.carray:
            # several times faster than its address, but for arrays to write to only
            return (_place_of(argument), *argument.shape)
        if not self.is_const:
            raise TypeError("the array is not in the order of C, or not to be written to")
        if flags.c_contiguous and flags.aligned:
            return (argument.ctypes.data, *argument.shape)
        # from another process an array may come at an odd address
        return (_place_of(np.array(argument, order="C")), *argument.shape)

    def c_types(self) -> list[Any]:
        """The types for what `as_c` gives."""
        if self.n_axes:
            return [ctypes.c_void_p, *[ctypes.c_int64] * self.n_axes]
        return [np.ctypeslib.as_ctypes_type(self.dtype)]


@dataclass(frozen=True, slots=True)
class Signature:
    """What a kernel takes and returns.

    Attributes:
        takes: Its parameters.
        returns: A number, or None.
    """

    takes: tuple[Parameter, ...]
    returns: Parameter | None

    def entry(self) -> str:
        """The source of a function of addresses, sizes and numbers that calls a kernel, `body`."""
        names, views = [], []
        for k, parameter in enumerate(self.takes):
            sizes = [f"p{k}_{axis}" for axis in range(parameter.n_axes)]
            names += [f"p{k}", *sizes]
            views.append(f"carray(p{k}, ({', '.join(sizes)},))" if sizes else f"p{k}")
        return f"lambda {', '.join(names)}: body({', '.join(views)})"

    def at(self, address: int) -> Function:
        """The function at an address that takes what `Parameter.as_c` gives."""
        returned = self.returns.c_types()[0] if self.returns else None
        taken = [c_type for parameter in self.takes for c_type in parameter.c_types()]
        return ctypes.CFUNCTYPE(returned, *taken)(address)


@dataclass(frozen=True, slots=True)
class Compiled:
    """A kernel that numba has compiled in this process.

    Attributes:
        object_file: For later runs; None if it would call more than `C_FUNCTIONS`.
        callback: What numba has of it, with an `address`; in memory as long as somebody keeps it.
    """

    object_file: bytes | None
    callback: Any


@cache
def machine() -> str:
    """What machine code depends on besides its source: versions and the processor."""
    releases = [_release("numba"), _release("llvmlite")]
    python = sys.implementation.cache_tag
    processor = [llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()]
    return "\n".join([*releases, python, llvm.get_process_triple(), *processor])


def compiled(
    name: str, body: Function, signature: Signature, helpers: Iterable[Function]
) -> Compiled:
    """Compile a kernel with numba.

    Args:
        name: What its object file calls it.
        body: The function; it allocates nothing and calls only the helpers.
        signature: What it takes and returns.
        helpers: Functions, which may call each other.
    """
    import numba  # noqa: PLC0415  only where nobody has compiled the kernel yet

    for function in (body, *helpers):
        _make_known(function)
    scope = {"body": body, "carray": numba.carray}
    # numba takes no function of a varying number of arguments
    entry = eval(signature.entry(), scope)  # noqa: S307  of our own words
    callback = numba.cfunc(_in_numba(signature), **OPTIONS)(entry)
    return Compiled(_object_file(callback, name), callback)


def loaded(name: str, object_file: bytes) -> int | None:
    """Put a kernel's object file into memory: its address, None where this machine cannot."""
    engine = _engine()
    if engine is None:
        return None
    engine.add_object_file(llvm.ObjectFileRef.from_data(object_file))
    engine.finalize_object()
    return engine.get_function_address(name) or None


def _release(package: str) -> str:
    """Which release of a package is installed: what the folder of its metadata is called.

    `importlib.metadata` knows more, but takes longer to load than all kernels.
    """
    spec = find_spec(package)
    places = spec.submodule_search_locations if spec else None
    folders = [entry for place in places or () for entry in os.listdir(os.path.dirname(place))]
    return " ".join(sorted(name for name in folders if name.startswith(f"{package}-")))


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


def _object_file(callback: Any, name: str) -> bytes | None:  # noqa: ANN401  numba's, untyped
    """The object file of a compiled kernel; None if it would call more than `C_FUNCTIONS`."""
    module = llvm.parse_assembly(callback.inspect_llvm())
    target = _target_machine()
    _cut_loose(module, callback.native_name, name, target)
    values = (*module.functions, *module.global_variables)
    called = {value.name for value in values if value.is_declaration}
    if {each for each in called if not each.startswith("llvm.")} - C_FUNCTIONS:
        return None
    return bytes(target.emit_object(module))


def _cut_loose(module: llvm.ModuleRef, entry: str, name: str, target: llvm.TargetMachine) -> None:
    """Name a kernel's entry and take out what cannot be reached from there.

    That is all that numba has put in for errors, which its kernels do not raise, and for counting
    references to arrays, which are not its own: that is known once constants are passed on from
    function to function, and for that functions must not be visible from outside.
    """
    for value in (*module.functions, *module.global_variables):
        if not value.is_declaration:
            value.linkage = "internal"
    function = module.get_function(entry)
    function.linkage, function.name = "external", name
    passes = llvm.create_new_module_pass_manager()
    passes.add_ipsccp_pass()
    passes.add_simplify_cfg_pass()
    passes.add_global_opt_pass()
    passes.add_global_dead_code_eliminate_pass()
    passes.add_strip_dead_prototype_pass()
    passes.run(module, llvm.create_pass_builder(target, llvm.create_pipeline_tuning_options()))


@cache
def _engine() -> llvm.ExecutionEngine | None:
    """What puts object files into memory; None where a function of C is not found."""
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), _target_machine())
    if any(llvm.address_of_symbol(name) is None for name in C_FUNCTIONS):
        return None
    return engine


def _target_machine() -> llvm.TargetMachine:
    """This machine, in the way that numba compiles for it."""
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    target = llvm.Target.from_triple(llvm.get_process_triple())
    return target.create_target_machine(
        cpu=llvm.get_host_cpu_name(),
        features=llvm.get_host_cpu_features().flatten(),
        opt=3,
        reloc="static" if target.name.startswith("x86") else "default",
        codemodel="jitdefault",
        jit=True,
    )
