"""Makes the archive of the command for one system: program, manual pages, completions, licences, a list of components, and a script that
installs all of it by copying files.

    python release/archive.py --program target/release/fakir --target x86_64-unknown-linux-gnu --output dist

Writes `fakir-VERSION-TARGET.tar.gz` (`.zip` for Windows), a file `.sha256` next to it for `sha256sum --check`, and the list of components as
`fakir-VERSION-TARGET.cdx.json` (CycloneDX 1.5). The same inputs give the same files, byte for byte: times are those of the last commit, or of
SOURCE_DATE_EPOCH. Needs Python 3.11 and cargo, no packages.
"""

import argparse
import gzip
import hashlib
import io
import json
import os
import re
import subprocess
import tarfile
import tomllib
import uuid
import zipfile
from datetime import UTC, datetime
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LICENCES = ["LICENSE-MIT", "LICENSE-APACHE"]
DOCUMENTS = ["README.md", "CHANGELOG.md", "CITATION.cff"]
# Where shells look for completions, below a prefix such as /usr/local.
COMPLETIONS = {
    "bash": "share/bash-completion/completions/fakir",
    "zsh": "share/zsh/site-functions/_fakir",
    "fish": "share/fish/vendor_completions.d/fakir.fish",
    "elvish": "share/elvish/lib/fakir.elv",
    "powershell": "share/fakir/fakir.ps1",
}
# Files with licences of a crate, in its folder.
LICENCE_FILE = re.compile(r"(?i)^(licen[cs]e|copying|copyright|notice|unlicense)([-_.].*)?$")


def output(*command):
    return subprocess.run(command, cwd=ROOT, check=True, capture_output=True).stdout


def version():
    return tomllib.loads((ROOT / "Cargo.toml").read_text(encoding="utf-8"))["workspace"]["package"]["version"]


def time():
    """Seconds since 1970 of everything in the archive."""
    given = os.environ.get("SOURCE_DATE_EPOCH")
    return int(given or output("git", "log", "-1", "--format=%ct"))


def components(target, features):
    """The crates that are linked into the command for a system: their metadata, without the command itself."""
    options = ["--format-version", "1", "--locked", "--filter-platform", target, "--manifest-path", "crates/fakir-cli/Cargo.toml"]
    if features:
        options += ["--features", features]
    metadata = json.loads(output("cargo", "metadata", *options))
    packages = {package["id"]: package for package in metadata["packages"]}
    nodes = {node["id"]: node for node in metadata["resolve"]["nodes"]}
    program = next(key for key, package in packages.items() if package["name"] == "fakir-cli")
    needed, waiting = {}, [program]
    while waiting:
        key = waiting.pop()
        if key in needed:
            continue
        # Neither what only tests or builds need, nor what runs within the compiler, is part of the program.
        linked = [
            dependency["pkg"]
            for dependency in nodes[key]["deps"]
            if any(kind["kind"] is None for kind in dependency["dep_kinds"])
            and not any("proc-macro" in part["kind"] for part in packages[dependency["pkg"]]["targets"])
        ]
        needed[key] = linked
        waiting += linked
    return program, packages, needed


def reference(package):
    """The package URL of a crate."""
    return f"pkg:cargo/{package['name']}@{package['version']}"


def bill_of_materials(target, features):
    """The list of components as CycloneDX 1.5."""
    program, packages, needed = components(target, features)
    locked = tomllib.loads((ROOT / "Cargo.lock").read_text(encoding="utf-8"))["package"]
    checksums = {(package["name"], package["version"]): package.get("checksum") for package in locked}

    def component(key):
        package = packages[key]
        found = {
            "type": "application" if key == program else "library",
            "bom-ref": reference(package),
            "name": package["name"],
            "version": package["version"],
            "purl": reference(package),
        }
        if package.get("description"):
            found["description"] = " ".join(package["description"].split())
        if package.get("license"):
            # Two crates write "MIT/Apache-2.0", the former form of a choice.
            found["licenses"] = [{"expression": package["license"].replace("/", " OR ")}]
        checksum = checksums.get((package["name"], package["version"]))
        if checksum:
            found["hashes"] = [{"alg": "SHA-256", "content": checksum}]
        if package.get("repository"):
            found["externalReferences"] = [{"type": "vcs", "url": package["repository"]}]
        return found

    keys = sorted((key for key in needed if key != program), key=lambda key: reference(packages[key]))
    listed = {
        "$schema": "http://cyclonedx.org/schema/bom-1.5.schema.json",
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": {
            "timestamp": datetime.fromtimestamp(time(), UTC).strftime("%Y-%m-%dT%H:%M:%SZ"),
            "component": component(program),
            "properties": [{"name": "target", "value": target}],
        },
        "components": [component(key) for key in keys],
        "dependencies": [
            {"ref": reference(packages[key]), "dependsOn": sorted({reference(packages[linked]) for linked in needed[key]})}
            for key in [program, *keys]
        ],
    }
    # The same contents have the same number.
    contents = json.dumps(listed, sort_keys=True)
    listed["serialNumber"] = f"urn:uuid:{uuid.uuid5(uuid.NAMESPACE_URL, contents)}"
    return json.dumps(listed, indent=2, ensure_ascii=False) + "\n"


