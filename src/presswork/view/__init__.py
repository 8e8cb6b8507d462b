# SPDX-License-Identifier: Apache-2.0
"""Pictures of the results, with matplotlib: pip install "presswork[plot]"."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
