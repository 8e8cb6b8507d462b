# SPDX-License-Identifier: Apache-2.0
"""Families of cases: sweeps in parallel processes, friction from a ring test, and the shape of a blank."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
