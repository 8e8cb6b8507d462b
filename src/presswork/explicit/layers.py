# SPDX-License-Identifier: Apache-2.0
"""Layers of an explicit run's shells: stress, what the law keeps, thickness; read, and begun with."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np
import numpy.typing as npt

from presswork import _core
from presswork.explicit.arrays import LayerArrays
from presswork.explicit.blocks import Shells, Solids
from presswork.explicit.input_checks import ExplicitError
from presswork.law.history import EQPS, STRESS, History
from presswork.law.umat import list_sheet_history
from presswork.state import State

Array = npt.NDArray[np.float64]


class LayersOfRun:
    """What an explicit run knows of its shells through the thickness."""

    blocks: list[Shells | Solids]
    """Those of shells first: one sheet."""
    state: Callable[[], State]
    take_state: Callable[[State], None]
    _loop: _core.SpaceLoop | _core.SpaceLoopSingle
    _shells: npt.NDArray[np.intp]
    """Number, as given, of each shell in the order of the loop (n,), which has them first."""
    _counts: list[int]
    """Shells of each block."""
    _fixed: npt.NDArray[np.uint8]
    _prescribed_temperature: Array | None = None
    _young: Array
    """Young's modulus of each shell (n,) [MPa]."""
    _damage_names: tuple[str, ...] = ()
    _poisson: Array
    """Poisson's ratio of each shell (n,)."""

    def _by_shell(self, inside: Array) -> Array:
        out = np.empty_like(inside)
        out[self._shells] = inside
        return out

    def _of_blocks(self, values: Callable[[int], Array]) -> Array:
        parts = [values(block) for block in range(len(self._counts))]
        if parts[0].ndim == 4 and parts[0].shape[1] > 1:  # the one point of triangles stands for all
            parts = [np.broadcast_to(part, (len(part), *parts[0].shape[1:])) for part in parts]
        return np.concatenate(parts)

    @property
    def stress(self) -> Array:
        """Stress xx, yy, xy (n, n_points, 3) [MPa] in the law's frame, from the bottom layer up; means in the plane.

        Where tools squeeze the sheet there is -pressure besides, along its normal.
        """
        return np.asarray(self.stress_at_points.mean(axis=1))

    @property
    def stress_at_points(self) -> Array:
        """Stress (n, q, n_points, 3) at the q points in the plane, in the order of the implicit shells of 2 x 2."""
        stress = self.flow_stress_at_points
        stress[..., :2] -= self.pressure_at_points[:, :, None, None]
        return stress

    @property
    def flow_stress_at_points(self) -> Array:
        """Plane stress (n, q, n_points, 3) that flows as the stress does: it with the pressure added to xx and yy."""
        return self._by_shell(self._of_blocks(self._loop.stress))

    @property
    def pressure_at_points(self) -> Array:
        """Pressure through the thickness (n, q) [MPa] where tools squeeze the sheet, else 0."""
        points = self.history_at_points.shape[1]
        parts = [self._loop.pressure(block) for block in range(len(self._counts))]
        return self._by_shell(np.concatenate([np.broadcast_to(p, (len(p), points)) for p in parts]))

    @property
    def pressure(self) -> Array:
        """Pressure through the thickness (n) [MPa]; means in the plane."""
        return np.asarray(self.pressure_at_points.mean(axis=1))

    @property
    def equivalent_plastic_strain(self) -> Array:
        """Equivalent plastic strain (n, n_points)."""
        return np.asarray(self.kept_in_layers.of(EQPS, self.history))

    @property
    def kept_in_layers(self) -> History:
        """What the law keeps at each layer, by name."""
        assert isinstance(self.blocks[0], Shells)
        return list_sheet_history(self.blocks[0].law)

    @property
    def history(self) -> Array:
        """What the law keeps at each layer (n, n_points, n_history), equivalent plastic strain first; means also."""
        return np.asarray(self.history_at_points.mean(axis=1))

    @property
    def history_at_points(self) -> Array:
        """What the law keeps at the q points in the plane (n, q, n_points, n_history)."""
        return self._by_shell(self._of_blocks(self._loop.history))

    @cached_property
    def _shape_of_layers(self) -> tuple[int, ...]:
        return self.history_at_points.shape[:3]

    @cached_property
    def _layers_of_blocks(self) -> list[tuple[int, ...]]:
        return [self._loop.history(block).shape[:3] for block in range(len(self._counts))]

    @property
    def prescribed_temperature(self) -> Array | None:
        """Temperature given from outside at the layers (n, q, n_points) [degrees C], from the bottom up.

        None, which cannot be set: that of the law's start. Set by an array of this shape, by one for all points in the
        plane (n, n_points), or by what broadcasts to that, such as a profile (n_points,) for all shells. It holds until
        it is set again; what the law heats itself comes on top.
        """
        return self._prescribed_temperature

    @prescribed_temperature.setter
    def prescribed_temperature(self, value: npt.ArrayLike) -> None:
        degrees, shape = np.asarray(value, dtype=float), self._shape_of_layers
        if not np.isfinite(degrees).all():
            raise ExplicitError("prescribed_temperature: every value must be a finite number [degrees C]")
        try:
            at_points = np.broadcast_to(degrees if degrees.ndim == 3 else np.atleast_2d(degrees)[:, None], shape)
        except ValueError:
            raise ExplicitError(
                f"prescribed_temperature has shape {degrees.shape}: these shells have layers {shape}"
            ) from None
        for block, part in enumerate(np.split(at_points[self._shells], np.cumsum(self._counts)[:-1])):
            of_block = part.mean(axis=1, keepdims=True) if self._layers_of_blocks[block][1] == 1 else part
            self._loop.set_temperature(block, np.ascontiguousarray(of_block))
        self._prescribed_temperature = np.array(at_points)

    @property
    def damage(self) -> dict[str, Array]:
        """Damage by the name of its quantity at the layers of the q points in the plane (n, q, n_points)."""
        return {
            name: self._by_shell(self._of_blocks(lambda block, name=name: self._damage_of(block, name)))[..., 0]  # type: ignore[misc]
            for name in self._damage_names
        }

    def _damage_of(self, block: int, name: str) -> Array:
        return np.asarray(self._loop.damage(block, name)).reshape(*self._layers_of_blocks[block], 1)

    def set_layers(self, stress: npt.ArrayLike, history: npt.ArrayLike) -> None:
        """Begin with stress and history in the form of these properties; internal forces follow from them.

        Both at the layers (n, n_points, ...), for all points in the plane, or at each of them (n, q, n_points, ...).
        """
        s, kept = (np.asarray(given, dtype=float) for given in (stress, history))
        for name, given, own in (("stress", s, self.stress_at_points), ("history", kept, self.history_at_points)):
            if given.shape not in (own.shape, own.shape[:1] + own.shape[2:]):
                raise ExplicitError(f"{name} has shape {given.shape}: these shells have {own.shape}")
        sums = np.stack([s[..., 0] + s[..., 1], s[..., 0] - s[..., 1], s[..., 2]], axis=-1)
        rows = np.concatenate([sums, kept], axis=-1)[self._shells]
        if rows.ndim == 3:
            rows = rows[:, None]
        for block, part in enumerate(np.split(rows, np.cumsum(self._counts)[:-1])):
            shape = self._loop.history(block).shape[:3]
            of_block = part.mean(axis=1, keepdims=True) if shape[1] == 1 else part
            layers = np.broadcast_to(of_block, (*shape, part.shape[-1]))
            self._loop.set_layers(block, np.ascontiguousarray(layers))
        self._loop.internal_force = self._loop.trial_force(np.zeros(self._fixed.shape))

    def recover(self, hardens: Array) -> None:
        """Let only a part of the equivalent plastic strain so far harden from now on (n, q, n_points)."""
        state, eqps = self.state(), self.kept_in_layers.behind(STRESS, 3)[EQPS]
        for block, part in enumerate(np.split(hardens[self._shells], np.cumsum(self._counts)[:-1])):
            layers = state[LayerArrays].layers[block]
            layers[..., eqps] *= (part.mean(axis=1, keepdims=True) if layers.shape[1] == 1 else part)[..., None]
        self.take_state(state)

    def released(self) -> tuple[Array, Array]:
        """Return stress_at_points and thickness once tools no longer squeeze the sheet, held in its plane, elastically.

        The pressure q leaves the normal stresses with q nu/(1 - nu) more, and the sheet thicker by q/M, M the modulus
        of constrained compression.
        """
        nu, pressure = self._poisson, self.pressure_at_points
        stress = self.stress_at_points
        stress[..., :2] += (nu / (1.0 - nu))[:, None, None, None] * pressure[:, :, None, None]
        modulus = self._young * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu))
        return stress, self.thickness * (1.0 + self.pressure / modulus)

    @property
    def thickness(self) -> Array:
        """Thickness (n) [mm]."""
        return self._by_shell(self._of_blocks(self._loop.thickness))
