"""Every public name, called with things of every kind, answers or says in a sentence what is wrong.

The names are found where users find them: in the package, its modules, and on what calls return.
"""

import inspect
import re
from types import FunctionType

import numpy as np
import pytest
from fuzz.generators import (
    FAMILY,
    FLAGS,
    PAIR,
    RODS,
    SEEDS,
    SOLVED,
    STEEL,
    TIMES,
    called,
    likely,
    objects,
    one_of,
)

import rodimpact as ri

EXAMPLES = 100 * TIMES  # of each seed
LEFT_OUT = {
    "warm",  # it compiles for minutes, and takes nothing that could be wrong
    "restored",
    "run",  # they take what files hold, which is spoilt elsewhere, or what was checked
}


def public():
    """Public functions and classes, by name."""
    for name in ri.__all__:
        thing = getattr(ri, name)
        yield name, thing
        if inspect.ismodule(thing):
            own = [
                k
                for k, v in vars(thing).items()
                if k[0] != "_" and getattr(v, "__module__", "") == thing.__name__
            ]
            for part in getattr(thing, "__all__", own):
                yield f"{name}.{part}", getattr(thing, part)


def is_called(thing):
    """Whether users call it: results have attributes in place of parameters."""
    if inspect.isclass(thing):
        return "Parameters\n" in (thing.__doc__ or "") and not issubclass(
            thing, BaseException
        )
    return inspect.isfunction(thing) and re.search(
        r"(Parameters|Examples)\n", thing.__doc__ or ""
    )


def methods(thing):
    """Public methods of a thing, by name."""
    for name in dir(thing):
        if (name[0] != "_" or name == "__getitem__") and name not in LEFT_OUT:
            method = inspect.getattr_static(thing, name)
            if isinstance(method, FunctionType | classmethod):
                yield f"{type(thing).__name__}.{name}", getattr(thing, name)


class Names:
    """All that can be called: functions, and methods of a thing of each kind that was returned."""

    def __init__(self):
        names = {name: thing for name, thing in public() if name not in LEFT_OUT}
        self.functions = [item for item in names.items() if is_called(item[1])]
        self.classes = {thing for thing in names.values() if inspect.isclass(thing)}
        self.kinds = {}
        steps = ri.solve(ri.System(RODS, contacts=[ri.Spring(1e8)]), until=1e-4)
        for solution in (
            SOLVED(),
            steps,
            ri.solve(PAIR, 1e-4, "finite-difference", cells=8),
        ):
            self.add(solution)
            self.add(solution.contacts[0])
        for thing in objects(np.random.default_rng(0)):
            self.add(thing)

    def add(self, thing):
        """Its methods are called from now on."""
        if type(thing) in self.classes and (found := [*methods(thing)]):
            self.kinds[type(thing), str(getattr(thing, "method", ""))[:9]] = found

    def one(self, rng):
        """A name and what it is."""
        return one_of(
            rng,
            self.functions
            if rng.random() < 0.6
            else one_of(rng, [*self.kinds.values()]),
        )


def arguments_for(rng, function):
    """Random arguments, positional and by name; some of them good, now and then one too many."""
    things, good, positional, named = objects(rng), rng.random(), [], {}
    for parameter in inspect.signature(function).parameters.values():
        if parameter.default is not parameter.empty and rng.random() < 0.6:
            continue
        known = parameter.name in FLAGS or rng.random() < good
        value = likely(rng, parameter.name) if known else one_of(rng, things)
        if parameter.kind is parameter.POSITIONAL_ONLY:
            positional.append(value)
        elif parameter.kind is parameter.VAR_KEYWORD:
            named[str(one_of(rng, ["length", "mass", "velocity", "area", "x"]))] = value
        elif parameter.kind is not parameter.VAR_POSITIONAL:
            named[parameter.name] = value
    if rng.random() < 0.02:
        named["lenght"] = 1.0
    return positional, named


@pytest.mark.parametrize("seed", SEEDS)
def test_calls_answer_or_refuse_in_a_sentence(monkeypatch, tmp_path, seed):
    rng, names, refused = np.random.default_rng(seed), Names(), 0
    monkeypatch.chdir(tmp_path)
    for _ in range(EXAMPLES):
        _, function = names.one(rng)
        positional, named = arguments_for(rng, function)
        result = called(function, *positional, **named)
        refused += isinstance(result, Exception)
        names.add(result)
    assert EXAMPLES / 10 < refused < EXAMPLES
    assert not list(tmp_path.rglob(".rodimpact*"))


REFUSED = [
    (lambda: ri.load(0), "path: must be the name of a file, got 0"),
    (lambda: SOLVED().save(b"x.toml"), "path: must be the name of a file"),
    (lambda: ri.parse_case("", source=1), "source: must be the name of a case, got 1"),
    (lambda: ri.plot.energy(3), "solution: must be a Solution"),
    (lambda: ri.plot.energy(SOLVED(), ax=STEEL), "ax: must be an Axes"),
    (lambda: ri.plot.animation(SOLVED(), fps=99), "fps: must be 1 to 50"),
    (lambda: SOLVED().gauge(0, [0.1, 0.2]), "x: must be a single number"),
    (
        lambda: SOLVED().displacement(0, [0, 0.1], [0, 0, 0]),
        "x: shape (2,) does not broadcast",
    ),
    (lambda: ri.gauges_to_csv("x.csv", [(0, 0.1)]), "gauges: must be records by name"),
    (lambda: PAIR[0], "array is 0-dimensional, but 1 were indexed"),
    (lambda: ri.solve(PAIR, progress=3), "progress: must be True, False or a function"),
    (lambda: ri.sweep(FAMILY).explain([0, 1]), "index: must pick one member"),
    (
        lambda: ri.rigid.contact_mass([1, 2], [1, 2, 3]),
        "m1 has shape (2,), m2 has shape (3,)",
    ),
    (
        lambda: ri.Segment(1.0, 1e-4, STEEL).area_between(0.1),
        "edges: must be two places or more",
    ),
    (lambda: ri.units.parse("1 m", 3), "unknown dimension 3"),
    (
        lambda: ri.System.from_dict({}),
        "data: must be what system.to_dict() gives, got {}",
    ),
    (
        lambda: RODS[0].in_steps(10**30),
        "n: must be a whole number from 1 to 100000, got 1000",
    ),
    (
        lambda: ri.regions_of(SOLVED(), limit=np.nan),
        "limit: must be 1 or more, got nan",
    ),
    (
        lambda: ri.gradient(PAIR, wrt=["bodies.0.length"])[2.0],
        "no derivative by 2.0; use one of",
    ),
    (
        lambda: ri.materials.aluminum,
        "no material is called 'aluminum'; perhaps 'aluminium' is",
    ),
]


@pytest.mark.parametrize(("call", "sentence"), REFUSED)
def test_what_was_found_is_refused(monkeypatch, tmp_path, call, sentence):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(
        (ValueError, LookupError, AttributeError), match=re.escape(sentence)
    ):
        call()
    assert not list(tmp_path.iterdir())
