"""COLLADA files: where their triangles are, and hostile ones."""

from __future__ import annotations

import io
import zipfile

import numpy as np
import pytest

from symofros.studio.viewer.drawing.collada import read_collada

HEAD = '<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>{asset}</asset>'
XYZ = '<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>'
ACCESSOR = f'<technique_common><accessor stride="3">{XYZ}</accessor></technique_common>'
GEOMETRY = f"""<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="15">0 0 0  1 0 0  1 2 0  0 2 0  0 0 3</float_array>{ACCESSOR}</source>
<source id="n"><float_array id="b" count="3">0 0 1</float_array>{ACCESSOR}</source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
{{pieces}}</mesh></geometry></library_geometries>"""
TRIANGLES = """<triangles count="2"><input semantic="NORMAL" source="#n" offset="0"/>
<input semantic="VERTEX" source="#v" offset="1"/><p>0 0 0 1 0 4  0 0 0 2 0 3</p></triangles>"""
SCENE = """<library_visual_scenes><visual_scene id="s">{nodes}</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene>"""
SHOWN = '<instance_geometry url="#g"/>'


def document(
    pieces: str = TRIANGLES, nodes: str | None = f"<node>{SHOWN}</node>", asset: str = "<up_axis>Z_UP</up_axis>"
) -> bytes:
    scene = "" if nodes is None else SCENE.format(nodes=nodes)
    return f"{HEAD.format(asset=asset)}{GEOMETRY.format(pieces=pieces)}{scene}</COLLADA>".encode()


def corners(data: bytes) -> np.ndarray:
    """Corners of all triangles (F, 3, 3)."""
    mesh = read_collada(data, 100)
    return mesh.vertices[mesh.faces]


PLAIN = np.array([[[0, 0, 0], [1, 0, 0], [0, 0, 3]], [[0, 0, 0], [1, 2, 0], [0, 2, 0]]], dtype=float)


def test_triangles_are_where_they_are_stated() -> None:
    assert np.array_equal(corners(document()), PLAIN)
    assert np.array_equal(corners(document(nodes=None)), PLAIN)  # Without a scene, each stands once.


@pytest.mark.parametrize(
    "pieces",
    [
        '<polylist count="2"><input semantic="VERTEX" source="#v" offset="0"/><vcount>4 3</vcount>'
        "<p>0 1 2 3  0 1 4</p></polylist>",
        '<polygons count="2"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2 3</p><p>0 1 4</p></polygons>',
    ],
)
def test_polygons_become_triangles(pieces: str) -> None:
    places = np.array([[0, 0, 0], [1, 0, 0], [1, 2, 0], [0, 2, 0], [0, 0, 3]])
    assert np.array_equal(corners(document(pieces)), places[[[0, 1, 2], [0, 2, 3], [0, 1, 4]]])


def test_nodes_transform_their_contents() -> None:
    inner = f"<node><rotate>0 0 1 90</rotate><scale>2 2 2</scale>{SHOWN}</node>"
    placed = corners(document(nodes=f"<node><translate>10 0 0</translate>{inner}</node>"))
    expected = np.stack([10 - 2 * PLAIN[..., 1], 2 * PLAIN[..., 0], 2 * PLAIN[..., 2]], axis=-1)
    assert np.allclose(placed, expected, atol=1e-6)  # In single precision.
    matrix = f"<node><matrix>1 0 0 5 0 1 0 6 0 0 -1 7 0 0 0 1</matrix>{SHOWN}</node>"
    mirrored = corners(document(nodes=matrix))
    assert np.allclose(mirrored[:, ::-1], PLAIN * [1, 1, -1] + [5, 6, 7])  # Seen from the same side as before.


@pytest.mark.parametrize(
    ("asset", "expected"),
    [
        ('<unit meter="0.01"/><up_axis>Z_UP</up_axis>', 0.01 * PLAIN),
        ("<up_axis>Y_UP</up_axis>", PLAIN[..., [0, 2, 1]] * [1, -1, 1]),
        ("", PLAIN[..., [0, 2, 1]] * [1, -1, 1]),  # As the format has it.
        ("<up_axis>X_UP</up_axis>", PLAIN[..., [1, 2, 0]] * [-1, -1, 1]),
        ("<contributor><authoring_tool>VCGLib | MeshLab</authoring_tool></contributor><up_axis>Y_UP</up_axis>", PLAIN),
    ],
)
def test_units_and_axes_of_collada_are_applied(asset: str, expected: np.ndarray) -> None:
    assert np.allclose(corners(document(asset=asset)), expected)


def bomb() -> str:
    """Nodes that show each other twice, thirty times over: a thousand million triangles."""
    twice = '<instance_node url="#n{0}"/><instance_node url="#n{0}"/>'
    return (
        "".join(f'<node id="n{i}">{twice.format(i + 1)}</node>' for i in range(30)) + f'<node id="n30">{SHOWN}</node>'
    )


