# SPDX-License-Identifier: Apache-2.0
"""Decks of Abaqus (.inp): keywords with parameters (blocks.py), parts and instances (assembly.py), steps (read.py)."""
