# SPDX-License-Identifier: Apache-2.0
"""A loop of the core whose state is on a device between calls, and is taken back only where it is looked at."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from presswork import _core
from presswork.explicit.device import Device, check_device
from presswork.explicit.input_checks import ExplicitError

Array = npt.NDArray[np.float64]
State = dict[str, dict[str, Array]]
Part = _core.DevicePart
ALL = (Part.places, Part.nodes, Part.sums, Part.reaction, Part.elements, Part.damage, Part.contact)
PRESENT = {
    *("tool_state", "lost_point", "drive_tool", "drive_bead", "bead_restraint", "element_mass", "inverse_mass"),
    *("true_mass", "added_mass", "seconds", "edge_nodes", "ironing"),
    *("wall_offset", "wall_angle", "wall_travel", "wall_impulse"),
}
"""Attributes of a loop that are present in it after every call, or that a call takes along."""
LOOKS_AT: dict[str, tuple[_core.DevicePart, ...]] = {
    "position": (Part.places,),
    "velocity": (Part.nodes,),
    "internal_force": (Part.nodes,),
    "reaction_impulse": (Part.reaction,),
    "contact_force": (Part.contact,),
    "force_of_tool": (Part.contact,),
    "wall_force": (Part.contact,),
    "wall_pressed": (Part.sums,),
    "wall_rubbed": (Part.sums,),
    "stress": (Part.elements,),
    "history": (Part.elements,),
    "pressure": (Part.elements,),
    "damage": (Part.damage,),
    "bound_frequencies": (Part.places, Part.elements),
    "trial_force": (Part.places, Part.nodes, Part.elements),
    "state": ALL,
}
"""What an attribute that only looks reads. Any other may change the loop: all is taken back, and there again."""
MEASURES: dict[str, tuple[_core.DevicePart, ...]] = {
    "thickness": (),
    "point_measures": (),
    "deepest": (Part.places,),
}
"""The same of those that need a few rows of the elements' state alone."""
MOVES_WALLS = {"move_wall", "push_wall", "float_wall", "hold_wall"}
SETS = {"set_temperature", "limit_wall_friction"}
HOST_MEMORY = 1e15
"""Memory of the host build [bytes]."""
SESSIONS: dict[type, type[_core.DeviceSession] | type[_core.DeviceSessionSingle]] = {
    _core.SpaceLoop: _core.DeviceSession,
    _core.SpaceLoopSingle: _core.DeviceSessionSingle,
}


@dataclass(frozen=True)
class Traffic:
    """Copies of arrays between the loop's memory and that of a device."""

    sends: int = 0
    sent: float = 0.0
    """[bytes]"""
    fetches: int = 0
    fetched: float = 0.0
    """[bytes]"""

    def __add__(self, other: Traffic) -> Traffic:
        return Traffic(
            self.sends + other.sends,
            self.sent + other.sent,
            self.fetches + other.fetches,
            self.fetched + other.fetched,
        )


