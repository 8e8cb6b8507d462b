# SPDX-License-Identifier: Apache-2.0
"""The case: schema, units, reading of case files, and the builders that turn a case into a Model."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
