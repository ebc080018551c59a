"""Picture of the rig from its geometry: each body in its place, or
lifted from it, with the things to buy.
"""

import numpy as np

from fingertip.cad.kernel.mesh import Mesh, to_canonical_mesh
from fingertip.pictures.labelled_scene import Label, PaintedMesh, Scene, draw_scene
from fingertip.pictures.raster import Camera

COLOURS = {
    "base": (0.62, 0.72, 0.80),
    "sled": (0.93, 0.80, 0.55),
    "strip": (0.55, 0.45, 0.35),
    "copper foil": (0.85, 0.50, 0.30),
    "hook": (0.80, 0.45, 0.40),
    "arm": (0.70, 0.78, 0.62),
    "skin": (0.87, 0.62, 0.52),
}
NAMES = {
    "strip": "surface, 45 x 30 mm",
    "arm": "arm; its disc carries the cup",
    "skin": "finger",
    "bone": "",
} | {
    "hook": "",
    "hook: screw M3 x 12": "",
    "contact: screw M3 x 12": "front contact",
}
BAR = (0.78, 0.72, 0.58)
STEEL = (0.45, 0.46, 0.48)
ON_ARM = ("arm", "bone", "skin", "stand", "hand_stub", "clamp")
MARKED = {
    "arm": (-0.4, 0.9, 1.0),
    "strip": (0.5, 0.9, -1.0),
    **dict.fromkeys(("stand", "hand_stub"), (-1.0, -1.0, 0.3)),
    "sled": (-1.0, -1.0, -1.0),
    "copper foil": (-1.0, 0.9, -0.1),
    "string to the weight": (0.0, -1.0, 0.0),
}
"""Direction, across, up and along the rig, of the point that a leader
shows, where that is not the nearest one.
"""
LIFT_MM = dict.fromkeys(ON_ARM, 100.0) | {
    "strip": 32.0,
    "sled": 24.0,
    "copper foil": 24.0,
    "hook": 92.0,
}


def points(rig):
    """List what the sheet names within a part: its name, the part, and its place in the rig."""
    x, y, z = rig.pivot
    return [
        ("handle", "hook", (x + 1, y - 45, z + 4)),
        ("nose", "hook", (x - 33, y + 7, z + 4)),
        ("pin", "hook", (x - 4, y + 11, z + 17)),
        ("post", "base", (x + 18, y + 11, z + 17)),
        ("peg", "sled", (rig.end - 6, -2, 14)),
        ("control hole", "sled", (rig.end - 8, 10, 14)),
        ("rear contact", "base", (rig.end + 15, -21, 9)),
    ]


def draw(rig, apart):
    """Draw the rig as it stands, or with `apart` = 1 each part
    lifted from its place and named, as PNG.
    """
    meshes = []
    labels = {}

    for name, body in (rig.assemble() | rig.bought()).items():
        mesh = to_canonical_mesh(
            body.translate((0, 0, apart * LIFT_MM.get(name.split(":")[0], 0.0)))
        )
        mesh = Mesh(mesh.vertices[:, [1, 2, 0]], mesh.triangles)  # y up, where the lamp is
        meshes.append(PaintedMesh(mesh, COLOURS.get(name, STEEL if "|" in name else BAR)))
        nearest = mesh.vertices[
            np.argmax(mesh.vertices @ np.array(MARKED.get(name, (-1.0, 0.0, 0.1))))
        ]
        text = name.split("|")[0]
        labels.setdefault(NAMES.get(text, text), tuple(nearest.tolist()))

    labels |= {text: (y, z + LIFT_MM.get(part, 0.0), x) for text, part, (x, y, z) in points(rig)}
    marks = [Label(text, at) for text, at in labels.items() if text and apart]
    return draw_scene(
        Scene(meshes, Camera.looking_from((-1.0, 0.75, 0.45), (0.0, 1.0, 0.0)), *marks)
    )
