# SPDX-License-Identifier: Apache-2.0
"""Derivatives that a run finds as it goes: of which columns of its history, by which numbers of its case."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from presswork.model.model import Model


@dataclass(frozen=True)
class Parameter:
    """A number of the case."""

    key: str
    """Its path in the case, for instance tools.punch.m."""
    value: float
    """Value in the units of the Model: mm, s, N, MPa."""
    step: float
    """Difference of the number in the two models: less in the one, more in the other."""
    less: Model | None
    """None: the run itself stands for it, in differences to one side."""
    more: Model


@dataclass(frozen=True)
class Gradients:
    """What a run differentiates."""

    of: tuple[str, ...]
    """Columns of history.csv; empty: the forces of all tools."""
    by: tuple[Parameter, ...]
