"""What is not as it was written is refused before it takes memory."""

import json
import os
import tracemalloc
import zipfile

import numpy as np
import pytest
from exhaustive import few_of

import rodimpact as ri
from rodimpact.methods import memory
from rodimpact.storage.reading import open_regular
from rodimpact.storage.writing import described

STEEL = ri.materials.steel


@pytest.fixture
def saved(tmp_path):
    """Path of a saved family of two members."""
    path = tmp_path / "map.npz"
    rod = ri.Rod([0.4, 0.5], area=1e-4, material=STEEL, velocity=1.0)
    ri.sweep(ri.System([rod, ri.Wall()])).save(path)
    return path


def contents(path):
    """The document of a saved file, as a dict, and {name: array} of the other arrays."""
    with np.load(path) as archive:
        arrays = dict(archive)
    document = json.loads(str(arrays.pop("document")))
    return document, arrays


def write_contents(path, document, arrays):
    """Save a document, a dict, and arrays by name, as a result is saved."""
    np.savez_compressed(path, document=np.array(json.dumps(document)), **arrays)


ZEROS = np.zeros(1 << 22)  # 34 MB


def write_long_column(path):
    """Replace a column of two numbers by one of millions."""
    document, arrays = contents(path)
    arrays["f8"] = ZEROS
    write_contents(path, document, arrays)


def write_foreign_array(path):
    """Write an array that no result has."""
    np.savez_compressed(path, x=ZEROS)


MEGABYTES = 257  # of a document: more than is read


def write_long_document(path):
    """Write a document of zeros, a text whose characters take four bytes."""
    characters = MEGABYTES << 18
    header = {"descr": f"<U{characters}", "fortran_order": False, "shape": ()}
    with (
        zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive,
        archive.open("document.npy", "w", force_zip64=True) as file,
    ):
        np.lib.format.write_array_header_1_0(file, header)
        for _ in range(MEGABYTES):
            file.write(bytes(1 << 20))


BOMBS = [write_long_column, write_long_document, write_foreign_array]


@pytest.mark.parametrize(
    "write_bomb", few_of(BOMBS, [write_long_column, write_foreign_array])
)
def test_a_small_file_of_many_zeros_is_refused_before_it_takes_memory(
    saved, write_bomb
):
    """A file of less than a megabyte that unpacks to over thirty megabytes of zeros is
    refused, with a peak of memory below 10 MB.
    """
    write_bomb(saved)
    assert saved.stat().st_size < 1e6
    tracemalloc.start()
    try:
        with pytest.raises(ri.FileFormatError):
            ri.load(saved)
        _, peak = tracemalloc.get_traced_memory()
        assert peak < 1e7  # bytes
    finally:
        tracemalloc.stop()


@pytest.mark.exhaustive
def test_a_file_is_refused_with_a_figure_only_if_it_takes_half_of_the_memory(
    saved, monkeypatch
):
    """The installed memory is set to just below twice what the document or the arrays
    of a file take: loading raises MemoryError with this figure. With enough memory it
    is loaded.
    """
    document, arrays = contents(saved)
    arrays["f8"] = np.resize(arrays["f8"], 10**6)
    document["arrays"]["f8"] = described(arrays["f8"])
    write_contents(saved, document, arrays)
    # A document of brackets alone takes 24 bytes a character.
    size_of_document = 24 * len(json.dumps(document))
    size_of_arrays = sum(array.nbytes for array in arrays.values())
    message = r"map\.npz: takes up to .* GB of memory, more than"

    for size in (size_of_document, size_of_arrays):
        monkeypatch.setattr(memory, "installed", lambda size=size: 2.0 * size - 1)
        with pytest.raises(MemoryError, match=message):
            ri.load(saved)
    enough = 2.0 * max(size_of_document, size_of_arrays)
    monkeypatch.setattr(memory, "installed", lambda: enough)
    ri.load(saved)


def test_a_message_does_not_repeat_the_file(saved):
    document, arrays = contents(saved)
    document["content"] = {"class": "x" * 20_000}
    write_contents(saved, document, arrays)

    with pytest.raises(ri.FileFormatError) as refused:
        ri.load(saved)

    assert len(str(refused.value)) < 1000


@pytest.mark.parametrize(
    "change",
    [
        lambda document, arrays: arrays.update(f8=arrays["f8"][::-1]),
        lambda document, arrays: document.pop("arrays"),
        lambda document, arrays: document["arrays"]["status"].update(type="no type"),
        lambda document, arrays: arrays.update(
            vibration=arrays["vibration"].astype(">f8")
        ),
    ],
)
def test_a_document_that_does_not_fit_the_arrays_is_refused(saved, change):
    """Document or arrays of a saved file are changed so that they do not fit: loading
    raises FileFormatError with the name of the file.
    """
    document, arrays = contents(saved)
    change(document, arrays)
    write_contents(saved, document, arrays)

    with pytest.raises(ri.FileFormatError, match=r"map\.npz: "):
        ri.load(saved)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes here")
@pytest.mark.parametrize("name", ["pipe", "sweep/members-00000000.npz"])
def test_a_pipe_is_refused_and_not_waited_for(tmp_path, name):
    """A named pipe in place of a file is refused by `load`, and, with the name of a
    file of a checkpoint, by `sweep`.
    """
    family = ri.System(
        [ri.Rod([0.4, 0.5], area=1e-4, material=STEEL, velocity=1.0), ri.Wall()]
    )
    ri.sweep(family, checkpoint=tmp_path / "sweep")
    path = tmp_path / name
    path.unlink(missing_ok=True)
    os.mkfifo(path)
    with pytest.raises(OSError, match=f"it is not a regular file: .*{name}'"):
        ri.load(path)
    if name != "pipe":
        # The sweep finds the pipe among its files, too.
        with pytest.raises(OSError, match=f"it is not a regular file: .*{name}'"):
            ri.sweep(family, checkpoint=tmp_path / "sweep")


def test_a_name_with_a_zero_byte_is_refused(tmp_path):
    with pytest.raises(
        ri.InvalidModel, match=r"must be the name of a file, got .*a\\x00b"
    ):
        ri.load(tmp_path / "a\0b")


def test_a_file_without_its_ending_is_answered_by_that_file(tmp_path):
    (tmp_path / "t1.toml").write_text("schema = 1")

    with pytest.raises(FileNotFoundError, match=r"perhaps .*t1\.toml' is meant"):
        open_regular(tmp_path / "t1")
