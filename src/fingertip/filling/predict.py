"""Prediction of one filling: time, pressures, last points, trapped air, and forces on insert and mold.

The silicone is Newtonian and the pressure at the inlet constant. Then time follows from the integral of the resistance
over the injected volume, t = (mu / dp) * integral of R dV, first of the ducts and then of the cavity. Curing thickens
silicone: state the viscosity of the end of the filling for a safe time.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fingertip.filling.ducts_and_mouths import Duct, Mouth, fill_in_series, mouth_resistance, open_mouth
from fingertip.filling.hele_shaw import Filling, TrappedAir, fill, find_air
from fingertip.filling.surface_links import Layer, SkinGrid
from fingertip.foundation.numerics import Array


def refine_peak(layer: Layer, values: Array, node: int) -> tuple[float, float, float]:
    """Return the point [mm] of a layer at which values have their maximum near a node."""
    rows, columns = layer.network.shape
    points = layer.points_mm
    point = points[node].copy()
    if node < rows * columns:
        i, j = divmod(node, columns)
        for low, high in (
            (i * columns + (j - 1) % columns, i * columns + (j + 1) % columns),
            (node - columns if i else -1, node + columns if i + 1 < rows else -1),
        ):
            if low < 0 or high < 0:
                continue
            # Move to the vertex of the parabola through the values of the three nodes.
            curvature = values[low] - 2.0 * values[node] + values[high]
            if np.isfinite(curvature) and curvature < 0.0:
                shift = float(np.clip(0.5 * (values[low] - values[high]) / curvature, -0.5, 0.5))
                point += abs(shift) * (points[high if shift > 0.0 else low] - points[node])
    return float(point[0]), float(point[1]), float(point[2])


_WITHIN = 0.5
"""Weight of a node from which on a sample of a mouth lies at that node."""
Point3 = tuple[float, float, float]
GRAVITY_M_S2 = 9.81


@dataclass(frozen=True)
class Opening:
    """Mouth of a gate or of a vent in the cavity's surface."""

    point_mm: Point3
    diameter_mm: float


@dataclass(frozen=True)
class LastPoint:
    point_mm: Point3
    arrival_mm3: float
    arrival_s: float


@dataclass(frozen=True)
class AirPocket:
    """Air that no vent can let out."""

    point_mm: Point3
    """Point of the pocket that would fill last."""
    volume_mm3: float
    """Volume when it is trapped, at the pressure of the air."""
    injected_mm3: float
    """Silicone in the cavity at that moment."""
    time_s: float


@dataclass(frozen=True, eq=False)
class FillingPrediction:
    """Filling of a mold at constant pressure. Times count from the moment the silicone enters the first duct."""

    volume_mm3: float
    ducts_mm3: float
    viscosity_pa_s: float
    pressure_pa: float
    """Pressure at the inlet of the first duct."""
    ducts_s: float
    """Time in which the ducts fill."""
    fill_s: float
    """Time at which the cavity is full."""
    ducts_resistance: float
    cavity_integral: float
    """Integral of the cavity's resistance over its volume [1]; divided by the volume, its mean resistance."""
    total_integral: float
    """Integral of all resistance over all injected volume [1]."""
    gate_pressure_pa: float
    """Largest pressure at the gate's mouth while the front moves. This pressure and the forces are taken up to the last
    front before the cavity is full, at some 98 % of its volume. Then the pressure rises to that of the inlet
    everywhere, if the vents are closed."""
    side_force_n: float
    """Largest force across the finger on the insert during the filling."""
    side_force_direction: tuple[float, float]
    """Unit vector (x, y) of that force."""
    axial_force_n: float
    """Largest force out of the cavity, towards -z, on the insert during the filling, its collar included."""
    opening_force_n: float
    """Largest force that parts the mold halves during the filling."""
    static_axial_force_n: float
    """Axial force when the cavity is full, the vents are closed and the inlet's pressure acts everywhere."""
    static_opening_force_n: float
    """Opening force then."""
    arrival_mm3: Array
    """Volume in the cavity when the front passes each node of the grid; NaN where no silicone comes."""
    arrival_s: Array
    """Time at which the front passes each node."""
    last_points: tuple[LastPoint, ...]
    """Last points, the last first."""
    air_pockets: tuple[AirPocket, ...]
    """Air pockets, the largest first."""

    def force_for_time_n(self, fill_s: float, bore_mm: float) -> float:
        """Compute the force on a syringe's plunger that fills ducts and cavity within a time."""
        return self.viscosity_pa_s * self.total_integral / fill_s * _area_m2(bore_mm)


