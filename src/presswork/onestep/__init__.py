# SPDX-License-Identifier: Apache-2.0
"""Inverse one-step analysis: from the finished part back to its blank."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
