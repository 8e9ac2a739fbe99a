"""Block references resolved: every visible entity of model space with its place and its layer.

The block graph is checked before anything is expanded, so that a small file cannot ask for
endless work; the expansion itself keeps its own stack. External references are followed only
where the caller can supply them; objects of other programs are replaced by the picture of
themselves that the drawing carries, if it does.
"""

import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from typing import Final, TypeAlias

from ezdxf.document import Drawing
from ezdxf.entities import ACADProxyEntity, DXFEntity, DXFGraphic, DXFTagStorage, Insert
from ezdxf.layouts import BaseLayout
from ezdxf.lldxf.const import DXFError
from ezdxf.math import Matrix44, Vec3

from satAOI_adapters.dxf_read import limits
from satAOI_adapters.dxf_read.finite import not_finite
from satAOI_geo.errors import DrawingError
from satAOI_geo.plan import Finding

Xrefs: TypeAlias = Callable[[str], Drawing | None]
"""The drawing that an external reference means, by the path it is stored with, if it is at hand."""

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

    entity: DXFEntity
    matrix: Matrix44
    layer: str
    blocks: tuple[str, ...]
    handle: str

    @property
    def kind(self) -> str:
        """The entity's DXF name."""
        return self.entity.dxftype()

    def label(self) -> str:
        """The entity as a person can find it in the drawing."""
        inside = f" in block '{self.blocks[-1]}'" if self.blocks else ""
        own = self.entity.dxf.get("handle") or self.handle
        return f"{self.kind} {own} on layer '{self.layer}'{inside}"


@dataclass(frozen=True, slots=True)
class Missing:
    """An external reference that is not at hand.

    Attributes:
        name: Of its block.
        path: As stored in the drawing.
        layer: The layer its reference lies on.
        handle: Of the reference.
    """

    name: str
    path: str
    layer: str
    handle: str


@dataclass(frozen=True, slots=True)
class Expansion:
    """What a drawing shows.

    Attributes:
        placed: Visible entities in drawing order.
        hidden: Entities not read because of a layer that is frozen or off, by layer.
        invisible: Entities not read since they are invisible themselves, by layer.
        missing: External references that could not be followed.
        findings: What could not be resolved, or was replaced.
        fault: Why no plan can come of it: the first reference that lies nowhere.
    """

    placed: tuple[Placed, ...]
    hidden: Counter[str]
    invisible: Counter[str]
    missing: tuple[Missing, ...]
    findings: tuple[Finding, ...]
    fault: DrawingError | None


@dataclass(slots=True)
class _Walk:
    """The state of one expansion."""

    document: Drawing
    xrefs: Xrefs
    include_hidden: bool
    placed: list[Placed] = field(default_factory=list)
    hidden: Counter[str] = field(default_factory=Counter)
    invisible: Counter[str] = field(default_factory=Counter)
    pictured: Counter[str] = field(default_factory=Counter)
    missing: list[Missing] = field(default_factory=list)
    findings: list[Finding] = field(default_factory=list)
    fault: DrawingError | None = None

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
    """One block reference on the stack: its entities still to come, and what they inherit.

    `prefix` goes before the layers of an external reference, as in the drawing that holds it.
    """

    entities: Iterator[DXFEntity]
    matrix: Matrix44
    layer: str
    blocks: tuple[str, ...]
    handle: str
    document: Drawing
    prefix: str = ""


def expand(document: Drawing, *, xrefs: Xrefs, include_hidden: bool) -> Expansion:
    """Resolve the block references of model space, or of a layout if model space is empty.

    Raises:
        DrawingError: If a block contains itself.
        LimitError: If there would be too many entities, copies or levels.
    """
    space, findings = space_of(document)
    _hold_count(document, space)
    walk = _Walk(document, xrefs, include_hidden, findings=findings)
    stack = [_Level(iter(space), Matrix44(), BY_PARENT, (), "", document)]
    while stack:
        # the copies of an array lie side by side on the stack, at one level
        depth = len(stack[-1].blocks)
        limits.hold("levels of blocks in blocks", depth, limits.MAX_NESTING, "explode some of them")
        entity = next(stack[-1].entities, None)
        if entity is None:
            stack.pop()
        else:
            stack.extend(_visit(walk, stack[-1], entity))
    return Expansion(
        tuple(walk.placed),
        walk.hidden,
        walk.invisible,
        tuple(walk.missing),
        (*walk.findings, *_pictured(walk.pictured)),
        walk.fault,
    )


