"""What the program's exit codes mean; README has the table."""

from typing import Final

DONE: Final = 0
FINDINGS: Final = 1
"""Under `--strict`."""
USAGE: Final = 2
UNUSABLE: Final = 3
NO_START: Final = 4
LIMIT_REACHED: Final = 5

SIGNALLED: Final = 128
"""A process that signal N has ended has the exit code 128 + N, as in shells."""

INTERRUPTED: Final = SIGNALLED + 2
