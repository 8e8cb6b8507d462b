# SPDX-License-Identifier: Apache-2.0
"""How the tools of a case move before anything is computed, and where they meet."""

from presswork.case.motion.clashes import find_planes
from presswork.case.motion.plan import mark_ends, plan_motion

__all__ = ["find_planes", "mark_ends", "plan_motion"]
