"""satAOI-geo: made ready, run, and its errors turned into lines and exit codes.

What takes time to load is imported by functions, so that an interrupt meanwhile is told as one.
"""

from collections.abc import Sequence
from typing import Final

from satAOI_adapters import signals
from satAOI_adapters.exit_codes import (
    INTERRUPTED,
    LIMIT_REACHED,
    NO_START,
    SIGNALLED,
    UNUSABLE,
    USAGE,
)
from satAOI_adapters.terminal import accept_any_text, say_error
from satAOI_geo.errors import DrawingError, InputError, LimitError, SatAoiError, StartError

EXIT_CODES: Final[dict[type[SatAoiError], int]] = {
    InputError: USAGE,
    DrawingError: UNUSABLE,
    StartError: NO_START,
    LimitError: LIMIT_REACHED,
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program and return its exit code; a known error becomes one line of talk."""
    try:
        with signals.raised():
            make_ready()
            return run(arguments)
    except SatAoiError as error:
        say_error(str(error))
        return next(code for sort, code in EXIT_CODES.items() if isinstance(error, sort))
    except OSError as error:
        say_error(f"{error.filename or 'input or output'}: {error.strerror or error}")
        return USAGE
    except MemoryError:
        say_error("not enough memory for this plan; give a coarser --step or a smaller --region")
        return LIMIT_REACHED
    except KeyboardInterrupt:
        say_error("interrupted")
        return INTERRUPTED
    except signals.EndedError as ended:
        say_error(str(ended))
        return SIGNALLED + ended.number


def run(arguments: Sequence[str] | None) -> int:
    """Run the command that the arguments name and return its exit code."""
    import rich_click as click

    from satAOI_geo.cli import commands

    try:
        code = commands.main(arguments, prog_name="satAOI-geo", standalone_mode=False)
        # of help there is none
        return int(code or 0)
    except click.ClickException as error:
        say_error(error.format_message())
        return error.exit_code
    except click.Abort as abort:
        raise KeyboardInterrupt from abort


def make_ready() -> None:
    """Let the libraries load quickly and take little, and let any text be printed."""
    from satAOI_adapters import class_code, linear_algebra, put_off
    from satAOI_adapters.collector import leave_at_once, look_seldom

    accept_any_text()
    look_seldom()
    leave_at_once()
    linear_algebra.without_threads()
    put_off.until_used()
    class_code.use_kept()
