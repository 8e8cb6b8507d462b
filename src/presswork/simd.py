# SPDX-License-Identifier: Apache-2.0
"""Which build of the compiled module is loaded.

Built for one machine (the default) the package holds `_core` alone. Built with `PRESSWORK_ARCH=portable` it holds one
build for each of x86-64-v2 (SSE4), v3 (AVX2) and v4 (AVX-512): the highest that the CPU has becomes `presswork._core`,
or the one that the environment variable PRESSWORK_SIMD names. Importing this module does that.
"""

from __future__ import annotations

import importlib.util
import os
import sys
from collections.abc import Sequence

from presswork.threads import limit_spinning

VARIABLE = "PRESSWORK_SIMD"
LEVELS = (2, 3, 4)


def choose(available: Sequence[int], level: int, wanted: str | None = None) -> int:
    """Give the level of the build to load on a CPU of this level; `wanted` forces one, as x86-64-v3.

    Raises ImportError when the CPU or the package does not have it.

    >>> choose((2, 3, 4), level=3)
    3
    """
    fit = [one for one in available if one <= level]
    if wanted is not None:
        names = {f"x86-64-v{one}": one for one in available}
        if wanted not in names:
            raise ImportError(
                f"{VARIABLE}={wanted}: this build of presswork has {', '.join(names) or 'one for one CPU'}"
            )
        if names[wanted] not in fit:
            raise ImportError(f"{VARIABLE}={wanted}: this CPU has x86-64-v{level} at most")
        return names[wanted]
    if not fit:
        raise ImportError(
            f"this CPU has x86-64-v{level}, presswork needs x86-64-v{min(available)}: build it from source"
        )
    return max(fit)


def load_core() -> None:
    """Make the build that suits the CPU `presswork._core`, unless the package was built for one machine."""
    wanted = os.environ.get(VARIABLE)
    found = {level: importlib.util.find_spec(f"presswork._core_v{level}") for level in LEVELS}
    specs = {level: spec.origin for level, spec in found.items() if spec is not None and spec.origin is not None}
    if not specs:
        if wanted is not None:
            choose((), 0, wanted)
        return
    from presswork import _cpu

    origin = specs[choose(sorted(specs), _cpu.level(), wanted)]
    # the init function in the file is that of the name, _core
    spec = importlib.util.spec_from_file_location("presswork._core", origin)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["presswork._core"] = module
    spec.loader.exec_module(module)


limit_spinning(os.environ)  # before the first module that brings GCC's OpenMP runtime
load_core()
