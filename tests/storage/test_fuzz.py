"""Files damaged at random are refused, or give what was saved; nothing else ever comes
of them.
"""

import json
import shutil
import warnings

import numpy as np
import pytest
from exhaustive import few_of
from fuzz.generators import SEED, TIMES
from networks import random_network
from storage.test_checkpoint import family, save_every_chunk

import rodimpact as ri

DAMAGES = 25 * TIMES  # of each seed
SEEDS = few_of(range(SEED, SEED + 4), [SEED])


@pytest.fixture(scope="module")
def originals(tmp_path_factory):
    """Sorted paths of three saved sweeps: a family of rods, a family of a random
    network, and a single member.
    """
    gauges = {"gauges": [(1, 0.5)], "times": [1e-4, 2e-4]}
    network = random_network(1, driven=True)
    family_of_networks = network.replace(gravity=[0.0, 0.1])
    results = {
        "fronts": ri.sweep(family(15), until=2e-4, **gauges),
        "profiles": ri.sweep(
            family_of_networks, until=0.1, rtol=1e-3, also=["accuracy"]
        ),
        "single": ri.sweep(family(15)[3, 1]),
    }
    folder = tmp_path_factory.mktemp("saved")
    for name, result in results.items():
        result.save(folder / f"{name}.npz")
    return sorted(folder.iterdir())


def spoil(rng, data):
    """Bytes with one piece of damage, of any kind that disks, networks and people
    make.
    """
    data = bytearray(data)
    kind = rng.integers(6)
    size = len(data)
    start, stop = sorted(rng.integers(size + 1, size=2).tolist())
    if kind == 0:  # up to three bits change
        for index in rng.integers(size, size=rng.integers(1, 4)):
            data[index] ^= 1 << rng.integers(8)
    elif kind == 1:  # the end is missing
        del data[start:]
    elif kind == 2:  # at most 40 bytes are missing
        del data[start : min(stop, start + 40)]
    elif kind == 3:  # zeros in place of a piece
        data[start:stop] = bytes(stop - start)
    elif kind == 4:  # random bytes between two others
        data[start:start] = rng.bytes(rng.integers(1, 40))
    else:  # random bytes in place of a piece
        data[start:stop] = rng.bytes(stop - start)
    return bytes(data)


def alter(rng, array):
    """A copy of the array with another type, shape, length or order, or with one random
    element larger by 1.
    """
    kind = rng.integers(6)
    flat = array.ravel()
    if kind == 0:
        return array.astype(rng.choice(["f4", "i2", "c16", "U8", ">f8", "M8[s]", "?"]))
    if kind == 1 and array.ndim > 1:
        return flat
    if kind == 1 or (kind == 2 and array.ndim == 0):
        return array[None]  # one axis more
    if kind == 2:
        length = rng.integers(array.shape[0] + 1)
        return array[:length]
    if kind == 3:
        return np.concatenate((flat, flat[:1]))
    if kind == 4:
        return flat[::-1].reshape(array.shape)
    array = array.copy()
    if array.size:
        array.flat[rng.integers(array.size)] += 1
    return array


def spoil_contents(rng, path):
    """Rewrite an NPZ file in place, with an array or a word of its document changed at
    random.
    """
    with np.load(path) as archive:
        arrays = dict(archive)
    names = sorted(arrays.keys() - {"document"})
    kind = rng.integers(5)
    one, other = rng.choice(names, 2)
    if kind == 0:
        arrays[one], arrays[other] = arrays[other], arrays[one]
    elif kind == 1:
        del arrays[one]
    elif kind == 2:
        arrays[f"{one}1"] = arrays[one]
    elif kind == 3:
        arrays[one] = alter(rng, arrays[one])
    else:
        document = json.loads(str(arrays["document"]))
        entry = document["arrays"][one]
        word = rng.choice(sorted(entry))
        entry[word] = [None, -1, [], "?", 1e300, [[1 << 40]], {}][rng.integers(7)]
        arrays["document"] = np.array(json.dumps(document))
    np.savez_compressed(path, **arrays)


