# SPDX-License-Identifier: Apache-2.0
"""Derivatives of the history by numbers of the case, beside the run."""
