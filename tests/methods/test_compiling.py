"""Kernels by stock numba: what is kept on disk, and what is not used again."""

import contextlib
import gc
import os
import warnings
from pathlib import Path

import numpy as np
import pytest
from numpy.random import default_rng

from rodimpact.methods import compiling, kernels, record_lists
from rodimpact.methods.fronts import members as fronts
from rodimpact.methods.fronts.records import NODE
from rodimpact.methods.pieces import march as pieces
from rodimpact.methods.pieces.records import PIECE
from rodimpact.methods.tick_rule import recognise

FOLDER = Path(compiling.__file__).parent


def test_garbage_is_not_collected_while_compiling_and_again_after_a_failure():
    """Garbage collection is off inside a call that fails, and on after it."""
    was_enabled = []
    with pytest.raises(RuntimeError, match="not compiled"):
        fail_while_uncollected(was_enabled)
    assert was_enabled == [False]
    assert gc.isenabled()


def fail_while_uncollected(was_enabled):
    """Append whether garbage is collected meanwhile, and raise RuntimeError."""
    with compiling.uncollected():
        was_enabled.append(gc.isenabled())
        raise RuntimeError("not compiled")


def test_garbage_that_was_not_collected_before_compiling_is_not_afterwards():
    """If garbage collection is off before `uncollected`, it stays off after it."""
    gc.disable()
    try:
        with compiling.uncollected():
            pass
        assert not gc.isenabled()
    finally:
        gc.enable()


def test_kernels_are_optimised_at_their_level_which_is_then_restored():
    """Inside a call that fails, numba optimises at OPTIMISATION_LEVEL at most; its own
    level is restored afterwards.
    """
    config = pytest.importorskip("numba").config
    before = config.OPT
    level_inside = fail_while_optimising()
    assert level_inside == min(compiling.OPTIMISATION_LEVEL, before)
    assert config.OPT is before


def fail_while_optimising():
    """Level of optimisation in a compilation that then fails."""
    levels = []
    with (
        contextlib.suppress(RuntimeError),
        compiling.optimised_for_kernels(),
    ):
        levels.append(int(compiling.compiler().config.OPT))
        raise RuntimeError("not compiled")
    return levels[0]


def test_a_lower_level_that_the_user_asks_for_is_kept(monkeypatch):
    """numba's level of optimisation, set lower by a user, is the same inside and after
    `optimised_for_kernels`.
    """
    config = pytest.importorskip("numba").config
    lower = type(config.OPT)(1)
    monkeypatch.setattr(config, "OPT", lower)
    with compiling.optimised_for_kernels():
        assert config.OPT is lower
    assert config.OPT is lower


def test_a_call_on_a_deep_stack_takes_its_argument_and_raises_its_error():
    arguments_of_calls = []
    compiling.call_on_deep_stack(arguments_of_calls.append, 1)
    assert arguments_of_calls == [1]
    with pytest.raises(ZeroDivisionError):
        compiling.call_on_deep_stack(lambda x: 1 / x, 0)


def test_names_used_once_are_those_that_one_function_calls_and_not_several():
    once = compiling._names_used_once(fronts)
    assert {"find_group_motion", "receive"} <= once
    assert once.isdisjoint({"no_front_in_flight", "accumulate_contact_totals"})


# Sources
# --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("module", "files"),
    [
        (
            pieces,
            [
                "pieces/march",
                "pieces/nodes",
                "pieces/series",
                "pieces/records",
                "contact_laws",
            ],
        ),
        (
            fronts,
            [
                "fronts/members",
                "fronts/events",
                "fronts/records",
                "tick_rule",
                "compiling",
            ],
        ),
    ],
)
def test_a_change_of_any_file_of_a_kernel_changes_its_digest(
    module, files, monkeypatch
):
    """The digest of a kernel's sources changes if any of the files gets one more
    character, also a file from which only constants are imported.
    """
    read_bytes = Path.read_bytes

    def digest_with_longer(file):
        """Digest as if this file, without its ending, had one more character."""
        path = FOLDER / f"{file}.py"

        def read_longer(each):
            content = read_bytes(each)
            if each == path:
                content += b"#"
            return content

        with monkeypatch.context() as patch:
            patch.setattr(Path, "read_bytes", read_longer)
            return compiling.digest_of(module)

    digests = {compiling.digest_of(module)}
    for file in files:
        digests.add(digest_with_longer(file))
    assert len(digests) == 1 + len(files)  # all differ


# Records
# --------------------------------------------------------------------------------------


@pytest.mark.parametrize("record", [NODE, PIECE], ids=["plain", "with arrays"])
def test_records_become_objects_and_objects_records(record):
    """Three random records become objects and records again: all fields are equal. No
    objects become no records.
    """
    # Bytes below 64 make no float that is nan, which would not equal itself.
    size = 3 * record.itemsize
    filled = default_rng(1).integers(0, 64, size, np.uint8)
    records = filled.view(record)
    objects = record_lists.as_objects(records)
    read_back = record_lists.as_records(objects, record)
    for name in record.names:
        assert np.array_equal(read_back[name], records[name])
    of_nothing = record_lists.as_records([], record)
    assert len(of_nothing) == 0


