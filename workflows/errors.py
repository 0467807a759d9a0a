"""The errors that a user can cause; the command line prints each as one sentence."""

from __future__ import annotations


class CaseError(ValueError):
    """A case cannot be used; the message names the file, the key, what is wrong and the remedy."""


class DirectoryError(ValueError):
    """A results directory cannot be used as asked; the message says why and what to do."""
