"""Files are whole or absent, and a saved solution comes back bit for bit or not at all."""

import errno
import json
import os
import pickle
import stat

import numpy as np
import pytest
from exhaustive import few_of
from grid_rows import random_row
from networks import random_network
from systems import horizon, with_ends

import rodimpact as ri
from rodimpact.running.loading import load
from rodimpact.storage import writing
from rodimpact.storage.reading import FileFormatError
from rodimpact.storage.writing import SCHEMA, check_target, write_text

STEEL = ri.materials.steel
SHORT = ri.Rod(0.4, area=1e-4, material=STEEL, velocity=1.0)
LONG = ri.Rod(1.0, area=1e-4, material=STEEL)

# Writing


def test_text_is_written_as_it_is(tmp_path):
    write_text(tmp_path / "a.txt", "Länge\r\n1 µm\n")
    assert (tmp_path / "a.txt").read_bytes() == "Länge\r\n1 µm\n".encode()
    assert os.listdir(tmp_path) == ["a.txt"]


@pytest.mark.parametrize("mask", [0o022, 0o077])
def test_permissions_follow_the_umask(tmp_path, mask):
    before = os.umask(mask)
    try:
        write_text(tmp_path / "a", "")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "a").stat().st_mode) == 0o666 & ~mask


@pytest.mark.parametrize(
    ("name", "error", "said"),
    [
        ("", IsADirectoryError, "is a directory"),
        ("new/", IsADirectoryError, "is a directory"),
        ("none/a.txt", FileNotFoundError, "there is no directory"),
        ("file/a.txt", NotADirectoryError, "is not a directory"),
        ("file/b/a.txt", FileNotFoundError, "there is no directory"),
    ],
)
@pytest.mark.parametrize("force", [False, True])
def test_places_where_no_file_can_be(tmp_path, name, error, said, force):
    (tmp_path / "file").write_text("kept")
    path = f"{tmp_path}/{name}"
    with pytest.raises(error, match=said) as caught:
        write_text(path, "x", force=force)
    assert path in str(caught.value)
    assert type(caught.value) is error
    assert os.listdir(tmp_path) == ["file"]
    with pytest.raises(error, match=said):
        check_target(path, force=force)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes here")
