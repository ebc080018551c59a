"""Printed slide that moves suddenly under a built finger, with a contact that opens at its first
motion.

It needs cadquery: .venv/bin/python examples/bench_rig/rig.py params/adult_finger.toml out/rig

A weight on a string pulls the sled towards the hinge of an arm that carries the finger. A rubber
band at a hook pulls it back harder, onto two screws. Copper foil on the sled joins these screws.
Off the hook, the sled leaves them at once. The hinge is as high as the surface, so that friction
does not change the normal force. Lengths are in mm: x runs from the hinge to the tip of the finger,
z up from the table. Each STL file lies as it is printed.
"""

import math
import sys
from functools import cached_property
from pathlib import Path

import cadquery as cq
import hook
import motion
import numpy as np
from hook import PIVOT_Y, POST_X
from manifold3d import Manifold
from motion import STROKE
from picture import draw
from shapes import FREE, THREAD, box, cut, headed, rod, solid_of, union

from fingertip import Design, mesh_of, part_mesh
from fingertip.cad.files import stl
from fingertip.cad.kernel.mesh import to_manifold
from fingertip.cad.printing.overhang import MAX_UNSUPPORTED_MM2, find_ceilings
from fingertip.models.hand_stub import BAR_MM, bars
from fingertip.models.stand import stand_outline

PLATE = 4.0
SLED = 10.0
STRIP = 1.0
POCKET = 0.5
PLAY = 0.4
GUIDE = 6.0
WALL = 8.0
BRIM = 4.0
TOP = PLATE + SLED
SURFACE = TOP + STRIP - POCKET
HALF = 25.0
CONTACT_Y = 21.0
CONTACT_Z = PLATE + SLED / 2
TIP = 1.5
"""Half the width of the sled, places of the contacts' screws, and
length of their tips inside the walls.
"""
BEFORE = 14.5
LENGTH = 69.0
PAD_X = 66.0
MARGIN = 6.0
"""Sled before the pad's first contact, its length, distance from the hinge to the pad at a tilt of
0, and least distance from the pad's contact to the surface's ends.
"""
CHEEK = 6.0
BEAM = 5.0
EYE = 6.0
EAR = 4.5
"""Thickness of cheeks and beam, half the width of the hinge's eye, and its height above
the axis.
"""
HOOK_Z = PLATE + 4.0
HOOK_TOP = PLATE + 4.0 + hook.HEIGHT
CUP = 15.0
"""Lower and upper side of the hook, and centre of the weights above the disc."""
SCREW = 12
HEAD = 3.0
DRIVER = 3.5
REACH = 60.0
THREADED = 5.0
"""Length of all screws but the hinge's, height of a head, radius and length of a driver, and least
length of a thread in plastic.
"""


