"""Contents of the crates, the wheel and the source distribution."""

import json
import os
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
CARGO = os.environ.get("CARGO", "cargo")
LICENCES = {"LICENSE-MIT", "LICENSE-APACHE"}


def cargo(*arguments):
    done = subprocess.run([CARGO, *arguments], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def published():
    metadata = json.loads(cargo("metadata", "--format-version", "1", "--no-deps", "--locked"))
    return [package for package in metadata["packages"] if package["publish"] is None]


def test_every_published_crate_has_what_a_registry_shows():
    crates = published()
    assert len(crates) == 9
    for crate in crates:
        assert crate["description"] and crate["keywords"] and crate["categories"], crate["name"]
        assert crate["readme"] == "README.md"
        assert crate["rust_version"] == "1.88"
        assert crate["metadata"]["docs"]["rs"]["all-features"]


def test_every_published_crate_contains_licences_and_its_readme():
    for crate in published():
        package = ["package", "--list", "--allow-dirty", "--locked", "--package", crate["name"]]
        files = set(cargo(*package).split())
        assert LICENCES | {"README.md", "Cargo.toml"} <= files, crate["name"]
        assert not [file for file in files if file.startswith("target/")]
        for name in LICENCES:
            kept = (Path(crate["manifest_path"]).parent / name).read_text(encoding="utf-8")
            assert kept == (ROOT / name).read_text(encoding="utf-8")


@pytest.mark.skipif("FAKIR_WHEEL" not in os.environ, reason="no wheel was built")
def test_the_wheel_contains_the_package_and_nothing_else():
    with zipfile.ZipFile(os.environ["FAKIR_WHEEL"]) as wheel:
        files = wheel.namelist()
        entry = next(name for name in files if name.endswith(".dist-info/entry_points.txt"))
        assert "fakir=fakir._command:main" in wheel.read(entry).decode().replace(" ", "")
    assert {Path(file).parts[0] for file in files} == {"fakir", Path(entry).parts[0]}
    assert LICENCES <= {Path(file).name for file in files if ".dist-info/licenses/" in file}
    assert {"py.typed", "_fakir.pyi", "_numbers.pyi", "__init__.py"} <= {Path(file).name for file in files}


@pytest.mark.slow
def test_the_source_distribution_contains_all_that_is_built(tmp_path):
    make = [sys.executable, "-m", "maturin", "sdist", "--out", str(tmp_path)]
    subprocess.run(make, cwd=ROOT / "python", check=True, capture_output=True)
    with tarfile.open(next(tmp_path.glob("*.tar.gz"))) as archive:
        files = {str(Path(*Path(name).parts[1:])) for name in archive.getnames()}
    assert LICENCES | {"PKG-INFO", "pyproject.toml", "Cargo.lock", "README.md"} <= files
    assert {"python/fakir/__init__.py", "fakir/__init__.py"} & files
    for name in ["fakir", "fakir-case", "fakir-cli", "fakir-py", "fakir-explore", "fakir-study"]:
        assert f"crates/{name}/Cargo.toml" in files
    assert "crates/fakir/doc/rendered/spectral.md" in files
