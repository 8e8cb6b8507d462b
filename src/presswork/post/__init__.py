# SPDX-License-Identifier: Apache-2.0
"""Evaluation of results: nodal averages, the contact surface and its force, neutral radius, profiles."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