def syringe_pressure_pa(force_n: float, bore_mm: float) -> float:
    """Compute the pressure under a syringe's plunger, without the friction of its seal."""
    return force_n / _area_m2(bore_mm)


def head_pressure_pa(density_g_cm3: float, height_mm: float) -> float:
    return density_g_cm3 * GRAVITY_M_S2 * height_mm


def _area_m2(diameter_mm: float) -> float:
    return math.pi / 4.0 * diameter_mm**2 * 1e-6


@dataclass(frozen=True, eq=False)
class Course:
    """Way of the front through a cavity: it depends on the gate alone, not on vents, ducts, viscosity or pressure."""

    grid: SkinGrid
    filling: Filling
    mouth_resistance: float
    """Resistance at the gate's mouth that the grid does not show [1/mm3]."""

    @classmethod
    def follow(cls, grid: SkinGrid, gate: Opening) -> Course:
        """Compute the way of the front, which takes most of the time of a prediction."""
        layer, network = grid.layer, grid.layer.network
        mouth = open_mouth(layer, gate.point_mm, gate.diameter_mm)
        source = mouth.shares(len(network.volume_mm3))
        if not network.is_open.all():
            reached = network.reach(source > 0.0)
            network = replace(network, volume_mm3=np.where(reached, network.volume_mm3, 0.0))
        return cls(grid, fill(network, source), mouth_resistance(layer, mouth, gate.diameter_mm))

    def find_last_points(self, vents: Sequence[Opening]) -> tuple[list[int], tuple[TrappedAir, ...]]:
        """Find the nodes that fill last, the last first, and the air that no vent lets out, the largest first."""
        layer, arrival = self.grid.layer, self.filling.arrival_mm3
        closing: dict[int, float] = {}
        for vent in vents:
            for node, volume in _close(open_mouth(layer, vent.point_mm, vent.diameter_mm), arrival):
                closing[node] = max(volume, closing.get(node, 0.0))
        points, pockets = find_air(self.filling.network, arrival, closing)
        # What closed quads cut off from the gate is one more pocket.
        network = self.grid.layer.network
        cut_off = network.is_open & ~self.filling.network.is_open
        if cut_off.any():
            volume = float(network.volume_mm3[cut_off].sum())
            pockets = (*pockets, TrappedAir(int(np.flatnonzero(cut_off)[0]), 0.0, volume))
        return points, pockets

    def place_of(self, node: int) -> Point3:
        """Locate a maximum of the arrival volume between the nodes around it [mm]."""
        return refine_peak(self.grid.layer, self.filling.arrival_mm3, node)

    def predict(
        self, vents: Sequence[Opening], ducts: Sequence[Duct], *, viscosity_pa_s: float, pressure_pa: float
    ) -> FillingPrediction:
        grid, filling, mouth = self.grid, self.filling, self.mouth_resistance
        before, seconds = fill_in_series(ducts), viscosity_pa_s / pressure_pa
        volume, arrival = filling.network.total_mm3, filling.arrival_mm3
        points, pockets = self.find_last_points(vents)
        # Resistance of the cavity at each front and its integral. The mouth's may be negative, their sums may not.
        injected = np.array([front.injected_mm3 for front in filling.fronts])
        resistance = np.array([filling.gate @ front.pressure_per_mm3 for front in filling.fronts]) + mouth
        integral = np.array([filling.gate @ front.potential for front in filling.fronts]) + mouth * injected
        resistance, integral = np.maximum(resistance, 0.0), np.maximum(integral, 0.0)

        def time_s(volume_mm3: Array) -> Array:
            """Compute the times at which volumes have been injected; the slope of the integral is the resistance."""
            in_cavity = _interpolate(volume_mm3, injected, integral, resistance)
            return seconds * (before.resistance_integral + before.resistance * volume_mm3 + in_cavity)

        arrival_s, trapped_s = time_s(arrival), time_s(np.array([air.injected_mm3 for air in pockets]))
        # At the last front the pressure has no finite limit, because the front has shrunk to a point.
        moving = slice(0, -1)
        pressures = np.stack([front.pressure_per_mm3 for front in filling.fronts[moving]])
        pressures *= (pressure_pa * 1e-6 / (before.resistance + resistance[moving]))[:, None]  # [N/mm2]
        on_insert = -pressures @ grid.insert_area_mm2
        across = np.hypot(on_insert[:, 0], on_insert[:, 1])
        worst = int(np.argmax(across))
        direction = on_insert[worst, :2] / max(float(across[worst]), 1e-300)
        largest = float(np.max(resistance[moving]))
        static_n = pressure_pa * 1e-6
        return FillingPrediction(
            volume_mm3=volume,
            ducts_mm3=before.volume_mm3,
            viscosity_pa_s=viscosity_pa_s,
            pressure_pa=pressure_pa,
            ducts_s=before.resistance_integral * seconds,
            fill_s=float(time_s(np.array([volume]))[0]),
            ducts_resistance=before.resistance,
            cavity_integral=float(integral[-1]),
            total_integral=before.resistance_integral + before.resistance * volume + float(integral[-1]),
            gate_pressure_pa=pressure_pa * (largest / (before.resistance + largest)),
            side_force_n=float(across[worst]),
            side_force_direction=(float(direction[0]), float(direction[1])),
            axial_force_n=float(np.max(-on_insert[:, 2])),
            opening_force_n=float(np.max(pressures @ grid.parting_area_mm2)),
            static_axial_force_n=static_n * float(grid.insert_area_mm2[:, 2].sum()),
            static_opening_force_n=static_n * float(grid.parting_area_mm2.sum()),
            arrival_mm3=arrival,
            arrival_s=arrival_s,
            last_points=tuple(
                LastPoint(self.place_of(node), float(arrival[node]), float(arrival_s[node])) for node in points
            ),
            air_pockets=tuple(
                AirPocket(self.place_of(air.node), air.volume_mm3, air.injected_mm3, time)
                for air, time in zip(pockets, trapped_s.tolist(), strict=True)
            ),
        )