def test_lengthened_lists_of_records_or_objects_begin_with_what_there_was():
    """Five records, and five objects, are lengthened."""
    pieces = np.ones(5, PIECE)
    pieces["start"] = np.arange(5)
    longer = record_lists.lengthened(pieces, PIECE)
    assert len(longer) > 5
    assert np.array_equal(longer[:5], pieces)
    objects = record_lists.as_objects(pieces)
    longer_objects = record_lists.lengthened(objects, PIECE)
    assert longer_objects[:5] == objects
    assert len(longer_objects) > 5


def test_blank_objects_are_records_of_zeros_and_can_be_set_each_alone():
    """Three blank nodes become records of zeros; after setting the gap of the second,
    only this one changes.
    """
    zeros = np.zeros(3, NODE)

    nodes = record_lists.blank(3, NODE)
    records = record_lists.as_records(nodes, NODE)
    assert records.tobytes() == zeros.tobytes()

    nodes[1].gap = 0.1
    records = record_lists.as_records(nodes, NODE)
    assert records["gap"].tolist() == [0.0, 0.1, 0.0]


# The cache
# --------------------------------------------------------------------------------------


@pytest.fixture
def cache(tmp_path, monkeypatch):
    """An empty folder, in which machine code is kept during the test; it is skipped if
    compiling is disabled.
    """
    if not kernels.enabled():
        pytest.skip("compiling is disabled")
    monkeypatch.setattr("numba.config.CACHE_DIR", str(tmp_path))
    return tmp_path


def new_kernel():
    """A kernel that has been neither compiled nor read, as in a process that begins."""
    return compiling.Compiled(recognise)


def cache_hits(kernel):
    """Call a kernel, and return how often its machine code has been read from disk: 0
    if it was compiled, or 1.
    """
    assert kernel(0.5) == recognise(0.5) == (1, 2)
    return sum(kernel._fast.stats.cache_hits.values())


def test_machine_code_is_found_again_unless_a_source_changed(cache, monkeypatch):
    """A new kernel is read from disk after the first call of one, and compiled anew
    once its digest is another one.
    """
    assert new_kernel().files() == []
    assert cache_hits(new_kernel()) == 0
    (file,) = new_kernel().files()
    assert file.is_relative_to(cache)
    assert cache_hits(new_kernel()) == 1

    def other_digest(module):
        return "a constant of another file changed"

    monkeypatch.setattr(compiling, "digest_of", other_digest)
    assert cache_hits(new_kernel()) == 0
    assert cache_hits(new_kernel()) == 1
    assert cache_hits(new_kernel()) == 1


@pytest.mark.exhaustive
def test_without_a_place_for_machine_code_it_is_made_in_each_process(
    cache, monkeypatch
):
    """numba finds no place for its cache: kernels are compiled each time and keep no
    files.
    """
    from numba import njit

    def nowhere(*arguments, cache=False, **more):
        if cache:
            raise RuntimeError("cannot cache function: no locator available")
        return njit(*arguments, **more)

    monkeypatch.setattr("numba.njit", nowhere)
    for _ in range(2):
        kernel = new_kernel()
        assert cache_hits(kernel) == 0
        assert kernel.place == ""
        assert kernel.files() == []


@pytest.mark.exhaustive
def test_a_full_disk_is_no_failure(cache, monkeypatch):
    """The kernel is compiled without a warning, and no index is kept."""

    def full(*arguments, **more):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)  # by this a file of the cache is placed
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert cache_hits(new_kernel()) == 0
    assert not list(cache.rglob("*.nbi"))


# The index of a kernel (nbi) names the files of its machine code (nbc).
@pytest.mark.exhaustive
@pytest.mark.parametrize(
    ("kind", "share"),
    [("nbi", 0.5), pytest.param("nbc", 0.99, marks=pytest.mark.exhaustive)],
)
def test_files_half_written_are_told_of_and_made_anew(cache, kind, share):
    """A warning says so, and from then on machine code is found again. `share` is the
    part of the file that is there.
    """
    assert cache_hits(new_kernel()) == 0
    (path,) = cache.rglob(f"*.{kind}")
    content = path.read_bytes()
    half_written = int(share * len(content))  # bytes
    path.write_bytes(content[:half_written])
    with pytest.warns(compiling.DamagedCache, match="is damaged; it is made anew"):
        assert cache_hits(new_kernel()) == 0
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert cache_hits(new_kernel()) == 0  # as if nothing had been kept
        assert cache_hits(new_kernel()) == 1


def test_what_calls_functions_of_the_user_is_kept_nowhere(cache):
    """A compiled kernel with a function of the user is found in no cache and leaves no
    file there.
    """
    from numba import njit

    force = njit(lambda overlap, rate: overlap)
    number = 1  # by which a link names the function
    kernel = compiling.Compiled(recognise, ((number, force),))
    assert cache_hits(kernel) == 0
    assert kernel.place == ""
    assert kernel.files() == []
    assert not list(cache.rglob("*.nb?"))
