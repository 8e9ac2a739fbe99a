"""What a user can say about how a drawing is to be read."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, slots=True, kw_only=True)
class ReadOptions:
    """How to read a drawing; every field has a default that suits a well-kept drawing.

    Attributes:
        units: Key of `units.MM_PER_UNIT`; goes before what the drawing says.
        layers: The user's own layer patterns (TOML).
        encoding: Of the names in the file; goes before what the file declares.
        include_hidden: Read layers that are frozen or switched off, too.
    """

    units: str | None = None
    layers: Path | None = None
    encoding: str | None = None
    include_hidden: bool = False
