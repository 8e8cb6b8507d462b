# SPDX-License-Identifier: Apache-2.0
"""Decks of OpenRadioss (.rad): blocks (blocks.py), groups of nodes and parts (groups.py), the starter (read.py) and the
engine (engine.py).
"""