def _close(mouth: Mouth, arrival_mm3: Array) -> Iterable[tuple[int, float]]:
    """List the node of each sample of a vent's mouth, and when the front covers it, in any part of the cavity."""
    reached = np.where(np.isfinite(arrival_mm3), arrival_mm3, 0.0)
    samples, corner = np.arange(len(mouth.nodes)), np.argmax(mouth.weights, axis=1)
    heaviest = mouth.nodes[samples, corner]
    covered = np.einsum("sk,sk->s", mouth.weights, reached[mouth.nodes])
    # A node is the smallest volume that is resolved: one within the mouth is vented as long as it is not full.
    covered = np.where(mouth.weights[samples, corner] > _WITHIN, reached[heaviest], covered)
    return zip(heaviest.tolist(), covered.tolist(), strict=True)


def _interpolate(at: Array, points: Array, values: Array, slopes: Array) -> Array:
    """Interpolate a function that begins at 0 as a constant, by cubics between points with known value and slope."""
    v, value, slope = (np.concatenate(([0.0], known)) for known in (points, values, slopes))
    k = np.clip(np.searchsorted(v, at) - 1, 0, len(v) - 2)
    step = v[k + 1] - v[k]
    x = (at - v[k]) / step
    return np.asarray(
        value[k] * (1 + 2 * x) * (1 - x) ** 2
        + value[k + 1] * x * x * (3 - 2 * x)
        + step * x * (1 - x) * (slope[k] * (1 - x) - slope[k + 1] * x)
    )
