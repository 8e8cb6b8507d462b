# SPDX-License-Identifier: Apache-2.0
"""`material fit`, by the kind of test."""
