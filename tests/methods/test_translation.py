"""Kernels as machine code: what is made, and what is kept on disk."""

import importlib.util
import math
import os
import subprocess
import sys
import warnings
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from exhaustive import few_of

from rodimpact.methods import kernel_parts, kernels, machine_code
from rodimpact.methods.tick_rule_kernel import assign_ticks, common_parts, recognise

pytest.importorskip("numba")
if not kernels.enabled():
    pytest.skip("compiling is disabled", allow_module_level=True)

import numba
from numba.core.caching import FunctionCache
from rodimpact.methods.columns import Columns

from rodimpact.methods import translation

DURATIONS = np.array([1.0, 0.5, math.sqrt(0.5), 1 / 3])


def ticks():
    """What a kernel of several parts says."""
    work = [np.zeros(4, dtype=np.int64) for _ in range(4)]
    whole = kernels.compiled(assign_ticks)(DURATIONS, 49, *work)
    return whole, [column.tolist() for column in work]


def again():
    """As if another process began."""
    for cached in (translation.translate, translation._part, kernels._compiled,
                   kernel_parts.sources, machine_code._tell_of_damage):
        cached.cache_clear()


@pytest.fixture
def cache(tmp_path, monkeypatch):
    """A cache of machine code of its own."""
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path))
    again()
    yield tmp_path
    again()


def files(cache):
    return [path for path in cache.rglob("*") if path.is_file()]


def test_numba_has_the_insides_that_parts_and_files_need(cache):
    """Where this fails, look how a newer numba links libraries and keeps code, and mend that."""
    assert numba.version_info[:2] <= translation.NEWEST
    ticks()
    assert type(kernels.compiled(assign_ticks)._cache) is translation.Kept
    (part,) = translation._part(common_parts).overloads.values()
    assert type(part.library) is translation.Part
    kernels.compiled(total)(pair())
    ((seen,),) = kernels.compiled(total).overloads
    assert type(seen) is Columns
    assert any(file.name.startswith("rodimpact.methods.tick_rule_kernel.assign_ticks.")
               for file in files(cache))


@pytest.mark.exhaustive
def test_a_newer_numba_finishes_every_function(cache, monkeypatch):
    expected = ticks()
    monkeypatch.setattr(translation, "NEWEST", (0, 0))
    again()
    for path in files(cache):
        path.unlink()
    assert ticks() == expected
    libraries = [x.library for x in translation._part(common_parts).overloads.values()]
    assert translation.Part not in map(type, libraries)


class Pair(NamedTuple):
    a: Any
    b: Any


class Three(NamedTuple):
    number: Any
    whole: Any
    flag: Any


def pair():
    return Pair(np.array([1.0, 2.0, 4.0]), np.array([8.0]))


def total(columns):
    found, count = 0.0, 0
    for column in columns:
        for x in column:
            found, count = found + x, count + len(column)
    return found, count


def rotate(columns):
    """Read and write at both ends, as whole numbers, fractions and flags."""
    columns.number[-1], columns.number[0] = columns.number[0], columns.whole[-2]
    columns.whole[1] += 3
    columns.flag[0] = columns.number[0] > columns.whole[0]
    for i in range(len(columns.flag)):
        if columns.flag[i]:
            columns.number[1] += columns.flag[i - 1]


def both(pairs, other):
    return total(pairs[0])[0] - total(pairs[1])[0] + other.b[0]


def three():
    return Three(np.array([0.5, 1.5, 2.5]), np.array([7, 8, 9]), np.array([False, True]))


def as_lists(columns):
    return type(columns)(*(column.tolist() for column in columns))


def test_columns_are_read_and_written_as_lists_are(cache):
    fast, slow = three(), as_lists(three())
    kernels.compiled(rotate)(fast)
    rotate(slow)
    assert as_lists(fast) == slow != as_lists(three())
    assert kernels.compiled(total)(pair()) == total(pair()) == (15.0, 10)
    pairs = pair(), Pair(*(-x for x in pair()))
    assert kernels.compiled(both)(pairs, pair()) == both(pairs, pair()) == 38.0
    with pytest.raises(numba.errors.TypingError, match="differ in type"):
        kernels.compiled(total)(three())


