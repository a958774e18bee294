"""Layers of a drawing: which entities are geometry, which are annotation and left out."""

from collections import Counter
from collections.abc import Iterable
from typing import NamedTuple

from seal_mdao.errors import GeometryError

ANNOTATION = frozenset({
    "TEXT", "MTEXT", "ATTDEF", "ATTRIB", "ACAD_TABLE", "DIMENSION", "ARC_DIMENSION",
    "LARGE_RADIAL_DIMENSION", "LEADER", "MULTILEADER", "MLEADER", "TOLERANCE", "HATCH", "MPOLYGON",
    "SOLID", "TRACE", "POINT", "RAY", "XLINE", "WIPEOUT", "IMAGE", "VIEWPORT", "OLE2FRAME",
    "OLEFRAME", "PDFUNDERLAY", "DWFUNDERLAY", "DGNUNDERLAY",
})  # fmt: skip
"""Kinds of entities that are no boundary on any layer."""

CENTRE_LINES = (
    "CENTER", "CENTRE", "PHANTOM", "DASHDOT", "ISO04W", "ISO05W", "ISO08W", "ISO09W",
    "ISO10W", "ISO11W", "ISO12W",
)  # fmt: skip
"""Parts of the names of line types (AutoCAD, ISO 128) that mean centre lines and phantom lines."""

DEEPEST = 16
"""Largest depth of blocks in blocks; a block that contains itself has no end."""


class Placed(NamedTuple):
    """An entity of the model space, or of a block placed there.

    Attributes
    ----------
    entity : DXFEntity
        In coordinates of the model space.
    layer : str
        Its layer; of an entity on layer "0" of a block that of the block reference.
    name : str
        Kind, handle, layer, block: for messages.
    symbol : bool
        Whether its layer is that of a block reference, not its own.
    """

    entity: object
    layer: str
    name: str
    symbol: bool = False


class Sorted(NamedTuple):
    """Entities of the visible layers of a drawing.

    Attributes
    ----------
    geometry : list of Placed
    texts : list of (str, (float, float))
        Contents and insertion points, in units of the drawing.
    left_out : Counter
        Number of entities that are not read, by layer.
    """

    geometry: list
    texts: list
    left_out: Counter


def sorted_entities(document, ignore: Iterable[str] = ()) -> Sorted:
    """Sort the entities of the model space into geometry, texts, and what is left out.

    Left out are annotation (``ANNOTATION``, centre lines), the layers ``ignore``, and blocks without
    layers of their own on layers that otherwise hold annotation only: symbols. Layers that are off or
    frozen, hidden entities, and block references on frozen layers with all that they hold are not
    looked at. Layers are compared without regard to case, as CAD programs do.

    Raises
    ------
    GeometryError
        For a block that contains itself.
    """
    ignored, geometry, texts, left_out = {n.casefold() for n in ignore}, [], [], Counter()
    for placed in _placed(document):
        if not _shown(document, placed.layer):
            continue
        is_text = placed.entity.dxftype() in ("TEXT", "MTEXT")
        if is_text:
            texts.append(_text(placed.entity))
        if placed.layer.casefold() in ignored or _is_annotation(document, placed):
            left_out[placed.layer] += 1
        else:
            geometry.append(placed)
    # a layer of annotation and blocks alone holds symbols
    drawn = {own.layer for own in geometry if not own.symbol}
    symbols = {own.layer for own in geometry if own.layer in left_out} - drawn
    left_out.update(own.layer for own in geometry if own.layer in symbols)
    return Sorted([own for own in geometry if own.layer not in symbols], texts, left_out)


def layer_names(document) -> list[str]:
    """List the layers that entities of the model space are on, block references resolved."""
    return list(dict.fromkeys(own.layer for own in _placed(document)))


def _placed(document):
    """Yield the entities of the model space and, in place of block references, those of the blocks."""
    for entity in document.modelspace():
        layer = _layer(document, entity)
        name = f"{entity.dxftype()} #{entity.dxf.handle} on layer {layer!r}"
        yield from _resolved(document, Placed(entity, layer, name), 0)


def _resolved(document, placed: Placed, depth: int):
    """Yield an entity, or what the block holds that it refers to."""
    entity = placed.entity
    if _attribute(entity, "invisible", 0):
        return
    if entity.dxftype() != "INSERT":
        yield placed
        return
    # a frozen layer hides the complete reference, a layer that is off only what is on it
    if _frozen(document, placed.layer):
        return
    block = entity.dxf.get("name", "")
    if depth > DEEPEST:
        raise GeometryError(
            f"{placed.name}: the block {block!r} contains itself; explode the block or remove the "
            "inner insert"
        )
    # attributes belong to the reference; rows and columns of one reference are single ones
    yield from (Placed(own, placed.layer, placed.name, True) for own in entity.attribs)
    for single in entity.multi_insert() if entity.mcount > 1 else [entity]:
        for own in single.virtual_entities():
            # layer 0 of a block is the layer of its reference
            layer = _layer(document, own)
            of_reference = layer == "0"
            layer = placed.layer if of_reference else layer
            name = f"{own.dxftype()} of the block {block!r} ({placed.name})"
            inner = Placed(own, layer, name, of_reference)
            yield from _resolved(document, inner, depth + 1)


def _layer(document, entity) -> str:
    """Return the layer of an entity as the table of layers spells it."""
    name = _attribute(entity, "layer", "0")
    return document.layers.get(name).dxf.name if name in document.layers else name


def _attribute(entity, name: str, default):
    """Return an attribute of an entity, also of a kind that ezdxf does not know but stores."""
    if entity.dxf.is_supported(name):
        return entity.dxf.get(name, default)
    stored = getattr(entity, "graphic_properties", dict)()
    return stored.get(name, default)


def _shown(document, name: str) -> bool:
    """Return whether a layer is on and not frozen; one without an entry is."""
    if name not in document.layers:
        return True
    return document.layers.get(name).is_on() and not _frozen(document, name)


def _frozen(document, name: str) -> bool:
    """Return whether a layer is frozen; one without an entry is not."""
    return name in document.layers and document.layers.get(name).is_frozen()


def _is_annotation(document, placed: Placed) -> bool:
    """Return whether an entity is annotation by its kind or its type of line."""
    if placed.entity.dxftype() in ANNOTATION:
        return True
    # the type of line of an entity, or that of its layer
    style = _attribute(placed.entity, "linetype", "BYLAYER").upper()
    if style == "BYLAYER" and placed.layer in document.layers:
        style = document.layers.get(placed.layer).dxf.get("linetype", "CONTINUOUS").upper()
    return any(part in style for part in CENTRE_LINES)


def _text(entity) -> tuple:
    """Return content and insertion point of a TEXT or MTEXT."""
    point = entity.dxf.insert
    if entity.dxftype() == "TEXT":
        point = entity.get_placement()[1]
    return entity.plain_text().strip(), (float(point[0]), float(point[1]))
