"""3MF files: parts as objects with shared vertices, which slicers recognise as manifold.

The archive is stored without compression and with fixed dates. Compressed bytes differ between
versions of zlib, and the same design must give the same file on every machine.
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from xml.etree import ElementTree

import numpy as np

from fingertip.cad.kernel.mesh import Mesh
from fingertip.foundation.numerics import Array

_CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
_MODEL_TYPE = "application/vnd.ms-package.3dmanufacturing-3dmodel+xml"
_CONTENT_TYPES = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
    '<Default Extension="rels" '
    'ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    f'<Default Extension="model" ContentType="{_MODEL_TYPE}"/>'
    '<Default Extension="config" ContentType="text/xml"/></Types>\n'
)
_RELATIONS = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
    '<Relationship Target="/3D/3dmodel.model" Id="rel0" '
    'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>\n'
)
_SETTINGS = "Metadata/Slic3r_PE_model.config"


@dataclass(frozen=True)
class Item:
    """Object of a 3MF file, and where it stands."""

    name: str
    """Letters, digits and underscores."""
    mesh: str
    """Mesh as `encode_mesh` writes it. Files that hold the same part share it."""
    note: str = ""
    rotation: Array | None = None
    shift: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Translation after the rotation [mm]."""
    settings: tuple[tuple[str, str], ...] = ()
    """Settings of the object for PrusaSlicer and its relatives,
    which other programs ignore: names and values.
    """


def to_bytes(mesh: Mesh, name: str, note: str = "") -> bytes:
    """Write a mesh as a 3MF archive in mm; the part's name holds
    letters, digits and underscores only.
    """
    return write_items(name, [Item(name, encode_mesh(mesh), note)])


def encode_mesh(mesh: Mesh) -> str:
    """Write a mesh as an element of a 3MF model."""
    vertices = "".join(
        f'<vertex x="{x!r}" y="{y!r}" z="{z!r}"/>\n' for x, y, z in mesh.vertices.tolist()
    )
    triangles = "".join(
        f'<triangle v1="{a}" v2="{b}" v3="{c}"/>\n' for a, b, c in mesh.triangles.tolist()
    )
    return (
        f"<mesh>\n<vertices>\n{vertices}</vertices>\n<triangles>\n{triangles}</triangles>\n</mesh>"
    )


def write_items(title: str, items: Sequence[Item]) -> bytes:
    """Write objects as a 3MF archive in mm."""
    objects = "\n".join(
        f'<object id="{number}" type="model" '
        f'name="{item.name}">{_describe(item)}{item.mesh}</object>'
        for number, item in enumerate(items, 1)
    )
    build = "".join(
        f'<item objectid="{number}"{_transform(item)}/>' for number, item in enumerate(items, 1)
    )
    model = (
        '<?xml version="1.0" encoding="UTF-8"?>\n<model unit="millimeter" xml:lang="en-US" '
        f'xmlns="{_CORE}">\n'
        f'<metadata name="Title">{title}</metadata>\n<metadata '
        'name="Application">fingertip</metadata>\n'
        f"<resources>{objects}</resources>\n"
        f"<build>{build}</build>\n</model>\n"
    )
    archive = io.BytesIO()

    with zipfile.ZipFile(archive, "w", zipfile.ZIP_STORED) as bundle:
        for path, text in (
            ("[Content_Types].xml", _CONTENT_TYPES),
            ("_rels/.rels", _RELATIONS),
            ("3D/3dmodel.model", model),
            *(
                [(_SETTINGS, _write_settings(items))]
                if any(item.settings for item in items)
                else []
            ),
        ):
            entry = zipfile.ZipInfo(path, date_time=(1980, 1, 1, 0, 0, 0))
            entry.create_system = 3  # the default differs between operating systems
            entry.external_attr = 0o644 << 16
            bundle.writestr(entry, text)

    return archive.getvalue()


def _describe(item: Item) -> str:
    if not item.note:
        return ""

    return (
        "<metadatagroup><metadata "
        f'name="Description">{escape(item.note, quote=False)}</metadata></metadatagroup>\n'
    )


def _write_settings(items: Sequence[Item]) -> str:
    """Write the settings of objects as PrusaSlicer does, which wants
    the range of each object's triangles with them.
    """
    objects = "".join(
        f'<object id="{number}" instances_count="1">\n'
        + "".join(
            f'<metadata type="object" key="{key}" value="{value}"/>\n'
            for key, value in (("name", item.name), *item.settings)
        )
        + f'<volume firstid="0" lastid="{item.mesh.count("<triangle ") - 1}">\n'
        f'<metadata type="volume" key="name" value="{item.name}"/>\n</volume>\n</object>\n'
        for number, item in enumerate(items, 1)
    )
    return f'<?xml version="1.0" encoding="UTF-8"?>\n<config>\n{objects}</config>\n'


def _transform(item: Item) -> str:
    """Write the placement. 3MF multiplies rows by the matrix, so the rotation is transposed."""
    if item.rotation is None and not any(item.shift):
        return ""

    rows = np.eye(3) if item.rotation is None else item.rotation.T
    numbers = [*rows.ravel().tolist(), *item.shift]
    written = " ".join(f"{number + 0.0:.17g}" for number in numbers)
    return f' transform="{written}"'


def from_bytes(data: bytes) -> Mesh:
    """Read the single object of a 3MF archive that `to_bytes` wrote."""
    root = ElementTree.fromstring(read_items(data)[0].mesh)
    vertices = [[float(v.attrib[axis]) for axis in "xyz"] for v in root.iter("vertex")]
    triangles = [
        [int(t.attrib[corner]) for corner in ("v1", "v2", "v3")] for t in root.iter("triangle")
    ]

    return Mesh(np.array(vertices), np.array(triangles, dtype=np.int64))


def read_items(data: bytes) -> list[Item]:
    """Read the objects of a 3MF archive that `write_items` wrote; their meshes stay text."""
    with zipfile.ZipFile(io.BytesIO(data)) as bundle:
        first, *others = bundle.read("3D/3dmodel.model").decode().split("<mesh>")

    meshes, between = zip(*(other.split("</mesh>") for other in others), strict=True)
    root = ElementTree.fromstring(first + "".join(between))
    objects = list(root.iter(f"{{{_CORE}}}object"))
    number = {element.attrib["id"]: i for i, element in enumerate(objects)}
    items = []

    for item in root.iter(f"{{{_CORE}}}item"):
        i = number[item.attrib["objectid"]]
        matrix = np.array(
            [float(value) for value in item.get("transform", "1 0 0 0 1 0 0 0 1 0 0 0").split()]
        )
        x, y, z = matrix[9:].tolist()
        note = objects[i].findtext(f".//{{{_CORE}}}metadata", "")
        mesh = f"<mesh>{meshes[i]}</mesh>"
        items.append(
            Item(
                name=objects[i].attrib["name"],
                mesh=mesh,
                note=note,
                rotation=matrix[:9].reshape(3, 3).T,
                shift=(x, y, z),
            )
        )

    return items
