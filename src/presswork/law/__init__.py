# SPDX-License-Identifier: Apache-2.0
"""The one place where a Model's material becomes a compiled law."""
