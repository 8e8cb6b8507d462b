# SPDX-License-Identifier: Apache-2.0
"""The output folder: written by a run, a whole file at a time, and read back by `Result`."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
