"""Compiled kernels count no references to arrays where they run often.

Numba counts references to arrays, atomically, wherever an array is last used behind a
condition. In the event loop of fronts this once took 77 % of the time. The counts are
those of the newest numba: other versions optimise differently, and only their speed
depends on it.
"""

import re
from typing import NamedTuple

import pytest

from rodimpact.methods import compiling, kernels
from rodimpact.methods.grid.records import Grid, StepHistory
from rodimpact.running.warming import warm_method

pytestmark = pytest.mark.exhaustive
NEWEST_NUMBA = (0, 68)


def kernel_calls(method):
    """Types of the arguments with which Python calls compiled kernels of a method.

    The keys are the functions, in a scope whose other kernels are compiled.
    """
    calls = {}
    run = compiling.Compiled.__call__

    def record(compiled, *args):
        types = []
        for arg in args:
            types.append(compiling.compiler().typeof(arg))
        calls[compiled._twin] = tuple(types)
        return run(compiled, *args)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compiling.Compiled, "__call__", record)
        warm_method(method)
    return calls


def imported_kernels(scope):
    """Kernel modules among the values of a dict of names, and all that they import."""
    modules = []
    scopes = [scope]
    for each in scopes:  # the list grows
        for value in each.values():
            if compiling._is_kernel(value) and value not in modules:
                modules.append(value)
                scopes.append(vars(value))
    return modules


class Counts(NamedTuple):
    """Instructions in the machine code of a function, not how often they are run."""

    increments: int
    decrements: int


def count_references(dispatcher):
    """Numbers of increments and decrements of reference counts in the machine code of a
    compiled function, over all its signatures.
    """
    code = "\n".join(dispatcher.inspect_llvm().values())
    return Counts(
        increments=len(re.findall(r"call void @NRT_incref", code)),
        decrements=len(re.findall(r"call void @NRT_decref", code)),
    )


def counts_in(scope):
    """Counts of the compiled functions among the values of a dict of names.

    The keys are their names behind that of their module.
    """
    counts = {}
    for name, value in scope.items():
        is_compiled = hasattr(value, "inspect_llvm")
        if is_compiled:
            counts[f"{scope['__name__']}.{name}"] = count_references(value)
    return counts


def reference_counts(method):
    """Counts by the name of each compiled function that a method runs.

    Functions without any are left out. An entry's name stands without its module's.
    """
    counts = {}
    for entry, types in kernel_calls(method).items():
        dispatcher = compiling.compiler().njit(**compiling.OPTIONS)(entry)
        dispatcher.compile(types)  # what the entry calls is compiled with it
        counts[entry.__name__] = count_references(dispatcher)
        counts |= counts_in(entry.__globals__)
        for module in imported_kernels(entry.__globals__):
            counts |= counts_in(vars(module))
    return {name: count for name, count in counts.items() if sum(count) > 0}


@pytest.fixture(scope="module", autouse=True)
def only_with_newest_numba():
    """Skip where no numba compiles, or one older than `NEWEST_NUMBA`."""
    why_not_compiled = kernels.why_not()
    if why_not_compiled:
        pytest.skip("nothing is compiled")
    version = compiling.compiler().__version__
    numbers = tuple(int(part) for part in version.split(".")[:2])
    if numbers < NEWEST_NUMBA:
        pytest.skip("an older numba")


def test_fronts_count_references_once_a_call():
    """The machine code of fronts counts references in `run_members` only: once for each
    array of the state, where a call begins and ends, and not in its loops.
    """
    counts = reference_counts("fronts")
    assert set(counts) == {"run_members"}
    increments, decrements = counts["run_members"]
    assert increments <= 14
    assert decrements <= 25


def test_characteristics_count_references_once_a_call():
    """Their arrays are borrowed: where the text still counts, there is no reference to
    count.

    The wrapper of a call gives 9 arrays back. Functions that are called from several
    places do not know that what they are given is borrowed; those that would look often
    borrow it once more.
    """
    increments, decrements = reference_counts("characteristics")["run_nodes"]
    assert increments <= 3
    assert decrements <= 13


def test_grids_count_no_references_in_their_steps():
    """Decrements stand behind the loop, where the arrays of a call are given back."""
    increments, decrements = reference_counts("finite-difference")["run_steps"]
    arrays = len(Grid._fields) + len(StepHistory._fields)
    assert increments == 0
    assert decrements <= 2 * arrays  # each array is given back in two places
