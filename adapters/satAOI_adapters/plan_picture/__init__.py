"""Pictures of a plan as it was understood, for a person to see what is wrong.

`layout` decides what goes where on a `page`, `svg` and `png` draw it.
"""

from collections.abc import Iterable
from pathlib import Path

from satAOI_adapters.files import written_whole
from satAOI_adapters.inspected import Figures, Inspected
from satAOI_adapters.plan_picture import png, svg
from satAOI_adapters.plan_picture.layout import page_of


def write_png(path: Path, found: Inspected[Figures], *, never_over: Iterable[Path] = ()) -> None:
    """Draw a plan as PNG.

    Raises:
        InputError: If the file must not or cannot be written.
    """
    _write(path, png.drawn(page_of(found)), never_over)


def write_svg(path: Path, found: Inspected[Figures], *, never_over: Iterable[Path] = ()) -> None:
    """Draw a plan as SVG.

    Raises:
        InputError: If the file must not or cannot be written.
    """
    _write(path, svg.drawn(page_of(found)), never_over)


def _write(path: Path, data: bytes, never_over: Iterable[Path]) -> None:
    with written_whole(path, never_over=never_over) as stream:
        stream.write(data)
