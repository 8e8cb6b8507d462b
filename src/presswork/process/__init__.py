# SPDX-License-Identifier: Apache-2.0
"""Stages in turn: forming, impact, trimming, springback, refinement, transfer; and what is recorded of them."""