def space_of(document: Drawing) -> tuple[BaseLayout, list[Finding]]:
    """Model space; the fullest layout where model space is empty."""
    model = document.modelspace()
    layouts = [layout for layout in document.layouts if not layout.is_modelspace]
    fullest = max(layouts, key=_n_drawn, default=model)
    if len(model) or not _n_drawn(fullest):
        return model, []
    return fullest, [
        Finding(
            "paper-space",
            f"model space is empty: layout '{fullest.name}' is read instead",
            "check the unit: layouts are often drawn at the size of the paper",
        )
    ]


def _n_drawn(layout: BaseLayout) -> int:
    return sum(entity.dxftype() != "VIEWPORT" for entity in layout)


def _visit(walk: _Walk, level: _Level, entity: DXFEntity) -> Iterable[_Level]:
    """Note one entity; for a block reference, the levels it opens."""
    own = _layer(entity)
    layer = level.layer if own == BY_PARENT else level.prefix + own
    handle = level.handle or str(entity.dxf.get("handle") or "")
    if _is_invisible(entity):
        walk.invisible[layer] += 1
    elif walk.is_frozen(layer):
        walk.hidden[layer] += 1
    elif isinstance(entity, Insert):
        # a reference on a layer that is off hides only what takes that layer from it
        yield from _levels(walk, level, entity, layer, handle)
    elif walk.is_off(layer):
        walk.hidden[layer] += 1
    elif picture := _picture(entity):
        walk.pictured[entity.dxftype()] += 1
        yield replace(level, entities=iter(picture), layer=layer, handle=handle)
    else:
        walk.placed.append(Placed(entity, level.matrix, layer, level.blocks, handle))


def _layer(entity: DXFEntity) -> str:
    if isinstance(entity, DXFTagStorage):
        return str(entity.graphic_properties().get("layer", BY_PARENT))
    return str(entity.dxf.get("layer", BY_PARENT))


def _is_invisible(entity: DXFEntity) -> bool:
    return isinstance(entity, DXFGraphic) and bool(entity.dxf.get("invisible", 0))


def _picture(entity: DXFEntity) -> list[DXFGraphic]:
    """The lines that another program left as the picture of its object; none for others."""
    if not isinstance(entity, DXFTagStorage | ACADProxyEntity):
        return []
    try:
        return list(entity.virtual_entities())
    except (DXFError, ValueError, LookupError, ArithmeticError):
        # a damaged picture is as good as none: the object counts as unreadable
        return []


def _pictured(pictured: Counter[str]) -> Iterator[Finding]:
    for kind, count in pictured.items():
        yield Finding(
            "proxy-picture",
            f"{count} {kind} are objects of another program: the picture of them that the drawing "
            "carries is read",
            "export the drawing without such objects (TArch: export as T3) if something is missing",
        )


def _levels(
    walk: _Walk, level: _Level, insert: Insert, layer: str, handle: str
) -> Iterable[_Level]:
    """One level for each copy of a block reference."""
    name = insert.dxf.get("name", "")
    block = level.document.blocks.get(name)
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
    content: BaseLayout = block
    document, prefix = level.document, level.prefix
    if block.block is not None and block.block.is_xref:
        path = str(block.block.dxf.get("xref_path", ""))
        external = walk.xrefs(path)
        if external is None:
            walk.missing.append(Missing(name, path, layer, handle))
            return
        content, document, prefix = external.modelspace(), external, f"{name}|"
        _hold_count(external, content)
    for offset in _copies(insert):
        matrix = insert.matrix44() * Matrix44.translate(*offset) * level.matrix
        if not all(map(math.isfinite, matrix)):
            walk.fault = walk.fault or DrawingError(
                f"the reference {insert.dxf.get('handle')} to block '{name}' on layer '{layer}' "
                f"cannot be placed: {not_finite(insert)}; correct it in the drawing or delete it",
                layer=layer,
                handle=handle,
            )
            return
        blocks = (*level.blocks, name)
        yield _Level(iter(content), matrix, layer, blocks, handle, document, prefix)


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


def _hold_count(document: Drawing, space: Iterable[DXFEntity]) -> None:
    limits.hold(
        "entities once its blocks are resolved",
        _count(document, space),
        limits.MAX_ENTITIES,
        "save the part that is needed as a drawing of its own",
    )


def _count(document: Drawing, space: Iterable[DXFEntity]) -> int:
    """Entities after expansion, from the block graph alone, in time linear in its size."""
    totals: dict[str, int] = {}
    top = list(space)
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
