"""Block references resolved: every visible entity of model space with its place and its layer.

The block graph is checked before anything is expanded, so that a small file cannot ask for
endless work; the expansion itself keeps its own stack.
"""

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Final

from ezdxf.document import Drawing
from ezdxf.entities import DXFEntity, DXFGraphic, Insert
from ezdxf.math import Matrix44, Vec3

from satAOI_adapters.dxf_read import limits
from satAOI_geo.errors import DrawingError
from satAOI_geo.plan import Finding

BY_PARENT: Final = "0"
"""What is drawn on this layer inside a block lies on the block reference's layer."""


@dataclass(frozen=True, slots=True)
class Placed:
    """An entity where it is seen.

    Attributes:
        entity: As it stands in model space or in a block definition.
        matrix: From the entity's world or block coordinates to the drawing's.
        layer: The layer it is seen on.
        blocks: Names of the blocks it is in, outermost first.
        handle: Of the entity of model space that brought it in.
    """

    entity: DXFGraphic
    matrix: Matrix44
    layer: str
    blocks: tuple[str, ...]
    handle: str

    @property
    def kind(self) -> str:
        """The entity's DXF name."""
        return self.entity.dxftype()


@dataclass(frozen=True, slots=True)
class Expansion:
    """What model space shows.

    Attributes:
        placed: Visible entities in drawing order.
        hidden: Entities not read because of a layer that is frozen or off, by layer.
        findings: Block references that could not be resolved.
    """

    placed: tuple[Placed, ...]
    hidden: Counter[str]
    findings: tuple[Finding, ...]


@dataclass(slots=True)
class _Walk:
    """The state of one expansion."""

    document: Drawing
    include_hidden: bool
    placed: list[Placed] = field(default_factory=list)
    hidden: Counter[str] = field(default_factory=Counter)
    findings: list[Finding] = field(default_factory=list)

    def is_frozen(self, layer: str) -> bool:
        return not self.include_hidden and self._has(layer, frozen=True)

    def is_off(self, layer: str) -> bool:
        return not self.include_hidden and self._has(layer, frozen=False)

    def _has(self, name: str, *, frozen: bool) -> bool:
        if name not in self.document.layers:
            return False
        layer = self.document.layers.get(name)
        return layer.is_frozen() if frozen else layer.is_off()


@dataclass(frozen=True, slots=True)
class _Level:
    """One block reference on the stack: its entities still to come, and what they inherit."""

    entities: Iterator[DXFEntity]
    matrix: Matrix44
    layer: str
    blocks: tuple[str, ...]
    handle: str


def expand(document: Drawing, *, include_hidden: bool) -> Expansion:
    """Resolve the block references of model space.

    Raises:
        DrawingError: If a block contains itself.
        LimitError: If there would be too many entities, copies or levels.
    """
    model = document.modelspace()
    limits.hold(
        "entities once its blocks are resolved",
        _count(document, model),
        limits.MAX_ENTITIES,
        "save the part that is needed as a drawing of its own",
    )
    walk = _Walk(document, include_hidden)
    stack = [_Level(iter(model), Matrix44(), BY_PARENT, (), "")]
    while stack:
        entity = next(stack[-1].entities, None)
        if entity is None:
            stack.pop()
        elif isinstance(entity, DXFGraphic):
            stack.extend(_visit(walk, stack[-1], entity))
    return Expansion(tuple(walk.placed), walk.hidden, tuple(walk.findings))


def _visit(walk: _Walk, level: _Level, entity: DXFGraphic) -> Iterable[_Level]:
    """Note one entity; for a block reference, the levels it opens."""
    layer = entity.dxf.layer
    if layer == BY_PARENT:
        layer = level.layer
    handle = level.handle or str(entity.dxf.get("handle") or "")
    if entity.dxf.get("invisible", 0) or walk.is_frozen(layer):
        walk.hidden[layer] += 1
    elif isinstance(entity, Insert):
        # a reference on a layer that is off hides only what takes that layer from it
        yield from _levels(walk, level, entity, layer, handle)
    elif walk.is_off(layer):
        walk.hidden[layer] += 1
    else:
        walk.placed.append(Placed(entity, level.matrix, layer, level.blocks, handle))


def _levels(
    walk: _Walk, level: _Level, insert: Insert, layer: str, handle: str
) -> Iterable[_Level]:
    """One level for each copy of a block reference."""
    name = insert.dxf.get("name", "")
    block = walk.document.blocks.get(name)
    fault = _fault(insert, exists=block is not None)
    if fault or block is None:
        walk.findings.append(
            Finding(
                "block-skipped",
                f"the reference to block '{name}' is not drawn: {fault}",
                "restore the block in the drawing if it shows something on the floor",
                layer=layer,
                handle=handle,
            )
        )
        return
    for offset in _copies(insert):
        matrix = insert.matrix44() * Matrix44.translate(*offset) * level.matrix
        yield _Level(iter(block), matrix, layer, (*level.blocks, name), handle)


def _fault(insert: Insert, *, exists: bool) -> str:
    """Why a block reference cannot be drawn, or an empty string."""
    if not exists:
        return "the drawing has no block of that name"
    if insert.dxf.xscale == 0 or insert.dxf.yscale == 0:
        return "its scale is 0"
    return ""


def _copies(insert: Insert) -> Iterator[Vec3]:
    """Where the copies of a block reference lie relative to it, one offset for an ordinary one."""
    columns, rows = max(insert.dxf.column_count, 1), max(insert.dxf.row_count, 1)
    limits.hold(
        "copies in one array", columns * rows, limits.MAX_ARRAY, "explode or thin out the array"
    )
    ocs = insert.ocs()
    for row in range(rows if insert.dxf.row_spacing else 1):
        for column in range(columns if insert.dxf.column_spacing else 1):
            # the array is turned with the block, not scaled
            step = Vec3(column * insert.dxf.column_spacing, row * insert.dxf.row_spacing)
            yield Vec3(ocs.to_wcs(step.rotate_deg(insert.dxf.rotation)))


def _count(document: Drawing, model: Iterable[DXFEntity]) -> int:
    """Entities after expansion, from the block graph alone, in time linear in its size."""
    totals: dict[str, int] = {}
    top = list(model)
    path: list[str] = []
    pending = [(name, False) for name in _references(top)]
    while pending:
        name, is_done = pending.pop()
        if is_done:
            path.pop()
            totals[name] = _total(_entities(document, name), totals)
        elif name in path:
            circle = " → ".join((*path[path.index(name) :], name))
            raise DrawingError(
                f"block '{name}' contains itself ({circle}); remove one of these references"
            )
        elif name not in totals:
            path.append(name)
            limits.hold(
                "levels of blocks in blocks", len(path), limits.MAX_NESTING, "explode some of them"
            )
            pending.append((name, True))
            pending.extend((inner, False) for inner in _references(_entities(document, name)))
    return _total(top, totals)


def _references(entities: Iterable[DXFEntity]) -> set[str]:
    """Names of the blocks that are referred to."""
    return {_key(entity) for entity in entities if isinstance(entity, Insert)}


def _total(entities: Iterable[DXFEntity], totals: dict[str, int]) -> int:
    return sum(
        max(entity.mcount, 1) * totals[_key(entity)] if isinstance(entity, Insert) else 1
        for entity in entities
    )


def _entities(document: Drawing, name: str) -> Iterable[DXFEntity]:
    block = document.blocks.get(name)
    return () if block is None else block


def _key(insert: Insert) -> str:
    """The block's name as the drawing's table keys it: case does not matter."""
    return str(insert.dxf.get("name", "")).casefold()
