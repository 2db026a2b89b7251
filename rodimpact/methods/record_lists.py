"""Lists of records, on which kernels work.

They are structured arrays or lists of small objects. A record class names its fields
with their types. In machine code a list of records is a structured array, in plain
Python a list of objects with the same fields: attributes of an object are read faster
than fields of an array's element.
"""

import dataclasses
import functools
import itertools
import operator
import typing
from typing import Any

import numpy as np

GROWTH_OF_LISTS = 2
GROWTH_OF_ARRAYS = 4  # what an array has room for takes no memory until it is set


def dtype_of(record: type) -> np.dtype[Any]:
    """Return the structured type of a record class.

    It has a field for each annotated name, in order. What a field is in an array stands
    in its annotation: ``tick: int``, or where that differs from what it is in plain
    Python, ``line: Annotated[int, "i4"]``.
    """
    fields = []
    for name, hint in typing.get_type_hints(record, include_extras=True).items():
        # What stands behind the type in `Annotated`, or else the type itself
        (kind,) = getattr(hint, "__metadata__", (hint,))
        fields.append((name, kind))
    return np.dtype(fields, align=True)


@functools.cache
def _object_class(record: Any) -> Any:
    """A class with the fields of a record: numbers and lists of numbers, 0 at first."""
    fields = []
    for name in record.names:
        zero = np.zeros((), record[name]).tolist  # it makes a number, or a new list
        if record[name].subdtype:  # the field is an array
            default = dataclasses.field(default_factory=zero)
        else:
            default = zero()
        fields.append((name, Any, default))
    return dataclasses.make_dataclass("Record", fields, slots=True)


def blank(count: int, record: Any) -> list[Any]:
    """Return objects with the fields of a record, all 0.

    Fields are numbers and lists of numbers.
    """
    make = _object_class(record)
    return [make() for _ in range(count)]


def as_objects(records: Any) -> list[Any]:
    """Return an array as a list, for plain Python.

    It has numbers, or small objects for records.
    """
    record = records.dtype
    if record.names is None:
        return records.tolist()  # type: ignore[no-any-return]
    make = _object_class(record)
    # Fields that are arrays become lists of their own;
    # without any, whole records are faster.
    if any(record[name].subdtype for name in record.names):
        columns = [records[name].tolist() for name in record.names]
        return list(map(make, *columns))
    return list(itertools.starmap(make, records.tolist()))


def as_records(objects: list[Any], record: Any) -> Any:
    """Return a list of `as_objects` as an array of that kind again."""
    rows = objects
    if record.names:  # records, not numbers
        fields_of = operator.attrgetter(*record.names)
        rows = list(map(fields_of, objects))
    return np.array(rows, record)


def lengthened(records: Any, record: Any) -> Any:
    """Return records with room for more behind them, as a list or array of its own.

    Behind a list are as many blank objects again; behind an array three times as many
    records, which are not set.
    """
    if isinstance(records, list):
        return records + blank((GROWTH_OF_LISTS - 1) * len(records), record)
    longer = np.empty(GROWTH_OF_ARRAYS * len(records), record)
    raw = f"V{record.itemsize}"  # copied as bytes: field by field takes longer
    longer.view(raw)[: len(records)] = records.view(raw)
    return longer


def joined(first: Any, second: Any) -> Any:
    """Return two arrays of one kind as one."""
    raw = f"V{first.dtype.itemsize}"  # joined as bytes: field by field takes longer
    return np.concatenate((first.view(raw), second.view(raw))).view(first.dtype)
