"""The <visual> elements of SDFormat as those of URDF, which one reader draws."""

from __future__ import annotations

from symofros.description.xml_nodes import Element

# Shape -> its sizes, which are children here and attributes in URDF.
_SIZES = {
    "box": {"size": "size"},
    "sphere": {"radius": "radius"},
    "cylinder": {"radius": "radius", "length": "length"},
    "capsule": {"radius": "radius", "length": "length"},
    "mesh": {"uri": "filename", "scale": "scale"},
}


def as_urdf(link: Element) -> Element:
    """A link of nothing but its visual shapes, as URDF states them."""
    return Element("link", {}, link.line, [_visual(visual) for visual in link.all("visual")], link.file)


def _visual(visual: Element) -> Element:
    line, children = visual.line, list[Element]()
    pose, geometry, material = (visual.first(tag) for tag in ("pose", "geometry", "material"))
    if pose is not None and pose.text:
        entries = pose.text.split()
        # Other than x y z roll pitch yaw in radians is no URDF, which the reader of visuals then says.
        plain = not any(pose.attributes.get(label) for label in ("relative_to", "frame", "rotation_format", "degrees"))
        placed = {"xyz": " ".join(entries[:3]), "rpy": " ".join(entries[3:]) if plain else "?"}
        children.append(Element("origin", placed, line))
    shape = geometry.children[0] if geometry is not None and geometry.children else None
    if shape is not None:
        names = _SIZES.get(shape.tag, {})
        sizes = {names[child.tag]: child.text for child in shape.children if child.tag in names}
        children.append(Element("geometry", {}, line, [Element(shape.tag, sizes, line)]))
    diffuse = material.first("diffuse") if material is not None else None
    if diffuse is not None:
        entries = diffuse.text.split()
        color = Element("color", {"rgba": " ".join(entries if len(entries) == 4 else [*entries, "1"])}, line)
        children.append(Element("material", {}, line, [color]))
    return Element("visual", dict(visual.attributes), line, children)
