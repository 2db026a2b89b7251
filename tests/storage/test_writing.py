"""A new file never takes the place of another's, and nothing half written is left
behind.
"""

import errno
import os
import signal
import subprocess
import sys
import threading

import pytest
from exhaustive import few_of

import rodimpact as ri
from rodimpact.storage import writing
from rodimpact.storage.writing import check_target, open_for_writing, write_bytes


@pytest.fixture(params=["links", "no links"])
def file_system(request, monkeypatch):
    """A file system with hard links, and one without them, as some are."""

    def link(*_):
        raise OSError(errno.EPERM, "Operation not permitted")

    if request.param == "no links":
        monkeypatch.setattr(writing.os, "link", link)


def test_a_file_that_appears_meanwhile_is_kept(tmp_path, file_system):
    """It is made by another process while a file of the same name is being written."""
    target = tmp_path / "a"

    def write_slowly():
        with open_for_writing(target) as file:
            file.write(b"mine")
            target.write_bytes(b"another's")

    with pytest.raises(FileExistsError, match=r"cannot write .*a': it exists already"):
        write_slowly()
    assert target.read_bytes() == b"another's"
    assert os.listdir(tmp_path) == ["a"]


def test_a_file_that_appears_meanwhile_is_replaced_with_force(tmp_path):
    target = tmp_path / "a"

    with open_for_writing(target, force=True) as file:
        file.write(b"mine")
        target.write_bytes(b"another's")

    assert target.read_bytes() == b"mine"
    assert os.listdir(tmp_path) == ["a"]


def test_of_many_writers_one_writes(tmp_path, file_system):
    """Each has seen that there is no file before any of them makes it."""
    target = tmp_path / "a"
    all_have_begun = threading.Barrier(8)
    written_by = []

    def write(number):
        try:
            with open_for_writing(target) as file:
                all_have_begun.wait()
                file.write(bytes([number]) * 1000)
            written_by.append(number)
        except FileExistsError:
            pass

    threads = [threading.Thread(target=write, args=(number,)) for number in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(written_by) == 1
    assert target.read_bytes() == bytes(written_by) * 1000
    assert os.listdir(tmp_path) == ["a"]


# Asks for a file of the name "a", and waits when it is half written
WRITES_HALF_THEN_WAITS = """
import sys
from rodimpact.storage.writing import open_for_writing
with open_for_writing("a") as file:
    file.write(b"half")
    print("ready", flush=True)
    sys.stdin.readline()
"""


@pytest.mark.exhaustive
@pytest.mark.parametrize("signal_name", few_of(["SIGTERM", "SIGINT"], ["SIGINT"]))
@pytest.mark.usefixtures("children_hear_signals")
def test_a_half_written_file_never_bears_the_name_and_an_interrupt_removes_it(
    tmp_path, signal_name
):
    """A process is ended by a signal after half of the file. The name asked for is "a"."""
    if not hasattr(signal, signal_name):
        pytest.skip(f"no {signal_name} here")
    with subprocess.Popen(
        [sys.executable, "-c", WRITES_HALF_THEN_WAITS],
        cwd=tmp_path,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    ) as process:
        assert process.stdout.readline() == "ready\n"
        (half_written,) = os.listdir(tmp_path)
        number = getattr(signal, signal_name)
        process.send_signal(number)
        assert process.wait(10) == -number
    assert half_written != "a"
    if signal_name == "SIGINT":
        assert os.listdir(tmp_path) == []
    else:
        # A process that is ended at once cannot clear up.
        assert os.listdir(tmp_path) == [half_written]


def test_a_directory_where_one_may_not_write_is_told_before(tmp_path, monkeypatch):
    """`check_target` raises PermissionError for a file in a folder that is read only,
    before anything is written.
    """
    is_user = os.name == "posix" and os.geteuid() != 0
    if is_user:
        tmp_path.chmod(0o500)
    else:
        # An administrator may write anywhere.
        monkeypatch.setattr(writing.os, "access", lambda path, mode: not mode & os.W_OK)
    try:
        with pytest.raises(
            PermissionError, match=r"x\.npz': you may not write in the directory"
        ):
            check_target(tmp_path / "x.npz")
    finally:
        tmp_path.chmod(0o700)


def test_names_that_no_file_can_have_are_refused(tmp_path):
    """`check_target` refuses a name of 300 letters, and one with a zero byte."""
    with pytest.raises(OSError, match="File name too long"):
        check_target(tmp_path / ("n" * 300))
    with pytest.raises(ri.InvalidModel, match="must be the name of a file"):
        check_target(tmp_path / "a\0b")


def test_a_link_that_points_nowhere_is_written_through(tmp_path):
    """`write_bytes` to a link makes the file to which it points; the link stays."""
    (tmp_path / "link").symlink_to("real")
    write_bytes(tmp_path / "link", b"x")
    assert (tmp_path / "real").read_bytes() == b"x"
    assert (tmp_path / "link").is_symlink()


def test_a_document_that_no_reader_would_take_is_not_written(tmp_path, monkeypatch):
    """A document is refused that is larger than what is read."""
    rod = ri.Rod([0.4], area=1e-4, material=ri.materials.steel, velocity=1.0)
    family = ri.sweep(ri.System([rod, ri.Wall()]))
    monkeypatch.setattr(writing, "MAX_DOCUMENT_BYTES", 100)
    with pytest.raises(OSError, match="too many numbers"):
        family.save(tmp_path / "a.npz")
    assert os.listdir(tmp_path) == []
