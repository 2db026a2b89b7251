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
    """Return the structured type of numpy of a record class, with aligned fields.

    It has a field for each annotated name, in order. What a field is in an array stands
    in its annotation: ``tick: int``, or where that differs from what it is in plain
    Python, ``line: Annotated[int, "i4"]``.
    """
    fields = []
    for name, hint in typing.get_type_hints(record, include_extras=True).items():
        # The one thing behind the type in `Annotated`, or else the type itself
        (kind,) = getattr(hint, "__metadata__", (hint,))
        fields.append((name, kind))
    return np.dtype(fields, align=True)


@functools.cache
def _object_class(record: Any) -> Any:
    """A class with the fields of a structured dtype: numbers and lists of numbers.

    Called without arguments it makes an object with all of them 0; its arguments are
    the fields in order. Each dtype has one class.
    """
    fields = []
    for name in record.names:
        make_zero = np.zeros((), record[name]).tolist  # makes a number, or a new list
        if record[name].subdtype:  # the field is an array: each object has its own list
            default = dataclasses.field(default_factory=make_zero)
        else:
            default = make_zero()
        fields.append((name, Any, default))
    return dataclasses.make_dataclass("Record", fields, slots=True)


def blank(count: int, record: Any) -> list[Any]:
    """Return objects with the fields of a record, all 0.

    Fields are numbers and lists of numbers.
    """
    make = _object_class(record)
    return [make() for _ in range(count)]


def as_objects(records: Any) -> list[Any]:
    """Return a copy of an array as a list, for plain Python.

    An array of records becomes a list of small objects with the same fields, those that
    are arrays as lists; one of numbers becomes a list of numbers.
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
    """Return a list of `as_objects` as a new array of the dtype `record`."""
    rows = objects
    if record.names:  # records, not numbers
        # This makes a tuple: records have two fields or more.
        fields_of = operator.attrgetter(*record.names)
        rows = list(map(fields_of, objects))
    return np.array(rows, record)


def lengthened(records: Any, record: Any) -> Any:
    """Return records with room for more behind them, as a new list or array.

    Behind the objects of a list, which are not copied, are as many blank ones again;
    behind the records of an array three times as many that are not set. `record` is
    their dtype.
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
