"""Compiled kernels count no references to arrays where they run often.

Numba counts references to arrays, atomically, wherever an array is last used behind a
condition. In the event loop of fronts this once took 77 % of the time. The counts are
those of the newest numba: other versions optimise differently, and only their speed
depends on it.
"""

import re
from types import ModuleType

import pytest

from rodimpact.methods import compiling, kernels
from rodimpact.methods.grid.records import Grid, StepHistory
from rodimpact.running.warming import warm_method

pytestmark = pytest.mark.exhaustive
NEWEST_NUMBA = (0, 68)


def kernel_calls(method):
    """Entries of the kernels of a method, as functions, with the types of their
    arguments.
    """
    calls = {}
    run = compiling.Compiled.__call__

    def record(compiled, *args):
        types = tuple(compiling.compiler().typeof(arg) for arg in args)
        calls[compiled._twin] = types
        return run(compiled, *args)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compiling.Compiled, "__call__", record)
        warm_method(method)
    return calls


def modules_of(module, seen):
    """A compiled kernel module and all that it imports."""
    seen.append(module)
    for value in vars(module).values():
        if compiling._is_kernel(value) and value not in seen:
            modules_of(value, seen)
    return seen


def count_references(dispatcher):
    """Increments and decrements in all machine code of a function."""
    code = "\n".join(dispatcher.inspect_llvm().values())
    increments = len(re.findall(r"call void @NRT_incref", code))
    decrements = len(re.findall(r"call void @NRT_decref", code))
    return increments, decrements


def reference_counts(method):
    """Increments and decrements by function, where there are any."""
    counts = {}
    for entry, types in kernel_calls(method).items():
        dispatcher = compiling.compiler().njit(**compiling.OPTIONS)(entry)
        dispatcher.compile(types)
        counts[entry.__name__] = count_references(dispatcher)
        module = ModuleType("scope")
        vars(module).update(entry.__globals__)
        for inner in modules_of(module, []):
            for name, value in vars(inner).items():
                if hasattr(value, "inspect_llvm"):
                    counts[f"{inner.__name__}.{name}"] = count_references(value)
    return {name: pair for name, pair in counts.items() if sum(pair)}


@pytest.fixture(scope="module", autouse=True)
def newest_numba():
    if kernels.why_not():
        pytest.skip("nothing is compiled")
    version = compiling.compiler().__version__
    numbers = tuple(int(part) for part in version.split(".")[:2])
    if numbers < NEWEST_NUMBA:
        pytest.skip("an older numba")


def test_fronts_count_references_once_a_call():
    """Once for each array of the state, where a call begins and ends: not in its
    loops.
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
