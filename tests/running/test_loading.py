"""Files are whole or absent; a saved solution, solved again, is the same to the last
bit.
"""

import dataclasses
import errno
import functools
import json
import math
import os
import pickle
import re
import stat

import numpy as np
import pytest
from exhaustive import few_of
from grid_rows import random_row
from networks import random_network
from systems import horizon, with_ends

import rodimpact as ri
from rodimpact.results.saved import case_of
from rodimpact.running.loading import load
from rodimpact.storage import writing
from rodimpact.storage.reading import FileFormatError
from rodimpact.storage.saved_result import SavedResult
from rodimpact.storage.writing import FILE_SCHEMA, check_target, write_text

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
    "one body": (ri.System([SHORT]), {}),
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
    all_facts = {
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
    all_facts["t_final"] = repr(s.t_final)
    all_facts["types"] = [
        type(getattr(s, name)) for name in ("until", "t_end", "t_final", "events")
    ]
    all_facts["energy"] = [
        np.asarray(entry).tobytes() for entry in vars(s.energy(t)).values()
    ]
    all_facts["contacts"] = [
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
        all_facts[i, "mean"] = s.mean_velocity(i, t).tobytes()
        all_facts[i, "position"] = s.position(i, 0.0, t).tobytes()
        if isinstance(body, ri.Rod):
            x = np.linspace(0, body.length, 7)[:, None]
            for field in (s.velocity, s.strain, s.displacement):
                all_facts[i, field.__name__] = field(i, x, t).tobytes()
    return all_facts


USUAL = [
    name
    for name in RUNS
    if "random" not in name or name.endswith((" 0", " 1", " 7", " 8"))
]


@pytest.mark.parametrize("name", few_of(RUNS, USUAL))
def test_a_saved_solution_is_found_again_bit_for_bit(tmp_path, name):
    system, options = RUNS[name]
    solution = ri.solve(system, **options)
    solution.save(tmp_path / "run.toml")
    loaded = ri.load(tmp_path / "run.toml")
    assert facts(loaded) == facts(solution)
    assert repr(loaded.outcome) == repr(solution.outcome)
    assert loaded.options == solution.options
    loaded.save(tmp_path / "again.toml")
    again = (tmp_path / "again.toml").read_bytes()
    assert again == (tmp_path / "run.toml").read_bytes()
    case = ri.read_case(tmp_path / "run.toml")
    assert case.system == system
    assert case.solve == options
    assert ri.parse_case(ri.format_case(case)) == dataclasses.replace(case, path="case")


@pytest.mark.parametrize("name", ["inf", "nan"])
def test_a_name_that_reads_as_a_number_stays_a_name(tmp_path, name):
    material = ri.Material(name, youngs_modulus=1.0, density=1.0)
    rods = [
        ri.Rod(length, area=1.0, material=material, velocity=v)
        for length, v in (([0.4, 0.5], 1.0), (1.0, 0.0))
    ]
    family = ri.System(rods)
    ri.solve(family[0]).save(tmp_path / "run.toml")
    ri.sweep(family).save(tmp_path / "family.npz")
    assert ri.load(tmp_path / "run.toml").system == family[0]
    assert ri.load(tmp_path / "family.npz").system == family


def test_the_state_of_a_smooth_wave_comes_back_equal(tmp_path):
    """Its waves are polynomials."""
    struck = SHORT.replace(velocity=0.0)
    row = ri.System(
        [ri.RigidMass(0.3, velocity=1.0), struck], contacts=[ri.Spring(1e6)]
    )
    state = ri.solve(row, until=2e-4).system_at(1e-4)
    assert isinstance(state.bodies[1].velocity, ri.Polynomials)
    solution = ri.solve(state, until=2e-5, rtol=1e-4)
    solution.save(tmp_path / "run.toml")
    loaded = ri.load(tmp_path / "run.toml")
    assert loaded.system == state
    assert loaded.outcome == solution.outcome


def test_a_case_that_no_reader_would_take_is_not_written(tmp_path, monkeypatch):
    solution = ri.solve(ri.System([SHORT, ri.Wall()]))
    size = len(ri.format_case(case_of(solution)).encode())
    monkeypatch.setattr("rodimpact.storage.case_writing.MAX_CASE_BYTES", size - 1)
    with pytest.raises(
        ri.InvalidModel, match=f"system: .* {size} bytes.*fewer samples"
    ):
        solution.save(tmp_path / "run.toml")
    assert not list(tmp_path.iterdir())
    monkeypatch.setattr("rodimpact.storage.case_writing.MAX_CASE_BYTES", size)
    solution.save(tmp_path / "run.toml")


def test_only_cases_are_written_and_none_over_another_file(tmp_path):
    solution = ri.solve(ri.System([SHORT, ri.Wall()]))
    for name in ("run.npz", "run", "toml"):
        with pytest.raises(ri.InvalidModel, match=r"path: must end in \.toml"):
            solution.save(tmp_path / name)
    (tmp_path / "run.toml").write_text("precious")
    with pytest.raises(FileExistsError, match="force=True"):
        solution.save(tmp_path / "run.toml")
    assert (tmp_path / "run.toml").read_text() == "precious"
    assert len(list(tmp_path.iterdir())) == 1
    solution.save(tmp_path / "run.toml", force=True)
    assert ri.load(tmp_path / "run.toml").final


# Another outcome


TWICE = ri.System(
    [ri.RigidMass(0.3, velocity=2.0), stepped, LONG],
    contacts=[ri.Hertz(1e10), ri.Rigid()],
)


@functools.cache
def saved_case():
    """Case of a solution with stated errors."""
    return case_of(ri.solve(TWICE, until=4e-4, rtol=1e-6))


def another(value):
    if isinstance(value, bool):
        return not value
    return "fronts" if isinstance(value, str) else value + 1e-3 * (abs(value) + 1)


def changed(result, name, change=another):
    """The same result with another value of this name."""
    if name in SavedResult._fields:
        return result._replace(**{name: change(getattr(result, name))})
    numbers = {**result.numbers, name: change(result.numbers[name])}
    return result._replace(numbers=numbers)


def write_with(path, result):
    text = ri.format_case(dataclasses.replace(saved_case(), result=result))
    path.write_text(text, encoding="utf-8")


def test_every_falsified_entry_is_named_with_both_values(tmp_path):
    path = tmp_path / "run.toml"
    result = saved_case().result
    loud = []
    names = ["stopped_by", "final", "method", *result.numbers]
    for name in names:
        write_with(path, changed(result, name))
        with pytest.warns(ri.OutcomeDiffers, match=r"run\.toml: ") as seen:
            ri.load(path)
        [warning] = seen
        assert warning.filename == __file__
        [named] = re.findall(r"([\w.]+) is \S+ stored is ", str(warning.message))
        loud.append(named)
    assert loud == names


def test_what_stated_errors_allow_is_no_difference(tmp_path):
    """Both runs state the error; a velocity may differ by nearly twice as much, and no
    more.
    """
    path = tmp_path / "run.toml"
    result = saved_case().result
    solution = ri.solve(TWICE, until=4e-4, rtol=1e-6)
    velocities = map(abs, solution.outcome.velocities_after)
    scale = max(solution.run.clock.scale, *velocities)
    error = result.accuracy["velocity"] * scale
    assert error > 0
    write_with(path, changed(result, "velocity_after.1", lambda v: v + 1.99 * error))
    assert ri.load(path).final == solution.final
    write_with(path, changed(result, "velocity_after.1", lambda v: v + 2.01 * error))
    with pytest.warns(ri.OutcomeDiffers, match=r"velocity_after\.1 is "):
        ri.load(path)


def test_unknown_errors_allow_everything_and_texts_are_not_compared(tmp_path):
    path = tmp_path / "run.toml"
    result = saved_case().result
    unknown = dict.fromkeys(result.accuracy, math.inf)
    for name in ("duration.0", "episodes.0", "velocity_after.1"):
        result = changed(result, name)
    result = result._replace(accuracy=unknown, version="0.0.1", status="earlier words")
    write_with(path, result)
    assert ri.load(path).outcome.status != "earlier words"


def test_many_differences_are_counted(tmp_path):
    path = tmp_path / "run.toml"
    result = saved_case().result
    for name in result.numbers:
        result = changed(result, name)
    write_with(path, result)
    with pytest.warns(ri.OutcomeDiffers, match=r"; and \d+ entries more$") as seen:
        ri.load(path)
    assert len(str(seen[0].message)) < 1500


# Files that are no saved results


def refused(path, said):
    with pytest.raises((FileFormatError, ri.InvalidModel), match=said) as caught:
        load(path)
    [(where, _)] = caught.value.problems
    assert where == str(path) or str(caught.value).startswith(str(path))


def test_missing_file_and_directory(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"none\.npz"):
        load(tmp_path / "none.npz")
    with pytest.raises(IsADirectoryError, match=str(tmp_path)):
        load(tmp_path)


@pytest.mark.parametrize("name", ["a.npz", "a.toml"])
@pytest.mark.parametrize(
    "content",
    [b"", b"time,force\n", pickle.dumps([1, 2]), b"\x93NUMPY\x01\x00"],
    ids=["empty", "text", "pickle", "npy"],
)
def test_other_files(tmp_path, name, content):
    path = tmp_path / name
    path.write_bytes(content)
    if name == "a.npz":
        refused(path, "is not an NPZ file")
    elif content:
        refused(path, "is not valid TOML|is not text in UTF-8")
    else:
        with pytest.raises(ri.InvalidModel, match="begin the file with schema = 1"):
            load(path)


def test_a_case_without_an_outcome_is_no_saved_solution(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(ri.format_case(TWICE))
    refused(path, r"no table \[result\].*read_case.*solve\(case\.system")


@pytest.mark.parametrize("schema", [4, 6])
def test_a_solution_that_an_earlier_version_saved_as_arrays_names_the_remedy(
    tmp_path, schema
):
    path = tmp_path / "run.npz"
    head = {"format": "rodimpact", "schema": schema, "rodimpact": "0.1.0"}
    document = {**head, "kind": "solution", "content": {}, "arrays": {}}
    np.savez_compressed(path, document=np.array(json.dumps(document)))
    refused(path, r'solve its system again, and save\("run\.toml"\).*as a case file')


MISTAKES = [
    ("version = ", "version = 1 #", "version", "must be text, got 1"),
    ("method = ", "methods = ", "methods", "unknown key; perhaps 'method' is meant"),
    ("method = ", "methods = ", "method", "is missing"),
    ("final = ", "final = 1 #", "final", "must be true or false, got 1"),
    ("damped = ", "damped = true #", "numbers.damped", "must be a number, got True"),
    (
        "radiated = ",
        "radiated = '1' #",
        "numbers.radiated",
        "must be a number, got '1'",
    ),
    (
        "dissipated = ",
        f"dissipated = {10**400} #",
        "numbers.dissipated",
        "must be a num",
    ),
    ("wall_work = ", "wall_work = 1979-05-27 #", "numbers.wall_work", "must be a num"),
    ("drive_work = ", "drive_work = [1] #", "numbers.drive_work", "must be a number"),
    ('"first.1"', '"first.2"', "numbers.first.2", "unknown key; perhaps 'first.1'"),
    ('"first.1"', '"first.2"', "numbers.first.1", "is missing"),
    ("\nvelocity = ", "\nvelocity = -1 #", "accuracy.velocity", "must not be negative"),
    ("\ntime = ", "\ntime = nan #", "accuracy.time", "must not be negative, got nan"),
    ("\nimpulse = ", "\nimpuls = ", "accuracy.impuls", "unknown key; perhaps"),
]


def test_all_mistakes_of_a_result_are_reported_at_once():
    text = ri.format_case(saved_case())
    for right, wrong, *_ in MISTAKES:
        text = text.replace(right, wrong)
    with pytest.raises(ri.InvalidModel) as caught:
        ri.parse_case(text + "[gauge]\n")
    problems = dict(caught.value.problems)
    for _, _, path, said in MISTAKES:
        assert problems.pop(f"result.{path}").startswith(said)
    assert list(problems) == ["gauge"]


@pytest.mark.parametrize(
    ("result", "said"),
    [
        ("result = 1", "result: must be a table, got 1"),
        ("result = []", "result: must be a table"),
        ("[[result]]", "result: must be a table"),
        ("[result]", "result.version: is missing"),
        ("[result]\nnumbers = 1", "result.numbers: must be a table of numbers, got 1"),
        ("[result]\nnumbers = {}", "result.numbers.velocity_after.2: is missing"),
        ("[result]\naccuracy = [1]", "result.accuracy: must be a table of numbers"),
    ],
)
def test_results_of_other_types(result, said):
    with pytest.raises(ri.InvalidModel, match=said):
        ri.parse_case(f"schema = 1\n{result}\n{ri.format_case(TWICE)[11:]}")


def outcome_in(text):
    """The outcome that a text holds, or the sentences that refuse it."""
    try:
        return ri.parse_case(text).result
    except ri.InvalidModel as error:
        return str(error)


def test_a_file_that_ends_anywhere_is_refused_in_sentences():
    """Or it is a case without an outcome; or all is there but stated errors."""
    text = ri.format_case(saved_case())
    ends = range(0, len(text), 7)
    results = [outcome_in(text[:end]) for end in ends]
    sentences = [result for result in results if isinstance(result, str)]
    assert all(0 < len(result) < 4000 for result in sentences)
    assert len(ends) / 2 < len(sentences) < len(ends)
    for end, result in zip(ends, results, strict=True):
        if isinstance(result, SavedResult):
            assert end > text.index("[result.accuracy]")
            assert result._replace(accuracy={}) == saved_case().result._replace(
                accuracy={}
            )


# Families


@pytest.fixture
def saved(tmp_path):
    path = tmp_path / "map.npz"
    family = ri.System([SHORT.replace(length=[0.2, 0.4]), LONG])
    ri.sweep(family).save(path)
    return path


def edit(path, change=None, **other):
    """Rewrite a saved file with other entries; an array that is None goes."""
    with np.load(path) as archive:
        arrays = dict(archive)
    document = json.loads(str(arrays.pop("document")))
    arrays = {
        "document": np.array(json.dumps({**document, **(change or {})})),
        **arrays,
        **other,
    }
    np.savez_compressed(path, **{k: v for k, v in arrays.items() if v is not None})


def test_the_file_of_a_family_opens_with_numpy_and_json_alone(saved):
    with np.load(saved, allow_pickle=False) as archive:
        document = json.loads(
            str(archive["document"]), parse_constant=fail(ValueError("no JSON"))
        )
        length = document["content"][0]["bodies"][0]["length"]
        column = archive[length["array"]][length["start"] :][: length["shape"][0]]
        restitution = archive["restitution"].tolist()
    assert column.tolist() == [0.2, 0.4]
    assert restitution == pytest.approx([0.2, 0.4])
    assert document["rodimpact"] == ri.__version__
    assert document["content"][0]["bodies"][1]["length"] == LONG.length


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
    "change", [{"schema": FILE_SCHEMA + 1}, {"kind": "hologram"}, {"schema": None}]
)
def test_what_a_newer_version_saved(saved, change):
    edit(saved, {**change, "rodimpact": "9.8.7"})
    refused(
        saved,
        rf"saved by rodimpact 9\.8\.7; this is rodimpact {ri.__version__}.*Load it "
        "with",
    )
