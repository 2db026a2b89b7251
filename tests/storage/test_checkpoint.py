"""A sweep on disk goes on where it was, and never mixes two sweeps."""

import contextlib
import errno
import json
import math
import os
import signal
import subprocess
import sys

import exhaustive
import numpy as np
import pytest

import rodimpact as ri
from rodimpact.running import chunks
from rodimpact.storage import checkpoint
from rodimpact.storage.checkpoint import Checkpoint

STEEL = ri.materials.steel
MANY = 60  # rows of two: thirty chunks
GAUGED = {"until": 3e-4, "gauges": [(0, 0.05), (1, 0.5)], "times": [0.0, 1e-4, 2e-4]}


def family(count=30, area=1e-4):
    return ri.System(
        [
            ri.Rod(
                np.linspace(0.1, 1, count)[:, None],
                area=area,
                material=STEEL,
                velocity=1.0,
            ),
            ri.Rod(1.0, area=np.array([1e-4, 3e-4]), material=STEEL),
        ]
    )


@pytest.fixture(autouse=True)
def small_chunks(monkeypatch):
    monkeypatch.setattr("rodimpact.running.chunks.JOBS_A_WORKER_TO_KEEP", 8)
    monkeypatch.setattr("rodimpact.methods.fronts.families.MAX_MEMBERS_PER_CALL", 4)


def same(a, b):
    return all(a.columns[k].tobytes() == b.columns[k].tobytes() for k in a.columns)


