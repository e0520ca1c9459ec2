"""The command ``fakir``: ``fakir`` and ``python -m fakir``."""

from __future__ import annotations

import sys

from . import _fakir


def main() -> int:
    """Runs the command with the arguments of this process; returns its exit status."""
    return _fakir.command(["fakir", *sys.argv[1:]])
