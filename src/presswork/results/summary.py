# SPDX-License-Identifier: Apache-2.0
"""summary.json: how the run went, in strict JSON."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from presswork.results.whole_file import write_whole


def write_summary(path: Path | str, summary: Mapping[str, Any]) -> None:
    """Replace the summary. Numpy numbers and arrays become numbers and lists, NaN and infinity null, paths text."""
    path = Path(path)
    content = (json.dumps(_strict(summary), indent=2, allow_nan=False, ensure_ascii=False) + "\n").encode()
    write_whole(path, content)


def _strict(value: Any) -> Any:
    """Return the value in terms that strict JSON knows."""
    if isinstance(value, (np.generic, np.ndarray)):
        value = value.tolist()
    if isinstance(value, Mapping):
        return {str(key): _strict(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_strict(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return str(value) if isinstance(value, Path) else value
