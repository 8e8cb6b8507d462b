# SPDX-License-Identifier: Apache-2.0
"""Let the long runs use the set-up of the fast verification tests."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "verification"))