@pytest.mark.parametrize("kind", ["strided", "read only"])
def test_arrays_of_another_kind_are_read_too(cache, kind):
    array = np.arange(8.0)
    columns = Pair(array[::2], array)
    if kind == "read only":
        array.flags.writeable = False
        columns = Pair(array, array)
    assert kernels.compiled(ends)(columns) == ends(columns)
    ((seen,),) = kernels.compiled(ends).overloads
    assert type(seen) is not Columns


def ends(columns):
    return columns.a[0] + 10 * columns.a[-1] + 100 * columns.b[1]


def test_read_only_arrays_are_not_written_to(cache):
    columns = three()
    columns.number.flags.writeable = False
    with pytest.raises(numba.errors.TypingError):
        kernels.compiled(rotate)(columns)
    assert as_lists(columns) == as_lists(three())


def test_an_error_in_a_part_is_that_of_plain_python(cache):
    zero = np.zeros(4)
    work = [np.zeros(4, dtype=np.int64) for _ in range(4)]
    for call in (kernels.compiled(assign_ticks), assign_ticks):
        with pytest.raises(ZeroDivisionError):
            call(zero if call is not assign_ticks else zero.tolist(), 49, *work)


def test_machine_code_is_found_again(cache):
    expected = ticks()
    again()
    assert translation.on_disk(assign_ticks)
    assert not translation.on_disk(recognise)
    assert ticks() == expected
    assert sum(kernels.compiled(assign_ticks).stats.cache_hits.values()) == 1
    assert not translation._part(recognise).overloads


def test_touching_the_same_files_makes_nothing_anew(cache, monkeypatch):
    ticks()
    again()
    stat = os.stat
    monkeypatch.setattr(os, "stat", lambda name, **how: type(stat(name, **how))(
        [*stat(name, **how)[:8], 0, *stat(name, **how)[9:]]))
    assert translation.on_disk(assign_ticks)


@pytest.mark.parametrize("changed", ["sources", "numba", "switches"])
def test_other_sources_or_compilers_have_other_machine_code(cache, monkeypatch, changed):
    expected = ticks()
    (old,) = files(cache)
    again()
    if changed == "sources":
        monkeypatch.setattr(translation, "sources", lambda: b"a constant of another file changed")
    elif changed == "numba":
        monkeypatch.setattr(numba, "__version__", "0.0.1")
    else:
        monkeypatch.setitem(translation.SWITCHES, "nogil", False)
    assert not translation.on_disk(assign_ticks)
    assert ticks() == expected
    (new,) = files(cache)
    assert new != old


def test_a_changed_kernel_file_changes_the_digest(tmp_path, monkeypatch):
    monkeypatch.setattr(kernel_parts, "PACKAGE", tmp_path)
    digests = set()
    for text in ("A = 1", "A = 2", "A = 1"):
        (tmp_path / "a_kernel.py").write_text(text)
        kernel_parts.sources.cache_clear()
        digests.add(kernel_parts.sources())
    (tmp_path / "b_kernel.py").write_text("")
    kernel_parts.sources.cache_clear()
    digests.add(kernel_parts.sources())
    kernel_parts.sources.cache_clear()
    assert len(digests) == 3


def test_two_signatures_are_two_files(cache):
    compiled = kernels.compiled(recognise)
    assert compiled(0.5) == compiled(np.float32(0.5)) == (1, 2)
    assert len(files(cache)) == 2
    again()
    compiled = kernels.compiled(recognise)
    assert compiled(0.5) == compiled(np.float32(0.5)) == (1, 2)
    assert len(compiled.stats.cache_hits) == 2


def test_without_a_writable_place_for_the_cache(cache, monkeypatch):
    def nowhere(*arguments):
        raise RuntimeError("no locator available")

    monkeypatch.setattr(FunctionCache, "__init__", nowhere)
    assert kernels.compiled(recognise)(0.5) == (1, 2)
    assert kernels.cache_directory(recognise) == ""
    assert not translation.on_disk(recognise)
    assert not files(cache)