def done_in(path):
    """How many chunks of four members are on the disk."""
    done = set()
    for part in path.glob("members-*.npz"):
        with np.load(part) as file:
            start = json.loads(str(file["document"]))["start"]
            done |= {*range(start // 4, (start + len(file["status"])) // 4)}
    return len(done)


@contextlib.contextmanager
def counted(monkeypatch):
    """Families of the members that are run meanwhile, a chunk each."""
    runs, work = [], chunks.run_chunk
    with monkeypatch.context() as patch:
        patch.setattr(
            "rodimpact.running.chunks.run_chunk",
            lambda *given: runs.append(given[0].system) or work(*given),
        )
        yield runs


def test_what_is_on_disk_equals_what_is_in_memory(tmp_path, monkeypatch):
    result = ri.sweep(family(), checkpoint=tmp_path / "run")
    assert same(result, ri.sweep(family()))
    with counted(monkeypatch) as runs:
        assert same(ri.sweep(family(), checkpoint=tmp_path / "run"), result)
    assert not runs


@pytest.mark.parametrize("options", [{}, GAUGED])
def test_an_interrupted_sweep_goes_on(tmp_path, monkeypatch, options):
    """What was done is not done again, and the end is the same."""

    def interrupt(done, total):
        if done >= 20:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ri.sweep(
            family(), workers=1, checkpoint=tmp_path, progress=interrupt, **options
        )
    done = done_in(tmp_path)
    assert 0 < done < 15
    with counted(monkeypatch) as runs:
        result = ri.sweep(family(), checkpoint=tmp_path, **options)
    assert sum(math.prod(chunk.shape) for chunk in runs) == 60 - 4 * done
    whole = ri.sweep(family(), **options)
    assert same(result, whole)
    assert not options or result.strain.tobytes() == whole.strain.tobytes()


def test_members_that_are_done_do_not_follow_a_job(tmp_path, monkeypatch):
    """The first chunk alone is run again: no member follows its last job."""
    for name in ("SAVE_INTERVAL", "SAVE_TIME_RATIO"):  # a file for each chunk
        monkeypatch.setattr(f"rodimpact.storage.checkpoint.{name}", 0.0)
    ri.sweep(family(), workers=1, checkpoint=tmp_path)
    first = min(tmp_path.glob("members-*.npz"))
    first.unlink()
    later = []
    work = chunks.run_chunk

    def noted(chunk, should_stop, later_members):
        later.append(later_members)
        return work(chunk, should_stop, later_members)

    monkeypatch.setattr(chunks, "run_chunk", noted)
    ri.sweep(family(), workers=1, checkpoint=tmp_path)

    assert later[-1] == 0


def child(path, then):
    """Another process that sweeps a family, with what stands in `then` as progress."""
    code = f"""
import sys, time
sys.path.extend({[os.path.dirname(__file__), os.path.dirname(exhaustive.__file__)]})
import rodimpact as ri
from rodimpact.methods.fronts import families
from rodimpact.running import chunks
from rodimpact.storage import checkpoint
from test_checkpoint import MANY, family
families.MAX_MEMBERS_PER_CALL, checkpoint.SAVE_INTERVAL, checkpoint.SAVE_TIME_RATIO = 4, 0.0, 0.0
def progress(done, total):
    {then}
chunks.JOBS_A_WORKER_TO_KEEP = 8
print("ready", flush=True)
sys.stdin.readline()
ri.sweep(family(MANY), checkpoint={str(path)!r}, progress=progress)
"""
    pipes = {
        "stdin": subprocess.PIPE,
        "stdout": subprocess.PIPE,
        "stderr": subprocess.PIPE,
    }
    process = subprocess.Popen(
        [sys.executable, "-W", "ignore", "-c", code], text=True, **pipes
    )
    assert process.stdout.readline() == "ready\n", process.stderr.read()
    return process


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs SIGKILL")
@pytest.mark.parametrize("seed", exhaustive.few_of(range(2), [0]))
def test_a_killed_process_goes_on_to_the_same_bytes(tmp_path, seed):
    """Killed a few times at random, then left alone."""
    rng, kept = np.random.default_rng(seed), tmp_path / "run"
    done, marks = 0, []
    while done < 90 and len(marks) < 2:
        with child(kept, "print(done, flush=True); time.sleep(0.01)") as process:
            process.stdin.write("\n")
            process.stdin.flush()
            aim = min(done + int(rng.integers(10, 60)), 90)
            while done < aim:
                done = int(process.stdout.readline())
            process.send_signal(signal.SIGKILL)
        marks.append(done_in(kept))
    assert 0 < marks[0] < 30
    assert marks == sorted(marks)
    assert same(ri.sweep(family(MANY), checkpoint=kept), ri.sweep(family(MANY)))
    assert all(
        path.match("members-*.npz")
        for path in kept.iterdir()
        if not path.name.startswith(".rodimpact-")
    )  # of a process that was killed


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
            ri.sweep(family(), workers=1, checkpoint=tmp_path)
    assert done_in(tmp_path) == 5
    assert same(ri.sweep(family(), checkpoint=tmp_path), ri.sweep(family()))


@pytest.mark.parametrize(
    ("system", "change", "what"),
    [
        (family(area=2e-4), {}, "system"),
        (family(31), {}, "system and shape"),
        (family(), {"max_events": 7}, "max_events"),
        (family(), {"until": 1e-3}, "until"),
        (family(), {"times": [0.0, 1e-4, 3e-4]}, "times"),
    ],
)
def test_another_sweep_is_refused(tmp_path, system, change, what):
    ri.sweep(family(), checkpoint=tmp_path, **GAUGED)
    with pytest.raises(ri.FileFormatError, match=f"another {what};"):
        ri.sweep(system, checkpoint=tmp_path, **GAUGED | change)


def test_a_foreign_directory_is_refused(tmp_path):
    (tmp_path / "thesis.tex").write_text("years of work")
    with pytest.raises(ri.FileFormatError, match=r"thesis\.tex"):
        ri.sweep(family(), checkpoint=tmp_path)
    assert [p.name for p in tmp_path.iterdir()] == ["thesis.tex"]


COLUMNS = [
    "restitution",
    "velocity_after.0",
    "velocity_after.1",
    "impulse.0",
    "peak_force.0",
    "duration.0",
    "episodes.0",
    "vibration",
    "final",
    "status",
]


def parts(path, monkeypatch):
    """Files of a sweep, one a chunk."""
    monkeypatch.setattr(checkpoint, "SAVE_INTERVAL", 0.0)
    monkeypatch.setattr(checkpoint, "SAVE_TIME_RATIO", 0.0)
    result = ri.sweep(family(), workers=1, checkpoint=path)
    assert {*result.columns} == {*COLUMNS}
    files = sorted(path.iterdir())
    assert len(files) == 15
    return result, files


@pytest.mark.parametrize(
    "damage",
    [
        lambda data: b"",
        lambda data: data[:-1],
        lambda data: b"years of work",
        lambda data: data[:-400] + bytes([data[-400] ^ 1]) + data[-399:],
    ],
)
def test_a_damaged_file_is_told_and_only_its_members_run_again(
    tmp_path, monkeypatch, damage
):
    result, files = parts(tmp_path, monkeypatch)
    damaged = damage(files[4].read_bytes())
    files[4].write_bytes(damaged)
    with (
        counted(monkeypatch) as runs,
        pytest.warns(ri.DamagedChunks, match=rf"{files[4].name}: is .*run again"),
    ):
        again = ri.sweep(family(), checkpoint=tmp_path)
    lengths = [chunk.bodies[0].length for chunk in runs]
    assert {*np.ravel(lengths)} == {*family().bodies[0].length[8:10, 0]}
    assert same(again, result)
    (aside,) = tmp_path.glob(".rodimpact-*")
    assert aside.read_bytes() == damaged  # perhaps somebody wants it
    with counted(monkeypatch) as runs:
        ri.sweep(family(), checkpoint=tmp_path)
    assert not runs


def test_a_file_of_another_sweep_is_refused(tmp_path, monkeypatch):
    _, files = parts(tmp_path / "run", monkeypatch)
    ri.sweep(family(area=2e-4), checkpoint=tmp_path / "other")
    next((tmp_path / "other").iterdir()).replace(files[3])
    with pytest.raises(
        ri.FileFormatError, match="holds another sweep, with another system;"
    ):
        ri.sweep(family(), checkpoint=tmp_path / "run")


@pytest.mark.skipif(
    os.name != "posix" or os.geteuid() == 0, reason="needs a user with limits"
)
def test_a_directory_that_cannot_be_written_is_told_at_once(tmp_path, monkeypatch):
    tmp_path.chmod(0o500)
    with (
        counted(monkeypatch) as runs,
        pytest.raises(PermissionError, match="may not write"),
    ):
        ri.sweep(family(), checkpoint=tmp_path)
    assert not runs


def test_two_processes_may_start_on_one_directory(tmp_path):
    """Neither harms what the other has written."""
    children = [child(tmp_path / "run", "pass") for _ in range(2)]
    for process in children:
        process.stdin.write("\n")
        process.stdin.flush()
    assert [process.communicate()[1] for process in children] == [""] * 2
    assert done_in(tmp_path / "run") == 30
    assert same(
        ri.sweep(family(MANY), checkpoint=tmp_path / "run"), ri.sweep(family(MANY))
    )


def test_a_file_is_no_directory(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError, match="file"):
        ri.sweep(family(), checkpoint=tmp_path / "file")


def test_a_refused_member_is_known_when_the_sweep_goes_on(tmp_path, monkeypatch):
    lengths = np.array([0.5, 1e-13, 0.7])
    system = ri.System(
        [
            ri.Rod(lengths, area=1e-4, material=STEEL, velocity=1.0),
            ri.Rod(1.0, area=1e-4, material=STEEL),
        ]
    )
    ri.sweep(system, checkpoint=tmp_path)
    with counted(monkeypatch) as runs:
        again = ri.sweep(system, checkpoint=tmp_path)
    assert not runs
    assert again.incomplete.tolist() == [False, True, False]
