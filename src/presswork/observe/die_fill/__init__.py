# SPDX-License-Identifier: Apache-2.0
"""How far dies with a flash land are filled, and how thick the flash is."""

from presswork.model import Model
from presswork.observe.die_fill.dies import DieFill
from presswork.observe.die_fill.plane import DieFillInPlane
from presswork.observe.die_fill.space import DieFillInSpace


def make_die_fill(model: Model) -> DieFill:
    """Return what measures the dies of a model; it has none where there is no cavity, or where sheet is formed."""
    return DieFillInSpace(model) if model.space_tools and model.analysis == "solid" else DieFillInPlane(model)