def third_party_licences(target, features):
    """The licences of all crates that are linked into the program, as one text."""
    program, packages, needed = components(target, features)
    # Equal texts are printed once, with all crates that have them.
    texts = {}
    lines = ["fakir contains the following libraries, under the licences named and printed below.", ""]
    for key in sorted(needed, key=lambda key: reference(packages[key])):
        package = packages[key]
        if package["source"] is None:
            continue
        name = f"{package['name']} {package['version']}"
        lines.append(f"{name}: {package['license'] or 'see the text'}")
        folder = Path(package["manifest_path"]).parent
        for path in sorted(folder.iterdir()):
            if path.is_file() and LICENCE_FILE.match(path.name):
                text = path.read_text(encoding="utf-8", errors="replace").strip()
                texts.setdefault(text, []).append(f"{name} ({path.name})")
    for text, names in sorted(texts.items(), key=lambda item: item[1]):
        lines += ["", "-" * 80, ", ".join(names), "-" * 80, "", text]
    return "\n".join(lines) + "\n"


def commands(program):
    """The names of all commands, from the help of the program."""
    text = output(str(program), "help").decode()
    listed = text.split("Commands:", 1)[1].split("\n\n", 1)[0]
    return [name for name in re.findall(r"^  ([a-z-]+)", listed, re.M) if name != "help"]


def contents(program, target, features):
    """The files of the archive by their paths, each with its contents and whether it is executable."""
    name = "fakir.exe" if "windows" in target else "fakir"
    files = {f"bin/{name}": (program.read_bytes(), True)}
    files["share/man/man1/fakir.1"] = (output(str(program), "man"), False)
    for command in commands(program):
        files[f"share/man/man1/fakir-{command}.1"] = (output(str(program), "man", command), False)
    for shell, path in COMPLETIONS.items():
        files[path] = (output(str(program), "completions", shell), False)
    for document in [*LICENCES, *DOCUMENTS]:
        files[f"share/doc/fakir/{document}"] = ((ROOT / document).read_bytes(), False)
    for example in output("git", "ls-files", "examples").decode().split():
        files[f"share/doc/fakir/{example}"] = ((ROOT / example).read_bytes(), False)
    files["share/doc/fakir/fakir.schema.json"] = (output(str(program), "init", "--schema"), False)
    files["share/doc/fakir/THIRD-PARTY-LICENCES.txt"] = (third_party_licences(target, features).encode(), False)
    files["share/doc/fakir/fakir.cdx.json"] = (bill_of_materials(target, features).encode(), False)
    installer = "install.ps1" if "windows" in target else "install.sh"
    files[installer] = ((ROOT / "release" / installer).read_bytes(), True)
    return files


def packed_tar(folder, files, when):
    unpacked = io.BytesIO()
    with tarfile.open(fileobj=unpacked, mode="w", format=tarfile.USTAR_FORMAT) as archive:
        for path in sorted(files):
            data, executable = files[path]
            entry = tarfile.TarInfo(f"{folder}/{path}")
            entry.size, entry.mtime, entry.mode = len(data), when, 0o755 if executable else 0o644
            archive.addfile(entry, io.BytesIO(data))
    return gzip.compress(unpacked.getvalue(), mtime=when)


def packed_zip(folder, files, when):
    packed = io.BytesIO()
    moment = datetime.fromtimestamp(when, UTC).timetuple()[:6]
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for path in sorted(files):
            entry = zipfile.ZipInfo(f"{folder}/{path}", moment)
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, files[path][0])
    return packed.getvalue()


def make(program, target, features, folder):
    """Writes the archive, its checksum and the list of components; returns the path of the archive."""
    name = f"fakir-{version()}-{target}"
    files = contents(program, target, features)
    windows = "windows" in target
    data = (packed_zip if windows else packed_tar)(name, files, time())
    folder.mkdir(parents=True, exist_ok=True)
    archive = folder / f"{name}{'.zip' if windows else '.tar.gz'}"
    archive.write_bytes(data)
    checksum = hashlib.sha256(data).hexdigest()
    (folder / f"{archive.name}.sha256").write_text(f"{checksum}  {archive.name}\n", encoding="utf-8", newline="\n")
    (folder / f"{name}.cdx.json").write_bytes(files["share/doc/fakir/fakir.cdx.json"][0])
    return archive


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, required=True)
    parser.add_argument("--target", required=True, help="name of the system, as rustc has it")
    parser.add_argument("--features", default="", help="features with which the program was built")
    parser.add_argument("--output", type=Path, required=True)
    given = parser.parse_args()
    if not given.program.is_file():
        parser.error(f"there is no program {given.program}: build it with cargo build --release --package fakir-cli")
    print(make(given.program.resolve(), given.target, given.features, given.output))