def zipped(data: bytes) -> bytes:
    """An archive with a file in it, which pycollada alone would unpack."""
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w") as file:
        file.writestr("a.dae", data)
    return archive.getvalue()


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        *((b"", "no element found"), (b"<a/>", "not <COLLADA>")),
        (b'<!DOCTYPE a [<!ENTITY b "c">]><COLLADA/>', "document types are refused"),
        (document(""), "no triangles"),
        (document(TRIANGLES.replace("0 0 0 1", "0 0 0 x")), "not a number"),
        (document(nodes=f'<node id="n"><instance_node url="#n"/>{SHOWN}</node>'), "in each other"),
        (document(nodes=bomb()), "more than 10000 nodes|too many triangles"),
        (document(nodes=f"<node>{SHOWN * 60}</node>"), "too many triangles"),
        (document(nodes=f"<node><matrix>1 2</matrix>{SHOWN}</node>"), "matrix"),
        (document().replace(b'stride="3"', b'stride="0"'), "stride"),
        (document().replace(b'stride="3"', b'stride="3" offset="3"'), "offset"),
        (document().replace(b'"VERTEX"', b'"NORMAL"'), "vertex input|VERTEX"),
        (document(TRIANGLES.replace("0 0 0 1", f"0 0 0 {10**30}")), "OverflowError|beyond|negative|Corrupted"),
        (document(TRIANGLES.replace("0 0 0 1", "0 0 0 -1")), "negative"),
        (document(TRIANGLES.replace("0 0 0 1", "0 0 0 5")), "beyond"),
        (
            document(
                '<polylist><input semantic="VERTEX" source="#v" offset="0"/>'
                "<vcount>2000000000</vcount><p>0 1 2</p></polylist>"
            ),
            "more corners than are there",
        ),
        (document(nodes=f"<node>{'<node>' * 60}{SHOWN}{'</node>' * 60}</node>"), "in each other"),
        (document(nodes=f'<node><instance_node url="file:///etc/passwd"/>{SHOWN}</node>'), "not there"),
        (document(nodes='<node><instance_geometry url="http://host/a.dae#g"/></node>'), "Invalid url"),
        (zipped(document()), "not well-formed"),
    ],
)
def test_invalid_collada_files_are_refused(data: bytes, expected: str) -> None:
    with pytest.raises(ValueError, match=expected):
        read_collada(data, 100)


EFFECT = '<effect id="{0}-e"><profile_COMMON><technique><phong>{1}</phong></technique></profile_COMMON></effect>'
DIFFUSE = "<diffuse><color>{}</color></diffuse>"


def painted(effects: str, bound: str = "") -> bytes:
    """Three materials of which two sets of triangles use one each, under the symbol `skin` and the name `bone`."""
    effect = EFFECT.format("red", DIFFUSE.format("1 0 0 1")) + EFFECT.format("blue", effects)
    library = f"<library_effects>{effect}</library_effects><library_materials>" + "".join(
        f'<material id="{name}"><instance_effect url="#{name}-e"/></material>' for name in ("red", "blue")
    )
    pieces = "".join(
        f'<triangles count="1" material="{name}"><input semantic="VERTEX" source="#v" offset="0"/>'
        f"<p>0 1 {k}</p></triangles>"
        for name, k in (("skin", 4), ("blue", 2))
    )
    use = f"<bind_material><technique_common>{bound}</technique_common></bind_material>"
    shown = f'<node><instance_geometry url="#g">{use}</instance_geometry></node>'
    text = (
        document(pieces, nodes=shown)
        .decode()
        .replace("<library_geometries>", f"{library}</library_materials><library_geometries>")
    )
    return text.encode()


BOUND = '<instance_material symbol="skin" target="#red"/>'


def test_triangles_have_the_colours_of_their_materials() -> None:
    """By the symbol that the scene binds, else by the material's name; what states no colour has none."""
    mesh = read_collada(painted(DIFFUSE.format("0 0.5 1 1"), BOUND), 100)
    assert mesh.colors is not None and mesh.colors.tolist() == [[255, 0, 0], [0, 128, 255]]
    parts = dict(mesh.by_color())
    assert {color: len(part.faces) for color, part in parts.items()} == {(255, 0, 0): 1, (0, 128, 255): 1}
    assert parts[255, 0, 0].vertices.tolist() == [[0, 0, 0], [1, 0, 0], [0, 0, 3]]
    textured = read_collada(painted('<diffuse><texture texture="t" texcoord="c"/></diffuse>', BOUND), 100)
    assert textured.colors is not None and textured.colors.tolist() == [[255, 0, 0], [-1, -1, -1]]
    assert [color for color, _ in textured.by_color()] == [None, (255, 0, 0)]
    for wrong in ("0 nan 1", "a b c", "1 0"):
        assert read_collada(painted(DIFFUSE.format(wrong)), 100).colors is None
    assert read_collada(document(), 100).by_color()[0][0] is None
