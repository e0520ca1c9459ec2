"""Writes the stubs of the classes that the Python package builds from the record: ``python tests/python/stubs.py``."""

from pathlib import Path

from fakir._record import Record

FILE = Path(__file__).parents[2] / "python" / "fakir" / "_numbers.pyi"


def stubs():
    """The text of the file."""
    record = Record()
    lines = ['"""The classes of the record, written by tests/python/stubs.py."""', ""]
    lines += ["from typing import NamedTuple", "", "from ._result import Answer, Number, Numbered"]
    for name, fields in record.groups.items():
        lines += ["", f"class {name}(NamedTuple):"]
        for attribute, field in fields.items():
            default = " = None" if field.optional else ""
            lines += [f"    {attribute}: {field.annotation}{default}", f"    {field.doc!r}"]
    for name, (base, fields) in record.answers.items():
        lines += ["", f"class {name}({base}):"]
        for attribute, field in fields.items():
            lines += [f"    {attribute}: Number[{field.annotation}]", f"    {field.doc!r}"]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    FILE.write_text(stubs())
