"""Every public name, with arguments that are spoilt, answers or says in a sentence what
is wrong.

The names and their parameters are taken from the package, so that no later name
escapes.
"""

import re
import webbrowser

import matplotlib.pyplot as plt
import numpy as np
import pytest
from fuzz import good_calls
from fuzz.bad_values import BAD_VALUES, NEVER_RIGHT
from fuzz.generators import SEEDS, TIMES, check_sentence, one_of, patience
from numpy.random import default_rng

import rodimpact as ri

EXAMPLES = 60 * TIMES  # of each seed
MOST_SPOILT = 3  # arguments at a time
CALLS = [*good_calls.functions(), *good_calls.methods()]
NAMES = sorted({call.name for call in CALLS})
FIGURES = "plot."  # they take long to draw
EXPECTED = (ValueError, TypeError, LookupError, AttributeError, OSError, MemoryError)


@pytest.fixture(autouse=True)
def folder(monkeypatch, tmp_path):
    """A folder of its own with the files that functions read; no browser, no window."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.setattr(webbrowser, "open", lambda *_: True)
    plt.switch_backend("agg")
    good_calls.write_files(tmp_path)
    yield tmp_path
    plt.close("all")


def refusal_of(call, arguments):
    """The exception with which a call refuses its arguments; None if it answers.

    An answer must also have texts. An exception that is not one of `EXPECTED` is a
    fault of the package, and is raised.
    """
    with patience():
        try:
            answer = call.make()(**arguments)
            if call.name == "plot.look":
                # Its answer is a context manager, which works when it is entered.
                with answer:
                    pass
            assert repr(answer)
            str(answer)
        except EXPECTED as error:
            return error
    return None


def check_spoilt(call, parameter, label):
    """Check that a call with one spoilt argument is answered or refused in a sentence.

    A value that is right for no argument must be refused.
    """
    arguments = call.arguments() | {parameter: BAD_VALUES[label]()}
    where = f"{call.name}({parameter}={label})"
    error = refusal_of(call, arguments)
    plt.close("all")
    if error is None:
        assert label not in NEVER_RIGHT, f"{where} is accepted"
    else:
        check_sentence(error, where)


@pytest.mark.exhaustive
def test_good_arguments_are_parameters_of_what_they_are_for():
    for call in CALLS:
        unknown = set(call.arguments()) - set(call.parameters)
        assert not unknown, call.name


def test_every_public_name_has_good_arguments():
    """Each of more than 200 public names, except `replace`, has good arguments in
    `good_calls`, and each public class an instance, or is named as an exception.
    """
    # `replace` takes no argument to be good.
    names = {name for name in NAMES if not name.endswith(".replace")}
    classes = set(good_calls.public_classes())
    assert names == set(good_calls.CALLS)
    assert set(good_calls.INSTANCES) | good_calls.EXCEPTIONS == classes
    assert classes > good_calls.RETURNED
    assert len(NAMES) > 200  # names are found at all


@pytest.mark.exhaustive
def test_good_arguments_are_answered_and_attributes_read():
    """An attribute that has no value here is refused in a sentence."""
    for call in CALLS:
        assert refusal_of(call, call.arguments()) is None, call.name
    for name, kind in good_calls.public_classes().items():
        for instance in good_calls.INSTANCES.get(name, []):
            for attribute in good_calls.properties_of(kind):
                try:
                    getattr(instance(), attribute)
                except EXPECTED as error:
                    check_sentence(error, f"{name}.{attribute}")


def test_one_bad_value_of_an_argument_is_answered_or_refused_in_a_sentence():
    """Every third call, except figures, gets one random bad value for one argument: it
    returns, or refuses it in a sentence. All values are tried under `exhaustive`.
    """
    rng = default_rng(0)
    quick = [call for call in CALLS if not call.name.startswith(FIGURES)]
    for call in quick[::3]:
        check_spoilt(call, one_of(rng, call.parameters), one_of(rng, [*BAD_VALUES]))


def labels_for(call, index):
    """Labels of the bad values for the parameter with this index.

    Figures take long: they try a third of the values that may be right, and the next
    parameter tries another third.
    """
    labels = list(BAD_VALUES)
    if not call.name.startswith(FIGURES):
        return labels
    may_be_right = [label for label in labels if label not in NEVER_RIGHT]
    return [*NEVER_RIGHT, *may_be_right[index % 3 :: 3]]


@pytest.mark.exhaustive
@pytest.mark.filterwarnings("ignore::rodimpact.DoubtfulReduction")
@pytest.mark.parametrize("name", NAMES)
def test_each_bad_value_of_each_argument_is_answered_or_refused_in_a_sentence(name):
    """Every argument of the calls of this name gets every bad value in turn: the call
    returns, or refuses it in a sentence.
    """
    for call in CALLS:
        if call.name != name:
            continue
        for index, parameter in enumerate(call.parameters):
            for label in labels_for(call, index):
                check_spoilt(call, parameter, label)


@pytest.mark.exhaustive
@pytest.mark.filterwarnings("ignore::rodimpact.DoubtfulReduction")
@pytest.mark.parametrize("seed", SEEDS)
def test_several_bad_arguments_are_answered_or_refused_in_a_sentence(seed):
    """Random public calls, except figures, get one to `MOST_SPOILT` bad arguments: each
    call returns or is refused in a sentence, and more than half are refused.
    """
    rng = default_rng(seed)
    quick = [call for call in CALLS if not call.name.startswith(FIGURES)]
    refused = 0
    for _ in range(EXAMPLES):
        call = one_of(rng, quick)
        arguments = call.arguments()
        for parameter in rng.choice(call.parameters, rng.integers(1, MOST_SPOILT + 1)):
            arguments[parameter] = BAD_VALUES[one_of(rng, [*BAD_VALUES])]()
        try:
            error = refusal_of(call, arguments)
        except FloatingPointError:
            # Products of numbers that are large, but not too large, may overflow.
            continue
        if error is not None:
            check_sentence(error, f"{call.name}(**{arguments})")
            refused += 1
    assert EXAMPLES / 2 < refused < EXAMPLES


REFUSED_CALLS = [
    (lambda: ri.load(0), "path: must be the name of a file, got 0"),
    (
        lambda: good_calls.exact_solution().save(b"x.toml"),
        "path: must be the name of a file",
    ),
    (lambda: ri.parse_case("", source=1), "source: must be the name of a case, got 1"),
    (lambda: ri.plot.energy(3), "solution: must be a Solution"),
    (
        lambda: ri.plot.energy(good_calls.exact_solution(), ax=good_calls.STEEL),
        "ax: must be an Axes",
    ),
    (
        lambda: ri.plot.animation(good_calls.exact_solution(), fps=99),
        "fps: must be 1 to 50",
    ),
    (
        lambda: good_calls.exact_solution().gauge(0, [0.1, 0.2]),
        "x: must be a single number",
    ),
    (
        lambda: good_calls.exact_solution().displacement(0, [0, 0.1], [0, 0, 0]),
        "x: shape (2,) does not broadcast",
    ),
    (lambda: ri.gauges_to_csv("x.csv", [(0, 0.1)]), "gauges: must be records by name"),
    (lambda: good_calls.PAIR[0], "its bodies are system.bodies"),
    (
        lambda: ri.solve(good_calls.PAIR, progress=3),
        "progress: must be True, False or a function",
    ),
    (
        lambda: ri.sweep(good_calls.FAMILY).explain([0, 1]),
        "index: must pick one member",
    ),
    (
        lambda: ri.rigid.reduced_mass([1, 2], [1, 2, 3]),
        "m1 has shape (2,), m2 has shape (3,)",
    ),
    (
        lambda: ri.Segment(1.0, 1e-4, good_calls.STEEL).area_between(0.1),
        "edges: must be two places or more",
    ),
    (lambda: ri.units.parse("1 m", 3), "unknown dimension 3"),
    (
        lambda: ri.System.from_dict({}),
        "data: must be what system.to_dict() gives, got {}",
    ),
    (
        lambda: good_calls.ROD.in_steps(10**30),
        "n: must be a whole number from 1 to 100000, got 1000",
    ),
    (
        lambda: ri.regions_of(good_calls.exact_solution(), limit=np.nan),
        "limit: must be 1 or more, got nan",
    ),
    (
        lambda: ri.gradient(good_calls.PAIR, wrt=["bodies.0.length"])[2.0],
        "no derivative by 2.0; use one of",
    ),
    (
        lambda: ri.materials.aluminum,
        "no material is called 'aluminum'; perhaps 'aluminium' is",
    ),
]


@pytest.mark.parametrize(("call", "sentence"), REFUSED_CALLS)
def test_wrong_calls_are_refused_and_write_no_file(folder, call, sentence):
    files = set(folder.iterdir())
    with pytest.raises(
        (ValueError, LookupError, AttributeError), match=re.escape(sentence)
    ):
        call()
    assert set(folder.iterdir()) == files
