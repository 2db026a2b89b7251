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
from rodimpact.model.frozen import Frozen
from rodimpact.results.saved import case_of
from rodimpact.running.loading import load
from rodimpact.storage import writing
from rodimpact.storage.family_file import CLASSES
from rodimpact.storage.reading import FileFormatError
from rodimpact.storage.saved_result import SavedResult
from rodimpact.storage.writing import FILE_SCHEMA, check_target, write_text

STEEL = ri.materials.steel
SHORT = ri.Rod(0.4, area=1e-4, material=STEEL, velocity=1.0)
LONG = ri.Rod(1.0, area=1e-4, material=STEEL)

# Writing


def test_text_is_written_as_it_is(tmp_path):
    """`write_text` writes UTF-8, keeps line ends, and leaves no temporary file."""
    text = "Länge\r\n1 µm\n"
    path = tmp_path / "a.txt"

    write_text(path, text)

    assert path.read_bytes() == text.encode()
    assert os.listdir(tmp_path) == ["a.txt"]  # and no temporary file


@pytest.mark.parametrize("mask", [0o022, 0o077])
def test_permissions_follow_the_umask(tmp_path, mask):
    """All may read and write a file, except where the mask forbids it."""
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
def test_paths_where_no_file_can_be_are_refused(tmp_path, name, error, said, force):
    """`check_target` and `write_text` refuse a path with the same error, which names
    it, and no file is written.
    """
    (tmp_path / "file").write_text("kept")
    path = f"{tmp_path}/{name}"

    with pytest.raises(error, match=said):
        check_target(path, force=force)
    with pytest.raises(error, match=said) as caught:
        write_text(path, "x", force=force)

    assert path in str(caught.value)
    assert type(caught.value) is error
    assert os.listdir(tmp_path) == ["file"]


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes here")
def test_only_regular_files_are_replaced(tmp_path):
    """`write_text` with force refuses a named pipe and leaves it as it is."""
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(OSError, match="not a regular file"):
        write_text(tmp_path / "pipe", "x", force=True)
    assert stat.S_ISFIFO((tmp_path / "pipe").stat().st_mode)


def fail(error):
    """A function of any arguments that raises this error."""

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
    """`step` is the function of `os` that fails with the error."""
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

STEPPED = ri.Rod(
    segments=[
        ri.Segment(0.2, 1e-4, STEEL),
        ri.Segment(0.1, 3e-4, ri.materials.aluminium),
    ],
    velocity=ri.Steps([1.0, -0.5], [0.05]),
    strain=ri.Steps([0.0, 1e-5, -1e-5], [0.1, 0.25]),
)
GRID = {"method": "finite-difference"}


def named_runs():
    """{name: (system, options)} of runs by all methods."""
    pair = ri.System([SHORT, LONG])
    mass_and_rod = ri.System([ri.RigidMass(0.3, velocity=1.0), SHORT])
    chosen = {"until": 2e-4, "snapshots": [1e-5, 1.3e-4], "cells": 10}
    runs = {
        "pair": (pair, {}),
        "one body": (ri.System([SHORT]), {}),
        "nothing meets": (ri.System([LONG, SHORT], gaps=[0.1]), {}),
        "no time": (pair, {"until": 0}),
        "capped": (ri.System([STEPPED, LONG, STEPPED]), {"max_events": 50}),
        "characteristics: to the proof": (mass_and_rod, {"rtol": 1e-3}),
        "characteristics: no time": (mass_and_rod, {"until": 0}),
        "grid: no time": (pair, {"until": 0, **GRID, "cells": 10}),
        "grid: chosen states": (pair, {**chosen, **GRID}),
    }
    for seed in range(6):
        system = with_ends(seed)
        options = {"until": horizon(system, 10), "max_events": 5000}
        runs[f"random {seed}"] = (system, options)
    for seed in range(12):
        system = random_network(seed, driven=seed % 2 == 0)
        options = {"until": 2.5, "method": "characteristics"}
        runs[f"characteristics: random {seed}"] = (system, options)
    for seed in (7, 8, 9, 11):
        system = random_row(seed, driven=seed % 2 == 0)
        runs[f"grid: random {seed}"] = (system, {"until": 1.5, **GRID, "cells": 8})
    return runs


