"""Picture of the rig from its geometry: each body in its place, or lifted from it, with the things to buy."""

import numpy as np

from fingertip.cad.kernel.mesh import Mesh, to_canonical_mesh
from fingertip.pictures.raster import Camera
from fingertip.pictures.scene import Label, Scene, Shown, draw_scene

COLOURS = {
    "base": (0.62, 0.72, 0.80),
    "sled": (0.93, 0.80, 0.55),
    "strip": (0.55, 0.45, 0.35),
    "copper foil": (0.85, 0.50, 0.30),
    "hook": (0.80, 0.45, 0.40),
    "arm": (0.70, 0.78, 0.62),
    "skin": (0.87, 0.62, 0.52),
}
NAMES = {"strip": "surface, 45 x 30 mm", "arm": "arm; its disc carries the cup", "skin": "finger", "bone": ""}
BAR, STEEL = (0.78, 0.72, 0.58), (0.45, 0.46, 0.48)
ON_ARM = ("arm", "bone", "skin", "stand", "hand_stub", "clamp")
MARKED = {
    "arm": (-0.4, 0.9, 1.0),
    "strip": (-1.0, 0.9, 0.1),
    **dict.fromkeys(("stand", "hand_stub"), (-1.0, -1.0, 0.3)),
    "sled": (0.1, 1.0, 1.0),
    "string to the weight": (0.0, -1.0, 0.0),
}
"""Direction, across, up and along the rig, of the point that a leader shows, where that is not the nearest one."""
LIFT_MM = dict.fromkeys(ON_ARM, 60.0) | {"strip": 26.0, "sled": 20.0, "copper foil": 20.0, "hook": 20.0}


def draw(rig, apart):
    """Draw the rig as it stands, or with `apart` = 1 each part lifted from its place and named, as PNG."""
    shown, labels = [], {}
    for name, body in (rig.assemble() | rig.bought()).items():
        mesh = to_canonical_mesh(body.translate((0, 0, apart * LIFT_MM.get(name.split(":")[0], 0.0))))
        mesh = Mesh(mesh.vertices[:, [1, 2, 0]], mesh.triangles)  # y up, where the lamp is
        shown.append(Shown(mesh, COLOURS.get(name, STEEL if "|" in name else BAR)))
        nearest = mesh.vertices[np.argmax(mesh.vertices @ np.array(MARKED.get(name, (-1.0, 0.0, 0.1))))]
        labels.setdefault(NAMES.get(name, name.split("|")[0]), tuple(nearest.tolist()))
    marks = [Label(text, at) for text, at in labels.items() if text and apart]
    return draw_scene(Scene(shown, Camera.looking_from((-1.0, 0.75, 0.45), (0.0, 1.0, 0.0)), *marks))
