"""Dashed lines: what lies above the cut or under the floor is drawn so.

Lintels over doors, beams, edges of the storey above, foundations and centre lines show the robot
nothing to run into. Taken as walls they would close every door that has a lintel, and as things on
the floor the footings would close it around each column.
"""

from collections import defaultdict
from collections.abc import Sequence
from typing import Final

from ezdxf.document import Drawing
from ezdxf.entities import Linetype

from satAOI_adapters.dxf_read.expand import BY_PARENT, Placed
from satAOI_adapters.dxf_read.features import Feature
from satAOI_adapters.dxf_read.meaning import Seen
from satAOI_adapters.meanings import Certainty, Meaning
from satAOI_adapters.wording import are, counted
from satAOI_geo.plan import Finding, Frame

BY_LAYER: Final = "BYLAYER"
"""Linetype of an entity that is drawn as its layer says."""

DASH_CODE, SHAPE_CODE = 49, 340
"""Group codes of a pattern: a dash (below 0 a gap), and the text or shape that some hold."""


def dashed_among(seen: Sequence[Seen]) -> frozenset[int]:
    """Identities of what is drawn dashed on layers of walls, of doors or without a meaning.

    Where most walls are dashed it is a manner of drawing and counts for nothing; so it does on
    layers that the user's own file names.
    """
    walls = [entity for entity in seen if entity.verdict.meaning is Meaning.WALL]
    others = [entity for entity in seen if entity.verdict.meaning in {Meaning.DOOR, None}]
    guessed = [entity for entity in walls if entity.verdict.certainty is not Certainty.GIVEN]
    dashed_walls = _dashed(guessed)
    return frozenset() if 2 * len(dashed_walls) > len(walls) else dashed_walls | _dashed(others)


def without_dashed(
    walls: Sequence[Feature], dashed: frozenset[int], frame: Frame
) -> tuple[list[Feature], tuple[Finding, ...]]:
    """Walls less the lines that are dashed, and what is to be said about these.

    Args:
        walls: What is drawn on wall layers; fills and wide lines stay.
        dashed: Identities of what is placed and dashed.
        frame: Of the walls.
    """
    kept: list[Feature] = []
    left_out: defaultdict[str, list[Feature]] = defaultdict(list)
    for feature in walls:
        if id(feature.placed) in dashed and not feature.is_area and not feature.width_mm:
            left_out[feature.placed.layer].append(feature)
        else:
            kept.append(feature)
    return kept, tuple(_finding(left_out[layer], frame) for layer in sorted(left_out))


def _dashed(entities: Sequence[Seen]) -> frozenset[int]:
    return frozenset(id(entity.placed) for entity in entities if is_dashed(entity.placed))


def is_dashed(placed: Placed) -> bool:
    """Whether an entity is drawn with gaps, by its own linetype or by that of its layer."""
    document = placed.entity.doc
    if document is None:
        return False
    name = str(placed.entity.dxf.get("linetype", BY_LAYER))
    if name.upper() == BY_LAYER:
        name = _of_layer(placed, document)
    return name in document.linetypes and _has_gaps(document.linetypes.get(name))


def _of_layer(placed: Placed, document: Drawing) -> str:
    own = str(placed.entity.dxf.get("layer", BY_PARENT))
    layer = placed.layer if own == BY_PARENT else own
    return str(document.layers.get(layer).dxf.linetype) if layer in document.layers else ""


def _has_gaps(linetype: Linetype) -> bool:
    """Whether a pattern has gaps and nothing but dashes between them: no fence, no insulation."""
    tags = linetype.pattern_tags.tags
    return not tags.has_tag(SHAPE_CODE) and any(
        tag.code == DASH_CODE and tag.value < 0 for tag in tags
    )


def _finding(lines: Sequence[Feature], frame: Frame) -> Finding:
    """What is to be said about dashed lines of one layer."""
    first = lines[0]
    x_mm, y_mm = frame.to_drawing_mm([first.paths[0].start])[0]
    return Finding(
        "dashed",
        f"{counted(len(lines), 'dashed line')} on layer '{first.placed.layer}' "
        f"{are(len(lines))} left out: things above the cut or under the floor are drawn so",
        "draw them continuous, or name the layer in a file for --layers, if they stop the robot",
        layer=first.placed.layer,
        handle=first.placed.handle,
        at_mm=(float(x_mm), float(y_mm)),
    )
