"""Hook that holds the sled against its rear screws, and the check of its turn; lengths in mm."""

import math

import cadquery as cq
import numpy as np
from shapes import FREE, box, cut, headed, union

HEIGHT = 4.0
PIVOT = 20.5
PIVOT_Y = -6.5
STOP_Y = -12.6
"""Height of the hook, place of its screw behind the sled and beside
the middle line, and wall that ends its turn.
"""
FORWARD = 1.5
BACK = 2.5
"""Ways along its slot, to be hooked and for tolerances of the rear screws."""
POST_X = 18.0
POST = 3.5
PIN_X = -4.0
PIN = 3.0
BAND = 80.0
BANDS = 10.0
STRETCH = 1.5
"""Post and pin of the rubber bands: places from the hook's screw and radii; length of a band all
around, height for all of them, and their least stretch in two turns.
"""


def hook():
    """Build it flat, around its screw at the origin, with a slot, a
    nose, a pin for the rubber bands and a handle.
    """
    y = -PIVOT_Y
    flat = union(
        box((-34, -2.5, 0), (9, 3, HEIGHT)),
        box((-34, -2.5, 0), (-29.05, y + 1, HEIGHT)),
        box((-7.5, -6.5, 0), (9, y + 8, HEIGHT)),
        box((-3, -46, 0), (6, 0, HEIGHT)),
        headed((PIN_X, y + 5), HEIGHT + BANDS, PIN),
    )
    slot = (
        cq.Workplane("XY")
        .center((FORWARD - BACK) / 2, 0)
        .slot2D(FORWARD + BACK + 2 * FREE, 2 * FREE)
    )

    return cut(flat, slot.extrude(HEIGHT))


def place(solid, pivot, angle_deg, slid=0.0):
    """Turn the hook about its screw at `pivot`, `slid` back along its slot."""
    return solid.translate((slid, 0, 0)).rotate((0, 0, angle_deg)).translate(pivot)


def check_stretch():
    stretch = 2 * (2 * (POST_X - PIN_X) + math.pi * (PIN + POST)) / BAND
    assert stretch >= STRETCH, f"two turns of a rubber band are {stretch:.2f} times as long as it"


def check_turn(
    solid,
    pivot,
    fixed,
    hooked,
    ways,
):
    """Sweep the hook through its turn; return at which angles it frees the sled and stops [deg].

    `fixed` stands still; the sled is at `hooked`, and then at each of `ways`.
    """

    def meets(other, angle_deg, slid=0.0):
        return (place(solid, pivot, angle_deg, slid) ^ other).volume() > 1e-6

    angles = np.arange(0.0, 20.0, 0.25)
    slides = (-FORWARD, 0.0, BACK)
    stop = next((angle for angle in angles if meets(fixed, angle)), np.inf)
    is_free = (
        not any(meets(way, angle, slid) for way in ways for slid in slides) for angle in angles
    )
    free = next((angle for angle, found in zip(angles, is_free, strict=True) if found), np.inf)
    assert free + 1.0 <= stop <= 11.0, (
        f"the hook frees the sled at {free:g} degrees, and stops at {stop:g}"
    )

    for slid in slides:
        for angle in angles[angles < stop]:
            others = [fixed] + [hooked] * (slid < 0.0) + ways * bool(angle >= free)
            met = any(meets(other, angle, slid) for other in others)
            assert not met, f"the hook, {slid:g} mm along its slot, strikes at {angle:g} degrees"

    assert meets(hooked, -3.0), "the recess does not keep the hook from turning in"
    return free, stop
