"""What is not as it was written is refused before it takes memory."""

import json
import os
import tracemalloc
import zipfile

import numpy as np
import pytest

import rodimpact as ri
from rodimpact.methods import memory
from rodimpact.storage.writing import described

STEEL = ri.materials.steel


@pytest.fixture
def saved(tmp_path):
    path = tmp_path / "map.npz"
    rod = ri.Rod([0.4, 0.5], area=1e-4, material=STEEL, velocity=1.0)
    ri.sweep(ri.System([rod, ri.Wall()])).save(path)
    return path


def contents(path):
    with np.load(path) as archive:
        arrays = dict(archive)
    return json.loads(str(arrays.pop("document"))), arrays


def put(path, document, arrays):
    np.savez_compressed(path, document=np.array(json.dumps(document)), **arrays)


def swollen(path):
    """A column of zeros a thousand times as long."""
    document, arrays = contents(path)
    put(path, document, arrays | {"f8": np.zeros(1 << 22)})


MEGABYTES = 257  # of a document: more than is read


def long_document(path):
    with (
        zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive,
        archive.open("document.npy", "w", force_zip64=True) as file,
    ):
        np.lib.format.write_array_header_1_0(
            file, {"descr": f"<U{MEGABYTES << 18}", "fortran_order": False, "shape": ()}
        )
        for _ in range(MEGABYTES):
            file.write(bytes(1 << 20))


@pytest.mark.parametrize(
    "bomb",
    [
        swollen,
        long_document,
        lambda path: np.savez_compressed(path, x=np.zeros(1 << 22)),
    ],
)
def test_a_small_file_takes_little_memory(saved, bomb):
    """Over thirty megabytes of zeros, packed into less than one."""
    bomb(saved)
    assert saved.stat().st_size < 1e6
    tracemalloc.start()
    try:
        with pytest.raises(ri.FileFormatError):
            ri.load(saved)
        assert tracemalloc.get_traced_memory()[1] < 1e7
    finally:
        tracemalloc.stop()


def test_what_is_larger_than_half_the_memory_is_refused_with_the_figure(
    saved, monkeypatch
):
    """A document of brackets alone takes 24 bytes a character."""
    document, arrays = contents(saved)
    arrays["f8"] = np.resize(arrays["f8"], 10**6)
    document["arrays"]["f8"] = described(arrays["f8"])
    put(saved, document, arrays)
    sizes = (
        24 * len(json.dumps(document)),
        sum(array.nbytes for array in arrays.values()),
    )
    for size in sizes:
        monkeypatch.setattr(memory, "installed", lambda size=size: 2.0 * size - 1)
        with pytest.raises(
            MemoryError, match=r"map\.npz: takes up to .* GB of memory, more than"
        ):
            ri.load(saved)
    monkeypatch.setattr(memory, "installed", lambda: 2.0 * max(sizes))
    ri.load(saved)


def test_a_sentence_does_not_repeat_the_file(saved):
    _, arrays = contents(saved)
    put(saved, {**contents(saved)[0], "content": {"class": "x" * 20_000}}, arrays)
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
def test_a_document_that_says_something_else_is_refused(saved, change):
    document, arrays = contents(saved)
    change(document, arrays)
    put(saved, document, arrays)
    with pytest.raises(ri.FileFormatError, match=r"map\.npz: "):
        ri.load(saved)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes here")
@pytest.mark.parametrize("name", ["pipe", "sweep/members-00000000.npz"])
def test_a_pipe_is_refused_and_not_waited_for(tmp_path, name):
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
        with pytest.raises(OSError, match=f"it is not a regular file: .*{name}'"):
            ri.sweep(family, checkpoint=tmp_path / "sweep")


def test_a_name_with_nul(tmp_path):
    with pytest.raises(
        ri.InvalidModel, match=r"must be the name of a file, got .*a\\x00b"
    ):
        ri.load(tmp_path / "a\0b")
