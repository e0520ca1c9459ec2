"""Times of the convolution, of products with the floor and of one-pillar problems beside what operations and bytes allow at the least."""

import subprocess

import common
from common import RESULTS, log

COMMAND = "python3 bench/run.py limits"
WORDS = """\
# Floors of time, measured

{where}. Command: `{command}`. One thread; the least of several times.

The floor is the longer of two times: all operations at the rate of multiplications and additions in registers, measured just before
in double precision and twice that in single,
and all bytes, every array once, at the rate of a copy of arrays of that size. A transform of length n counts 5 n log2 n
operations, one of real numbers half of that. *Transforms alone*: those of the product, of numbers that stay in the cache, without
anything else; they are the library's. *Floor and tops*: the product of a patch past the transition at a surface fraction of 0.1 with
the tops beside it; by a quadrant of its cells where all is its own mirror image.

{table}
"""


def run(options):
    """Measures, and writes the table."""
    program = common.build("-p", "fakir", "--example", "limits") / "examples" / "limits"
    where = f"{common.versions()}; {common.now()[:10]}; {common.processor()}; load average {common.load_average():.1f}"
    done = subprocess.run([program], check=True, capture_output=True, text=True)
    folder = options.folder / "quick" if options.quick else RESULTS
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "limits.md").write_text(WORDS.format(where=where, command=COMMAND, table=done.stdout.strip()))
    log(f"written: {folder}/limits.md")
