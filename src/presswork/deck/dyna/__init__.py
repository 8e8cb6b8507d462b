# SPDX-License-Identifier: Apache-2.0
"""Decks of LS-DYNA (.k, .key, .dyn): blocks of keywords (blocks.py), what they mean."""
