# SPDX-License-Identifier: Apache-2.0
"""The kinds of case, distinguished by `analysis`: the class and the builder of each, by name.

A new kind is an entry of KINDS. Its class needs the key `analysis`, a Literal of words that no other kind uses. Class
and builder are imported when a case of that kind is read, so a run does not wait for the schemas of all others.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Kind:
    """A kind of case, by names alone."""

    analyses: tuple[str, ...]
    """Values of `analysis` that make a case of this kind: those of the Literal in its class."""
    place: str
    """Module and name of its class, as "module:name"."""
    builder: str
    """Module and name of what makes a Model of it."""
    has_laws: bool = True
    """Whether its materials have laws of deformation, which may be in shared libraries."""

    @property
    def name(self) -> str:
        """Name of its class."""
        return self.place.partition(":")[2]


KINDS = {
    "plane": Kind(
        ("axisymmetric", "plane_strain"),
        "presswork.case.plane.schema:Case",
        "presswork.case.plane.builder:build_plane_model",
    ),
    "solid": Kind(
        ("solid",), "presswork.case.space.schema:SpaceCase", "presswork.case.space.builder:build_space_model"
    ),
    "shell": Kind(
        ("shell",), "presswork.case.shell.schema:ShellCase", "presswork.case.shell.builder:build_shell_model"
    ),
    "stamping": Kind(
        ("stamping",),
        "presswork.case.stamping.schema:StampingCase",
        "presswork.case.stamping.builder:build_stamping_model",
    ),
    "heat": Kind(
        ("heat",),
        "presswork.case.heat.schema:HeatCase",
        "presswork.case.heat.builder:build_heat_model",
        has_laws=False,
    ),
    "onestep": Kind(
        ("onestep",),
        "presswork.case.onestep.schema:OneStepCase",
        "presswork.case.onestep.schema:build_onestep_model",
        has_laws=False,
    ),
}
"""Kinds of case by the names that `presswork schema` accepts."""


def find_kind(analysis: object) -> Kind | None:
    """Return the kind that a value of `analysis` makes, or None."""
    return next((kind for kind in KINDS.values() if analysis in kind.analyses), None)
