"""The state of a kernel, which members of a family use one after the other.

Plain Python runs on lists of objects until machine code pays: then all goes on in
arrays of records.
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
        It takes the state. All that it changes is in the state: called again, it goes
        on.
    state : StateT
        In machine code of arrays, else of lists of objects.
    record_types : dict of str to dtype
        Types of the records of the state, by field; its other fields are numbers.
    is_compiled : bool
        Whether the state is one for machine code.
    user_laws : tuple of (int, function)
        Functions of the user that the kernel calls.
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
        """Run the kernel on the state, in the form that it has, and change the state.

        Return what the kernel returns.
        """
        kernel: Any
        if self.is_compiled:
            kernel = compiling.compiled(self.kernel, self.user_laws)
        else:
            kernel = compiling.interpreted(self.kernel, self.user_laws)
        return kernel(self.state)

    def choose_form(self, seconds: float) -> None:
        """Make the state arrays for machine code, or lists for plain Python.

        `seconds` is what the next run takes in plain Python. `worth_compiling` adds it
        to the seconds of earlier runs of this kernel: once they pay for compiling,
        machine code runs. With a law of the user that numba has not compiled, plain
        Python always runs. A state that has its form already stays as it is.
        """
        use_arrays = False  # machine code cannot call functions that are not compiled
        if compiling.can_be(self.user_laws):
            use_arrays = kernels.worth_compiling(seconds, self.kernel)
        if use_arrays and not self.is_compiled:
            self.to_arrays()
        elif self.is_compiled and not use_arrays:
            self.to_lists()

    def to_arrays(self) -> None:
        """Make arrays of all fields of the state.

        From now on machine code runs on them.
        """
        arrays = {name: self.array(name) for name in self.state._fields}
        self.state = type(self.state)(**arrays)
        self.is_compiled = True

    def to_lists(self) -> None:
        """Make lists of all fields of the state.

        From now on plain Python runs on them.
        """
        lists = {name: self.objects(name) for name in self.state._fields}
        self.state = type(self.state)(**lists)
        self.is_compiled = False

    def array(self, name: str) -> Any:
        """The field `name` of the state as an array of numbers or records.

        It is the array of the state itself if the state is compiled, else a copy of the
        list. A list of lists of records, one list a member and all of one length,
        becomes an array [member, i]. The state is not changed.
        """
        values: Any = getattr(self.state, name)
        if self.is_compiled:
            return values
        if name not in self.record_types:  # numbers
            return np.array(values)
        record = self.record_types[name]
        if values and isinstance(values[0], list):  # a list of records for each member
            return np.array([as_records(objects, record) for objects in values])
        return as_records(values, record)

    def objects(self, name: str) -> list[Any]:
        """The field `name` of the state as a list: of numbers, or objects for records.

        It is the list of the state itself, or a copy if the state is compiled.
        """
        values: Any = getattr(self.state, name)
        if self.is_compiled:
            return as_objects(values)
        objects: list[Any] = values
        return objects

    def lengthen(self, *names: str) -> None:
        """Replace these fields of records in the state by longer ones.

        Lists become twice as long, arrays four times. The records come first; those
        behind them are blank in a list, and not set in an array.
        """
        longer = {}
        for name in names:
            longer[name] = lengthened(
                getattr(self.state, name), self.record_types[name]
            )
        self.state = self.state._replace(**longer)
