"""A sweep on disk goes on where it was, and never mixes two sweeps."""

import contextlib
import errno
import json
import os
import signal
import subprocess
import sys

import exhaustive
import numpy as np
import pytest

import rodimpact as ri
from rodimpact.storage import checkpoint
from rodimpact.storage.checkpoint import Checkpoint

STEEL = ri.materials.steel
MANY = 60  # rows of two: thirty chunks


def family(count=30, area=1e-4):
    return ri.System([
        ri.Rod(np.linspace(0.1, 1, count)[:, None], area=area, material=STEEL, velocity=1.0),
        ri.Rod(1.0, area=np.array([1e-4, 3e-4]), material=STEEL),
    ])


@pytest.fixture(autouse=True)
def small_chunks(monkeypatch):
    monkeypatch.setattr("rodimpact.methods.fronts.method.MOST_MEMBERS", 4)


def same(a, b):
    return all(a.columns[k].tobytes() == b.columns[k].tobytes() for k in a.columns)


def done_in(path):
    return np.load(path / "checksums.npy") != 0


@contextlib.contextmanager
def counted(monkeypatch):
    """The chunks that are run meanwhile."""
    runs, work = [], ri.sweep.__globals__["run_chunk"]
    with monkeypatch.context() as patch:
        patch.setattr("rodimpact.running.sweeping.run_chunk",
                      lambda *given: runs.append(given[0]) or work(*given))
        yield runs


def test_columns_on_disk_equal_those_in_memory(tmp_path):
    result = ri.sweep(family(), checkpoint=tmp_path / "run")
    assert same(result, ri.sweep(family()))
    on_disk = np.load(tmp_path / "run" / "restitution.npy")
    assert on_disk.tobytes() == result.restitution.tobytes()
    assert on_disk.shape == result.shape


def test_an_interrupted_sweep_goes_on(tmp_path, monkeypatch):
    """What was done is not done again, and the end is the same."""
    def interrupt(done, total):
        if done >= 20:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ri.sweep(family(), checkpoint=tmp_path, progress=interrupt)
    done = done_in(tmp_path)
    assert 0 < done.sum() < done.size
    with counted(monkeypatch) as runs:
        result = ri.sweep(family(), checkpoint=tmp_path)
    assert len(runs) == done.size - done.sum()
    assert same(result, ri.sweep(family()))


def test_strains_are_kept_too(tmp_path):
    options = {"until": 3e-4, "gauges": [(0, 0.05), (1, 0.5)], "times": [0.0, 1e-4, 2e-4]}

    def interrupt(done, total):
        if done >= 20:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ri.sweep(family(), checkpoint=tmp_path, progress=interrupt, **options)
    result = ri.sweep(family(), checkpoint=tmp_path, **options)
    assert result.strain.tobytes() == ri.sweep(family(), **options).strain.tobytes()
    assert np.load(tmp_path / "strain.npy").shape == (30, 2, 2, 3)
    with pytest.raises(ri.FileFormatError, match="another times;"):
        ri.sweep(family(), checkpoint=tmp_path, **{**options, "times": [0.0, 1e-4, 3e-4]})


def child(path, then):
    """Another process that sweeps a family, with what stands in `then` as progress."""
    code = f"""
import sys, time
sys.path.extend({[os.path.dirname(__file__), os.path.dirname(exhaustive.__file__)]})
import rodimpact as ri
from rodimpact.methods.fronts import method
from rodimpact.storage import checkpoint
from test_checkpoint import MANY, family
method.MOST_MEMBERS, checkpoint.SYNC_EVERY = 4, 0.0
def progress(done, total):
    {then}
print("ready", flush=True)
sys.stdin.readline()
ri.sweep(family(MANY), checkpoint={str(path)!r}, progress=progress)
"""
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    process = subprocess.Popen([sys.executable, "-W", "ignore", "-c", code], text=True, **pipes)
    assert process.stdout.readline() == "ready\n", process.stderr.read()
    return process


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs SIGKILL")
@pytest.mark.parametrize("seed", exhaustive.few_of(range(4), [0]))
def test_a_killed_process_goes_on_to_the_same_bytes(tmp_path, seed):
    """Killed a few times at random, then left alone."""
    rng, kept = np.random.default_rng(seed), tmp_path / "run"
    done, marks = 0, []
    while done < 90 and len(marks) < 3:
        with child(kept, "print(done, flush=True); time.sleep(0.01)") as process:
            process.stdin.write("\n")
            process.stdin.flush()
            aim = min(done + int(rng.integers(10, 60)), 90)
            while done < aim:
                done = int(process.stdout.readline())
            process.send_signal(signal.SIGKILL)
        marks.append(done_in(kept).sum())
    assert 0 < marks[0] < 30
    assert marks == sorted(marks)
    assert same(ri.sweep(family(MANY), checkpoint=kept), ri.sweep(family(MANY)))
    assert all(name.endswith((".npy", ".json")) for name in os.listdir(kept))


