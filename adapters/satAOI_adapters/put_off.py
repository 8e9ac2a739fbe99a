"""Modules that libraries load at once and hardly ever use, put off until they are used.

ezdxf reads queries, such as `LINE[layer=="A-WALL"]`, with pyparsing, typefaces with fontTools and
places on the globe with ElementTree; it reads the stroke fonts of CAD programs, works out all
patterns of hatches and can measure texts as such a program sets them. numpy writes the help texts
of its functions in C. This program asks for none of these, and they are more than a tenth of all
that a run loads. So something stands in for what the libraries take from them. Where that is used
after all, or anything else of them is asked for, the module is loaded and everything is as ever;
but nothing asks for numpy's help texts, which are missing as in `python -OO`.
"""

import sys
from importlib import import_module
from importlib.machinery import ModuleSpec, PathFinder
from threading import Lock
from types import ModuleType
from typing import Any, Final

TAKEN: Final = {
    "ezdxf.queryparser": ("ezdxf.query", ["EntityQueryParser"]),
    "pyparsing": ("ezdxf.sections.blocks", ["ParseException"]),
    "fontTools.ttLib": ("ezdxf.fonts.font_manager", ["TTFont", "TTLibError"]),
    "ezdxf.fonts.shapefile": ("ezdxf.fonts.font_manager", []),
    "ezdxf.fonts.lff": ("ezdxf.fonts.font_manager", []),
    "ezdxf.tools.pattern": ("ezdxf.entities.pattern", []),
    "ezdxf.tools.text_size": ("ezdxf.render.mleader", []),
    "xml.etree.ElementTree": ("ezdxf.entities.geodata", []),
    "numpy._core._add_newdocs": ("numpy._core", []),
    "numpy._core._add_newdocs_scalars": ("numpy._core", []),
}
"""Module that is put off, to the one that takes it, or parts of it, and which parts."""

_one_at_a_time = Lock()


class NeverRaised(Exception):  # noqa: N818 - it is no error
    """For an exception to be caught, of a library that is not loaded and so raises none."""


def until_used() -> None:
    """Put the libraries off, where they are not loaded yet; for a program, as it starts."""
    for module, (_, names) in TAKEN.items():
        spec = _spec_of(module)
        if spec is not None and module not in sys.modules:
            sys.modules[module] = _StandIn(spec, names)


class _StandIn(ModuleType):
    """For a module; what it does not have is the module's own."""

    def __init__(self, spec: ModuleSpec, names: list[str]) -> None:
        super().__init__(spec.name)
        self.__spec__ = spec
        if spec.submodule_search_locations is not None:
            self.__path__ = spec.submodule_search_locations
        for name in names:
            is_caught = name.endswith(("Error", "Exception"))
            setattr(self, name, NeverRaised if is_caught else _Later(spec.name, name))

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401  whatever the module has
        if name == "__path__":
            raise AttributeError(f"'{self.__name__}' is no package")
        return getattr(_loaded(self.__name__), name)


class _Later:
    """For a class or an object of a module."""

    def __init__(self, module: str, name: str) -> None:
        self._module, self._name = module, name

    def __call__(self, *args: Any, **kwargs: Any) -> Any:  # noqa: ANN401  as the class does
        return getattr(_loaded(self._module), self._name)(*args, **kwargs)

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401  whatever the object has
        return getattr(getattr(_loaded(self._module), self._name), name)


def _loaded(module: str) -> ModuleType:
    """The module itself, from now on also where something stood in for parts of it."""
    with _one_at_a_time:
        stand_in = sys.modules.get(module)
        if isinstance(stand_in, _StandIn):
            del sys.modules[module]
    loaded = import_module(module)
    if isinstance(stand_in, _StandIn):
        # for who has taken hold of it
        vars(stand_in).update(vars(loaded))
    taker, names = TAKEN[module]
    if taker in sys.modules:
        vars(sys.modules[taker]).update({name: getattr(loaded, name) for name in names})
    return loaded


def _spec_of(module: str) -> ModuleSpec | None:
    """Where a module lies, without loading the packages it is in; None if it is not there."""
    spec, folders, name = None, None, ""
    for part in module.split("."):
        name = f"{name}.{part}" if name else part
        spec = PathFinder.find_spec(name, folders)
        if spec is None:
            return None
        folders = spec.submodule_search_locations
    return spec
