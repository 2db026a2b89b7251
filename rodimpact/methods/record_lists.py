"""Lists of records, on which kernels work.

A record class names its fields and their types. In machine code a list of records is a
structured array. In plain Python it is a list of small objects with the same fields,
since reading an attribute of an object is faster than reading a field of an array.
"""

import dataclasses
import functools
import itertools
import operator
import typing
from typing import Any

import numpy as np

GROWTH_OF_LISTS = 2  # factor by which `lengthened` makes a list longer
GROWTH_OF_ARRAYS = 4  # larger, as new entries of an array take no memory until set


def dtype_of(record: type) -> np.dtype[Any]:
    """Return the structured dtype of a record class, with aligned fields.

    It has a field for each annotated name, in order. The type of a field in an array is
    its annotation, ``tick: int``. If it differs from the type in plain Python, it is
    the second part of an ``Annotated``, ``line: Annotated[int, "i4"]``.
    """
    fields = []
    for name, hint in typing.get_type_hints(record, include_extras=True).items():
        # `__metadata__` of Annotated[int, "i4"] is ("i4",); other types have none.
        (kind,) = getattr(hint, "__metadata__", (hint,))
        fields.append((name, kind))
    return np.dtype(fields, align=True)


@functools.cache
def _object_class(record: Any) -> Any:
    """Make a class with the fields of a structured dtype: numbers and lists of numbers.

    The arguments of the class are the fields in order; a field that is not given is 0,
    or a list of zeros. The same dtype always gives the same class.
    """
    fields = []
    for name in record.names:
        make_zero = np.zeros((), record[name]).tolist  # makes a number, or a new list
        if record[name].subdtype:  # an array field: each object needs its own list
            default = dataclasses.field(default_factory=make_zero)
        else:
            default = make_zero()
        fields.append((name, Any, default))
    return dataclasses.make_dataclass("Record", fields, slots=True)


def blank(count: int, record: Any) -> list[Any]:
    """Return a list of `count` objects with the fields of the dtype `record`, all 0.

    The fields are numbers and lists of numbers.
    """
    make = _object_class(record)
    return [make() for _ in range(count)]


def as_objects(records: Any) -> list[Any]:
    """Return a copy of an array as a list, for plain Python.

    An array of records becomes a list of small objects with the same fields; array
    fields become lists. An array of numbers becomes a list of numbers, nested if it has
    several dimensions.
    """
    record = records.dtype
    if record.names is None:  # numbers
        return records.tolist()  # type: ignore[no-any-return]
    make = _object_class(record)
    # Array fields must become lists, so that each field is converted by itself. Without
    # array fields it is faster to convert whole records.
    if any(record[name].subdtype for name in record.names):
        columns = [records[name].tolist() for name in record.names]
        return list(map(make, *columns))
    return list(itertools.starmap(make, records.tolist()))


def as_records(objects: list[Any], record: Any) -> Any:
    """Return a list of objects or numbers as a new array of the dtype `record`.

    It is the inverse of `as_objects`.
    """
    rows = objects
    if record.names:  # records, not numbers
        # With at least two names, as all records have, the result is a tuple.
        fields_of = operator.attrgetter(*record.names)
        rows = list(map(fields_of, objects))
    return np.array(rows, record)


def lengthened(records: Any, record: Any) -> Any:
    """Return the records followed by new ones, as a new list or array.

    A list becomes twice as long: its objects, which are not copied, are followed by
    blank ones. An array becomes four times as long: copies of its records are followed
    by records that are not set. `record` is the dtype.
    """
    if isinstance(records, list):
        return records + blank((GROWTH_OF_LISTS - 1) * len(records), record)
    longer = np.empty(GROWTH_OF_ARRAYS * len(records), record)
    raw = f"V{record.itemsize}"  # plain bytes: numpy copies field by field otherwise
    longer.view(raw)[: len(records)] = records.view(raw)
    return longer


def joined(first: Any, second: Any) -> Any:
    """Return a new array of the entries of two arrays of the same dtype."""
    raw = f"V{first.dtype.itemsize}"  # plain bytes, as in `lengthened`
    return np.concatenate((first.view(raw), second.view(raw))).view(first.dtype)
