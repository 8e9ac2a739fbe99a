"""Which value of an entity is no finite number, by its group code."""

import math

from ezdxf.entities import DXFEntity
from ezdxf.lldxf.tagwriter import TagCollector


def not_finite(entity: DXFEntity) -> str:
    """The first value of an entity that is infinite or not a number, in words; empty for none."""
    for tag in TagCollector.dxftags(entity):
        if isinstance(tag.value, float) and not math.isfinite(tag.value):
            return f"group code {tag.code} is {tag.value}, not a finite number"
    return ""
