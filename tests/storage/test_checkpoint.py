"""A sweep on disk goes on where it was, and never mixes two sweeps."""

import contextlib
import errno
import json
import math
import os
import shutil
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
CHUNK = 4
"""Members of a chunk, by the fixture `small_chunks`."""
ROWS = 30
"""Rows of a family, of two members each: 15 chunks."""
MANY_ROWS = 60
"""Rows of a large family, of two members each: 30 chunks."""
N_CHUNKS = 2 * ROWS // CHUNK
GAUGED = {"until": 3e-4, "gauges": [(0, 0.05), (1, 0.5)], "times": [0.0, 1e-4, 2e-4]}


def family(rows=ROWS, striker_area=1e-4):
    """A family [rows, 2], by the length of the striker, 0.1 to 1 m, and the area of the
    struck rod, 1e-4 or 3e-4 m^2. Not swept.
    """
    lengths = np.linspace(0.1, 1, rows)[:, None]
    striker = ri.Rod(lengths, area=striker_area, material=STEEL, velocity=1.0)
    struck = ri.Rod(1.0, area=np.array([1e-4, 3e-4]), material=STEEL)
    return ri.System([striker, struck])


@pytest.fixture(autouse=True)
def small_chunks(monkeypatch):
    """Small families make many chunks and jobs."""
    monkeypatch.setattr("rodimpact.running.chunks.JOBS_A_WORKER_TO_KEEP", 8)
    monkeypatch.setattr("rodimpact.methods.fronts.families.MAX_MEMBERS_PER_CALL", CHUNK)


def save_every_chunk(monkeypatch):
    """Let a sweep write a file for each chunk, however quick it is."""
    monkeypatch.setattr(checkpoint, "SAVE_INTERVAL", 0.0)
    monkeypatch.setattr(checkpoint, "SAVE_TIME_RATIO", 0.0)


def same(result, other):
    """Whether two sweeps have the same columns with the same bits."""
    if result.columns.keys() != other.columns.keys():
        return False
    for name, column in result.columns.items():
        if column.tobytes() != other.columns[name].tobytes():
            return False
    return True


