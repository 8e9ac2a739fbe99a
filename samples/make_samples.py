"""Write the sample drawings: `python samples/make_samples.py [FOLDER]`.

The same version of ezdxf writes the same bytes on every run.
"""

import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Final

import ezdxf
import flat
import halls
import pen
import rooms
from ezdxf.document import Drawing

SAMPLES: Final[dict[str, Callable[[], Drawing]]] = {
    "hall_simple": halls.simple,
    "hall_medium": halls.medium,
    "hall_complex": halls.complex_,
    "two_rooms_760": partial(rooms.two_rooms, 760.0, units=pen.MM),
    "two_rooms_900": partial(rooms.two_rooms, 900.0, units=pen.METRE),
    "flat": flat.flat,
}


def main(folder: Path) -> None:
    """Write every sample into a folder."""
    # no time stamps and no random identifiers in the files
    ezdxf.options.write_fixed_meta_data_for_testing = True
    for name, draw in SAMPLES.items():
        save(draw(), folder / f"{name}.dxf")


def save(doc: Drawing, path: Path) -> None:
    """Write a drawing, with its classes in a fixed order.

    ezdxf registers the classes in use in the order of a set of strings, which differs from run
    to run; a class that is registered already keeps its place.
    """
    for dxf_type in sorted(doc.entitydb.dxf_types_in_use()):
        doc.classes.add_class(dxf_type)
    doc.saveas(path)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
