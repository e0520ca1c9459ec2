"""Compares fakir with its peers, in one command; see README.md.

    python3 bench/run.py                  # everything
    python3 bench/run.py texture --surface-fraction 0.1
    python3 bench/run.py elements
    python3 bench/run.py surfaces
    python3 bench/run.py adhesion
    python3 bench/run.py limits
    python3 bench/run.py viscoelastic
"""

import argparse
import tempfile
from pathlib import Path

import adhesion
import elements
import limits
import surfaces
import texture
import viscoelastic

PARTS = {"texture": texture.run, "elements": elements.run, "surfaces": surfaces.run, "adhesion": adhesion.run,
         "limits": limits.run, "viscoelastic": viscoelastic.run}


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"{' or '.join(PARTS)}; all unless given")
    parser.add_argument("--quick", action="store_true",
                        help="a minute of the smallest problems, once each; the results go to FOLDER/quick")
    parser.add_argument("--folder", type=Path, default=Path(tempfile.gettempdir()) / "fakir-bench",
                        help="where the environment and the problems are put (default: %(default)s)")
    group = parser.add_argument_group("texture")
    group.add_argument("--surface-fraction", type=float, action="append", choices=list(texture.PRESSED),
                       help="only this (repeatable); previous results of the others are kept")
    group.add_argument("--resume", action="store_true", help="keep all runs that are in the table, and do the others")
    group.add_argument("--report", action="store_true", help="measure nothing; write the report and figures again")
    group = parser.add_argument_group("elements and surfaces")
    group.add_argument("--repeats", type=int, default=3)
    group.add_argument("--problem", action="append", default=[], help="only this, such as 'sphere 512' (repeatable)")
    group.add_argument("--no-products", action="store_true")
    options = parser.parse_args()
    unknown = [part for part in options.parts if part not in PARTS]
    if unknown:
        parser.error(f"no part {unknown[0]}: there are {' and '.join(PARTS)}")
    options.folder.mkdir(parents=True, exist_ok=True)
    for part in options.parts or PARTS:
        PARTS[part](options)


if __name__ == "__main__":
    main()
