"""3MF files: one part as one object with shared vertices, which slicers recognise as manifold.

The archive is stored without compression and with fixed dates. Compressed bytes differ between versions of zlib, and
the same design must give the same file on every machine.
"""

from __future__ import annotations

import io
import zipfile

import numpy as np

from fingertip.cad.kernel.mesh import Mesh

_CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
_MODEL_TYPE = "application/vnd.ms-package.3dmanufacturing-3dmodel+xml"
_CONTENT_TYPES = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
    '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    f'<Default Extension="model" ContentType="{_MODEL_TYPE}"/></Types>\n'
)
_RELATIONS = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
    '<Relationship Target="/3D/3dmodel.model" Id="rel0" '
    'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>\n'
)


def to_bytes(mesh: Mesh, name: str) -> bytes:
    """Write a mesh as a 3MF archive in mm; the part's name holds letters, digits and underscores only."""
    vertices = "".join(f'<vertex x="{x!r}" y="{y!r}" z="{z!r}"/>\n' for x, y, z in mesh.vertices.tolist())
    triangles = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>\n' for a, b, c in mesh.triangles.tolist())
    model = (
        f'<?xml version="1.0" encoding="UTF-8"?>\n<model unit="millimeter" xml:lang="en-US" xmlns="{_CORE}">\n'
        f'<metadata name="Title">{name}</metadata>\n<metadata name="Application">fingertip</metadata>\n'
        f'<resources><object id="1" type="model" name="{name}"><mesh>\n<vertices>\n{vertices}</vertices>\n'
        f"<triangles>\n{triangles}</triangles>\n</mesh></object></resources>\n"
        '<build><item objectid="1"/></build>\n</model>\n'
    )
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_STORED) as bundle:
        for path, text in (
            ("[Content_Types].xml", _CONTENT_TYPES),
            ("_rels/.rels", _RELATIONS),
            ("3D/3dmodel.model", model),
        ):
            entry = zipfile.ZipInfo(path, date_time=(1980, 1, 1, 0, 0, 0))
            entry.create_system = 3  # the default differs between operating systems
            entry.external_attr = 0o644 << 16
            bundle.writestr(entry, text)
    return archive.getvalue()


def from_bytes(data: bytes) -> Mesh:
    """Read the single object of a 3MF archive that `to_bytes` wrote."""
    from xml.etree import ElementTree

    with zipfile.ZipFile(io.BytesIO(data)) as bundle:
        root = ElementTree.fromstring(bundle.read("3D/3dmodel.model"))
    vertices = [[float(v.attrib[axis]) for axis in "xyz"] for v in root.iter(f"{{{_CORE}}}vertex")]
    triangles = [[int(t.attrib[corner]) for corner in ("v1", "v2", "v3")] for t in root.iter(f"{{{_CORE}}}triangle")]
    return Mesh(np.array(vertices), np.array(triangles, dtype=np.int64))
