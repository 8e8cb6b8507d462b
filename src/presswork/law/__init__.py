# SPDX-License-Identifier: Apache-2.0
"""The one way from a Model's material to a compiled law."""