class Rig:
    def __init__(self, design):
        self.design = design
        self.is_post = design.bone.interface == "post"
        assert self.is_post or design.bone.interface == "clevis", (
            "choose bone.interface = post or clevis"
        )
        self.holder = "stand" if self.is_post else "hand_stub"
        bar = stand_outline(design) if self.is_post else bars(design)[1]
        self.bar = bar
        self.half = bar.high[0]
        self.rear = PAD_X - (design.dimensions.sensor_z - bar.low[2])
        self.finger = {
            name: self.in_arm(part_mesh(design, name, 0.05))
            for name in ("bone", "skin", self.holder)
        }
        skin = self.finger["skin"].to_mesh().vert_properties[:, :3]
        low = self.finger[self.holder].to_mesh().vert_properties[:, :3]

        for tilt in range(3, 15):
            self.tilt, turn = math.radians(tilt), self.turn(math.radians(tilt))
            turned = skin @ turn.T
            at = turned[np.argmin(turned[:, 2])]
            over_hinge = bar.low[1] * turn[2, 2] + EYE * turn[2, 0] - at[2] - EAR
            if over_hinge >= 1.0 and (low @ turn.T)[:, 2].min() >= at[2] + 2.5:
                break

        self.contact_x = float(at[0])
        self.depth = -float(at[2])
        self.hinge = self.depth * math.sin(self.tilt), -self.depth * math.cos(self.tilt)
        self.rest = self.contact_x - BEFORE
        self.end = self.rest + LENGTH
        self.sled_to = self.rest - STROKE

    def in_arm(self, mesh):
        """Move what has the finger's coordinates: z to x, x to y, y to z."""
        low = self.bar.low[2]
        return to_manifold(
            mesh.vertices[:, [2, 0, 1]] + np.array([self.rear - low, 0.0, 0.0]), mesh.triangles
        )

    @staticmethod
    def turn(angle):
        c = math.cos(angle)
        s = math.sin(angle)
        return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])

    def base(self):
        """Plate with guides, walls with contact screws, block of the
        hinge, boss of the hook and post of the band.
        """
        side = HALF + PLAY + GUIDE
        inner = HALF + PLAY
        front = self.sled_to - TIP
        rear = self.end + TIP
        x = self.pivot_x
        parts = [box((-EYE - 1, -side, 0), (x + POST_X + 4, side, PLATE))]
        parts += [
            box((front - WALL, min(y, y + w), 0), (rear + WALL, max(y, y + w), TOP - 2))
            for y, w in ((inner, GUIDE), (-inner, -GUIDE))
        ]
        walls = (
            (front - WALL, 3.0, side),
            (front - WALL, -side, -3.0),
            (rear, 8.0, side),
            (rear, -side, hook.STOP_Y),
        )
        parts += [box((at, y, 0), (at + WALL, end, TOP)) for at, y, end in walls]
        block = self.half - PLAY
        for y, end in ((3.0, block), (-block, -3.0)):
            parts += [box((-EYE, y, 0), (EYE, end, SURFACE)), rod("y", (SURFACE, 0), y, end, EAR)]

        # Ears for clamps, whose jaws reach some 30 mm beyond the table's edge.
        parts += [box((4, y, 0), (34, y + 20, PLATE)) for y in (side - 1, -side - 19)]
        parts += [
            rod("z", (x, PIVOT_Y), 0, HOOK_Z, 6.0),
            headed((x + POST_X, 5.0), HOOK_TOP + hook.BANDS, hook.POST),
        ]
        holes = [
            rod("x", (y, CONTACT_Z), at - 1, at + WALL + 1, THREAD)
            for y in (CONTACT_Y, -CONTACT_Y)
            for at in (front - WALL, rear)
        ]
        holes += [
            rod("z", (x, PIVOT_Y), -1, HOOK_Z + 1, THREAD),
            rod("y", (SURFACE, 0), -side, side, FREE),
            rod("z", (self.end - 8, 10.0), -1, PLATE + 1, THREAD),
        ]

        return cut(union(*parts), *holes)

    def x_of(self, u, w):
        """Place along the rig of a point of the arm."""
        return u * math.cos(self.tilt) + w * math.sin(self.tilt)

    @property
    def pivot_x(self):
        return self.end + hook.PIVOT

    @property
    def pivot(self):
        return self.pivot_x, PIVOT_Y, HOOK_Z + 0.1

    def sled(self):
        """Block with a peg for the hook in a recess, and a pocket
        for the knot of the string at the bottom.
        """
        block = box((0, -HALF, 0), (LENGTH, HALF, SLED))
        recess = box((LENGTH - 16, -17, 3), (LENGTH + 1, 2, SLED + 1))
        peg = box((LENGTH - 8.5, -2.5, 0), (LENGTH - 3.5, 2.5, SLED))
        surface = box((6.75, -15.25, SLED - POCKET), (LENGTH - 16.75, 15.25, SLED + 1))
        knot = rod("z", (8, 0), -1, 6, 3.0)
        string = rod("x", (0, 3), -1, 8, 1.2)
        # Screwed down, the control screw holds the sled where the rear contacts belong.
        control = [
            rod("z", (LENGTH - 8, 10), low, SLED + 1, radius)
            for low, radius in ((-1, FREE), (SLED - 2, 3.2))
        ]

        return cut(union(cut(block, recess), peg), surface, knot, string, *control)

    def arm(self):
        """Beam with the channel for the bar, whose cheeks reach down
        to the hinge, and a disc for the weights.
        """
        top = self.bar.high[1]
        inner = self.half + PLAY
        beam = top + max(1.5, self.design.skin.semi_axis_dorsal_mm + 2.0 - top)
        outer = inner + CHEEK
        u, w = self.hinge
        rear, ends = min(self.rear, u - EYE), self.rear + (24.0 if self.is_post else 42.0)
        # The centre of the weights, CUP above the disc, stands above the contact.
        middle = (self.contact_x - (beam + BEAM + CUP) * math.sin(self.tilt)) / math.cos(self.tilt)
        parts = [
            box((rear, -outer, beam), (middle, outer, beam + BEAM)),
            box((rear, -outer, top), (ends, outer, beam)),
            rod("z", (middle, 0), beam, beam + BEAM, 22.0),
        ]

        for y in (inner, -outer):
            parts.append(box((rear, y, self.bar.low[1] + 2), (ends, y + CHEEK, beam)))
            parts += [
                box((u - EYE, y, w), (u + EYE, y + CHEEK, beam)),
                rod("y", (w, u), y, y + CHEEK, EYE),
            ]

        holes = [rod("y", (w, u), -outer - 1, outer + 1, FREE)]
        holes += [rod("y", (self.screw_w, at), -outer - 1, outer + 1, THREAD) for at in self.screws]
        if not self.is_post:  # room for the rubber band around the stub
            begin = self.rear + BAR_MM - 38
            holes.append(box((begin, -inner, top - 1), (begin + 13, inner, top + 1.5)))

        return cut(union(*parts), *holes)

    @property
    def screws(self):
        """Places of the clamp's screws along the bar, beside notches and cross bolt."""
        return [self.rear + 6, self.rear + (18 if self.is_post else 36)]

    @property
    def screw_w(self):
        return (self.bar.low[1] + self.bar.high[1]) / 2 + 1.0

    def hang(self, solid):
        """Turn what has the arm's coordinates about the hinge, to where the pad touches."""
        return solid.transform(
            np.hstack([self.turn(self.tilt), [[0.0], [0.0], [SURFACE + self.depth]]])
        )

    def assemble(self, moved=0.0, is_armed=True):
        """Place all bodies with the sled `moved` from its rest."""
        base, sled, lever, arm = map(solid_of, self.parts.values())
        strip = solid_of(box((7, -15, SLED - POCKET), (LENGTH - 17, 15, SLED - POCKET + STRIP)))
        bodies = {
            "base": base,
            "hook": hook.place(lever, self.pivot, 0.0 if is_armed else 10.0),
            "arm": self.hang(arm),
        }
        for name, each in (("sled", sled), ("strip", strip)):
            bodies[name] = each.translate((self.rest - moved, 0, PLATE))

        return bodies | {name: self.hang(solid) for name, solid in self.finger.items()}

    @cached_property
    def parts(self):
        return {
            "base": self.base(),
            "sled": self.sled(),
            "hook": hook.hook(),
            "arm": self.arm(),
        }

    def screw_list(self):
        """List axis, the two other coordinates, end of the head,
        direction to the driver, threaded and whole length.
        """
        front = self.sled_to - TIP - WALL
        rear = self.end + TIP + WALL
        out = SCREW - WALL - TIP + HEAD
        found = [
            ("x", (y, CONTACT_Z), front - out, -1, WALL, SCREW) for y in (-CONTACT_Y, CONTACT_Y)
        ]
        found += [
            ("x", (y, CONTACT_Z), rear + out, 1, WALL, SCREW) for y in (-CONTACT_Y, CONTACT_Y)
        ]
        found += [("z", (self.pivot_x, PIVOT_Y), HOOK_TOP + HEAD + 0.2, 1, HOOK_Z, SCREW)]
        outer = self.half + PLAY + CHEEK
        # Its nut is held by hand.
        found += [("y", (SURFACE, 0.0), outer + HEAD + 0.2, 1, THREADED, 40)]
        c = math.cos(self.tilt)
        s = math.sin(self.tilt)
        lift = SURFACE + self.depth

        for u in self.screws:
            at = (-u * s + self.screw_w * c + lift, u * c + self.screw_w * s)
            found += [
                ("y", at, side * (self.half + SCREW + HEAD), side, CHEEK, SCREW) for side in (-1, 1)
            ]

        return found

    def on_bed(self):
        """Return the mesh of each part as it is printed: the arm on its upper side."""
        turned = {
            name: part.rotate((0, 0, 0), (1, 0, 0), 180 if name == "arm" else 0)
            for name, part in self.parts.items()
        }
        return {
            name: mesh_of(part.translate((0, 0, -part.val().BoundingBox().zmin)))
            for name, part in turned.items()
        }

    def check(self):
        """Assert what a maker relies on; return the figures."""
        for name, mesh in self.on_bed().items():
            whole = to_manifold(mesh.vertices, mesh.triangles)
            bed = self.design.printer
            assert len(whole.decompose()) == 1, f"{name}: not one closed body"
            worst = max((each.unsupported_mm2() for each in find_ceilings(mesh)), default=0.0)
            assert worst <= MAX_UNSUPPORTED_MM2, f"{name}: {worst:.1f} mm2 would need supports"
            size = np.ptp(mesh.vertices, axis=0)
            room = np.array([bed.bed_x_mm - 2 * BRIM, bed.bed_y_mm - 2 * BRIM, bed.bed_z_mm])
            assert (size <= room).all(), f"{name}: {size} is larger than the bed inside a brim"

        for moved, is_armed in ((0.0, True), (0.0, False), (STROKE / 2, False), (STROKE, False)):
            bodies = self.assemble(moved, is_armed) | {
                n: each for n, each in self.bought().items() if "|" in n
            }
            names = list(bodies)
            inside = {"bone", "skin", self.holder}

            for i, a in enumerate(names):
                for b in names[i + 1 :]:
                    meet = 0.0 if {a, b} <= inside else (bodies[a] ^ bodies[b]).volume()
                    assert meet <= 1e-6, (
                        f"{a} and {b} overlap by {meet:.3g} mm3, {moved:g} mm from the rest"
                    )

            beside = (bodies["sled"].translate((0, y, 0)) ^ bodies["base"] for y in (0.3, -0.3))
            assert all(meet.volume() <= 1e-6 for meet in beside), (
                "the sled has no play between the guides"
            )

        moving = [self.assemble()[name] for name in ("arm", *inside)]
        for lift in (20, 40, 60):
            turn = self.turn(-math.radians(lift))
            about = np.hstack([turn, (np.eye(3) - turn) @ [[0.0], [0.0], [SURFACE]]])
            met = any((each.transform(about) ^ self.standing).volume() > 1e-6 for each in moving)
            assert not met, f"the arm strikes when it is lifted by {lift} degrees"

        held = self.assemble(0.2)
        assert (held["sled"] ^ held["hook"]).volume() > 1.0, "the hook does not hold the sled"
        hook.check_stretch()
        bodies = self.assemble()

        for axis, at, begin, way, threaded, _ in self.screw_list():
            assert threaded >= THREADED
            low, high = sorted((begin, begin + way * REACH))
            tool = solid_of(rod(axis, at, low, high, DRIVER))
            later = {"hook"} if axis == "x" else set()  # the sheet mounts it after the contacts
            met = [
                name
                for name in bodies
                if name not in later and (tool ^ bodies[name]).volume() > 1e-6
            ]
            assert not met, f"the driver of the screw along {axis} at {at} meets {met}"

        corners = bodies["skin"].to_mesh().vert_properties[:, :3]
        touch_x, _, touch_z = map(float, corners[np.argmin(corners[:, 2])])
        assert abs(touch_z - SURFACE) < 0.01, "the pad does not touch the surface"
        dims = self.design.dimensions
        sensor = self.x_of(dims.sensor_z - self.bar.low[2] + self.rear, -dims.platform_depth)
        assert abs(touch_x - sensor) <= 1.5, "the pad does not touch below its sensor"
        strip = bodies["strip"].bounding_box()
        beyond = min(touch_x - strip[0], strip[3] - touch_x - STROKE)
        assert beyond >= MARGIN, f"the pad comes within {beyond:.1f} mm of the surface's end"
        free_deg, stop_deg = self.check_turn()

        return {
            "tilt_deg": math.degrees(self.tilt),
            "contact_to_sensor_mm": touch_x - sensor,
            "margin_mm": beyond,
            "hook_free_deg": free_deg,
            "hook_stop_deg": stop_deg,
        } | motion.check(self.design.detector.sample_rate_hz)

    @cached_property
    def standing(self):
        """Base with the contacts' screws."""
        return sum(
            (each for name, each in self.bought().items() if "contact" in name),
            solid_of(self.parts["base"]),
        )

    def check_turn(self):
        """Check the hook's turn beside the sled, to both sides
        of the guides; return its angles [deg].
        """
        sled = solid_of(self.parts["sled"])
        ways = (0.0, 0.5, *np.arange(2.0, STROKE + 1, 2.0))
        hooked, *free = (
            sum((sled.translate((self.rest - moved, y, PLATE)) for y in (-0.3, 0.3)), Manifold())
            for moved in ways
        )

        return hook.check_turn(
            solid_of(self.parts["hook"]), self.pivot, self.standing, hooked, free
        )

    def bought(self):
        """Build what is bought, by its name; "clamp" is in those of the arm."""
        x = self.pivot_x
        y = 5.0
        z = HOOK_TOP + 3
        found = {
            "string to the weight": union(
                rod("x", (0, PLATE + 3), -14, self.rest, 0.6),
                rod("z", (-14, 0), -45, PLATE + 3, 0.6),
            ),
            "rubber band": union(
                *(rod("x", (y + w, z), x + hook.PIN_X, x + POST_X, 0.8) for w in (4.3, -4.3))
            ),
        }
        strips = [
            box((self.rest, y - 3, TOP), (self.end, y + 3, TOP + 0.1))
            for y in (-CONTACT_Y, CONTACT_Y)
        ]
        strips.append(box((self.rest, -CONTACT_Y, TOP), (self.rest + 6, CONTACT_Y, TOP + 0.1)))
        found["copper foil"] = union(*strips)
        uses = {"x": "contact: ", "z": "hook: ", "y": "clamp: "}

        for number, (axis, at, begin, way, _, length) in enumerate(self.screw_list()):
            use = uses[axis] if length == SCREW else "hinge: "
            head = begin - HEAD * way
            end = begin - (HEAD + length - 0.01) * way
            # The thread, which cuts into the plastic, is left out, and 0.01 mm of the tip, which
            # touches.
            shank = rod(axis, at, *sorted((head, end)), 1.3)
            top = rod(axis, at, *sorted((head, begin)), 2.8)
            found[f"{use}screw M3 x {length}|{number}"] = union(shank, top)

        return {name: solid_of(part) for name, part in found.items()}


def main(design_file, folder):
    rig = Rig(Design.load(design_file))
    out = Path(folder)
    out.mkdir(parents=True, exist_ok=True)
    figures = rig.check()

    for name, mesh in rig.on_bed().items():
        (out / f"rig_{name}.stl").write_bytes(stl.to_bytes(mesh, f"rig_{name}"))
        cq.exporters.export(rig.parts[name], str(out / f"rig_{name}.step"))

    for name, exploded in (("rig.png", 0.0), ("rig_exploded.png", 1.0)):
        (out / name).write_bytes(draw(rig, exploded))

    for name, value in figures.items():
        print(f"{name}: {value:.4f}")

    for force_n in (0.5, 0.8, 1.5, 2.5):
        kg, tension_n = motion.pulling_kg(force_n)
        print(
            f"force {force_n:g} N: {1000 * kg:.0f} g on the string, rubber band above "
            f"{tension_n:.1f} N"
        )


if __name__ == "__main__":
    main(*sys.argv[1:])