class ResidentLoop:
    """Has the attributes of the loop, and computes its cycles on a device.

    Raises ExplicitError where the device does not compute what the loop has, or has too little memory.
    """

    def __init__(self, loop: _core.SpaceLoop | _core.SpaceLoopSingle, device: Device) -> None:
        self.__dict__.update(loop=loop, device=device, _session=None, _fresh=set(), _past=Traffic(), _kept=None)

    loop: Any
    device: Device
    _session: Any
    _fresh: set[object]
    """Parts that have been taken back since the last call."""
    _past: Traffic
    _kept: State | str | None
    """The state that was kept; "there": on the device."""

    def __getattr__(self, name: str) -> Any:
        if name in PRESENT or self._session is None:
            return getattr(self.loop, name)
        if name in MOVES_WALLS | SETS | {"begin_wall_sums"}:
            return partial(self._change, name)
        if name in MEASURES:
            self._fetch_measures()
            self._fetch(MEASURES[name])
        elif name in LOOKS_AT:
            self._fetch(LOOKS_AT[name])
        else:
            self._leave()
        return getattr(self.loop, name)

    def __setattr__(self, name: str, value: Any) -> None:
        if name in self.__dict__:
            self.__dict__[name] = value
        elif name == "reaction_impulse" and self._session is not None and not value.any():
            self.loop.reaction_impulse = value
            self._session.clear_reaction()
            self._fresh.add(Part.reaction)
        else:
            self._leave()
            setattr(self.loop, name, value)

    def enter(self) -> Any:
        """Take the loop to the device, if it is not there; return its session."""
        if self._session is None:
            check_device(self.device, self.loop)
            target = _core.Device[self.device]
            try:
                self._session = SESSIONS[type(self.loop)](self.loop, target, HOST_MEMORY)
            except RuntimeError as error:
                raise ExplicitError(f"device = {self.device!r}: {error}") from None
            self._fresh = {*ALL, "measures"}
        return self._session

    def _fetch(self, parts: tuple[_core.DevicePart, ...]) -> None:
        for part in parts:
            if part not in self._fresh:
                self._session.fetch(part)
                self._fresh.add(part)

    def _fetch_measures(self) -> None:
        if not self._fresh & {Part.elements, "measures"}:
            self._session.fetch_measures()
            self._fresh.add("measures")

    def _change(self, name: str, *args: Any, **how: Any) -> None:
        """Call what changes little of the loop, and take only that to the device."""
        if name == "begin_wall_sums":
            self._fetch((Part.sums,))
        getattr(self.loop, name)(*args, **how)
        if name == "begin_wall_sums":
            self._session.send_sums()
        elif name in MOVES_WALLS:
            self._session.send_walls()
        elif not self._session.send_given():
            self._leave()

    def _leave(self) -> None:
        """Take all back: the loop is about to be changed."""
        if self._session is None:
            return
        self._fetch(ALL)
        if self._kept == "there":
            self._kept = self._take_kept()
        self._past = self.traffic
        self._session = None

    def advance(
        self,
        time: float,
        dt: float,
        dt_before: float,
        force_scale: Array,
        velocity_scale: Array,
        *,
        damping: float = 0.0,
    ) -> tuple[int, _core.LawStatus, int]:
        """Advance a cycle for each scale; return the element that has failed, why, and in which cycle; -1: none has."""
        session = self.enter()
        self._fresh.clear()
        try:
            found: tuple[int, _core.LawStatus, int] = session.advance(
                dt, dt_before, force_scale, velocity_scale, damping=damping
            )
        except RuntimeError as error:
            raise ExplicitError(f"device = {self.device!r}: {error}") from None
        return found

    @property
    def is_finite(self) -> bool:
        """Whether the last call has left all places finite."""
        return self._session is not None and bool(self._session.is_finite)

    @property
    def traffic(self) -> Traffic:
        """Copies so far."""
        return self._past if self._session is None else self._past + Traffic(*self._session.traffic)

    def measure_energies(self, dt: float, dt_before: float, **scales: float) -> _core.Energies:
        """Give the energies as the device sums them up."""
        found: _core.Energies = self.enter().energies(dt, dt_before, **scales)
        return found

    def measure_frequency(self) -> float:
        """Give the largest bound of an element's squared frequency [1/s2] as the device finds it."""
        return float(self.enter().bound_frequency())

    def keep(self) -> Callable[[], State]:
        """Keep the present state on the device; return what gives it, until it is asked again."""
        self.enter().keep()
        self._kept = "there"
        return self._return_kept

    def _return_kept(self) -> State:
        self._leave()
        assert isinstance(self._kept, dict)
        return self._kept

    def _take_kept(self) -> State:
        """Return what was kept; the loop, which has the present state, has it again in the end."""
        present = self.loop.state()
        self._session.put_back()
        for part in set(ALL) - {Part.reaction, Part.sums}:  # these are no part of the state
            self._session.fetch(part)
        kept: State = self.loop.state()
        self.loop.restore(present)
        return kept
