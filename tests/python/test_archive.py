"""The archive of the command: its script only copies files, and the program runs from them in an empty root."""

import gzip
import hashlib
import importlib.util
import json
import os
import platform
import re
import shutil
import subprocess
import tarfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
RELEASE = ROOT / "release"
pytestmark = pytest.mark.skipif(os.name == "nt", reason="the script of installation is for shells")
TARGET = f"{platform.machine()}-{'apple-darwin' if platform.system() == 'Darwin' else 'unknown-linux-gnu'}".replace("arm64-apple", "aarch64-apple")


def install(folder, *arguments, **environment):
    """Runs the script of an unpacked archive with no environment but this."""
    return subprocess.run(
        ["sh", str(folder / "install.sh"), *map(str, arguments)],
        env={"PATH": "/usr/bin:/bin", **environment},
        cwd=folder.parent,
        capture_output=True,
        text=True,
    )


@pytest.fixture
def small(tmp_path):
    """An unpacked archive with three files, in a folder whose name contains a blank."""
    folder = tmp_path / "an archive"
    for name, text in [("bin/fakir", "#!/bin/sh\necho one\n"), ("share/man/man1/fakir.1", ".TH"), ("share/doc/fakir/a b.txt", "x")]:
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    shutil.copy(RELEASE / "install.sh", folder)
    return folder


def files(folder):
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())


COPIED = ["bin/fakir", "share/doc/fakir/a b.txt", "share/fakir/installed.txt", "share/man/man1/fakir.1"]


def test_the_script_copies_files_and_lists_them(small, tmp_path):
    place = tmp_path / "usr local"
    done = install(small, place)
    assert done.returncode == 0, done.stderr
    assert "PATH" in done.stdout
    assert files(place) == COPIED
    program = place / "bin" / "fakir"
    assert subprocess.run([program], capture_output=True, text=True).stdout == "one\n"
    # An older version is replaced, and other files stay.
    (place / "bin" / "other").write_text("mine")
    (small / "bin" / "fakir").write_text("#!/bin/sh\necho two\n")
    assert install(small, place).returncode == 0
    assert subprocess.run([program], capture_output=True, text=True).stdout == "two\n"
    # Removing the files of the list uninstalls it.
    for line in (place / "share" / "fakir" / "installed.txt").read_text().splitlines():
        Path(line).unlink()
    assert files(place) == ["bin/other"]


def test_the_script_installs_in_the_home_or_a_staged_folder(small, tmp_path):
    home = tmp_path / "home"
    assert install(small, HOME=str(home)).returncode == 0
    assert files(home / ".local") == COPIED
    staged = tmp_path / "staged"
    assert install(small, "/usr", DESTDIR=str(staged)).returncode == 0
    assert files(staged / "usr") == COPIED
    listed = (staged / "usr" / "share" / "fakir" / "installed.txt").read_text().splitlines()
    assert "/usr/bin/fakir" in listed


@pytest.mark.parametrize("arguments", [["a", "b"], ["--help"], []], ids=["two folders", "an option", "no home"])
def test_the_script_refuses_what_it_does_not_understand(small, tmp_path, arguments):
    done = install(small, *arguments)
    assert done.returncode == 2
    assert "usage" in done.stderr or "HOME is not set" in done.stderr
    assert not list(tmp_path.rglob("installed.txt"))


def archive_module():
    found = importlib.util.spec_from_file_location("archive", RELEASE / "archive.py")
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    return module


def test_scripts_of_installation_need_no_network():
    for name in ["install.sh", "install.ps1"]:
        text = (RELEASE / name).read_text(encoding="utf-8")
        assert not re.search(r"curl|wget|Invoke-WebRequest|https?://", text), name


@pytest.fixture(scope="module")
def archive(tmp_path_factory):
    """The archive of the program that is tested."""
    folder = tmp_path_factory.mktemp("dist")
    os.environ["SOURCE_DATE_EPOCH"] = "1700000000"
    try:
        return archive_module().make(Path(os.environ["FAKIR"]), TARGET, "parquet", folder)
    finally:
        del os.environ["SOURCE_DATE_EPOCH"]


