"""The one exception of this module."""

from __future__ import annotations


class DataError(ValueError):
    """A file or an argument is at fault; the message says which and, where it can, what to do."""
