# SPDX-License-Identifier: Apache-2.0
"""The state of a sheet as arrays under names, for a checkpoint, and back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.process.mesh_change.transfer import SheetBlock, SheetState

POSITION, HEATED, BLOCK, EVOLVED = "position", "heated.", "block.", "evolved"


def dump_sheet(state: SheetState) -> dict[str, NDArray[np.generic]]:
    """Return the arrays of a sheet."""
    arrays: dict[str, NDArray[Any]] = {POSITION: state.position}
    arrays |= {f"{HEATED}{name}": values for name, values in state.heated.items()}
    for i, block in enumerate(state.blocks):
        for each in fields(SheetBlock):
            values = getattr(block, each.name)
            if each.name == EVOLVED:
                arrays |= {f"{BLOCK}{i}.{EVOLVED}.{name}": own for name, own in values.items()}
            elif values is not None:
                arrays[f"{BLOCK}{i}.{each.name}"] = values
    return arrays


def load_sheet(arrays: Mapping[str, NDArray[Any]]) -> SheetState:
    """Return the sheet that dump_sheet gave."""
    blocks: list[SheetBlock] = []
    while own := _under(arrays, f"{BLOCK}{len(blocks)}."):
        evolved = _under(own, f"{EVOLVED}.")
        plain = {name: values for name, values in own.items() if not name.startswith(f"{EVOLVED}.")}
        blocks.append(SheetBlock(evolved=evolved, **plain))
    return SheetState(arrays[POSITION], tuple(blocks), _under(arrays, HEATED))


def _under(arrays: Mapping[str, NDArray[Any]], prefix: str) -> dict[str, NDArray[Any]]:
    return {name.removeprefix(prefix): values for name, values in arrays.items() if name.startswith(prefix)}
