"""A sweep on disk goes on where it was, and never mixes two sweeps."""

import errno
import json
import os
import signal
import subprocess
import sys

import numpy as np
import pytest

import rodimpact as ri
from rodimpact.storage import checkpoint
from rodimpact.storage.checkpoint import Checkpoint

STEEL = ri.materials.steel


def family(count=30, area=1e-4):
    return ri.System([
        ri.Rod(np.linspace(0.1, 1, count)[:, None], area=area, material=STEEL, velocity=1.0),
        ri.Rod(1.0, area=np.array([1e-4, 3e-4]), material=STEEL),
    ])


@pytest.fixture(autouse=True)
def small_chunks(monkeypatch):
    monkeypatch.setattr("rodimpact.methods.fronts.families.MOST_MEMBERS", 4)


def same(a, b):
    return all(a.columns[k].tobytes() == b.columns[k].tobytes() for k in a.columns)


def test_columns_on_disk_equal_those_in_memory(tmp_path):
    result = ri.sweep(family(), checkpoint=tmp_path / "run")
    assert same(result, ri.sweep(family()))
    on_disk = np.load(tmp_path / "run" / "restitution.npy")
    assert on_disk.tobytes() == result.restitution.tobytes()
    assert on_disk.shape == result.shape


def test_a_single_collision_has_a_checkpoint_too(tmp_path):
    result = ri.sweep(family()[3, 1], checkpoint=tmp_path)
    assert float(result.restitution) == float(ri.sweep(family()).restitution[3, 1])


def test_an_interrupted_sweep_goes_on(tmp_path, monkeypatch):
    """What was done is not done again, and the end is the same."""
    def interrupt(done, total):
        if done >= 20:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ri.sweep(family(), checkpoint=tmp_path, progress=interrupt)
    done = np.load(tmp_path / "done.npy")
    assert 0 < done.sum() < done.size

    runs = []
    work = ri.sweep.__globals__["run_chunk"]
    monkeypatch.setattr(
        "rodimpact.running.sweeping.run_chunk", lambda *a: runs.append(1) or work(*a)
    )
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


KILLED = """
import sys, time
import numpy as np
import rodimpact as ri
from rodimpact.methods.fronts import families
from rodimpact.storage import checkpoint
families.MOST_MEMBERS, checkpoint.SYNC_EVERY = 4, 0.0
sys.path.insert(0, {here!r})
from test_checkpoint import family
def slowly(done, total):
    print(done, flush=True)
    time.sleep(0.02)
ri.sweep(family(200), checkpoint={path!r}, progress=slowly)
"""


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs SIGKILL")
def test_a_killed_process_goes_on_to_the_same_bytes(tmp_path):
    code = KILLED.format(path=str(tmp_path / "run"), here=os.path.dirname(__file__))
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as child:
        while int(child.stdout.readline()) < 100:
            pass
        child.send_signal(signal.SIGKILL)
    done = np.load(tmp_path / "run" / "done.npy")
    assert 0 < done.sum() < done.size
    undisturbed = ri.sweep(family(200))
    assert same(ri.sweep(family(200), checkpoint=tmp_path / "run"), undisturbed)


def test_a_full_disk_is_an_error_that_loses_nothing(tmp_path, monkeypatch):
    write, calls = Checkpoint.write, []

    def full(self, *arguments):
        calls.append(1)
        if len(calls) > 5:
            raise OSError(errno.ENOSPC, "No space left on device")
        write(self, *arguments)

    with monkeypatch.context() as patch:
        patch.setattr(Checkpoint, "write", full)
        with pytest.raises(OSError, match="No space left"):
            ri.sweep(family(), checkpoint=tmp_path)
    assert np.load(tmp_path / "done.npy").sum() == 5
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


def test_a_beginning_that_was_cut_off_is_begun_again(tmp_path):
    (tmp_path / "restitution.npy").write_bytes(b"\x93NUMPY")
    assert same(ri.sweep(family(), checkpoint=tmp_path), ri.sweep(family()))


@pytest.mark.parametrize("damage", ["head", "column", "short", "done"])
def test_damage_is_found(tmp_path, damage):
    ri.sweep(family(), checkpoint=tmp_path)
    if damage == "head":
        (tmp_path / "sweep.json").write_text("{")
    elif damage == "column":
        (tmp_path / "impulse.0.npy").write_bytes(b"nothing")
    elif damage == "short":
        np.save(tmp_path / "impulse.0.npy", np.zeros(3))
    else:
        (tmp_path / "done.npy").unlink()
    with pytest.raises(ri.FileFormatError, match="new directory"):
        ri.sweep(family(), checkpoint=tmp_path)


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


def test_marks_follow_the_numbers(tmp_path, monkeypatch):
    """A chunk is marked only after its numbers were brought to the disk."""
    order = []
    monkeypatch.setattr(checkpoint.os, "fsync", lambda file: order.append(file))
    keep = Checkpoint(tmp_path, {"a": 1}, {"x": (np.dtype(float), (4,))}, 2)
    order.clear()
    keep.write(0, 0, {"x": np.array([1.0, 2.0])})
    assert not np.load(tmp_path / "done.npy").any()
    keep.sync()
    assert order == [keep._open["x"].fileno(), keep._open["done"].fileno()]
    keep.close()
    assert np.load(tmp_path / "done.npy").tolist() == [True, False]
    assert np.load(tmp_path / "x.npy").tolist() == [1.0, 2.0, 0.0, 0.0]
    assert json.loads((tmp_path / "sweep.json").read_text()) == {"a": 1}