def test_a_full_disk_is_an_error_that_loses_nothing(tmp_path, monkeypatch):
    put, calls = Checkpoint.put, []

    def full(self, *arguments):
        calls.append(1)
        if len(calls) > 5:
            raise OSError(errno.ENOSPC, "No space left on device")
        put(self, *arguments)

    with monkeypatch.context() as patch:
        patch.setattr(Checkpoint, "put", full)
        with pytest.raises(OSError, match="No space left"):
            ri.sweep(family(), checkpoint=tmp_path)
    assert done_in(tmp_path).sum() == 5
    assert same(ri.sweep(family(), checkpoint=tmp_path), ri.sweep(family()))


@pytest.mark.parametrize(("system", "options", "what"), [
    (family(area=2e-4), {}, "system"), (family(31), {}, "system and shape"),
    (family(), {"max_events": 7}, "max_events"), (family(), {"until": 1e-3}, "until"),
])
def test_another_sweep_is_refused(tmp_path, system, options, what):
    ri.sweep(family(), checkpoint=tmp_path)
    with pytest.raises(ri.FileFormatError, match=f"another {what};"):
        ri.sweep(system, checkpoint=tmp_path, on_error="record", **options)


def test_a_foreign_directory_is_refused(tmp_path):
    (tmp_path / "thesis.tex").write_text("years of work")
    with pytest.raises(ri.FileFormatError, match=r"thesis\.tex"):
        ri.sweep(family(), checkpoint=tmp_path)
    assert [p.name for p in tmp_path.iterdir()] == ["thesis.tex"]


def test_a_file_of_the_users_own_is_not_overwritten(tmp_path):
    """Though it has the name of a column."""
    (tmp_path / "restitution.npy").write_bytes(b"years of work")
    with pytest.raises(ri.FileFormatError, match=r"holds 'restitution\.npy'; name a new"):
        ri.sweep(family(), checkpoint=tmp_path)
    assert os.listdir(tmp_path) == ["restitution.npy"]
    assert (tmp_path / "restitution.npy").read_bytes() == b"years of work"


@pytest.mark.parametrize("kept", ["sweep.json", "sweep.json restitution.npy"])
def test_a_beginning_that_was_cut_off_is_begun_again(tmp_path, kept):
    ri.sweep(family(), checkpoint=tmp_path)
    for path in tmp_path.iterdir():
        if path.name not in kept:
            path.unlink()
    (tmp_path / ".rodimpact-0123456789abcdef").write_bytes(b"of a process that was killed")
    assert same(ri.sweep(family(), checkpoint=tmp_path), ri.sweep(family()))


COLUMNS = ["restitution", "velocity_after.0", "velocity_after.1", "impulse.0", "peak_force.0",
           "duration.0", "episodes.0", "vibration", "final", "status"]


@pytest.mark.parametrize("column", ["velocity_after.1", "status", "checksums"])
def test_a_flipped_bit_is_told_and_only_its_chunk_run_again(tmp_path, monkeypatch, column):
    result = ri.sweep(family(), checkpoint=tmp_path)
    assert {*result.columns} == {*COLUMNS}
    path, member = tmp_path / f"{column}.npy", 17
    data, numbers = bytearray(path.read_bytes()), np.load(path)
    assert numbers.size == (15 if column == "checksums" else 60)  # chunks of four
    place = member // 4 if column == "checksums" else member
    data[len(data) - numbers.nbytes + place * numbers.itemsize] ^= 1
    path.write_bytes(data)
    with counted(monkeypatch) as runs, pytest.warns(ri.DamagedChunks, match=r"1 of 15, .* 4 on"):
        again = ri.sweep(family(), checkpoint=tmp_path)
    assert runs == [family()[8:10]]
    assert same(again, result)
    with counted(monkeypatch) as runs:
        ri.sweep(family(), checkpoint=tmp_path)
    assert not runs


