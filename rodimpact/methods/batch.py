"""The state of a kernel, which members of a family use one after the other.

Plain Python runs on lists of objects. Once machine code pays, the lists become arrays
of records, and machine code goes on with them.
"""

from collections.abc import Mapping
from typing import Any, Generic, TypeVar

import numpy as np

from . import compiling, kernels
from .compiling import Functions, Kernel
from .record_lists import as_objects, as_records, lengthened

StateT = TypeVar("StateT", bound=Any)
"""A named tuple of lists of records, or of numbers."""


class Batch(Generic[StateT]):
    """A state, and the kernel that runs on it.

    Parameters
    ----------
    kernel : function
        It takes the state, and changes nothing else, so that a further call goes on
        from there.
    state : StateT
        Its fields are arrays for machine code, or lists for plain Python.
    record_types : dict of str to dtype
        Types of the records of the state, by field; other fields have numbers.
    is_compiled : bool
        Whether the fields of the state are arrays, for machine code.
    user_laws : tuple of (int, function)
        Functions of the user that the kernel calls, by number.
    """

    def __init__(
        self,
        kernel: Kernel,
        state: StateT,
        record_types: Mapping[str, Any],
        *,
        is_compiled: bool,
        user_laws: Functions = (),
    ) -> None:
        """Keep the arguments as attributes; nothing runs yet."""
        self.kernel = kernel
        self.state = state
        self.record_types = record_types
        self.is_compiled = is_compiled
        self.user_laws = user_laws

    def run(self) -> Any:
        """Run the kernel on the state, which changes; return the result of the kernel.

        Arrays run in machine code, lists in plain Python.
        """
        kernel: Any
        if self.is_compiled:
            kernel = compiling.compiled(self.kernel, self.user_laws)
        else:
            kernel = compiling.interpreted(self.kernel, self.user_laws)
        return kernel(self.state)

    def choose_form(self, seconds: float) -> None:
        """Convert the state to arrays for machine code, or to lists for plain Python.

        `seconds` is the time of the next run in plain Python. `worth_compiling` adds it
        to the time of earlier runs of this kernel; once the sum pays for compiling,
        machine code is chosen. If a law of the user is not compiled, plain Python is
        chosen. A state in the chosen form already is not changed.
        """
        use_arrays = False
        # Machine code cannot call functions that numba has not compiled.
        if compiling.can_be(self.user_laws):
            use_arrays = kernels.worth_compiling(seconds, self.kernel)
        if use_arrays and not self.is_compiled:
            self.to_arrays()
        elif self.is_compiled and not use_arrays:
            self.to_lists()

    def to_arrays(self) -> None:
        """Convert all fields of the state to arrays, on which machine code runs."""
        arrays = {name: self.array(name) for name in self.state._fields}
        self.state = type(self.state)(**arrays)
        self.is_compiled = True

    def to_lists(self) -> None:
        """Convert all fields of the state to lists, on which plain Python runs."""
        lists = {name: self.objects(name) for name in self.state._fields}
        self.state = type(self.state)(**lists)
        self.is_compiled = False

    def array(self, name: str) -> Any:
        """The field `name` of the state as an array of numbers or records.

        If the state has arrays, it is the array of the state itself, otherwise a new
        array. A list of lists of records, one list a member and all of the same length,
        becomes an array [member, i]. The state is not changed.
        """
        values: Any = getattr(self.state, name)
        if self.is_compiled:
            return values
        if name not in self.record_types:  # numbers
            return np.array(values)
        record = self.record_types[name]
        if values and isinstance(values[0], list):  # one list of records a member
            return np.array([as_records(objects, record) for objects in values])
        return as_records(values, record)

    def objects(self, name: str) -> list[Any]:
        """The field `name` of the state as a list of numbers or objects (records).

        If the state has lists, it is the list of the state itself, otherwise a new
        list.
        """
        values: Any = getattr(self.state, name)
        if self.is_compiled:
            return as_objects(values)
        objects: list[Any] = values
        return objects

    def lengthen(self, *names: str) -> None:
        """Replace fields of records in the state, given by name, by longer ones.

        A list becomes twice as long, an array four times. The present records are
        followed by blank records in a list, and by records that are not set in an
        array.
        """
        longer = {}
        for name in names:
            longer[name] = lengthened(
                getattr(self.state, name), self.record_types[name]
            )
        self.state = self.state._replace(**longer)
