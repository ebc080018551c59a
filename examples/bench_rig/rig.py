"""Printed slide that moves suddenly under a built finger, with a contact that opens at its first motion.

It needs cadquery: .venv/bin/python examples/bench_rig/rig.py params/adult_finger.toml out/rig

A weight on a string pulls the sled towards the hinge of an arm that carries the finger. A rubber band at a hook pulls
it back harder, onto two screws. Copper foil on the sled joins these screws. Off the hook, the sled leaves them at once.
The hinge is as high as the surface, so that friction does not change the normal force. Lengths are in mm: x runs from
the hinge to the tip of the finger, z up from the table. Each STL file lies as it is printed.
"""

import math
import sys
from functools import cached_property
from pathlib import Path

import cadquery as cq
import numpy as np
from picture import draw
from shapes import box, cut, rod, solid_of, union

from fingertip import Design, mesh_of, part_mesh
from fingertip.cad.files import stl
from fingertip.cad.kernel.mesh import to_manifold
from fingertip.cad.printing.overhang import MAX_UNSUPPORTED_MM2, find_ceilings
from fingertip.cad.shapes import bench

STROKE, OPEN, LONGEST_S, MAX_ERROR_S = 30.0, 0.05, 0.2, 0.005
"""Way of the sled, way by which both contacts are open (assumption), its longest travel and the largest error [s]."""
PLATE, SLED, STRIP, PLAY, GUIDE, WALL = 4.0, 10.0, 1.0, 0.4, 6.0, 8.0
TOP = PLATE + SLED
SURFACE = TOP + STRIP
HALF, CONTACT_Y, CONTACT_Z, TIP = 25.0, 21.0, PLATE + SLED / 2, 1.5
"""Half the width of the sled, places of the contacts' screws, and length of their tips inside the walls."""
BEFORE, BEHIND, PAD_X = 14.0, 26.0, 66.0
"""Surface before and behind the way of the pad, and distance from the hinge to the pad at a tilt of 0."""
LENGTH = BEFORE + STROKE + BEHIND
THREAD, FREE, CHEEK, BEAM, EYE, EAR = 1.35, 1.65, 6.0, 5.0, 6.0, 4.5
"""Radii of a hole in which M3 cuts its thread and of one that it passes, thickness of cheeks and beam, half the width
of the hinge's eye, and its height above the axis."""
HOOK_Z, HOOK, PIVOT_Y, CUP = PLATE + 4.0, 4.0, -6.5, 15.0
POST_X, PIN_X, BAND, STRETCH = 20.0, -4.0, 80.0, 1.5
"""Post and pin of the rubber band, from the hook's screw, its length all around, and its least stretch in two turns."""
SCREW, HEAD, DRIVER, REACH, THREADED = 12, 3.0, 3.5, 60.0, 5.0
"""Length of all screws but the hinge's, height of a head, radius and length of a driver, and least length of a thread
in plastic."""
MASS_KG, SLIDING, EDGE, FRICTION, LEAST_M_S2 = 0.05, 0.3, 1.6, 1.0, 1.5
"""Sled with strip; friction coefficient below it; ratio of tensions over the edge, exp(0.3 pi / 2); largest friction
coefficient of the skin; least acceleration."""


def onset_s(travel_s, rate_hz):
    """Return by how much the open contact lags the first motion [s], and the error of that [s].

    At a constant acceleration a, s = a t^2 / 2: the first OPEN of the way take travel sqrt(OPEN / STROKE). The lag lies
    between 0 and that; take its half. The clock adds one sample.
    """
    longest_s = travel_s * math.sqrt(OPEN / STROKE)
    return longest_s / 2, longest_s / 2 + 1 / rate_hz


def pulling_kg(force_n):
    """Return the mass on the string that gives LEAST_M_S2 against all friction, and the tension of the string [N]."""
    resisting_n = FRICTION * force_n + SLIDING * (force_n + 9.81 * MASS_KG)
    kg = EDGE * (resisting_n + MASS_KG * LEAST_M_S2) / (9.81 - LEAST_M_S2)
    return kg, 9.81 * kg