def test_what_a_column_held_that_is_gone_is_run_again(tmp_path):
    ri.sweep(family(), checkpoint=tmp_path)
    (tmp_path / "impulse.0.npy").unlink()
    with pytest.warns(ri.DamagedChunks, match="15 of 15"):
        again = ri.sweep(family(), checkpoint=tmp_path)
    assert same(again, ri.sweep(family()))


@pytest.mark.parametrize("name", ["impulse.0.npy", "checksums.npy"])
@pytest.mark.parametrize("damage", [
    b"", b"\x93NUMPY", "short", "cut", "columns first", "type",
], ids=repr)
def test_a_file_that_is_no_such_column_is_refused_and_kept(tmp_path, name, damage):
    ri.sweep(family(), checkpoint=tmp_path)
    path = tmp_path / name
    numbers = np.load(path)
    if damage == "cut":
        path.write_bytes(path.read_bytes()[:-1])
    elif isinstance(damage, bytes):
        path.write_bytes(damage)
    else:
        np.save(path, {"short": numbers[:-1], "columns first": np.asfortranarray(numbers[None]),
                       "type": numbers.astype(np.float32)}[damage])
    before = path.read_bytes()
    with pytest.raises(ri.FileFormatError, match=rf"{name}: is damaged.*new directory"):
        ri.sweep(family(), checkpoint=tmp_path)
    assert path.read_bytes() == before


@pytest.mark.parametrize("head", [b"", b"{", b"[[1, 2]]",
                                  b"\xff\xfe", b"[" * 100_000, b"1" * 5000], ids=lambda h: h[:9])
def test_a_damaged_head_is_refused(tmp_path, head):
    ri.sweep(family(), checkpoint=tmp_path)
    (tmp_path / "sweep.json").write_bytes(head)
    with pytest.raises(ri.FileFormatError, match=r"sweep\.json: is damaged.*new directory"):
        ri.sweep(family(), checkpoint=tmp_path)


def test_two_processes_may_start_on_one_directory(tmp_path):
    """Neither harms what the other has written."""
    children = [child(tmp_path / "run", "pass") for _ in range(2)]
    for process in children:
        process.stdin.write("\n")
        process.stdin.flush()
    assert [process.communicate()[1] for process in children] == [""] * 2
    assert done_in(tmp_path / "run").all()
    assert same(ri.sweep(family(MANY), checkpoint=tmp_path / "run"), ri.sweep(family(MANY)))


def test_a_file_is_no_directory(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError, match="file"):
        ri.sweep(family(), checkpoint=tmp_path / "file")


def test_errors_are_raised_again_when_resumed(tmp_path):
    lengths = np.array([0.5, 1e-13, 0.7])
    system = ri.System([ri.Rod(lengths, area=1e-4, material=STEEL, velocity=1.0),
                        ri.Rod(1.0, area=1e-4, material=STEEL)])
    ri.sweep(system, on_error="record", checkpoint=tmp_path)
    with pytest.raises(ri.SweepError, match=r"member \[1\]"):
        ri.sweep(system, on_error="raise", checkpoint=tmp_path)


def test_checksums_follow_the_numbers(tmp_path, monkeypatch):
    """A chunk is done only after its numbers were brought to the disk."""
    order = []
    keep = Checkpoint(tmp_path, {"a": 1}, {"x": (np.dtype(float), (4,))}, [(0, 2), (2, 4)])
    monkeypatch.setattr(checkpoint.os, "fsync", lambda file: order.append(file))
    keep.put(0, 2, {"x": np.array([1.0, 2.0])})
    assert not done_in(tmp_path).any()
    keep.sync()
    assert order == [keep._open["x"].fileno(), keep._open["checksums"].fileno()]
    keep.close()
    assert done_in(tmp_path).tolist() == [True, False]
    assert np.load(tmp_path / "x.npy").tolist() == [1.0, 2.0, 0.0, 0.0]
    assert json.loads((tmp_path / "sweep.json").read_text()) == {"a": 1}