def test_only_regular_files_are_replaced(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(OSError, match="not a regular file"):
        write_text(tmp_path / "pipe", "x", force=True)
    assert stat.S_ISFIFO((tmp_path / "pipe").stat().st_mode)


def fail(error):
    def function(*_):
        raise error

    return function


@pytest.mark.parametrize("step", ["fsync", "replace"])
@pytest.mark.parametrize(
    "error",
    [
        OSError(errno.ENOSPC, "No space left on device"),
        PermissionError(errno.EACCES, "Permission denied"),
        KeyboardInterrupt(),
    ],
    ids=lambda e: type(e).__name__,
)
def test_a_failure_leaves_everything_as_it_was(tmp_path, monkeypatch, step, error):
    path = tmp_path / "a.txt"
    path.write_text("old")
    monkeypatch.setattr(writing.os, step, fail(error))
    with pytest.raises(type(error)) as caught:
        write_text(path, "new", force=True)
    assert type(caught.value) is type(error)
    if isinstance(error, OSError):
        assert str(caught.value) == f"cannot write {str(path)!r}: {error.strerror}"
    assert os.listdir(tmp_path) == ["a.txt"]
    assert path.read_text() == "old"


# Saving and loading

stepped = ri.Rod(
    segments=[
        ri.Segment(0.2, 1e-4, STEEL),
        ri.Segment(0.1, 3e-4, ri.materials.aluminium),
    ],
    velocity=ri.Steps([1.0, -0.5], [0.05]),
    strain=ri.Steps([0.0, 1e-5, -1e-5], [0.1, 0.25]),
)
GRID = {"method": "finite-difference"}
RUNS = {
    "pair": (ri.System([SHORT, LONG]), {}),
    "nothing meets": (ri.System([LONG, SHORT], gaps=[0.1]), {}),
    "no time": (ri.System([SHORT, LONG]), {"until": 0}),
    "capped": (ri.System([stepped, LONG, stepped]), {"max_events": 50}),
    **{
        f"random {seed}": (
            s := with_ends(seed),
            {"until": horizon(s, 10), "max_events": 5000},
        )
        for seed in range(6)
    },
    "characteristics: to the proof": (
        ri.System([ri.RigidMass(0.3, velocity=1.0), SHORT]),
        {"rtol": 1e-3},
    ),
    "characteristics: no time": (
        ri.System([ri.RigidMass(0.3, velocity=1.0), SHORT]),
        {"until": 0},
    ),
    **{
        f"characteristics: random {seed}": (
            random_network(seed, driven=seed % 2 == 0),
            {"until": 2.5, "method": "characteristics"},
        )
        for seed in range(12)
    },
    "grid: no time": (ri.System([SHORT, LONG]), {"until": 0, **GRID, "cells": 10}),
    "grid: chosen states": (
        ri.System([SHORT, LONG]),
        {"until": 2e-4, **GRID, "snapshots": [1e-5, 1.3e-4], "cells": 10},
    ),
    **{
        f"grid: random {seed}": (
            random_row(seed, driven=seed % 2 == 0),
            {"until": 1.5, **GRID, "cells": 8},
        )
        for seed in (7, 8, 9, 11)
    },
}


def facts(s):
    """All that a solution knows, in a form in which equal means the same bits."""
    t = np.linspace(0, s.t_end, 23)
    found = {
        name: getattr(s, name)
        for name in (
            "method",
            "until",
            "stopped_by",
            "status",
            "t_end",
            "final",
            "events",
            "transit_error",
            "outcome",
            "system",
            "accuracy",
        )
    }
    assert {type(error) for error in s.accuracy.values()} <= {float}
    found["t_final"] = repr(s.t_final)
    found["types"] = [
        type(getattr(s, name)) for name in ("until", "t_end", "t_final", "events")
    ]
    found["energy"] = [
        np.asarray(entry).tobytes() for entry in vars(s.energy(t)).values()
    ]
    found["contacts"] = [
        (
            repr(c.episodes),
            repr((c.impulse, c.duration, c.peak_force)),
            c.force(t).tobytes(),
            c.gap(t).tobytes(),
            [b.tobytes() for b in c.breakpoints()],
        )
        for c in s.contacts
    ]
    for i, body in enumerate(s.system.bodies):
        found[i, "mean"] = s.mean_velocity(i, t).tobytes()
        found[i, "position"] = s.position(i, 0.0, t).tobytes()
        if isinstance(body, ri.Rod):
            x = np.linspace(0, body.length, 7)[:, None]
            for field in (s.velocity, s.strain, s.displacement):
                found[i, field.__name__] = field(i, x, t).tobytes()
    return found


USUAL = [
    name
    for name in RUNS
    if "random" not in name or name.endswith((" 0", " 1", " 7", " 8"))
]


@pytest.mark.parametrize("name", few_of(RUNS, USUAL))
def test_loading_gives_the_saved_solution_bit_for_bit(tmp_path, name, monkeypatch):
    system, options = RUNS[name]
    solution = ri.solve(system, **options)
    solution.save(tmp_path / "run.npz")
    for solver in ("fronts.driver.solve_one", "pieces.driver.Members.go"):
        monkeypatch.setattr(
            f"rodimpact.methods.{solver}", fail(AssertionError("solved again"))
        )
    loaded = load(tmp_path / "run.npz")
    assert facts(loaded) == facts(solution)
    assert repr(loaded.outcome) == repr(solution.outcome)
    loaded.save(tmp_path / "again.npz")
    assert (tmp_path / "again.npz").read_bytes() == (tmp_path / "run.npz").read_bytes()


@pytest.mark.parametrize("name", ["inf", "nan"])
def test_a_name_that_reads_as_a_number_stays_a_name(tmp_path, name):
    material = ri.Material(name, youngs_modulus=1.0, density=1.0)
    rods = [
        ri.Rod(length, area=1.0, material=material, velocity=v)
        for length, v in (([0.4, 0.5], 1.0), (1.0, 0.0))
    ]
    family = ri.System(rods)
    ri.solve(family[0]).save(tmp_path / "run.npz")
    ri.sweep(family).save(tmp_path / "family.npz")
    assert ri.load(tmp_path / "run.npz").system == family[0]
    assert ri.load(tmp_path / "family.npz").system == family


def test_a_loaded_solution_can_be_continued(tmp_path):
    solution = ri.solve(ri.System([SHORT, LONG]))
    solution.save(tmp_path / "run.npz")
    loaded = load(str(tmp_path / "run.npz"))
    t = solution.t_end / 3
    assert loaded.system_at(t) == solution.system_at(t)


def test_the_file_opens_with_numpy_and_json_alone(tmp_path):
    solution = ri.solve(ri.System([SHORT, ri.Wall()]))
    solution.save(tmp_path / "run.npz")
    with np.load(tmp_path / "run.npz", allow_pickle=False) as archive:
        document = json.loads(
            str(archive["document"]), parse_constant=fail(ValueError("no JSON"))
        )
        force = document["content"]["signals"]["contacts"][0]["force"]["coefficients"]
        column = archive[force["array"]][force["start"] :][: force["shape"][0]]
    assert np.array_equal(column, solution.contacts[0].push.values)
    assert document["content"]["totals"]["masses"] == [
        solution.outcome.masses[0],
        "inf",
    ]
    assert document["rodimpact"] == ri.__version__
    assert document["content"]["clock"]["system"]["bodies"][0]["length"] == SHORT.length


# What is no saved solution


@pytest.fixture
def saved(tmp_path):
    path = tmp_path / "run.npz"
    ri.solve(ri.System([stepped, LONG]), until=5e-4).save(path)
    return path


def read(path):
    with np.load(path) as archive:
        arrays = dict(archive)
    return json.loads(str(arrays.pop("document"))), arrays


def edit(path, change=None, **other):
    """Rewrite a saved file with other entries; an array that is None goes."""
    document, arrays = read(path)
    arrays = {
        "document": np.array(json.dumps({**document, **(change or {})})),
        **arrays,
        **other,
    }
    np.savez_compressed(path, **{k: v for k, v in arrays.items() if v is not None})


def refused(path, said):
    with pytest.raises(FileFormatError, match=said) as caught:
        load(path)
    assert str(caught.value).startswith(str(path))
    assert isinstance(caught.value, ValueError)


def test_missing_file_and_directory(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"none\.npz"):
        load(tmp_path / "none.npz")
    with pytest.raises(IsADirectoryError, match=str(tmp_path)):
        load(tmp_path)


@pytest.mark.parametrize(
    "content",
    [b"", b"time,force\n", pickle.dumps([1, 2]), b"\x93NUMPY\x01\x00"],
    ids=["empty", "text", "pickle", "npy"],
)
def test_other_files(tmp_path, content):
    path = tmp_path / "a.npz"
    path.write_bytes(content)
    refused(path, "is not an NPZ file")


def test_pickled_arrays_are_never_unpickled(saved, tmp_path):
    class Bomb:
        def __reduce__(self):
            return os.mkdir, (str(tmp_path / "exploded"),)

    edit(saved, f8=np.array([Bomb()], dtype=object))
    refused(saved, "plain arrays")
    np.savez(saved, document=np.array([Bomb()], dtype=object))
    refused(saved, "plain arrays")
    assert not (tmp_path / "exploded").exists()


@pytest.mark.parametrize(
    "arrays",
    [
        {"x": np.zeros(3)},
        {"document": np.array("no json")},
        {"document": np.array('{"format": "other", "schema": 1, "kind": "solution"}')},
        {"document": np.array("[1, 2]")},
        {"document": np.array("[" * 100_000)},
        {"document": np.arange(4)},
    ],
)
def test_foreign_archives(tmp_path, arrays):
    np.savez(tmp_path / "a.npz", **arrays)
    refused(tmp_path / "a.npz", "not one that rodimpact saved")


@pytest.mark.parametrize(
    "change", [{"schema": SCHEMA + 1}, {"kind": "hologram"}, {"schema": None}]
)
def test_what_a_newer_version_saved(saved, change):
    edit(saved, {**change, "rodimpact": "9.8.7"})
    refused(
        saved,
        rf"saved by rodimpact 9\.8\.7; this is rodimpact {ri.__version__}.*Load it with",
    )