RUNS = named_runs()
ATTRIBUTES = (
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


def facts(solution):
    """Numbers, arrays and texts of a solution, in a form that is equal exactly if all
    bits are.
    """
    t = np.linspace(0, solution.t_end, 23)
    all_facts = {name: getattr(solution, name) for name in ATTRIBUTES}
    all_facts["t_final"] = repr(solution.t_final)  # it may be nan
    for name in ("until", "t_end", "t_final", "events"):
        all_facts["type", name] = type(getattr(solution, name))
    for name, values in vars(solution.energy(t)).items():
        all_facts["energy", name] = np.asarray(values).tobytes()
    for k, contact in enumerate(solution.contacts):
        totals = (contact.impulse, contact.duration, contact.peak_force)
        breakpoints = [times.tobytes() for times in contact.breakpoints()]
        all_facts["episodes", k] = repr(contact.episodes)
        all_facts["totals", k] = repr(totals)
        all_facts["force", k] = contact.force(t).tobytes()
        all_facts["gap", k] = contact.gap(t).tobytes()
        all_facts["breakpoints", k] = breakpoints
    for i, body in enumerate(solution.system.bodies):
        all_facts["mean velocity", i] = solution.mean_velocity(i, t).tobytes()
        all_facts["position", i] = solution.position(i, 0.0, t).tobytes()
        if isinstance(body, ri.Rod):
            x = np.linspace(0, body.length, 7)[:, None]
            for field in (solution.velocity, solution.strain, solution.displacement):
                all_facts[field.__name__, i] = field(i, x, t).tobytes()
    return all_facts


FEW_SEEDS = (" 1", " 7")
USUAL = [name for name in RUNS if "random" not in name or name.endswith(FEW_SEEDS)]


@pytest.mark.parametrize("name", few_of(RUNS, USUAL))
def test_a_saved_solution_is_found_again_bit_for_bit_and_saved_as_the_same_file(
    tmp_path, name
):
    """A solution is saved, loaded and saved again: facts, outcome, options and file are
    equal bit for bit, and the file read as a case gives the system and its options.
    """
    system, options = RUNS[name]
    path = tmp_path / "run.toml"
    path_of_loaded = tmp_path / "again.toml"

    solution = ri.solve(system, **options)
    solution.save(path)
    loaded = ri.load(path)
    loaded.save(path_of_loaded)

    assert facts(loaded) == facts(solution)
    assert repr(loaded.outcome) == repr(solution.outcome)
    assert loaded.options == solution.options
    for error in [*solution.accuracy.values(), *loaded.accuracy.values()]:
        assert type(error) is float
    assert path_of_loaded.read_bytes() == path.read_bytes()
    case = ri.read_case(path)
    assert case.system == system
    assert case.solve == options
    # A text has no path.
    again = ri.parse_case(ri.format_case(case))
    assert again == dataclasses.replace(case, path="case")


@pytest.mark.parametrize("name", ["inf", "nan"])
def test_a_name_that_reads_as_a_number_stays_a_name(tmp_path, name):
    """A material with such a name is saved in a solution and in a family, and loaded
    with the same system.
    """
    material = ri.Material(name, youngs_modulus=1.0, density=1.0)
    striker = ri.Rod([0.4, 0.5], area=1.0, material=material, velocity=1.0)
    struck = ri.Rod(1.0, area=1.0, material=material)
    family = ri.System([striker, struck])

    ri.solve(family[0]).save(tmp_path / "run.toml")
    ri.sweep(family).save(tmp_path / "family.npz")

    assert ri.load(tmp_path / "run.toml").system == family[0]
    assert ri.load(tmp_path / "family.npz").system == family


def test_the_state_of_a_smooth_wave_comes_back_equal(tmp_path):
    """A run from a state whose waves are polynomials is saved and loaded: system and
    outcome are equal.
    """
    striker = ri.RigidMass(0.3, velocity=1.0)
    struck = SHORT.replace(velocity=0.0)
    row = ri.System([striker, struck], contacts=[ri.Spring(1e6)])
    state = ri.solve(row, until=2e-4).system_at(1e-4)
    assert isinstance(state.bodies[1].velocity, ri.Polynomials)
    solution = ri.solve(state, until=2e-5, rtol=1e-4)

    solution.save(tmp_path / "run.toml")
    loaded = ri.load(tmp_path / "run.toml")

    assert loaded.system == state
    assert loaded.outcome == solution.outcome


def test_a_case_that_is_too_large_for_a_reader_is_not_written(tmp_path, monkeypatch):
    """With a limit one byte below the size of its file, saving a solution is refused
    and writes nothing; with the exact size it is written.
    """
    solution = ri.solve(ri.System([SHORT, ri.Wall()]))
    size = len(ri.format_case(case_of(solution)).encode())
    limit = "rodimpact.storage.case_writing.MAX_CASE_BYTES"
    path = tmp_path / "run.toml"
    message = f"system: .* {size} bytes.*fewer samples"

    monkeypatch.setattr(limit, size - 1)
    with pytest.raises(ri.InvalidModel, match=message):
        solution.save(path)
    assert not path.exists()

    monkeypatch.setattr(limit, size)
    solution.save(path)
    assert path.exists()


def test_a_solution_is_saved_in_a_toml_file_only(tmp_path):
    solution = ri.solve(ri.System([SHORT, ri.Wall()]))
    for name in ("run.npz", "run", "toml"):  # the last two have no ending
        with pytest.raises(ri.InvalidModel, match=r"path: must end in \.toml"):
            solution.save(tmp_path / name)
    assert os.listdir(tmp_path) == []


def test_a_solution_is_saved_over_another_file_by_force_only(tmp_path):
    """Saving over a file raises FileExistsError and leaves it; with force=True it is
    replaced.
    """
    solution = ri.solve(ri.System([SHORT, ri.Wall()]))
    path = tmp_path / "run.toml"
    path.write_text("precious")

    with pytest.raises(FileExistsError, match="force=True"):
        solution.save(path)
    assert path.read_text() == "precious"
    assert os.listdir(tmp_path) == ["run.toml"]

    solution.save(path, force=True)
    assert ri.load(path).final


# Another outcome


THREE_BODIES = ri.System(
    [ri.RigidMass(0.3, velocity=2.0), STEPPED, LONG],
    contacts=[ri.Hertz(1e10), ri.Rigid()],
)


@functools.cache
def saved_case():
    """Case of a solution with stated errors."""
    return case_of(ri.solve(THREE_BODIES, until=4e-4, rtol=1e-6))


def another(value):
    """A value of the same type that differs from this one."""
    if isinstance(value, bool):
        return not value
    if isinstance(value, str):
        return "fronts"
    return value + 1e-3 * (abs(value) + 1)


def changed(result, name, change=another):
    """The same result with another value of an entry, which `change` makes of it."""
    if name in SavedResult._fields:
        return result._replace(**{name: change(getattr(result, name))})
    numbers = {**result.numbers, name: change(result.numbers[name])}
    return result._replace(numbers=numbers)


def write_with(path, result):
    """Write the saved case with another result."""
    text = ri.format_case(dataclasses.replace(saved_case(), result=result))
    path.write_text(text, encoding="utf-8")


FOURTHS = slice(None, None, 4)
"""Every fourth entry."""


@pytest.mark.exhaustive
@pytest.mark.parametrize("part", few_of([FOURTHS, slice(None)], [FOURTHS]))
def test_every_falsified_entry_is_named_with_both_values(tmp_path, part):
    """Each entry of a saved result is changed in turn: loading warns of exactly this
    entry, with both values and the line of the call.
    """
    path = tmp_path / "run.toml"
    result = saved_case().result
    names = ["stopped_by", "final", "method", *result.numbers]
    for name in names[part]:
        write_with(path, changed(result, name))
        with pytest.warns(ri.OutcomeDiffers, match=r"run\.toml: ") as warned:
            ri.load(path)
        (warning,) = warned
        named = re.findall(r"([\w.]+) is \S+ stored is ", str(warning.message))
        assert warning.filename == __file__
        assert named == [name]


def test_a_difference_within_the_stated_errors_of_both_runs_is_none(tmp_path):
    """A velocity may differ by nearly twice the stated error, and no more."""
    path = tmp_path / "run.toml"
    result = saved_case().result
    solution = ri.solve(THREE_BODIES, until=4e-4, rtol=1e-6)
    speeds = np.abs(solution.outcome.velocities_after)
    scale = max(solution.run.clock.scale, *speeds)
    error = result.accuracy["velocity"] * scale  # m/s
    name = "velocity_after.1"
    within = changed(result, name, lambda v: v + 1.99 * error)
    beyond = changed(result, name, lambda v: v + 2.01 * error)
    assert error > 0

    write_with(path, within)
    assert ri.load(path).final == solution.final  # a warning would be an error

    write_with(path, beyond)
    with pytest.warns(ri.OutcomeDiffers, match=r"velocity_after\.1 is "):
        ri.load(path)


def test_unknown_errors_allow_everything_and_texts_are_not_compared(tmp_path):
    """A saved result with changed numbers, infinite errors, another version and status
    is loaded without a warning.
    """
    path = tmp_path / "run.toml"
    result = saved_case().result
    unknown_errors = dict.fromkeys(result.accuracy, math.inf)
    for name in ("duration.0", "episodes.0", "velocity_after.1"):
        result = changed(result, name)
    result = result._replace(
        accuracy=unknown_errors, version="0.0.1", status="earlier words"
    )
    write_with(path, result)

    loaded = ri.load(path)  # a warning would be an error

    assert loaded.outcome.status != "earlier words"


def test_many_differences_are_counted_in_a_short_warning(tmp_path):
    """All numbers of a saved result are changed: the warning names some, counts the
    others, and has less than 1500 characters.
    """
    path = tmp_path / "run.toml"
    result = saved_case().result
    for name in result.numbers:
        result = changed(result, name)
    write_with(path, result)
    with pytest.warns(ri.OutcomeDiffers, match=r"; and \d+ entries more$") as warned:
        ri.load(path)
    (warning,) = warned
    assert len(str(warning.message)) < 1500


# Files that are no saved results


def assert_refused(path, message):
    """A file is refused with this message, and as a whole: by its own name."""
    with pytest.raises((FileFormatError, ri.InvalidModel), match=message) as caught:
        load(path)
    ((name, _),) = caught.value.problems
    assert name == str(path) or str(caught.value).startswith(str(path))


def test_a_missing_file_and_a_directory_are_errors_of_the_system(tmp_path):
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
def test_files_of_other_kinds_are_refused(tmp_path, name, content):
    """A file with other contents is refused in the words for its ending; an empty one
    lacks its schema.
    """
    path = tmp_path / name
    path.write_bytes(content)
    if name == "a.npz":
        assert_refused(path, "is not an NPZ file")
    elif content:
        assert_refused(path, "is not valid TOML|is not text in UTF-8")
    else:
        # An empty file is TOML.
        with pytest.raises(ri.InvalidModel, match="begin the file with schema = 1"):
            load(path)


def test_a_case_without_an_outcome_is_no_saved_solution(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(ri.format_case(THREE_BODIES))
    assert_refused(path, r"no table \[result\].*read_case.*solve\(case\.system")


@pytest.mark.parametrize("schema", [4, 6])
def test_a_solution_that_an_earlier_version_saved_as_arrays_names_the_remedy(
    tmp_path, schema
):
    """Loading a solution in the old format of arrays is refused with the advice to
    solve the system again and save it as a case file.
    """
    path = tmp_path / "run.npz"
    document = {
        "format": "rodimpact",
        "schema": schema,
        "rodimpact": "0.1.0",
        "kind": "solution",
        "content": {},
        "arrays": {},
    }
    np.savez_compressed(path, document=np.array(json.dumps(document)))
    remedy = r'solve its system again, and save\("run\.toml"\).*as a case file'
    assert_refused(path, remedy)


# Text of a right file, what replaces it, the path below `result`, and the message. What
# follows a "#" is a comment of the file.
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
    """A saved result gets all of `MISTAKES` and an unknown table: each path has its
    message, and no other is reported.
    """
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
def test_results_of_other_types_are_refused(result, said):
    case = ri.format_case(THREE_BODIES).removeprefix("schema = 1\n")

    with pytest.raises(ri.InvalidModel, match=said):
        ri.parse_case(f"schema = 1\n{result}\n{case}")


@pytest.mark.exhaustive
def test_a_file_that_ends_anywhere_is_refused_or_lacks_only_its_last_tables():
    """A saved solution is cut at every seventh character: it is refused in a sentence,
    or is a case without an outcome, or lacks stated errors only. More than half are
    refused.
    """
    text = ri.format_case(saved_case())
    begin_of_errors = text.index("[result.accuracy]")
    outcome = saved_case().result._replace(accuracy={})
    ends = range(0, len(text), 7)  # every seventh, to save time
    sentences = []
    for end in ends:
        try:
            result = ri.parse_case(text[:end]).result
        except ri.InvalidModel as error:
            sentences.append(str(error))
            continue
        if result is not None:
            assert end > begin_of_errors
            assert result._replace(accuracy={}) == outcome
    # Most files are refused, and not all.
    assert len(ends) / 2 < len(sentences) < len(ends)
    for sentence in sentences:
        assert 0 < len(sentence) < 4000


# Families


@pytest.fixture
def saved(tmp_path):
    """Path of a saved sweep over a family of two members."""
    path = tmp_path / "map.npz"
    family = ri.System([SHORT.replace(length=[0.2, 0.4]), LONG])
    ri.sweep(family).save(path)
    return path


def edit(path, change_of_document, **changed_arrays):
    """Rewrite a saved file in place: `change_of_document` is merged into its document,
    and the named arrays replace its own or are added.
    """
    with np.load(path) as archive:
        arrays = dict(archive)
    document = json.loads(str(arrays["document"])) | change_of_document
    arrays["document"] = np.array(json.dumps(document))
    arrays |= changed_arrays
    np.savez_compressed(path, **arrays)


SHAFTS = {
    "soil": ri.Soil(20e3, quake=[2e-3, 3e-3], damping=0.1),
    "drag": ri.Drag([5.0, 10.0]),
}


@pytest.mark.parametrize("name", SHAFTS)
def test_a_saved_family_of_rods_in_soil_or_with_drag_is_found_again(tmp_path, name):
    """A swept family of a mass and a pile in this soil or drag is saved and loaded:
    system and columns are equal.
    """
    pile = ri.Rod(4.0, area=1e-2, material=STEEL, shaft=SHAFTS[name])
    family = ri.System([ri.RigidMass(100.0, velocity=2.0), pile])
    result = ri.sweep(family, until=1e-3, method="finite-difference", cells=8)
    result.save(tmp_path / "piles.npz")

    loaded = ri.load(tmp_path / "piles.npz")

    assert loaded.system == family
    assert loaded.columns.keys() == result.columns.keys()
    for column, values in result.columns.items():
        np.testing.assert_array_equal(loaded.columns[column], values)


def public_classes(kind):
    """Yield the public subclasses of `kind`, at any depth, that are defined in the
    model.
    """
    for below in kind.__subclasses__():
        is_of_model = below.__module__.startswith("rodimpact.model.")
        if is_of_model and below.__name__ in dir(ri):
            yield below
        yield from public_classes(below)


def test_files_of_families_have_every_class_of_the_model_but_functions():
    names = {kind.__name__ for kind in public_classes(Frozen)}
    assert names - CLASSES.keys() == {"Law"}  # `save` refuses a law that is a function


def test_the_file_of_a_family_opens_with_numpy_and_json_alone(saved):
    """The saved file of a family is read without the package: its document, strict
    JSON, leads to the lengths of rod 1 in an array and has the version; the restitution
    is an array.
    """
    with np.load(saved, allow_pickle=False) as archive:
        arrays = dict(archive)
    # NaN and Infinity are no JSON.
    refuse = fail(ValueError("no JSON"))
    document = json.loads(str(arrays["document"]), parse_constant=refuse)

    first, second = document["content"][0]["bodies"]
    reference = first["length"]  # to a part of an array of the file
    start = reference["start"]
    (count,) = reference["shape"]
    array = arrays[reference["array"]]
    lengths = array[start : start + count]
    assert lengths.tolist() == [0.2, 0.4]
    assert second["length"] == LONG.length  # 1 m, so that e = l1/l2 is l1
    assert arrays["restitution"] == pytest.approx(lengths)
    assert document["rodimpact"] == ri.__version__


def test_pickled_arrays_are_never_unpickled(saved, tmp_path):
    """A saved file with a pickled array, among its arrays or as its document, is
    refused, and the pickle is not run.
    """

    class Bomb:
        def __reduce__(self):
            return os.mkdir, (str(tmp_path / "exploded"),)

    bomb = np.array([Bomb()], dtype=object)
    edit(saved, {}, f8=bomb)
    assert_refused(saved, "plain arrays")
    np.savez(saved, document=bomb)
    assert_refused(saved, "plain arrays")
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
def test_foreign_archives_are_refused(tmp_path, arrays):
    path = tmp_path / "a.npz"
    np.savez(path, **arrays)
    assert_refused(path, "not one that rodimpact saved")


@pytest.mark.parametrize(
    "change", [{"schema": FILE_SCHEMA + 1}, {"kind": "hologram"}, {"schema": None}]
)
def test_a_file_that_a_newer_version_saved_names_both_versions(saved, change):
    edit(saved, change | {"rodimpact": "9.8.7"})
    versions = rf"saved by rodimpact 9\.8\.7; this is rodimpact {ri.__version__}"
    assert_refused(saved, rf"{versions}.*Load it with")
