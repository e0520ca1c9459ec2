"""Prints every test of Rust with its processor time, slowest first: `cargo xtask test times`.

    python tests/times.py PROGRAM FOLDER NAME [PROGRAM FOLDER NAME ...]

Runs each test of the programs in a separate process with one thread, so that a result that several tests share counts for
each of them. Tests of the second tier (marked `ignore`) are printed with a star; campaigns, which are run by hand, are left out.
"""

import os
import subprocess
import sys

# Seconds of processor time above which a test of the first tier is pointed out.
LIMIT = 2.0


def names(program, folder, *options):
    listed = subprocess.run([program, "--list", *options], cwd=folder, capture_output=True, text=True, check=True)
    return [line.removesuffix(": test") for line in listed.stdout.splitlines() if line.endswith(": test")]


def seconds(program, folder, name):
    """Processor time of a test and its children, and its exit status."""
    environment = os.environ | {"RAYON_NUM_THREADS": "1", "RUST_TEST_THREADS": "1"}
    command = [program, "--exact", name, "--include-ignored"]
    with subprocess.Popen(command, cwd=folder, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as run:
        _, status, usage = os.wait4(run.pid, 0)
        run.returncode = os.waitstatus_to_exitcode(status)
    return usage.ru_utime + usage.ru_stime, run.returncode


def main(arguments):
    rows = []
    for program, folder, crate in zip(*[iter(arguments)] * 3, strict=True):
        slow = set(names(program, folder, "--ignored"))
        for name in names(program, folder, "--skip", "campaign_of_"):
            time, status = seconds(program, folder, name)
            rows.append((time, name in slow, f"{crate} {name}" + ("" if status == 0 else f" FAILED ({status})")))
    rows.sort(reverse=True)
    for time, slow, name in rows:
        print(f"{time:8.2f} s{'*' if slow else ' '} {name}")
    first = [time for time, slow, _ in rows if not slow]
    print(f"{sum(first):8.2f} s  {len(first)} tests of the first tier")
    print(f"{sum(time for time, slow, _ in rows if slow):8.2f} s* {len(rows) - len(first)} tests of the second tier")
    over = [name for time, slow, name in rows if not slow and time > LIMIT]
    print(f"{len(over)} tests of the first tier take more than {LIMIT:.0f} s" + "".join(f"\n    {name}" for name in over))


if __name__ == "__main__":
    main(sys.argv[1:])
