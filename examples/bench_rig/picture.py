"""Picture of the rig from its geometry: each body in its place, or lifted from it, with the things to buy."""

import numpy as np

from fingertip.cad.kernel.mesh import to_canonical_mesh
from fingertip.pictures.raster import Camera
from fingertip.pictures.scene import Label, Scene, Shown, draw_scene

COLOURS = {
    "base": (0.62, 0.72, 0.80),
    "sled": (0.93, 0.80, 0.55),
    "strip": (0.55, 0.45, 0.35),
    "hook": (0.80, 0.45, 0.40),
    "arm": (0.70, 0.78, 0.62),
    "skin": (0.87, 0.62, 0.52),
}
NAMES = {"strip": "surface, 45 x 30 mm", "arm": "arm; its disc carries the cup", "skin": "finger", "bone": ""}
BAR, STEEL = (0.78, 0.72, 0.58), (0.45, 0.46, 0.48)
ON_ARM = ("arm", "bone", "skin", "stand", "hand_stub", "clamp")
LIFT_MM = dict.fromkeys(ON_ARM, 60.0) | {"strip": 26.0, "sled": 20.0, "hook": 20.0}


def draw(rig, apart):
    """Draw the rig as it stands, or with `apart` = 1 each part lifted from its place, as PNG."""
    shown, labels = [], {}
    for name, body in (rig.assemble() | rig.bought()).items():
        mesh = to_canonical_mesh(body.translate((0, 0, apart * LIFT_MM.get(name.split(":")[0], 0.0))))
        shown.append(Shown(mesh, COLOURS.get(name, STEEL if "|" in name else BAR)))
        direction = np.array([0.1, -1.0, 0.9 if name in ("arm", "strip") else 0.0])
        nearest = mesh.vertices[np.argmax(mesh.vertices @ direction)]
        labels.setdefault(NAMES.get(name, name.split("|")[0]), tuple(nearest.tolist()))
    marks = [Label(text, at) for text, at in labels.items() if text]
    return draw_scene(Scene(shown, Camera.looking_from((0.45, -1.0, 0.75), (0.0, 0.0, 1.0)), *marks))