@pytest.mark.filterwarnings("ignore")  # NumPy warns of types that lose digits
@pytest.mark.parametrize("seed", SEEDS)
def test_a_damaged_file_is_refused_or_is_what_was_saved(tmp_path, originals, seed):
    """Saved sweeps are spoilt at random, in bytes or contents. Loading is refused by a
    message that begins with the path, in more than half of the cases, or what is loaded
    saves as the original file.
    """
    rng = np.random.default_rng(seed)
    path = tmp_path / "damaged.npz"
    again = tmp_path / "again.npz"
    refusals = []
    for _ in range(DAMAGES):
        original = originals[rng.integers(len(originals))]
        shutil.copy(original, path)
        if rng.integers(3):
            path.write_bytes(spoil(rng, path.read_bytes()))
        else:
            spoil_contents(rng, path)
        try:
            loaded = ri.load(path)
        except ri.FileFormatError as error:
            refusals.append(str(error))
        else:
            loaded.save(again, force=True)
            assert again.read_bytes() == original.read_bytes()
    assert len(refusals) > DAMAGES / 2
    for message in refusals:
        assert message.startswith(str(path))


def exchange(first, second):
    """Exchange the names of two files."""
    spare = first.parent / ".rodimpact-spare"
    first.replace(spare)
    second.replace(first)
    spare.replace(second)


def spoil_directory(rng, folder, other):
    """Damage a checkpoint in place, once to three times: remove, exchange, overwrite or
    spoil a file, or leave a temporary one.
    """
    for _ in range(rng.integers(1, 4)):
        paths = sorted(path for path in folder.iterdir() if path.is_file())
        if not paths:
            paths = [folder / "new.npz"]
        i, j = rng.choice(len(paths), 2)
        first = paths[i]
        second = paths[j]
        kind = rng.integers(6)
        if kind == 0:
            first.unlink(missing_ok=True)
        elif kind == 1 and first != second:
            exchange(first, second)
        elif kind == 2:
            shutil.copy(other, first)
        elif kind == 3:
            left_over = folder / f".rodimpact-{rng.integers(1 << 60):016x}"
            left_over.write_bytes(rng.bytes(9))
        elif first.exists():
            data = first.read_bytes() or b"x"
            first.write_bytes(spoil(rng, data))


@pytest.mark.exhaustive
@pytest.mark.parametrize("damages", few_of([6, DAMAGES], [6]))
@pytest.mark.parametrize("seed", SEEDS)
def test_a_damaged_checkpoint_is_refused_or_comes_to_the_same_end(
    tmp_path, monkeypatch, seed, damages
):
    """The folder of a finished sweep is spoilt at random, many times. The sweep is run
    with it again: it is refused by a message that begins with the path, or has the same
    bits. Both occur.
    """
    monkeypatch.setattr("rodimpact.methods.fronts.families.MAX_MEMBERS_PER_CALL", 4)
    # Waiting for the disk would take most of the time.
    monkeypatch.setattr("rodimpact.storage.writing.os.fsync", lambda file: None)
    save_every_chunk(monkeypatch)
    rng = np.random.default_rng(seed)
    whole = tmp_path / "whole"
    folder = tmp_path / "damaged"
    result = ri.sweep(family(15), checkpoint=whole)
    ri.sweep(family(15), checkpoint=tmp_path / "other", max_events=1)
    other = next((tmp_path / "other").iterdir())
    refusals = []
    gone_on = 0
    for _ in range(damages):
        shutil.copytree(whole, folder)
        spoil_directory(rng, folder, other)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ri.DamagedChunks)
            try:
                again = ri.sweep(family(15), checkpoint=folder)
            except ri.FileFormatError as error:
                refusals.append(str(error))
            else:
                gone_on += 1
                for name, column in result.columns.items():
                    assert again.columns[name].tobytes() == column.tobytes()
        shutil.rmtree(folder)
    assert refusals
    assert gone_on
    for message in refusals:
        assert message.startswith(str(folder))
