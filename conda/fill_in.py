"""Prints the recipe of the conda package with the version and the checksum of a source distribution.

    python conda/fill_in.py fakir-0.2.0.tar.gz > recipe.yaml
"""

import hashlib
import re
import sys
from pathlib import Path

RECIPE = Path(__file__).parent / "recipe" / "recipe.yaml"


def filled_in(archive):
    """The recipe for a source distribution; its name contains the version."""
    version = re.fullmatch(r"fakir-(\d+(?:\.\d+)+)\.tar\.gz", archive.name)
    if version is None:
        raise SystemExit(f"{archive.name} is not the name of a source distribution: give fakir-VERSION.tar.gz")
    if not archive.is_file():
        raise SystemExit(f"there is no file {archive}")
    checksum = hashlib.sha256(archive.read_bytes()).hexdigest()
    text = RECIPE.read_text(encoding="utf-8")
    text = re.sub(r'^  version: ".*"$', f'  version: "{version[1]}"', text, flags=re.M)
    text = re.sub(r"^  # Set by .*\n", "", text, flags=re.M)
    return re.sub(r'^  sha256: ".*"$', f'  sha256: "{checksum}"', text, flags=re.M)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    sys.stdout.write(filled_in(Path(sys.argv[1])))
