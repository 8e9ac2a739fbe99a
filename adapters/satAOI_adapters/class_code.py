"""What Python compiles for dataclasses, kept from run to run.

As a dataclass is loaded, Python writes source for each of its methods and compiles it. For the
hundred and more of a run this takes longer than all else that their modules do as they are loaded.
Python keeps the code of modules, but not of this source. So it is kept here, beside the kernels,
found again by the source itself, and made anew where it is not found.
"""

import atexit
import dataclasses
import marshal
import sys
from importlib.util import MAGIC_NUMBER
from typing import Any

from satAOI_adapters import kernel_cache
from satAOI_geo import kept


def use_kept() -> None:
    """Make dataclasses of what is kept from now on; for a program, as it starts.

    What has to be compiled is kept as the program ends, for the next run.
    """
    folder = kernel_cache.place()
    if folder is None or "exec" in vars(dataclasses):
        return
    code = _Code(str(folder / f"dataclasses-{sys.implementation.cache_tag}"))
    # the name that the module finds before Python's own, which it calls for nothing but this
    vars(dataclasses)["exec"] = code.run
    atexit.register(code.keep)


class _Code:
    """Compiled code by its source."""

    def __init__(self, path: str) -> None:
        self._path = path
        self._compiled = _read(path)
        self._n_kept = len(self._compiled)

    def run(self, source: str, *names: dict[str, Any]) -> None:
        """Run source as `exec` does, with the names that it knows."""
        compiled = self._compiled.get(source)
        if compiled is None:
            code = compile(source, "<string>", "exec", dont_inherit=True)
            self._compiled[source] = marshal.dumps(code)
        else:
            code = marshal.loads(compiled)  # noqa: S302 - it is what the line above has made
        exec(code, *names)  # noqa: S102 - in place of what dataclasses would do

    def keep(self) -> None:
        """Keep what has come up since it was read."""
        if len(self._compiled) > self._n_kept:
            kept.write(self._path, marshal.dumps((MAGIC_NUMBER, self._compiled)))


def _read(path: str) -> dict[str, bytes]:
    """Compiled code by its source, as it was kept by the same Python; nothing if there is none."""
    content = kept.read(path)
    if content is None:
        return {}
    of_python, compiled = marshal.loads(content)  # noqa: S302 - it has the digest of what was kept
    return compiled if of_python == MAGIC_NUMBER else {}
