"""Hostile files of what the editor and the viewer open: sound ones, mutated at random from a seed."""

from __future__ import annotations

import io
import random
import re
import struct
import warnings
import zipfile
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

import numpy as np
import numpy.typing as npt

FILE_KINDS = (
    "stl", "obj", "ply", "off", "dae", "motion.npz", "motion.csv", "motion.parquet", "samples.npz", "samples.csv",
    "document",
)  # fmt: skip
# Before what is there instead of a file.
PLACE = b"\0instead of a file: "
# Between a document, its positions, its unsaved text and a part.
PARTS = b"\0\0part\0\0"
_PLACES = ("folder", "pipe", "socket", "loop", "endless", "dangling", "outside", "nothing")
_CORNERS = np.array([(x, y, z) for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
_FACES = np.array([(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)])
# Words of texts, and numbers of binary files, that lie.
_WORDS = (
    b"nan", b"inf", b"-inf", b"1e400", b"-1", b"0", b"1e308", b"9" * 20, b"4294967295", b"2147483647",
    b"-0", b"0x10", b"1_000", b"", b"\0", b"\xff\xfe", b'"', b"'", b",", b"\n", b"\r", b"(" * 300, b"<a>" * 300,
    b"[" * 3000, b"{" * 3000,
    b"a" * 100_000, b"../../etc/passwd", b"/dev/zero", b"file:///etc/passwd", b"t", b"q1", b"end_header", b"f 1 2 3",
    b"element face 4000000000", b"property list uint64 int32 x", b"usemtl x", b"mtllib /dev/zero", b"solid",
    b"endsolid",
    b'<!DOCTYPE a [<!ENTITY b "c">]>', b"&b;", b"&a [*a]", b"!!python/object:os.system", b"include: [hostile.yaml]",
    b"1 " * 100_000, "größe".encode("utf-16"), b"\xef\xbb\xbf",
)  # fmt: skip
_BINARY = (
    *(struct.pack("<I", n) for n in (0, 1, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF)),
    *(struct.pack("<Q", n) for n in (0, 1 << 40, (1 << 63) - 1, (1 << 64) - 1)),
    *(struct.pack("<d", x) for x in (float("nan"), float("inf"), 1e308, -1e308, 5e-324)),
    *(struct.pack("<f", x) for x in (float("nan"), float("inf"), 3e38)),
)
_WORD = re.compile(rb"[A-Za-z_]\w*|-?\d+(?:\.\d+)?")


def mutated_files(kind: str, seed: int) -> Iterator[bytes]:
    """Endless mutations of sound files of a kind, the same ones for the same seed."""
    rng, sound = random.Random(f"{kind} {seed}"), sound_files(kind)
    while True:
        if rng.random() < 0.02:
            yield PLACE + rng.choice(_PLACES).encode()
        elif kind.endswith(".npz") and rng.random() < 0.7:
            yield _lying_archive(rng)
        elif kind.endswith(".parquet") and rng.random() < 0.5:
            yield _invalid_table(rng)
        else:
            data = rng.choice(sound)
            for _ in range(rng.choice((1, 1, 1, 2, 3, 6))):
                data = _mutate(data, rng)
            yield data


def sound_files(kind: str) -> list[bytes]:
    """Valid files from which mutations of a kind start."""
    if kind == "document":
        return _documents()
    if kind.endswith(".csv"):
        return [_motion_table().encode()]
    if kind.endswith(".npz"):
        return [_archive({"t": np.arange(3.0), "q": np.tile([0.1, 0.0, 0.0, 0.0, 1.0], (3, 1)), "u": np.zeros((3, 1))})]
    if kind.endswith(".parquet"):
        return [_parquet(_columns())]
    return _meshes(kind)


def _meshes(kind: str) -> list[bytes]:
    corners, faces = _CORNERS, _FACES
    rows = [" ".join(map(str, corner)) for corner in corners]
    if kind == "stl":
        triangles = corners[faces].astype("<f4").reshape(-1, 9)
        binary = b"".join(struct.pack("<3f", 0, 0, 1) + row.tobytes() + b"\0\0" for row in triangles)
        lines = "".join(
            "facet normal 0 0 1\nouter loop\n" + "".join(f"vertex {rows[i]}\n" for i in face) + "endloop\nendfacet\n"
            for face in faces
        )
        return [
            b"binary".ljust(80, b"\0") + struct.pack("<I", len(faces)) + binary,
            f"solid s\n{lines}endsolid s\n".encode(),
        ]
    indices = [" ".join(map(str, face)) for face in faces]
    if kind == "obj":
        lines = "\n".join([*(f"v {row}" for row in rows), "vt 0 0", "vn 0 0 1", "g a", "usemtl m", *(
            "f " + " ".join(f"{i + 1}/1/1" for i in face) for face in faces
        )])  # fmt: skip
        return [b"mtllib a.mtl\n" + lines.encode(), lines.replace("/1/1", "").encode()]
    if kind == "off":
        return ["\n".join(["OFF", f"{len(rows)} {len(faces)} 0", *rows, *(f"3 {i}" for i in indices)]).encode()]
    if kind == "ply":
        head = (
            f"ply\nformat {{}} 1.0\ncomment c\nelement vertex {len(rows)}\n"
            "property float x\nproperty float y\nproperty float z\n"
            f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
        )
        binary = corners.astype("<f4").tobytes() + b"".join(b"\3" + face.astype("<i4").tobytes() for face in faces)
        text = "\n".join([*rows, *(f"3 {i}" for i in indices)]) + "\n"
        return [head.format("binary_little_endian").encode() + binary, (head.format("ascii") + text).encode()]
    text = f"""<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="0.01"/><up_axis>Y_UP</up_axis></asset><library_geometries><geometry id="g"><mesh>
<source id="s"><float_array id="a" count="{corners.size}">{" ".join(rows)}</float_array><technique_common>
<accessor source="#a" count="{len(rows)}" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
<triangles count="{len(faces)}"><input semantic="VERTEX" source="#v" offset="0"/><p>{" ".join(indices)}</p></triangles>
</mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="w"><node id="n">
<matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</matrix><translate>1 0 0</translate><instance_geometry url="#g"/></node>
</visual_scene></library_visual_scenes><scene>
<instance_visual_scene url="#w"/></scene></COLLADA>"""
    return [
        text.encode(),
        text.replace("<p>", f"<vcount>{'3 ' * len(faces)}</vcount><p>").replace("triangles", "polylist").encode(),
    ]


def _documents() -> list[bytes]:
    corpus = Path(__file__).parent.parent / "corpus"
    texts = [path.read_bytes() for path in sorted(corpus.glob("*.yaml"))]
    layout = b'{"layout": {"bodies/link": [10, 20.5], "world": [0, 0]}}'
    part = b"bodies:\n  link:\n    joint: {kind: revolute, name: q}\n    inertia: {mass: 1, moments: [1, 1, 1]}\n"
    return [PARTS.join((text, layout, text, part)) for text in texts] + [PARTS.join((text, layout)) for text in texts]


def _columns() -> dict[str, object]:
    columns = {"t": np.arange(4.0), "q1": np.linspace(0, 1, 4)}
    return columns | {f"q2.q{axis}": np.full(4, float(axis == "w")) for axis in "xyzw"}


def _motion_table() -> str:
    columns = _columns()
    rows = zip(*columns.values(), strict=True)
    return "\n".join([",".join(columns), *(",".join(map(str, row)) for row in rows)]) + "\n"


def _parquet(columns: dict[str, object]) -> bytes:
    try:
        pyarrow, parquet = import_module("pyarrow"), import_module("pyarrow.parquet")
    except ImportError:
        return b"PAR1" + bytes(40) + b"PAR1"
    stream = io.BytesIO()
    parquet.write_table(pyarrow.table(columns), stream)
    return stream.getvalue()


def _invalid_table(rng: random.Random) -> bytes:
    """A Parquet file whose columns have other types, values or lengths than a motion's; some are mutated, too."""
    columns = _columns()
    name = rng.choice([*columns])
    count = rng.choice((4, 4, 4, 0, 1, 300_000))
    odd: list[object] = [
        np.full(count, 1.0), ["a"] * 4, [None] * 4, [[1.0]] * 4, [{"a": 1}] * 4, [b"x"] * 4, [True] * 4,
        np.full(4, np.nan),
        [1.0, None, 2.0, 3.0], np.full(4, 1e308), np.array([3.0, 2.0, 1.0, 0.0]), np.arange(4).astype("datetime64[s]"),
        np.full(4, 2**63, np.uint64), np.zeros(4, np.float16),
    ]  # fmt: skip
    columns[name] = rng.choice(odd)
    if count != 4:
        columns = {key: np.full(count, float(key in ("t", "q2.qw"))) for key in columns}
    if rng.random() < 0.2:
        columns[f"{name}.{'x' * 1000}"] = columns[name]
    data = _parquet(columns)
    return _mutate(data, rng) if rng.random() < 0.3 else data


def _archive(arrays: dict[str, npt.NDArray[np.float64]]) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, array in arrays.items():
            content = io.BytesIO()
            np.lib.format.write_array(content, array)
            archive.writestr(zipfile.ZipInfo(f"{name}.npy"), content.getvalue(), zipfile.ZIP_DEFLATED)
    return stream.getvalue()


def _lying_archive(rng: random.Random) -> bytes:
    """An archive whose members are sound, hostile, or headers that lie."""
    stream = io.BytesIO()
    method = rng.choice((zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA))
    with warnings.catch_warnings(), zipfile.ZipFile(stream, "w", method) as archive:
        warnings.simplefilter("ignore")  # Of names that are there already.
        members = {
            "t": np.arange(3.0),
            "q": np.tile([0.1, 0.0, 0.0, 0.0, 1.0], (3, 1)),
            "u": np.zeros((3, 1)),
            "a": np.arange(3.0),
        }
        for name, array in members.items():
            content = io.BytesIO()
            np.lib.format.write_array(content, array)
            data = content.getvalue()
            if rng.random() < 0.4:
                data = _lying_array(data, rng)
            named = (
                name if rng.random() < 0.95 else rng.choice(("../../x", "/etc/passwd", "", "t", "q.npy", "a" * 60_000))
            )
            archive.writestr(zipfile.ZipInfo(f"{named}.npy"), data, method)  # Without the time of day.
        if rng.random() < 0.05:
            for i in range(5000):
                archive.writestr(zipfile.ZipInfo(f"m{i}.npy"), b"")
    data = stream.getvalue()
    return _mutate(data, rng) if rng.random() < 0.3 else data


def _lying_array(data: bytes, rng: random.Random) -> bytes:
    """One array of an archive with another shape, type or content than its length has."""
    kind = rng.randrange(6)
    if kind == 0:
        return data[:128] + bytes(rng.choice((100_000, 5_000_000)))
    if kind == 1:
        shapes = (
            b"(99999999999,)",
            b"(-3,)",
            b"(3, 0, 7)",
            b"()",
            b"(1e9,)",
            b"(" * 200,
            b"(3,) * 9**9",
            b"'x'",
            b"(2**70,)",
        )
        return _with_header(data, b"(3,)", rng.choice(shapes))
    if kind == 2:
        types = (
            b"'|O'",
            b"'<c16'",
            b"'<U1000000'",
            b"'<M8[s]'",
            b"'|V0'",
            b"[('a', '<f8')]",
            b"'<f2'",
            b"'>f8'",
            b"'|b1'",
            b"9" * 60,
        )
        return _with_header(data, b"'<f8'", rng.choice(types))
    if kind == 3:
        return data[: rng.randrange(len(data))]
    if kind == 4:
        at = rng.randrange(max(1, len(data) - 8))
        return data[:at] + rng.choice(_BINARY) + data[at + 8 :]
    return _mutate(data, rng)


def _with_header(data: bytes, old: bytes, new: bytes) -> bytes:
    """The header with another word, and its length put right."""
    head = data[10 : 10 + struct.unpack("<H", data[8:10])[0]].replace(old, new, 1)
    return data[:8] + struct.pack("<H", len(head)) + head + data[128:]


def _mutate(data: bytes, rng: random.Random) -> bytes:
    """One change: of a bit, a number, a word, a piece, the length, the encoding."""
    at, kind = rng.randrange(len(data) + 1), rng.randrange(10)
    if kind == 0 and data:
        at = rng.randrange(len(data))
        return data[:at] + bytes([data[at] ^ 1 << rng.randrange(8)]) + data[at + 1 :]
    if kind == 1:
        number = rng.choice(_BINARY)
        return data[:at] + number + data[at + len(number) :]
    if kind == 2:
        return data[:at]
    if kind == 3:
        return data[:at] + rng.choice(_WORDS) + data[at:]
    if kind == 4:
        return data[:at] + data[at : at + rng.randint(1, 200)] * rng.choice((2, 3, 300)) + data[at:]
    if kind == 5:
        return data[:at] + data[at + rng.randint(1, 100) :]
    if kind == 6 and rng.random() < 0.2:
        return data.decode("latin-1").encode(rng.choice(("utf-16", "utf-32", "utf-7", "utf-8")), "replace")
    if kind == 6:
        return data + rng.randbytes(rng.choice((1, 10, 1000)))
    words = list(_WORD.finditer(data[:50_000]))
    if not words:
        return data
    word = rng.choice(words)
    other = rng.choice(words).group() if rng.random() < 0.5 else rng.choice(_WORDS)
    return data[: word.start()] + other + data[word.end() :]