def chunks_on_disk(path):
    """Number of chunks of a sweep whose members are in the files of a folder."""
    numbers = set()
    for part in path.glob("members-*.npz"):
        with np.load(part) as file:
            start = json.loads(str(file["document"]))["start"]
            end = start + len(file["status"])
            numbers.update(range(start // CHUNK, end // CHUNK))
    return len(numbers)


@contextlib.contextmanager
def recorded_families(monkeypatch):
    """In the block: a list to which each chunk of a sweep that runs adds its part of
    the family, a system. Chunks that are read from disk add nothing.
    """
    families = []
    run_chunk = chunks.run_chunk

    def recording(chunk, *arguments):
        families.append(chunk.system)
        return run_chunk(chunk, *arguments)

    with monkeypatch.context() as patch:
        patch.setattr("rodimpact.running.chunks.run_chunk", recording)
        yield families


def test_a_finished_sweep_is_read_as_it_was_run_without_running(tmp_path, monkeypatch):
    """A second sweep with the same checkpoint runs no member."""
    first = ri.sweep(family(), checkpoint=tmp_path)
    with recorded_families(monkeypatch) as families_run:
        second = ri.sweep(family(), checkpoint=tmp_path)

    in_memory = ri.sweep(family())
    assert same(first, in_memory)
    assert same(second, in_memory)
    assert families_run == []


@pytest.mark.parametrize("readings", exhaustive.few_of([{}, GAUGED], [GAUGED]))
def test_an_interrupted_sweep_goes_on(tmp_path, monkeypatch, readings):
    """A sweep is interrupted after 20 members. The next one runs only the members of
    the missing chunks, and has the bits of an uninterrupted one, with gauges as well.
    """
    options = {"checkpoint": tmp_path, **readings}

    def interrupt(done, total):
        if done >= 20:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ri.sweep(family(), workers=1, progress=interrupt, **options)
    chunks_done = chunks_on_disk(tmp_path)
    with recorded_families(monkeypatch) as families_run:
        result = ri.sweep(family(), **options)

    assert 0 < chunks_done < N_CHUNKS
    members_run = sum(math.prod(chunk.shape) for chunk in families_run)
    n_members = 2 * ROWS
    assert members_run == n_members - CHUNK * chunks_done
    uninterrupted = ri.sweep(family(), **readings)
    assert same(result, uninterrupted)
    if readings:
        assert result.strain.tobytes() == uninterrupted.strain.tobytes()


def test_a_job_knows_of_no_later_members_that_are_done(tmp_path, monkeypatch):
    """The file of the first chunk of a finished sweep is removed, and the sweep is run
    again: the last job is told that no members follow it.
    """
    save_every_chunk(monkeypatch)
    ri.sweep(family(), workers=1, checkpoint=tmp_path)
    first = min(tmp_path.glob("members-*.npz"))
    first.unlink()
    later_members_of_jobs = []
    run_chunk = chunks.run_chunk

    def recording(chunk, should_stop, later_members):
        later_members_of_jobs.append(later_members)
        return run_chunk(chunk, should_stop, later_members)

    monkeypatch.setattr(chunks, "run_chunk", recording)
    ri.sweep(family(), workers=1, checkpoint=tmp_path)

    *_, last_count = later_members_of_jobs
    assert last_count == 0


def start_sweep(path, progress):
    """Another process that sweeps a family of `MANY_ROWS` as soon as it reads a line.

    `progress` is the code of the function of that name, with `done` and `total`.
    """
    code = f"""
import sys, time
sys.path.extend({[os.path.dirname(__file__), os.path.dirname(exhaustive.__file__)]})
import rodimpact as ri
from rodimpact.methods.fronts import families
from rodimpact.running import chunks
from rodimpact.storage import checkpoint
from test_checkpoint import CHUNK, MANY_ROWS, family
families.MAX_MEMBERS_PER_CALL = CHUNK
chunks.JOBS_A_WORKER_TO_KEEP = 8
checkpoint.SAVE_INTERVAL = 0.0
checkpoint.SAVE_TIME_RATIO = 0.0
def progress(done, total):
    {progress}
print("ready", flush=True)
sys.stdin.readline()
ri.sweep(family(MANY_ROWS), checkpoint={str(path)!r}, progress=progress)
"""
    process = subprocess.Popen(
        [sys.executable, "-W", "ignore", "-c", code],
        text=True,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    assert process.stdout.readline() == "ready\n", process.stderr.read()
    return process


def let_go(process):
    """Write the line for which a process of `start_sweep` waits."""
    process.stdin.write("\n")
    process.stdin.flush()


@pytest.mark.exhaustive
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs SIGKILL")
@pytest.mark.parametrize("seed", range(2))
def test_a_killed_process_goes_on_to_the_same_bytes(tmp_path, seed):
    """A process that sweeps is killed at random, twice or, near the end, once. Another
    sweep with its folder has the bits of an uninterrupted one; chunks are kept, and
    only temporary files are left over.
    """
    rng = np.random.default_rng(seed)
    folder = tmp_path / "run"
    near_end = 90  # of 120 members
    report_slowly = "print(done, flush=True); time.sleep(0.01)"
    done = 0
    chunks_after_kills = []
    while done < near_end and len(chunks_after_kills) < 2:
        with start_sweep(folder, report_slowly) as process:
            let_go(process)
            end = min(done + int(rng.integers(10, 60)), near_end)
            while done < end:
                done = int(process.stdout.readline())
            process.send_signal(signal.SIGKILL)
        chunks_after_kills.append(chunks_on_disk(folder))

    result = ri.sweep(family(MANY_ROWS), checkpoint=folder)

    assert 0 < chunks_after_kills[0] < 2 * MANY_ROWS // CHUNK
    assert chunks_after_kills == sorted(chunks_after_kills)
    assert same(result, ri.sweep(family(MANY_ROWS)))
    for path in folder.iterdir():
        # A killed process may leave a temporary file, and no other.
        assert path.match("members-*.npz") or path.match(".rodimpact-*")


def test_a_full_disk_is_an_error_that_loses_nothing(tmp_path, monkeypatch):
    """There is room for five chunks on the disk."""
    room = 5
    put = Checkpoint.put
    calls = []

    def put_until_full(self, *arguments):
        calls.append(arguments)
        if len(calls) > room:
            raise OSError(errno.ENOSPC, "No space left on device")
        put(self, *arguments)

    with monkeypatch.context() as patch:
        patch.setattr(Checkpoint, "put", put_until_full)
        with pytest.raises(OSError, match="No space left"):
            ri.sweep(family(), workers=1, checkpoint=tmp_path)
    chunks_kept = chunks_on_disk(tmp_path)
    with_room_again = ri.sweep(family(), checkpoint=tmp_path)

    assert chunks_kept == room
    assert same(with_room_again, ri.sweep(family()))


@pytest.mark.parametrize(
    ("system", "change", "differences"),
    [
        pytest.param(
            family(striker_area=2e-4), {}, "system", marks=pytest.mark.exhaustive
        ),
        (family(31), {}, "system and shape"),
        pytest.param(
            family(), {"max_events": 7}, "max_events", marks=pytest.mark.exhaustive
        ),
        pytest.param(family(), {"until": 1e-3}, "until", marks=pytest.mark.exhaustive),
        (family(), {"times": [0.0, 1e-4, 3e-4]}, "times"),
    ],
)
def test_a_directory_of_another_sweep_is_refused_with_the_differences(
    tmp_path, system, change, differences
):
    """`change` is what the second sweep has else than the first one."""
    ri.sweep(family(), checkpoint=tmp_path, **GAUGED)
    options = GAUGED | change

    with pytest.raises(ri.FileFormatError, match=f"another {differences};"):
        ri.sweep(system, checkpoint=tmp_path, **options)


def test_a_foreign_directory_is_refused_and_left_alone(tmp_path):
    (tmp_path / "thesis.tex").write_text("years of work")

    with pytest.raises(ri.FileFormatError, match=r"thesis\.tex"):
        ri.sweep(family(), checkpoint=tmp_path)

    assert os.listdir(tmp_path) == ["thesis.tex"]


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


def swept_into_files(path, monkeypatch):
    """Result of a sweep with a checkpoint, and its files in order, one a chunk.

    From now on sweeps write a file for each chunk.
    """
    save_every_chunk(monkeypatch)
    result = ri.sweep(family(), workers=1, checkpoint=path)
    assert set(result.columns) == set(COLUMNS)
    files = sorted(path.iterdir())
    assert len(files) == N_CHUNKS
    return result, files


@pytest.mark.parametrize(
    "damage",
    [
        pytest.param(lambda data: b"", marks=pytest.mark.exhaustive),
        lambda data: data[:-1],
        pytest.param(lambda data: b"years of work", marks=pytest.mark.exhaustive),
        lambda data: data[:-400] + bytes([data[-400] ^ 1]) + data[-399:],
    ],
)
def test_a_damaged_file_is_told_and_kept_and_only_its_members_run_again(
    tmp_path, monkeypatch, damage
):
    """The fifth of the files is damaged, and the sweep is called again: it warns of the
    file, runs its members only, has the same result, and keeps the damaged file. A
    third call runs nothing.
    """
    result, files = swept_into_files(tmp_path, monkeypatch)
    fifth = files[4]
    damaged = damage(fifth.read_bytes())
    fifth.write_bytes(damaged)

    with (
        recorded_families(monkeypatch) as families_run,
        pytest.warns(
            ri.DamagedChunks, match=rf"{fifth.name}: is .*run again"
        ) as warned,
    ):
        again = ri.sweep(family(), checkpoint=tmp_path)

    # A chunk has two rows of two members: the fifth one has the rows 8 and 9.
    lengths_run = [chunk.bodies[0].length for chunk in families_run]
    lengths_of_fifth = family().bodies[0].length[8:10, 0]
    assert set(np.ravel(lengths_run)) == set(lengths_of_fifth)
    assert same(again, result)
    # The warning names the line that calls `sweep`.
    assert warned[0].filename == __file__
    # The damaged file is put aside: perhaps somebody wants it.
    (aside,) = tmp_path.glob(".rodimpact-*")
    assert aside.read_bytes() == damaged
    # It is not in the way of the next sweep.
    with recorded_families(monkeypatch) as run_later:
        ri.sweep(family(), checkpoint=tmp_path)
    assert run_later == []


@pytest.mark.exhaustive
def test_a_file_of_another_sweep_among_those_of_this_one_is_refused(
    tmp_path, monkeypatch
):
    """A file of chunks of a family with another area is copied into the folder of a
    sweep: FileFormatError says that it belongs to another sweep.
    """
    save_every_chunk(monkeypatch)
    folder = tmp_path / "run"
    other = tmp_path / "other"
    ri.sweep(family(), workers=1, checkpoint=folder)
    ri.sweep(family(striker_area=2e-4), workers=1, checkpoint=other)
    file_of_other = sorted(other.iterdir())[3]
    shutil.copy(file_of_other, folder / file_of_other.name)

    with pytest.raises(
        ri.FileFormatError, match="holds another sweep, with another system;"
    ):
        ri.sweep(family(), checkpoint=folder)


@pytest.mark.skipif(
    os.name != "posix" or os.geteuid() == 0, reason="needs a user with limits"
)
def test_a_directory_that_cannot_be_written_is_told_at_once(tmp_path, monkeypatch):
    """A sweep into a directory that may only be read raises PermissionError before any
    family is run.
    """
    tmp_path.chmod(0o500)  # read only
    with (
        recorded_families(monkeypatch) as families_run,
        pytest.raises(PermissionError, match="may not write"),
    ):
        ri.sweep(family(), checkpoint=tmp_path)
    assert families_run == []


@pytest.mark.exhaustive
def test_two_processes_may_start_on_one_directory(tmp_path):
    """Two processes sweep the same family with one folder at the same time. Both end
    without an error, all chunks are on disk, and the result is that of a sweep without
    a folder.
    """
    folder = tmp_path / "run"
    other_process = start_sweep(folder, "pass")
    let_go(other_process)

    result = ri.sweep(family(MANY_ROWS), checkpoint=folder)

    _, errors = other_process.communicate()
    assert errors == ""
    assert chunks_on_disk(folder) == 2 * MANY_ROWS // CHUNK
    again = ri.sweep(family(MANY_ROWS), checkpoint=folder)
    uninterrupted = ri.sweep(family(MANY_ROWS))
    assert same(result, uninterrupted)
    assert same(again, uninterrupted)


def test_a_checkpoint_that_is_a_file_is_refused(tmp_path):
    path = tmp_path / "notes"
    path.write_text("")

    with pytest.raises(OSError, match="notes"):
        ri.sweep(family(), checkpoint=path)


def test_a_refused_member_is_known_when_the_sweep_goes_on(tmp_path, monkeypatch):
    """The second of three members is refused; a second sweep with the same checkpoint
    runs none again, and the second is incomplete as before.
    """
    lengths = np.array([0.5, 1e-13, 0.7])  # no clock counts the waves of the second
    striker = ri.Rod(lengths, area=1e-4, material=STEEL, velocity=1.0)
    struck = ri.Rod(1.0, area=1e-4, material=STEEL)
    system = ri.System([striker, struck])
    ri.sweep(system, checkpoint=tmp_path)

    with recorded_families(monkeypatch) as families_run:
        again = ri.sweep(system, checkpoint=tmp_path)

    assert families_run == []
    assert again.incomplete.tolist() == [False, True, False]
