"""What archives and package managers read: CITATION.cff, .zenodo.json, codemeta.json and the recipe of the conda package agree with the
packages that are published."""

import hashlib
import importlib.util
import json
import re
import tomllib
from importlib.metadata import distribution
from pathlib import Path

import jsonschema
import pytest
import yaml

ROOT = Path(__file__).parents[2]
WORKSPACE = tomllib.loads((ROOT / "Cargo.toml").read_text(encoding="utf-8"))["workspace"]["package"]
VERSION = WORKSPACE["version"]
PROJECT = tomllib.loads((ROOT / "python" / "pyproject.toml").read_text(encoding="utf-8"))
CITATION = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
ZENODO = json.loads((ROOT / ".zenodo.json").read_text(encoding="utf-8"))
CODEMETA = json.loads((ROOT / "codemeta.json").read_text(encoding="utf-8"))
RECIPE_FILE = ROOT / "conda" / "recipe" / "recipe.yaml"
RECIPE = yaml.safe_load(RECIPE_FILE.read_text(encoding="utf-8"))
PAPER = "10.1103/PhysRevE.104.055007"
BINDER = (ROOT / ".binder" / "requirements.txt").read_text(encoding="utf-8")


def test_all_files_have_the_version():
    found = {
        "CITATION.cff": CITATION["version"],
        ".zenodo.json": ZENODO["version"],
        "codemeta.json": CODEMETA["version"],
        "conda recipe": RECIPE["context"]["version"],
        "Binder": re.search(r"^fakir\[[\w,]+\]==(.+)$", BINDER, re.M)[1],
    }
    assert found == dict.fromkeys(found, VERSION)


def test_the_citation_is_valid():
    """The schema of the Citation File Format 1.2.0 is that in the package cffconvert."""
    # Without importing the package, which needs others.
    schema = distribution("cffconvert").locate_file("cffconvert/schemas/1.2.0/schema.json")
    schema = json.loads(Path(schema).read_text(encoding="utf-8"))
    # Dates are written as texts in JSON.
    document = json.loads(json.dumps(CITATION, default=str))
    jsonschema.validate(document, schema)


def test_licences_keywords_and_the_paper_agree():
    assert WORKSPACE["license"] == PROJECT["project"]["license"] == RECIPE["about"]["license"] == "MIT OR Apache-2.0"
    licences = ["MIT", "Apache-2.0"]
    assert CITATION["license"] == licences
    assert CODEMETA["license"] == [f"https://spdx.org/licenses/{name}" for name in licences]
    assert ZENODO["license"] == "mit" and all(name in ZENODO["notes"] for name in licences)
    assert CITATION["keywords"] == ZENODO["keywords"] == CODEMETA["keywords"]
    assert [name.replace("-", " ") for name in WORKSPACE["keywords"]] == CITATION["keywords"]
    assert PAPER in {reference["doi"] for reference in CITATION["references"]}
    assert PAPER in {related["identifier"] for related in ZENODO["related_identifiers"]}
    assert CODEMETA["referencePublication"]["@id"] == f"https://doi.org/{PAPER}"


def test_no_names_are_invented():
    """Authors are given by those who publish; until then all files name the developers as a group."""
    group = "the fakir developers"
    assert [author["name"] for author in CITATION["authors"]] == [group]
    assert [author["name"] for author in ZENODO["creators"]] == [group]
    assert [author["name"] for author in CODEMETA["author"]] == [group]
    assert WORKSPACE["authors"] == [group] == [author["name"] for author in PROJECT["project"]["authors"]]


def test_addresses_agree_once_they_are_known():
    """The repository is named in Cargo.toml first, and the DOI in CITATION.cff: all other files then repeat them."""
    repository = WORKSPACE.get("repository")
    assert CITATION.get("repository-code") == repository
    assert CODEMETA.get("codeRepository") == repository
    assert RECIPE["about"].get("repository") == repository
    doi = CITATION.get("doi")
    assert CODEMETA.get("identifier") == (f"https://doi.org/{doi}" if doi else None)


def test_the_recipe_requires_what_the_package_requires():
    project = PROJECT["project"]
    run = RECIPE["requirements"]["run"]
    dependencies = [re.sub(r"([\w-]+)(.*)", r"\1 \2", name) for name in project["dependencies"]]
    assert [name for name in run if name != "python"] == dependencies
    oldest = project["requires-python"].removeprefix(">=")
    assert RECIPE["build"]["skip"] == f'match(python, "<{oldest}")'
    maturin = PROJECT["build-system"]["requires"][0].replace("maturin", "maturin ")
    assert maturin in RECIPE["requirements"]["host"]
    assert RECIPE["about"]["summary"] == project["description"]
    assert set(project["license-files"]) < set(RECIPE["about"]["license_file"])


def fill_in():
    found = importlib.util.spec_from_file_location("fill_in", ROOT / "conda" / "fill_in.py")
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    return module


def test_the_recipe_is_filled_in_from_a_source_distribution(tmp_path):
    archive = tmp_path / "fakir-0.3.0.tar.gz"
    archive.write_bytes(b"contents")
    recipe = yaml.safe_load(fill_in().filled_in(archive))
    assert recipe["context"]["version"] == "0.3.0"
    assert recipe["source"]["sha256"] == hashlib.sha256(b"contents").hexdigest()
    assert recipe["requirements"] == RECIPE["requirements"]
    with pytest.raises(SystemExit, match="give fakir-VERSION.tar.gz"):
        fill_in().filled_in(tmp_path / "fakir.zip")
    with pytest.raises(SystemExit, match="there is no file"):
        fill_in().filled_in(tmp_path / "fakir-0.4.0.tar.gz")


@pytest.mark.slow
@pytest.mark.parametrize("platform", ["linux-64", "linux-aarch64", "osx-arm64", "win-64"])
def test_the_recipe_is_understood_by_rattler_build(platform):
    from rattler_build import PlatformConfig, RenderConfig, Stage0Recipe, VariantConfig

    recipe = Stage0Recipe.from_file(str(RECIPE_FILE))
    # As in the pinning of conda-forge.
    variants = VariantConfig(
        {
            "python": ["3.11.* *_cpython", "3.12.* *_cpython"],
            "c_stdlib": ["sysroot"],
            "c_stdlib_version": ["2.17"],
            "c_compiler": ["gcc"],
            "rust_compiler": ["rust"],
        }
    )
    config = RenderConfig(PlatformConfig(build_platform="linux-64", host_platform=platform, target_platform=platform))
    rendered = recipe.render(variants, config)
    assert len(rendered) == 2
