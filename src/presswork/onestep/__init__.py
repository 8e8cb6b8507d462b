# SPDX-License-Identifier: Apache-2.0
"""From the finished part back to its blank: the run, its files and pictures, and the command line."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
