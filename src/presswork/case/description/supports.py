# SPDX-License-Identifier: Apache-2.0
"""What `presswork check` reports about supports."""

from __future__ import annotations

from presswork import model

NAMES = ("x", "y", "z", "rotation about x", "rotation about y", "rotation about z")


def describe_support(support: model.Support, problem: model.Model) -> str:
    """Describe a support of a solid or a shell."""
    fixed = " and ".join(name for name, fix in zip(NAMES, support.fix, strict=False) if fix)
    count = len(problem.mesh.node_sets[support.node_set])
    return f"support: {fixed} held on {support.node_set} ({count} nodes){name_stages(support, problem)}"


def name_stages(support: model.Support, problem: model.Model) -> str:
    """Return where a support holds, if not in every stage."""
    held = [stage.name for stage in problem.stages if support.name not in stage.released]
    return "" if len(held) == len(problem.stages) else f", in stage {' and '.join(held)} alone"