@pytest.mark.parametrize("where", ["mkdir", "write_bytes"])
def test_when_the_cache_cannot_be_written_at_the_first_call(cache, monkeypatch, where):
    def full_disk(*arguments, **more):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, where, full_disk)
    fast = kernels.compiled(recognise)
    assert fast(0.5) == (1, 2)
    assert fast(0.25) == (1, 4)
    assert not files(cache)


@pytest.mark.parametrize("seed", few_of(range(100), range(6)))
def test_no_damage_to_the_cache_goes_unnoticed(cache, seed):
    """Bytes changed, lost, or another kernel's: machine code is made anew, and kept."""
    rng = np.random.default_rng(seed)
    assert kernels.compiled(recognise)(0.5) == (1, 2)
    (path,) = files(cache)
    data = bytearray(path.read_bytes())
    whole = bytes(data)
    damage = rng.integers(4)
    if damage == 0:
        data[rng.integers(len(data))] ^= 1 << rng.integers(8)
    elif damage == 1:
        del data[rng.integers(len(data)) :]
    elif damage == 2:
        data = bytearray(rng.bytes(len(data)))
    else:
        start = rng.integers(len(data))
        data[start : start + 16] = bytes(16)
    path.write_bytes(data)
    again()
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        assert kernels.compiled(recognise)(0.5) == (1, 2)
    assert [warning.category for warning in told] == (
        [machine_code.DamagedCache] if data != whole else [])
    again()
    assert kernels.compiled(recognise)(0.25) == (1, 4)  # and nothing is told


def test_copies_of_a_kernel_file_do_not_take_each_others_code(cache):
    """As in two environments with one directory for machine code."""
    answers = {}
    for place, answer in (("one", 1), ("two", 2)):
        folder = cache / "copies" / place
        folder.mkdir(parents=True)
        (folder / "a_kernel.py").write_text(f"def answer(x):\n    return {answer} * x\n")
        loader = importlib.util.spec_from_file_location("a_kernel", folder / "a_kernel.py")
        module = importlib.util.module_from_spec(loader)
        loader.loader.exec_module(module)
        answers[place] = kernels.compiled(module.answer)(10)
    assert answers == {"one": 10, "two": 20}
    assert len([*cache.rglob("*.nbc")]) == 2


def test_machine_code_of_another_kernel_is_not_run(cache):
    assert kernels.compiled(recognise)(0.5) == (1, 2)
    (path,) = files(cache)
    ticks()
    (other,) = set(files(cache)) - {path}
    path.write_bytes(other.read_bytes())
    again()
    with pytest.warns(machine_code.DamagedCache, match="is damaged; it is made anew"):
        assert kernels.compiled(recognise)(0.5) == (1, 2)


ONE_CALL = """
import numpy as np
from rodimpact.methods import kernels
from rodimpact.results import field_kernel as k
print(kernels.compiled(k.first_at_or_after)(np.array([1, 5, 9]), 6, 0))
"""


def call_in_processes(count, **variables):
    """Output and errors of processes that call a compiled kernel at the same time."""
    started = [
        subprocess.Popen([sys.executable, "-c", ONE_CALL], env={**os.environ, **variables},
                         stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        for _ in range(count)
    ]
    return [process.communicate() for process in started]


def test_a_damaged_cache_is_made_anew(tmp_path):
    """Files that a crash left half written, read by several processes at once."""
    place = {"NUMBA_CACHE_DIR": str(tmp_path)}
    assert call_in_processes(1, **place) == [("2\n", "")]
    kept = files(tmp_path)
    assert kept
    for file in kept:
        whole = file.read_bytes()
        file.write_bytes(whole[: len(whole) // 2])
    for output, errors in call_in_processes(3, **place):
        assert output == "2\n"
        assert errors.count("DamagedCache: machine code in") <= 1
        assert "Traceback" not in errors
    assert call_in_processes(1, **place) == [("2\n", "")]
    assert files(tmp_path) == kept