class Rig:
    def __init__(self, design):
        self.design = design
        self.is_post = design.bone.interface == "post"
        assert self.is_post or design.bone.interface == "clevis", "choose bone.interface = post or clevis"
        self.holder = "stand" if self.is_post else "hand_stub"
        bar = bench.stand_outline(design) if self.is_post else bench.bars(design)[1]
        self.bar, self.half = bar, bar.high[0]
        self.rear = PAD_X - (design.dimensions.sensor_z - bar.low[2])
        self.finger = {name: self.in_arm(part_mesh(design, name, 0.05)) for name in ("bone", "skin", self.holder)}
        skin = self.finger["skin"].to_mesh().vert_properties[:, :3]
        low = self.finger[self.holder].to_mesh().vert_properties[:, :3]
        for tilt in range(3, 15):
            self.tilt, turn = math.radians(tilt), self.turn(math.radians(tilt))
            turned = skin @ turn.T
            at = turned[np.argmin(turned[:, 2])]
            over_hinge = bar.low[1] * turn[2, 2] + EYE * turn[2, 0] - at[2] - EAR
            if over_hinge >= 1.0 and (low @ turn.T)[:, 2].min() >= at[2] + 2.5:
                break
        self.contact_x, self.depth = float(at[0]), -float(at[2])
        self.hinge = self.depth * math.sin(self.tilt), -self.depth * math.cos(self.tilt)
        self.rest = self.contact_x - BEFORE
        self.end = self.rest + LENGTH
        self.sled_to = self.rest - STROKE

    def in_arm(self, mesh):
        """Move what has the finger's coordinates: z to x, x to y, y to z."""
        low = self.bar.low[2]
        return to_manifold(mesh.vertices[:, [2, 0, 1]] + np.array([self.rear - low, 0.0, 0.0]), mesh.triangles)

    @staticmethod
    def turn(angle):
        c, s = math.cos(angle), math.sin(angle)
        return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])

    def base(self):
        """Plate with guides, walls with contact screws, block of the hinge, boss of the hook and post of the band."""
        side, inner = HALF + PLAY + GUIDE, HALF + PLAY
        front, rear = self.sled_to - TIP, self.end + TIP
        x = self.pivot_x
        parts = [box((-EYE - 2, -side, 0), (x + 26, side, PLATE))]
        parts += [box((front - WALL, min(y, y + w), 0), (rear + WALL, max(y, y + w), TOP - 2))
                  for y, w in ((inner, GUIDE), (-inner, -GUIDE))]  # fmt: skip
        walls = (front - WALL, 3.0, side), (front - WALL, -side, -3.0), (rear, 8.0, side), (rear, -side, -16.0)
        parts += [box((at, y, 0), (at + WALL, end, TOP)) for at, y, end in walls]
        block = self.half - PLAY
        parts += [box((-EYE, y, 0), (EYE, end, SURFACE + EAR)) for y, end in ((3.0, block), (-block, -3.0))]
        # Ears for clamps, whose jaws reach some 30 mm beyond the table's edge.
        parts += [box((4, y, 0), (34, y + 20, PLATE)) for y in (side - 1, -side - 19)]
        parts += [rod("z", (x, PIVOT_Y), 0, HOOK_Z, 6.0), rod("z", (x + POST_X, 5.0), 0, 18.0, 3.0)]
        holes = [rod("x", (y, CONTACT_Z), at - 1, at + WALL + 1, THREAD)
                 for y in (CONTACT_Y, -CONTACT_Y) for at in (front - WALL, rear)]  # fmt: skip
        holes += [rod("z", (x, PIVOT_Y), -1, HOOK_Z + 1, THREAD), rod("y", (SURFACE, 0), -side, side, FREE)]
        return cut(union(*parts), *holes)

    def x_of(self, u, w):
        """Place along the rig of a point of the arm."""
        return u * math.cos(self.tilt) + w * math.sin(self.tilt)

    @property
    def pivot_x(self):
        return self.end + 22.0

    def sled(self):
        """Block with a peg for the hook in a recess, and a pocket for the knot of the string at the bottom."""
        block = box((0, -HALF, 0), (LENGTH, HALF, SLED))
        recess = box((LENGTH - 17, -17, 3), (LENGTH + 1, 7, SLED + 1))
        peg = box((LENGTH - 9.5, -2.5, 0), (LENGTH - 4.5, 2.5, SLED))
        knot, string = rod("z", (8, 0), -1, 6, 3.0), rod("x", (0, 3), -1, 8, 1.2)
        return cut(union(cut(block, recess), peg), knot, string)

    def hook(self):
        """Flat hook around its screw at the origin, with a slot, a nose, a pin for the rubber band and a handle."""
        y = -PIVOT_Y
        flat = union(
            box((-36.5, -2.5, 0), (9, 3, HOOK)), box((-36.5, -2.5, 0), (-31.55, y + 2, HOOK)),
            box((-9, -6.5, 0), (9, y + 9, HOOK)), box((-5, -46, 0), (5, 0, HOOK)),
            rod("z", (PIN_X, y + 5), 0, HOOK + 6, 2.5),
        )  # fmt: skip
        # It goes 3 mm forward, to be hooked, and 1 mm back, so that it knocks little when it is free.
        return cut(flat, cq.Workplane("XY").center(1, 0).slot2D(4 + 2 * FREE, 2 * FREE).extrude(HOOK))

    def arm(self):
        """Beam with the channel for the bar, whose cheeks reach down to the hinge, and a disc for the weights."""
        top, inner = self.bar.high[1], self.half + PLAY
        beam = top + max(1.5, self.design.skin.semi_axis_dorsal_mm + 2.0 - top)
        outer, (u, w) = inner + CHEEK, self.hinge
        rear, ends = min(self.rear, u - EYE), self.rear + (24.0 if self.is_post else 42.0)
        # The centre of the weights, CUP above the disc, stands above the contact.
        middle = (self.contact_x - (beam + BEAM + CUP) * math.sin(self.tilt)) / math.cos(self.tilt)
        parts = [box((rear, -outer, beam), (middle, outer, beam + BEAM)),
                 box((rear, -outer, top), (ends, outer, beam)),
                 rod("z", (middle, 0), beam, beam + BEAM, 22.0)]  # fmt: skip
        for y in (inner, -outer):
            parts.append(box((rear, y, self.bar.low[1] + 2), (ends, y + CHEEK, beam)))
            parts.append(box((u - EYE, y, w - EYE), (u + EYE, y + CHEEK, beam)))
        holes = [rod("y", (w, u), -outer - 1, outer + 1, FREE)]
        holes += [rod("y", (self.screw_w, at), -outer - 1, outer + 1, THREAD) for at in self.screws]
        if not self.is_post:  # room for the rubber band around the stub
            begin = self.rear + bench.BAR_MM - 38
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
        return solid.transform(np.hstack([self.turn(self.tilt), [[0.0], [0.0], [SURFACE + self.depth]]]))

    def assemble(self, moved=0.0, is_armed=True):
        """Place all bodies with the sled `moved` from its rest."""
        base, sled, hook, arm = map(solid_of, self.parts.values())
        hook = hook if is_armed else hook.rotate((0, 0, 9.5))
        strip = solid_of(box((7, -15, SLED), (LENGTH - 18, 15, SLED + STRIP)))
        bodies = {"base": base, "hook": hook.translate((self.pivot_x, PIVOT_Y, HOOK_Z + 0.1)), "arm": self.hang(arm)}
        for name, each in (("sled", sled), ("strip", strip)):
            bodies[name] = each.translate((self.rest - moved, 0, PLATE))
        return bodies | {name: self.hang(solid) for name, solid in self.finger.items()}

    @cached_property
    def parts(self):
        return {"base": self.base(), "sled": self.sled(), "hook": self.hook(), "arm": self.arm()}

    def screw_list(self):
        """List axis, the two other coordinates, end of the head, direction to the driver, threaded and whole length."""
        front, rear = self.sled_to - TIP - WALL, self.end + TIP + WALL
        out = SCREW - WALL - TIP + HEAD
        found = [("x", (y, CONTACT_Z), front - out, -1, WALL, SCREW) for y in (-CONTACT_Y, CONTACT_Y)]
        found += [("x", (y, CONTACT_Z), rear + out, 1, WALL, SCREW) for y in (-CONTACT_Y, CONTACT_Y)]
        found += [("z", (self.pivot_x, PIVOT_Y), HOOK_Z + HOOK + HEAD + 0.2, 1, HOOK_Z, SCREW)]
        outer = self.half + PLAY + CHEEK
        found += [("y", (SURFACE, 0.0), outer + HEAD + 0.2, 1, THREADED, 40)]  # its nut is held by hand
        c, s, lift = math.cos(self.tilt), math.sin(self.tilt), SURFACE + self.depth
        for u in self.screws:
            at = (-u * s + self.screw_w * c + lift, u * c + self.screw_w * s)
            found += [("y", at, side * (self.half + SCREW + HEAD), side, CHEEK, SCREW) for side in (-1, 1)]
        return found

    def on_bed(self):
        """Return the mesh of each part as it is printed: the arm on its upper side."""
        turned = {name: part.rotate((0, 0, 0), (1, 0, 0), 180 if name == "arm" else 0)
                  for name, part in self.parts.items()}  # fmt: skip
        return {name: mesh_of(part.translate((0, 0, -part.val().BoundingBox().zmin))) for name, part in turned.items()}

    def check(self):
        """Assert what a maker relies on; return the figures."""
        for name, mesh in self.on_bed().items():
            whole, bed = to_manifold(mesh.vertices, mesh.triangles), self.design.printer
            assert len(whole.decompose()) == 1, f"{name}: not one closed body"
            worst = max((each.unsupported_mm2() for each in find_ceilings(mesh)), default=0.0)
            assert worst <= MAX_UNSUPPORTED_MM2, f"{name}: {worst:.1f} mm2 would need supports"
            size = np.ptp(mesh.vertices, axis=0)
            assert (size <= (bed.bed_x_mm, bed.bed_y_mm, bed.bed_z_mm)).all(), f"{name}: {size} is larger than the bed"
        for moved, is_armed in ((0.0, True), (0.0, False), (STROKE / 2, False), (STROKE, False)):
            bodies = self.assemble(moved, is_armed) | {n: each for n, each in self.bought().items() if "|" in n}
            names, inside = list(bodies), {"bone", "skin", self.holder}
            for i, a in enumerate(names):
                for b in names[i + 1 :]:
                    meet = 0.0 if {a, b} <= inside else (bodies[a] ^ bodies[b]).volume()
                    assert meet <= 1e-6, f"{a} and {b} overlap by {meet:.3g} mm3, {moved:g} mm from the rest"
            beside = (bodies["sled"].translate((0, y, 0)) ^ bodies["base"] for y in (0.3, -0.3))
            assert all(meet.volume() <= 1e-6 for meet in beside), "the sled has no play between the guides"
        held = self.assemble(0.2)
        assert (held["sled"] ^ held["hook"]).volume() > 1.0, "the hook does not hold the sled"
        stretch = 2 * (2 * (POST_X - PIN_X) + math.pi * (2.5 + 3.0)) / BAND
        assert stretch >= STRETCH, f"two turns of a rubber band are {stretch:.2f} times as long as it"
        bodies = self.assemble()
        for axis, at, begin, way, threaded, _ in self.screw_list():
            assert threaded >= THREADED
            low, high = sorted((begin, begin + way * REACH))
            tool = solid_of(rod(axis, at, low, high, DRIVER))
            later = {"hook"} if axis == "x" else set()  # the sheet mounts it after the contacts
            met = [name for name in bodies if name not in later and (tool ^ bodies[name]).volume() > 1e-6]
            assert not met, f"the driver of the screw along {axis} at {at} meets {met}"
        corners = bodies["skin"].to_mesh().vert_properties
        height = float(corners[:, 2].min()) - SURFACE
        assert abs(height) < 0.01, "the pad does not touch the surface"
        dims = self.design.dimensions
        sensor = self.x_of(dims.sensor_z - self.bar.low[2] + self.rear, -dims.platform_depth)
        assert abs(self.contact_x - sensor) <= 1.5, "the pad does not touch below its sensor"
        lag_s, error_s = onset_s(LONGEST_S, self.design.detector.sample_rate_hz)
        assert error_s <= MAX_ERROR_S
        assert math.sqrt(2e-3 * STROKE / LEAST_M_S2) <= LONGEST_S + 1e-9, "the weights of pulling_kg travel too long"
        strip = bodies["strip"].bounding_box()
        beyond = min(self.contact_x - strip[0], strip[3] - self.contact_x - STROKE)
        assert beyond >= 7.0, f"the pad comes within {beyond:.1f} mm of the surface's end"
        arm = self.parts["arm"].val()
        share = arm.Volume() * 1.27e-6 * 0.6 * 9.81 * (arm.Center().x - self.hinge[0]) / self.contact_x
        return {
            "tilt_deg": math.degrees(self.tilt),
            "contact_to_sensor_mm": self.contact_x - sensor,
            "lag_s": lag_s,
            "error_s": error_s,
            "arm_share_n": share,
        }

    def bought(self):
        """Build what is bought, by its name; "clamp" is in those of the arm."""
        x, y, z = self.pivot_x, 5.0, HOOK_Z + HOOK + 3
        found = {"string to the weight": union(rod("x", (0, PLATE + 3), -14, self.rest, 0.6),
                                               rod("z", (-14, 0), -45, PLATE + 3, 0.6)),
                 "rubber band": union(*(rod("x", (y + w, z), x + PIN_X, x + POST_X, 0.8)
                                        for w in (3.8, -3.8)))}  # fmt: skip
        strips = [box((self.rest, y - 3, TOP), (self.end, y + 3, TOP + 0.1)) for y in (-CONTACT_Y, CONTACT_Y)]
        strips.append(box((self.rest, -CONTACT_Y, TOP), (self.rest + 6, CONTACT_Y, TOP + 0.1)))
        found["copper foil"] = union(*strips)
        uses = {"x": "contact: ", "z": "hook: ", "y": "clamp: "}
        for number, (axis, at, begin, way, _, length) in enumerate(self.screw_list()):
            use = uses[axis] if length == SCREW else "hinge: "
            head, end = begin - HEAD * way, begin - (HEAD + length - 0.01) * way
            # The thread, which cuts into the plastic, is left out, and 0.01 mm of the tip, which touches.
            shank, top = rod(axis, at, *sorted((head, end)), 1.3), rod(axis, at, *sorted((head, begin)), 2.8)
            found[f"{use}screw M3 x {length}|{number}"] = union(shank, top)
        return {name: solid_of(part) for name, part in found.items()}


def main(design_file, folder):
    rig, out = Rig(Design.load(design_file)), Path(folder)
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
        kg, tension_n = pulling_kg(force_n)
        print(f"force {force_n:g} N: {1000 * kg:.0f} g on the string, rubber band above {tension_n:.1f} N")


if __name__ == "__main__":
    main(*sys.argv[1:])
