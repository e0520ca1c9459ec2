"""The classes of the record; `_numbers.pyi` describes them."""

from ._record import Record

globals().update(Record().classes(__name__))
