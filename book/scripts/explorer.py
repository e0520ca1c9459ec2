"""A picture of the explorer, of a case of the examples: python explorer.py FILE

Prints nothing if all is well. Needs Chromium: its name is in the environment variable CHROMIUM.
"""

import os
import subprocess
import sys

serve = ["fakir", "explore", "examples/paper-intermediate.toml", "--no-browser", "--quiet"]
with subprocess.Popen(serve, stderr=subprocess.PIPE, text=True) as server:
    try:
        address = next(word for line in server.stderr for word in line.split() if word.startswith("http"))
        subprocess.run(
            [
                os.environ.get("CHROMIUM", "chromium"),
                *["--headless", "--no-sandbox", "--hide-scrollbars", "--window-size=1400,900"],
                *["--virtual-time-budget=20000", f"--screenshot={os.path.abspath(sys.argv[1])}", address],
            ],
            check=True,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            timeout=120,
        )
    finally:
        server.terminate()
