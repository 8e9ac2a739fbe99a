"""The threads of OpenBLAS, numpy's linear algebra, kept from starting where nobody needs them.

Once numpy is loaded there would be one a core, which take memory, and time too: each looks out for
work before it goes to sleep. This program multiplies but a few small matrices.
"""

import os
from typing import Final

VARIABLE: Final = "OPENBLAS_NUM_THREADS"
"""OpenBLAS's own, read as numpy is loaded."""


def without_threads() -> None:
    """Let numpy, if it is not loaded yet, start no threads; a value the user set is left alone."""
    os.environ.setdefault(VARIABLE, "1")
