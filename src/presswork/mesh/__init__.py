# SPDX-License-Identifier: Apache-2.0
"""Meshes of the workpiece: structured generators and readers of mesh files."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
