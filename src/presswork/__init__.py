# SPDX-License-Identifier: Apache-2.0
"""presswork: simulate metal forming from a short case file or from Python.

    case = presswork.read_case("upsetting_4cst.toml")
    result = presswork.run(case, "out").result
    force, strain = result.history["punch.force"], result.field("equivalent_plastic_strain", step=-1)

Names are imported when they are first used (`__init__.pyi` lists them), so that a command loads only what it needs.
"""

import importlib
from typing import Any

import lazy_loader

__version__ = "0.2.0"

_find, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> Any:
    """Import a public name, or the compiled module: the build of it that suits this CPU."""
    if name == "_core":
        importlib.import_module("presswork.simd")
        return importlib.import_module("presswork._core")
    return _find(name)
