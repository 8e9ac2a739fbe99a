"""Machine code of kernels: made of LLVM's bitcode, put into memory and called.

    llvmlite  is LLVM, a compiler, for Python: it makes bitcode an object file for this processor,
              as a C compiler would, and puts object files into memory
    ctypes    calls what is there, the interpreter's lock released meanwhile

LLVM ends the process when an object file calls a function that it cannot find. So an object file
is made only of code that calls none but `C_FUNCTIONS`, and put into memory only where all of
these are found. Calls that LLVM puts in by itself are to functions that it brings along.
"""

import ctypes
import os
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from typing import Any, Final

import llvmlite.binding as llvm
import numpy as np

Function = Callable[..., Any]

C_FUNCTIONS: Final = frozenset(
    "acos acosh asin asinh atan atan2 atanh ceil copysign cos cosh erf erfc exp expm1 "  # noqa: SIM905  easier read
    "fabs floor fmod hypot lgamma log log10 log1p memcpy memmove memset pow round sin "
    "sinh sqrt tan tanh tgamma trunc".split()
)
"""Functions of C that code may call, or LLVM's operations of that name become."""

ENTRY: Final = "kernel"
"""What bitcode calls the one function in it that is called from outside."""

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


@cache
def machine() -> str:
    """What machine code depends on besides its source: versions and the processor."""
    releases = [_release("numba"), _release("llvmlite")]
    python = sys.implementation.cache_tag
    processor = [llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()]
    return "\n".join([*releases, python, llvm.get_process_triple(), *processor])


def object_file(bitcode: bytes, name: str) -> bytes | None:
    """An object file for this machine, with one function; None where it cannot be made.

    The bitcode may be of a later LLVM, for another sort of processor, or call more than
    `C_FUNCTIONS`.

    Args:
        bitcode: Of a function, `ENTRY`.
        name: What the object file calls the function.
    """
    try:
        module = llvm.parse_bitcode(bitcode)
    except RuntimeError:
        return None
    target = target_machine()
    if _processor(module.triple) != _processor(target.triple):
        return None
    module.triple, module.data_layout = target.triple, str(target.target_data)
    module.get_function(ENTRY).name = name
    optimise(module, target, for_processor=True)
    values = (*module.functions, *module.global_variables)
    called = {value.name for value in values if value.is_declaration}
    if {each for each in called if not each.startswith("llvm.")} - C_FUNCTIONS:
        return None
    return bytes(target.emit_object(module))


def optimise(module: llvm.ModuleRef, target: llvm.TargetMachine, *, for_processor: bool) -> None:
    """Make code shorter and faster, for a processor's vector instructions or for any processor."""
    options = llvm.create_pipeline_tuning_options(3 if for_processor else 2)
    options.loop_vectorization = options.loop_interleaving = for_processor
    options.loop_unrolling = for_processor
    options.slp_vectorization = False
    builder = llvm.create_pass_builder(target, options)
    builder.getModulePassManager().run(module, builder)


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
def _engine() -> llvm.ExecutionEngine | None:
    """What puts object files into memory; None where a function of C is not found."""
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), target_machine())
    if any(llvm.address_of_symbol(name) is None for name in C_FUNCTIONS):
        return None
    return engine


def target_machine(cpu: str | None = None) -> llvm.TargetMachine:
    """This machine, or one of its sort with another processor."""
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    target = llvm.Target.from_triple(llvm.get_process_triple())
    return target.create_target_machine(
        cpu=cpu or llvm.get_host_cpu_name(),
        features="" if cpu else llvm.get_host_cpu_features().flatten(),
        opt=3,
        reloc="static" if target.name.startswith("x86") else "default",
        codemodel="jitdefault",
        jit=True,
    )


def _processor(triple: str) -> str:
    """What sort of processor code is for, of a triple "x86_64-unknown-linux-gnu"."""
    return triple.partition("-")[0]
