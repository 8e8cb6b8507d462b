# SPDX-License-Identifier: Apache-2.0
"""Devices that explicit runs compute on: the CPU, an NVIDIA card, and the card's code on the CPU."""

from __future__ import annotations

from typing import Literal, get_args

from presswork import _core
from presswork.explicit.input_checks import ExplicitError

Device = Literal["cpu", "host", "cuda"]
DEVICES: tuple[Device, ...] = get_args(Device)
OLDEST = 80
"""Ten times the least compute capability."""


def refuse(device: Device, lack: str) -> None:
    """Raise ExplicitError: a device does not compute what it lacks."""
    if device != "cpu":
        raise ExplicitError(f'device = {device!r} does not compute {lack}: take device = "cpu"')


def name_device(device: Device) -> str:
    """Return the part of a log line that names the device; empty for the CPU."""
    return {"cpu": "", "host": " by the host build of the code for cards", "cuda": " on the graphics card"}[device]


def check_device(device: Device, loop: _core.SpaceLoop | _core.SpaceLoopSingle) -> None:
    """Raise ExplicitError where a device is not there, or the loop has what it does not compute."""
    if device == "cpu":
        return
    lack = _core.find_device_lack(loop)
    if lack:
        refuse(device, lack)
    if device == "cuda":
        cards, why = _core.list_cuda_cards()
        if cards and cards[0][1] < OLDEST:
            why = f"{cards[0][0]} is too old, it must have compute capability 8.0 or more"
        if why:
            raise ExplicitError(f'device = "cuda": {why}; or take device = "cpu"')


def describe_devices() -> list[tuple[str, str]]:
    """List each device with its description."""
    cards, why = _core.list_cuda_cards()
    rows = [
        ("cpu", "all that explicit runs have, in packs of SIMD width; the default"),
        ("host", "the code for cards on the CPU, a shell at a time: slow, for tests"),
    ]
    for name, capability, memory, free in cards:
        fit = "" if capability >= OLDEST else ", too old: 8.0 is needed"
        wording = f"compute capability {capability / 10:.1f}{fit}, {free * 1e-9:.1f} of {memory * 1e-9:.1f} GB free"
        rows.append(("cuda", f"{name}, {wording}"))
    return rows if cards else [*rows, ("cuda", f"not here: {why or 'there is no NVIDIA card'}")]
