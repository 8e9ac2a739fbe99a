"""Write an area of interest into a DXF drawing.

The input, where it is a DXF, is kept whole underneath; any other plan is first drawn on layers
named FLOOR, WALL, COLUMN and so on, so that the drawing can be read again. On top come:

    SATAOI-AOI         one solid hatch for each connected part; hatches lie below everything else
    SATAOI-AOI-EDGE    its outline, closed polylines with true arcs
    SATAOI-UNREACHED   free floor that is not reached, with area and reason of each patch
    SATAOI-UPPER       the same where only the disc-connected estimate claims it
    SATAOI-ZONE        outline of what each set-down can trowel; the layer is frozen
    SATAOI-START       the disc at the start
    SATAOI-OBSTACLE    floor and obstacles as they were read, coloured by kind
    SATAOI-NOTE        legend and figures beside the plan

Whatever lay on these layers before is replaced. Each entity says in extended data (SATAOI) what
it stands for; a record SATAOI in the root dictionary holds the settings of the run.
"""

from pathlib import Path

from satAOI_adapters.dxf_write.layers import STYLES
from satAOI_adapters.dxf_write.legend import note_rows
from satAOI_adapters.dxf_write.output import drawing
from satAOI_adapters.dxf_write.place import floor_bounds, text_height
from satAOI_adapters.dxf_write.scene import (
    draw_area,
    draw_plan,
    draw_start,
    draw_unreached,
    draw_zones,
    send_to_back,
)
from satAOI_geo.pipeline import Result

__all__ = ["write"]


def write(path: Path, result: Result) -> None:
    """Write the input drawing with the area of interest drawn into it.

    The same result gives the same bytes.

    Args:
        path: The DXF file to write.
        result: The area of interest and the plan it was found on.

    Raises:
        InputError: If the file must not or cannot be written.
        UnreadableError: If the input drawing is gone or was changed since it was read.
    """
    with drawing(path, result, STYLES, note_rows(result)) as space:
        draw_plan(space, result)
        draw_zones(space, result)
        hatches = draw_area(space, result)
        hatches += draw_unreached(space, result, text_height(floor_bounds(result.plan)))
        draw_start(space, result)
        send_to_back(space, hatches)
