"""Runs a command with a time limit, and prints the resources of its process.

    python -I -S launch.py SECONDS COMMAND ...

The last line of standard output is a JSON object. A separate process, started without the site
packages: the peak memory that the system reports of a process includes that of the process that
started it, which is to be small therefore.
"""

import json
import os
import signal
import sys

process = os.posix_spawn(sys.argv[2], sys.argv[2:], os.environ)
signal.signal(signal.SIGALRM, lambda *_: os.kill(process, signal.SIGKILL))
signal.alarm(int(sys.argv[1]))
_, ended, usage = os.wait4(process, 0)
signal.alarm(0)
answer = {
    "status": os.waitstatus_to_exitcode(ended),
    "processor_s": usage.ru_utime + usage.ru_stime,
    "peak_bytes": 1024 * usage.ru_maxrss,
}
sys.stdout.write("\n" + json.dumps(answer) + "\n")
