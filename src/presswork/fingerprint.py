# SPDX-License-Identifier: Apache-2.0
"""The digest by which a checkpoint knows the Model that it belongs to."""

from __future__ import annotations

import hashlib
import sys
from dataclasses import fields

import numpy as np

from presswork.model import Model

_NOT_COMPUTED_WITH = ("title", "output", "case_text", "mesh", "limits")


def fingerprint(model: Model) -> str:
    """Return a digest of what a checkpoint depends on: everything but the title and what is saved."""
    digest = hashlib.sha256()
    with np.printoptions(threshold=sys.maxsize, floatmode="unique"):
        digest.update(f"{_save_points(model)!r}".encode())
        for part in fields(model):
            if part.name not in _NOT_COMPUTED_WITH:
                digest.update(f"{part.name} {getattr(model, part.name)!r}".encode())
    digest.update(np.ascontiguousarray(model.mesh.points).tobytes())
    if model.mesh.normals is not None:
        digest.update(np.ascontiguousarray(model.mesh.normals).tobytes())
    for block in model.mesh.blocks:
        section = repr(block.section).encode() if block.section else b""
        digest.update(block.element.encode() + section + np.ascontiguousarray(block.connectivity).tobytes())
        if block.zone or block.rolling:
            digest.update(f"{block.zone} {block.material} {block.rolling}".encode())
        if block.own_thickness is not None:
            digest.update(np.ascontiguousarray(block.own_thickness).tobytes())
    return digest.hexdigest()


def _save_points(model: Model) -> object:
    """Return the output settings that change the implicit procedure's increments, which end where a step is saved."""
    if model.explicit is not None:
        return None
    steps = 0 if model.output.every else model.output.steps
    return steps, tuple(float(part) for part in model.output.at)
