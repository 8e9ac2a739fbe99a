"""Read floor plans from DXF drawings.

The way of a drawing, one module a stage: `opening` (bytes to document), `expand` (blocks
resolved), `survey` (meaning, unit, size; `boundary`, `frames`, `joints` and `lookalikes` tell by
its look what no name tells), `entities` and `curves` (exact geometry), `shapes` (polygons on a
stated side), `swings`, `doors`, `windows`, `nameless` and `dashed` (what among the lines is wall),
`obstacles` and `linework` (walls, columns, holes), `openings` (doors over walls), `floor`,
`reading` (the plan).
"""

from satAOI_adapters.dxf_read.options import ReadOptions
from satAOI_adapters.dxf_read.reading import read

__all__ = ["ReadOptions", "read"]
