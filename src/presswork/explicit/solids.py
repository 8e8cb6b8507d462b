# SPDX-License-Identifier: Apache-2.0
"""Explicit dynamics of solids in plane strain or axisymmetry: central differences, `n` cycles a call in C++.

    run = ExplicitSolids(mesh, [material], axisymmetric=True)
    run.fix("left", "u")
    run.set_velocity("all", (0.0, -287e3))
    wall = run.add_wall("anvil", line)
    run.run_to(80e-6)
    run.energies().error_percent

Units are mm, s, t, N, MPa, degrees Celsius. A node has two freedoms: u along x (the radius), v along y (the axis).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from presswork import _core, stop
from presswork.explicit.energy import EnergyBalance, MassScaling, compute_balance, sum_energies
from presswork.explicit.input_checks import ExplicitError, check_nodal, check_solids
from presswork.explicit.motion import Motion
from presswork.explicit.shells import SAFETY
from presswork.explicit.solid_material import SolidMaterial
from presswork.law.umat import TOLD
from presswork.model import Mesh

Array = npt.NDArray[np.float64]
FREEDOMS = "uv"
RENEWAL = 10
"""Cycles after which `run_to` finds the stable step anew."""
CRUSHED = 1e-3
"""Of the first step: what a cell asks for that no result should be taken from, and that would take for ever."""


class Wall:
    """A rigid profile that no node passes."""

    def __init__(self, loop: _core.SolidLoop, number: int, name: str) -> None:
        self._loop, self._number, self.name = loop, number, name
        self._velocity = (0.0, 0.0)

    @property
    def velocity(self) -> tuple[float, float]:
        """Prescribed velocity [mm/s], times the velocity_scale of each cycle."""
        return self._velocity

    @velocity.setter
    def velocity(self, value: tuple[float, float]) -> None:
        x, y = (float(v) for v in value)
        if not np.isfinite([x, y]).all():
            raise ExplicitError(f"velocity of wall {self.name} = {value}: it must be two finite numbers")
        self._velocity = (x, y)
        self._loop.move_wall(self._number, self._velocity)

    @property
    def displacement(self) -> Array:
        """Displacement since the start (2,) [mm]."""
        return np.array(self._loop.wall_offset(self._number))

    @property
    def impulse(self) -> Array:
        """Impulse of the solids on the wall since the start (2,) [N s]: its change over a time is the mean force."""
        return -np.array(self._loop.wall_impulse(self._number))

    @property
    def nodal_force(self) -> Array:
        """Forces of the wall on the nodes in the last cycle (n_nodes, 2) [N]; of the whole ring in axisymmetry."""
        return self._loop.wall_force(self._number)

    @property
    def force(self) -> Array:
        """Force of the solids on the wall in the last cycle (2,) [N]."""
        return np.asarray(-self.nodal_force.sum(axis=0))


class ExplicitSolids:
    """Solids of quad4_1pt or tri3 in explicit dynamics.

    mesh: points (n_nodes, 2) [mm], blocks of cells; materials: as the blocks number them. depth [mm]: of plane strain.
    hourglass_fraction: of the shear modulus, that resists hourglass modes of quad4_1pt.
    """

    def __init__(
        self,
        mesh: Mesh,
        materials: Sequence[SolidMaterial],
        *,
        axisymmetric: bool,
        depth: float = 1.0,
        hourglass_fraction: float = 0.05,
    ) -> None:
        check_solids(mesh, len(materials), axisymmetric, depth, hourglass_fraction)
        self.mesh = mesh
        n = len(mesh.points)
        rim = np.zeros(n, dtype=np.uint8)
        rim[mesh.boundary_edges.ravel()] = 1
        self._loop = _core.SolidLoop(
            np.ascontiguousarray(mesh.points, dtype=float),
            rim,
            axisymmetric=axisymmetric,
            depth=depth,
            hourglass_fraction=hourglass_fraction,
        )
        for block in mesh.blocks:
            material = materials[block.material]
            cells = np.ascontiguousarray(block.connectivity, dtype=np.int32)
            elastic = {"young": material.young, "poisson": material.poisson}
            self._loop.add(block.element, cells, material.make_law(), material.density, **elastic)
        self._given_temperature = np.concatenate(
            [np.full(len(b.connectivity), materials[b.material].start) for b in mesh.blocks]
        )
        self._fastest = max(materials[b.material].wave_speed for b in mesh.blocks)
        self._fixed = np.zeros((n, 2), dtype=np.uint8)
        self._prescribed = np.zeros((n, 2))
        self._walls: list[Wall] = []
        self._reference: tuple[float, float] | None = None
        self._scales = (0.0, 1.0, 1.0)
        self.cycle = 0
        self.time = 0.0
        self.dt = SAFETY * self.stable_step()
        self._dt_before = self._first_dt = self.dt

    @property
    def position(self) -> Array:
        """Positions (n_nodes, 2) [mm]."""
        return self._loop.position

    @property
    def velocity(self) -> Array:
        """Velocities (n_nodes, 2) [mm/s], half a step back."""
        return self._loop.velocity

    @velocity.setter
    def velocity(self, value: npt.ArrayLike) -> None:
        v = self._shaped(value, "velocity")
        self._check_speed(v)
        self._loop.velocity = v
        self._reference = None

    @property
    def force(self) -> Array:
        """Nodal forces from outside (n_nodes, 2) [N]; of the whole ring in axisymmetry."""
        return self._loop.force

    @force.setter
    def force(self, value: npt.ArrayLike) -> None:
        self._loop.force = self._shaped(value, "force")

    @property
    def internal_force(self) -> Array:
        """Internal forces (n_nodes, 2) [N]."""
        return self._loop.internal_force

    @property
    def reaction_impulse(self) -> Array:
        """Impulse of what holds prescribed freedoms since reset_reaction (n_nodes, 2) [N s]."""
        return self._loop.reaction_impulse

    def reset_reaction(self) -> None:
        """Begin a new sum of reaction_impulse."""
        self._loop.reaction_impulse = np.zeros(self._fixed.shape)

    @property
    def mass(self) -> Array:
        """Mass of each node (n_nodes) [t], with what was added; of its ring in axisymmetry."""
        return self._loop.mass

    @property
    def stress(self) -> Array:
        """Stress xx, yy, zz (hoop), xy (n_cells, 4) [MPa], through the blocks."""
        return self._loop.stress

    @property
    def equivalent_plastic_strain(self) -> Array:
        """Equivalent plastic strain (n_cells)."""
        return self._loop.eqps

    @property
    def temperature(self) -> Array:
        """Temperature (n_cells) [degrees C]: what is given from outside, and the rise by plastic work."""
        return self._given_temperature + self._loop.rise

    @property
    def given_temperature(self) -> Array:
        """What is given from outside (n_cells) [degrees C]; at first that of the materials' start."""
        return self._given_temperature.copy()

    @given_temperature.setter
    def given_temperature(self, value: npt.ArrayLike) -> None:
        degrees = np.array(np.broadcast_to(np.asarray(value, dtype=float), self._given_temperature.shape))
        if not np.isfinite(degrees).all():
            raise ExplicitError("given_temperature: every value must be a finite number [degrees C]")
        self._loop.set_temperature(degrees)
        self._given_temperature = degrees

    def _shaped(self, value: npt.ArrayLike, name: str) -> Array:
        return check_nodal(value, name, self._fixed.shape)

    def _check_speed(self, velocity: Array) -> None:
        speed = float(np.abs(velocity).max(initial=0.0))
        if speed > self._fastest:
            raise ExplicitError(
                f"a velocity of {speed:g} mm/s is beyond the material's sound, {self._fastest:.3g} mm/s: velocities "
                "are in mm/s, 1 m/s is 1000"
            )

    def nodes_of(self, nodes: str | npt.ArrayLike) -> npt.NDArray[np.intp]:
        """Give node numbers: those of a node set of the mesh by its name, or the numbers given."""
        if isinstance(nodes, str):
            if nodes not in self.mesh.node_sets:
                known = ", ".join(sorted(self.mesh.node_sets)) or "none"
                raise ExplicitError(f"there is no node set {nodes!r}; the mesh has: {known}")
            return np.asarray(self.mesh.node_sets[nodes], dtype=np.intp)
        numbers = np.atleast_1d(np.asarray(nodes, dtype=np.intp))
        outside = (numbers < 0) | (numbers >= len(self._fixed))
        if outside.any():
            raise ExplicitError(f"there is no node {numbers[outside][0]}: they are 0 to {len(self._fixed) - 1}")
        return numbers

    def fix(self, nodes: str | npt.ArrayLike, freedoms: str, velocity: npt.ArrayLike = 0.0) -> None:
        """Prescribe the velocity [mm/s], one or one for each node, of freedoms "u", "v" or "uv"."""
        if not freedoms or set(freedoms) - set(FREEDOMS):
            raise ExplicitError(f"freedoms = {freedoms!r}: give letters of {FREEDOMS!r}")
        numbers, value = self.nodes_of(nodes), np.asarray(velocity, dtype=float)
        self._check_speed(value)
        for letter in freedoms:
            self._fixed[numbers, FREEDOMS.index(letter)] = 1
            self._prescribed[numbers, FREEDOMS.index(letter)] = value
        self._loop.prescribe(self._fixed, self._prescribed)

    def release(self) -> None:
        """Let every freedom go that fix has prescribed."""
        self._fixed[:] = 0
        self._prescribed[:] = 0.0
        self._loop.prescribe(self._fixed, self._prescribed)

    def set_velocity(self, nodes: str | npt.ArrayLike, velocity: tuple[float, float]) -> None:
        """Give nodes a velocity (2,) [mm/s] to start from."""
        v = self.velocity
        v[self.nodes_of(nodes)] = velocity
        self.velocity = v

    def add_wall(self, name: str, segments: npt.ArrayLike, *, mu: float = 0.0) -> Wall:
        """Add a rigid profile, segments (n, 7) as in model.Tool, its metal on the right; mu: Coulomb friction.

        Every node of the boundary is held off it.
        """
        profile = np.atleast_2d(np.ascontiguousarray(segments, dtype=float))
        if profile.shape[1] != 7 or not np.isfinite(profile).all():
            raise ExplicitError(f"segments of wall {name} must be finite numbers of shape (n, 7)")
        if not 0 <= mu <= 2:
            raise ExplicitError(f"mu of wall {name} = {mu}: it must lie between 0 and 2")
        gap = _core.touch_profile(profile, self.position)[0]
        rim = np.unique(self.mesh.boundary_edges)
        size = float(np.ptp(self.mesh.points, axis=0).max())
        deepest = rim[np.argmin(gap[rim])]
        if gap[deepest] < -1e-6 * size:
            raise ExplicitError(
                f"wall {name}: node {deepest} lies {-gap[deepest]:g} mm inside it at the start: move the wall off, or "
                "turn its direction round (metal is on the right)"
            )
        self._loop.add_wall(profile, mu=mu)
        wall = Wall(self._loop, len(self._walls), name)
        self._walls.append(wall)
        return wall

    def stable_step(self) -> float:
        """Give the bound of the stable time step [s] of the cells as they are now."""
        return float(2.0 / np.sqrt(self._loop.bound_frequencies().max()))

    def scale_mass(self, target_step: float) -> MassScaling:
        """Add mass to cells whose stable step is below the target [s], take the target as the step; report the mass.

        The safety factor is kept: the cells' bound becomes target_step/0.9. Mass once added stays. The kinetic energy
        that it brings is no error of the balance.
        """
        if not target_step > 0:
            raise ExplicitError(f"target_step = {target_step}: it must be above zero")
        loop, before = self._loop, self._loop.mass_factor
        start = sum_energies(self._energies(*self._scales))
        factor = loop.bound_frequencies() * (0.5 * target_step / SAFETY) ** 2
        now = before * np.maximum(factor, 1.0)
        loop.mass_factor = now
        loop.weigh()
        self.dt = target_step
        if self._reference:
            first, largest = self._reference
            self._reference = (first + sum_energies(self._energies(*self._scales)) - start, largest)
        return self.added_mass()

    def added_mass(self) -> MassScaling:
        """Give the state of mass scaling."""
        true, factor = self._loop.cell_mass, self._loop.mass_factor
        return MassScaling(float(true.sum()), float(((factor - 1.0) * true).sum()), int((factor > 1.0).sum()))

    def advance(
        self,
        n: int,
        *,
        force_scale: float | npt.ArrayLike = 1.0,
        velocity_scale: float | npt.ArrayLike = 1.0,
        damping: float = 0.0,
    ) -> None:
        """Advance n cycles of `dt`, which may be changed between calls.

        force_scale, velocity_scale: factors on force and on prescribed velocities (walls too), one or one a cycle.
        damping: mass damping [1/s]. Raises ExplicitError when a cell is turned inside out or its law fails.
        """
        force, velocity = (np.broadcast_to(np.asarray(s, dtype=float), n).copy() for s in (force_scale, velocity_scale))
        if n < 1:
            raise ExplicitError(f"n = {n}: advance at least one cycle")
        if self._reference is None:
            self._scales = (damping, float(force[0]), float(velocity[0]))
            start = sum_energies(self._energies(*self._scales))
            self._reference = (start, abs(start))
        failed, status = self._loop.advance(self.time, self.dt, self._dt_before, force, velocity, damping=damping)
        if failed >= 0:
            when = f"between cycles {self.cycle} and {self.cycle + n} (t = {self.time:g} s)"
            if status != _core.LawStatus.done:
                raise ExplicitError(f"{TOLD[status]} in cell {failed} {when}: shorten the step {self.dt:g} s")
            raise ExplicitError(
                f"cell {failed} is turned inside out {when}: shorten the step {self.dt:g} s (the cells allow "
                f"{SAFETY * self.stable_step():g} s now), refine the mesh, or set explicit.hourglass_stiffness higher"
            )
        self._scales = (damping, float(force[-1]), float(velocity[-1]))
        self._dt_before = self.dt
        self.cycle += n
        self.time += n * self.dt
        finite = np.isfinite(self.position).all(axis=1)
        if not finite.all():
            raise ExplicitError(
                f"node {np.argmin(finite)} has left for infinity by cycle {self.cycle} (t = {self.time:g} s): the step "
                f"{self.dt:g} s is too long (the cells allow {SAFETY * self.stable_step():g} s now)"
            )

    def run_to(
        self, end: float, *, damping: float = 0.0, target_step: float | None = None, motion: Motion | None = None
    ) -> None:
        """Run to the time `end` [s], with a step that follows the cells' own: found anew every 10 cycles.

        target_step [s]: where the cells' own is shorter, mass is added as by scale_mass. motion: how long walls and
        prescribed velocities have gone at their speed [s], by a time; e.g. SmoothStroke(T, T) starts them smoothly,
        stops them after T, and takes them as far as T at their speed would. Without it they go at their speed. Raises
        ExplicitError where a cell is so crushed that its step is a thousandth of the first.
        """
        if not end > self.time:
            raise ExplicitError(f"end = {end:g} s: it must lie beyond the time reached, {self.time:g} s")
        while end - self.time > 1e-9 * end:
            self.dt = SAFETY * self.stable_step()
            if target_step is not None and self.dt < target_step * (1 - 1e-9):
                self.scale_mass(target_step)
            if self.dt < CRUSHED * self._first_dt:
                raise ExplicitError(
                    f"cell {np.argmax(self._loop.bound_frequencies())} is crushed at t = {self.time:g} s: its step is "
                    f"{self.dt:.3g} s, that of the mesh was {self._first_dt:.3g} s at first: refine the mesh, make it "
                    "coarser along the way that it is crushed, or give explicit.target_step"
                )
            left = int(np.ceil((end - self.time) / self.dt * (1 - 1e-9)))
            if left <= RENEWAL:
                self.dt = (end - self.time) / left
            n = min(left, RENEWAL)
            scale: float | Array = 1.0
            if motion is not None:
                scale = np.diff(motion.position(np.linspace(self.time, self.time + n * self.dt, n + 1))) / self.dt
            self.advance(n, velocity_scale=scale, damping=damping)
            stop.look()

    def _energies(self, damping: float, force_scale: float, velocity_scale: float) -> _core.SolidEnergies:
        # velocities stand half of the last step back: so long is the way to now, whatever the next step will be
        dt = self._dt_before
        return self._loop.energies(dt, dt, damping=damping, force_scale=force_scale, velocity_scale=velocity_scale)

    def energies(self) -> EnergyBalance:
        """Give the energies now; damping and scales are taken as in the last cycle."""
        balance, reference = compute_balance(self._energies(*self._scales), self._reference)
        if self._reference:
            self._reference = reference
        return balance

    def dump(self) -> dict[str, Array]:
        """Give everything that the next cycle depends on, beside the constructor, fix, force and walls."""
        loop = self._loop
        walls = [
            [*loop.wall_offset(i), *loop.wall_impulse(i), *loop.wall_force(i).ravel()] for i in range(len(self._walls))
        ]
        reference = self._reference or (np.nan, np.nan)
        return {
            "position": loop.position,
            "velocity": loop.velocity,
            "internal_force": loop.internal_force,
            "stress": loop.stress,
            "eqps": loop.eqps,
            "rise": loop.rise,
            "given_temperature": self._given_temperature,
            "hourglass": loop.hourglass,
            "kept": loop.kept,
            "cell_work": loop.cell_work,
            "mass_factor": loop.mass_factor,
            "walls": np.array(walls),
            "scalars": np.array(
                [self.cycle, self.time, self.dt, self._dt_before, *loop.work, *reference, *self._scales], dtype=float
            ),
        }

    def restore(self, dump: dict[str, Array]) -> None:
        """Take over what dump gave: the run goes on with the same bits as one never stopped."""
        loop = self._loop
        cycle, self.time, self.dt, self._dt_before, *rest = (float(s) for s in dump["scalars"])
        self.cycle = int(cycle)
        loop.work = rest[:4]
        self._reference = None if np.isnan(rest[4]) else (rest[4], rest[5])
        self._scales = (rest[6], rest[7], rest[8])
        self.given_temperature = dump["given_temperature"]
        for name in dump.keys() - {"walls", "scalars", "given_temperature"}:
            setattr(loop, name, np.ascontiguousarray(dump[name]))
        loop.weigh()
        if len(dump["walls"]) != len(self._walls):
            raise ExplicitError(f"the dump has {len(dump['walls'])} walls, the run {len(self._walls)}: add them first")
        for i, row in enumerate(dump["walls"]):
            loop.restore_wall(i, row[:2].tolist(), row[2:4].tolist(), row[4:].copy())
