"""Common parts: the environment of the peers, the programs, versions, the machine."""

import json
import os
import platform
import subprocess
import sys
import venv
from datetime import datetime, timezone
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
RESULTS = HERE / "results"
PEERS = ["ContactMechanics", "Tamaas"]


def log(text):
    print(text, file=sys.stderr, flush=True)


def settings(threads):
    """Environment variables that set the number of threads."""
    names = ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"]
    return {**os.environ, **{name: str(threads) for name in names}}


def environment(folder):
    """The Python of an environment with the pinned peers."""
    python = folder / "environment"
    if not python.exists():
        venv.create(python, with_pip=True)
    python = python / "bin" / "python"
    requirements = HERE / "requirements.txt"
    subprocess.run([python, "-m", "pip", "install", "-q", "-r", requirements], check=True)
    return python


def build(*what):
    """Builds fakir in release, and returns the folder of the program."""
    log("building fakir")
    subprocess.run(["cargo", "build", "--release", "--locked", "-q", *what], cwd=ROOT, check=True)
    return Path(metadata()["target_directory"]) / "release"


def metadata():
    command = ["cargo", "metadata", "--format-version", "1", "--no-deps", "--locked"]
    done = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True)
    return json.loads(done.stdout)


def output_of(*command):
    try:
        return subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return ""


def fakir_version():
    """Version with the commit, and a plus if a source file differs from the commit."""
    number = next(p["version"] for p in metadata()["packages"] if p["name"] == "fakir")
    commit = output_of("git", "rev-parse", "--short=10", "HEAD")
    changed = output_of("git", "status", "--porcelain", "--", "crates", "Cargo.toml", "Cargo.lock")
    return f"{number} ({commit}{'+' if changed else ''})" if commit else number


def pinned():
    """Versions of the peers, by their names."""
    lines = (HERE / "requirements.txt").read_text().split()
    numbers = {name.lower(): number for name, number in (line.split("==") for line in lines)}
    return {peer: numbers[peer.lower()] for peer in PEERS}


def versions():
    pinned = (HERE / "requirements.txt").read_text().split()
    compiler = " ".join(output_of("rustc", "--version").split()[:2])
    python = platform.python_version()
    return f"fakir {fakir_version()} ({compiler}), Python {python}, " + ", ".join(pinned)


def processor():
    with open("/proc/cpuinfo") as lines:
        names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return f"{len(names)} processors {names[0]}" if names else f"{os.cpu_count()} processors"


def load_average():
    """Load average of the machine over the last minute."""
    return round(os.getloadavg()[0], 2)


def now():
    return datetime.now(timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
