"""``python -m fakir``: the command ``fakir``."""

import sys

from ._command import main

sys.exit(main())
