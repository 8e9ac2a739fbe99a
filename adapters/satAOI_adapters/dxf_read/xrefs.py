"""External references: drawings beside the drawing, read only from a folder that the user names."""

from functools import cache
from pathlib import Path, PureWindowsPath

from ezdxf.document import Drawing

from satAOI_adapters.dxf_read.expand import Xrefs
from satAOI_adapters.dxf_read.opening import open_drawing
from satAOI_adapters.layers import LayerTable
from satAOI_geo.errors import InputError


def xrefs_in(folder: Path | None, table: LayerTable) -> Xrefs:
    """A function that finds the drawing an external reference means.

    Only the file's name counts, with the suffix .dxf in place of .dwg; the folders in the stored
    path belong to another machine, and nothing outside the folder given here is ever opened.

    Raises:
        InputError: If there is no such folder.
    """
    if folder is not None and not folder.is_dir():
        raise InputError(f"there is no folder '{folder}' for external references")

    @cache
    def find(path: str) -> Drawing | None:
        if folder is None:
            return None
        wanted = f"{PureWindowsPath(path).stem}.dxf".casefold()
        for file in sorted(folder.iterdir()):
            inside = file.resolve().parent == folder.resolve()
            if inside and file.name.casefold() == wanted:
                return open_drawing(file, table).document
        return None

    return find
