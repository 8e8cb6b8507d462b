# SPDX-License-Identifier: Apache-2.0
"""Properties that every element, law and contact has."""
