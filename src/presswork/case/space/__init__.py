# SPDX-License-Identifier: Apache-2.0
"""The case of a solid in space, and the way from it to the Model."""