@pytest.mark.slow
def test_the_archive_contains_everything(archive, tmp_path):
    version = archive_module().version()
    assert archive.name == f"fakir-{version}-{TARGET}.tar.gz"
    written = (archive.parent / f"{archive.name}.sha256").read_text()
    assert written == f"{hashlib.sha256(archive.read_bytes()).hexdigest()}  {archive.name}\n"
    with tarfile.open(archive) as packed:
        names = {name.split("/", 1)[1] for name in packed.getnames()}
        packed.extractall(tmp_path, filter="data")
    folder = tmp_path / f"fakir-{version}-{TARGET}"
    share = {"man/man1/fakir.1", "man/man1/fakir-transition.1", "bash-completion/completions/fakir", "zsh/site-functions/_fakir"}
    share |= {"fish/vendor_completions.d/fakir.fish", "doc/fakir/LICENSE-MIT", "doc/fakir/LICENSE-APACHE"}
    share |= {"doc/fakir/THIRD-PARTY-LICENCES.txt", "doc/fakir/fakir.cdx.json", "doc/fakir/fakir.schema.json"}
    assert {"bin/fakir", "install.sh", *(f"share/{name}" for name in share)} <= names
    pages = {name for name in names if name.startswith("share/man/man1/fakir-")}
    assert len(pages) >= 15
    for page in pages:
        assert (folder / page).read_text(encoding="utf-8").count(".SH") >= 2, page
    # The same inputs give the same bytes.
    os.environ["SOURCE_DATE_EPOCH"] = "1700000000"
    try:
        again = archive_module().make(Path(os.environ["FAKIR"]), TARGET, "parquet", tmp_path / "again")
    finally:
        del os.environ["SOURCE_DATE_EPOCH"]
    assert again.read_bytes() == archive.read_bytes()
    assert gzip.decompress(archive.read_bytes())[:5] == b"fakir"


@pytest.mark.slow
def test_components_and_licences_are_those_of_the_lock_file(archive):
    import tomllib

    from cyclonedx.schema import SchemaVersion
    from cyclonedx.validation.json import JsonStrictValidator

    path = next(archive.parent.glob("*.cdx.json"))
    text = path.read_text(encoding="utf-8")
    assert JsonStrictValidator(SchemaVersion.V1_5).validate_str(text) is None
    listed = json.loads(text)
    locked = tomllib.loads((ROOT / "Cargo.lock").read_text(encoding="utf-8"))["package"]
    known = {(package["name"], package["version"]): package.get("checksum") for package in locked}
    names = {component["name"] for component in listed["components"]}
    assert {"fakir", "fakir-case", "fakir-study", "clap", "rustfft", "toml", "parquet"} <= names
    # Neither what only tests and builds need nor what runs within the compiler.
    assert not {"insta", "proptest", "syn", "serde_derive", "xtask", "fakir-py"} & names
    with tarfile.open(archive) as packed:
        member = next(name for name in packed.getnames() if name.endswith("THIRD-PARTY-LICENCES.txt"))
        licences = packed.extractfile(member).read().decode()
    for component in listed["components"]:
        checksum = known[component["name"], component["version"]]
        assert component["licenses"][0]["expression"]
        if checksum:
            assert component["hashes"] == [{"alg": "SHA-256", "content": checksum}]
            assert f"{component['name']} {component['version']}: " in licences
        else:
            assert component["name"].startswith("fakir")
    references = {component["bom-ref"] for component in listed["components"]}
    for entry in listed["dependencies"]:
        assert set(entry["dependsOn"]) <= references


@pytest.mark.slow
def test_the_program_runs_in_an_empty_root(archive, tmp_path):
    """Installed into a folder with nothing else but the C library; run by chroot where this is permitted, otherwise without an environment."""
    with tarfile.open(archive) as packed:
        packed.extractall(tmp_path / "unpacked", filter="data")
    folder = next((tmp_path / "unpacked").iterdir())
    root = tmp_path / "root"
    work = root / "work"
    work.mkdir(parents=True)
    assert install(folder, "/usr/local", DESTDIR=str(root)).returncode == 0
    program = "/usr/local/bin/fakir"
    as_root = hasattr(os, "geteuid") and os.geteuid() == 0 and platform.system() == "Linux" and shutil.which("chroot")
    if as_root:
        libraries = subprocess.run(["ldd", str(root / program.lstrip("/"))], capture_output=True, text=True, check=True).stdout
        for library in re.findall(r"(/\S+) \(0x", libraries):
            copy = root / library.lstrip("/")
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(os.path.realpath(library), copy)

    def run(*arguments):
        command = [program, *arguments]
        if as_root:
            command = [as_root, str(root), *command]
        else:
            command[0] = str(root / program.lstrip("/"))
        place = {} if as_root else {"cwd": work}
        return subprocess.run(command, env={}, capture_output=True, text=True, **place)

    case = "/work/case.toml" if as_root else "case.toml"
    assert run("init", case).returncode == 0
    done = run("transition", case)
    assert done.returncode == 0, done.stderr
    # That of the README.
    assert "4.44813 mN" in done.stdout
    output = "/work/results" if as_root else "results"
    assert run("transition", case, "--output", output).returncode == 0
    assert (work / "results" / "pressure-map.svg").is_file()
