"""Hints on names that do not exist: the attribute, argument or function that is meant.

`nearest` compares a wrong word with the names that exist. `explain_missing` lets the
objects of a class answer a wrong attribute with such a hint, `explain_arguments` a
function a wrong argument, `NamedItems` a dictionary a wrong key, `TupleOfParts` a tuple
an attribute that its items have, or an index without an item, and `missing_name` makes
the error of a wrong name in a module.
"""

import difflib
import inspect
import re
from collections.abc import Callable, Collection, Iterator
from functools import wraps
from typing import Any, NamedTuple, ParamSpec, TypeVar

from .units import MOST_SHOWN, one_line, shown

P = ParamSpec("P")
R = TypeVar("R")
C = TypeVar("C", bound=type)
T = TypeVar("T")

MOST_CHOICES = 12
"""Choices that a message names."""
SHORTEST_BEGINNING = 5
"""Letters with which two words must begin alike to be related."""
MOST_LEVELS = 2
"""Levels below an object that are searched for a missing attribute."""
SYNONYMS: dict[str, tuple[str, ...]] = {
    # letters of formulas
    "A": ("area",),
    "E": ("youngs_modulus", "material"),
    "F": ("force", "peak_force"),
    "J": ("impulse",),
    "L": ("length",),
    "P": ("impulse",),
    "T": ("transit_time",),
    "Ru": ("resistance",),
    "Z": ("impedance",),
    "c": ("damping", "wave_speed"),
    "c0": ("wave_speed",),
    "d": ("diameter",),
    "e": ("restitution",),
    "g": ("gravity",),
    "k": ("stiffness",),
    "l": ("length",),
    "m": ("mass",),
    "n": ("cells",),
    "nu": ("poisson_ratio",),
    "p": ("exponent",),
    "r": ("diameter",),
    "rho": ("density", "material"),
    "sigma": ("stress",),
    "t": ("times", "until"),
    "u": ("displacement",),
    "v": ("velocity",),
    "v0": ("velocity",),
    "v1": ("velocity_1",),
    "v2": ("velocity_2",),
    # words for numbers and arguments
    "axes": ("ax",),
    "bar_speed": ("wave_speed",),
    "coefficient_of_restitution": ("restitution",),
    "contact": ("contacts",),
    "cor": ("restitution",),
    "dia": ("diameter",),
    "energy": ("energy", "kinetic_after"),
    "energy_loss": ("energy_lost", "dissipated"),
    "energy_lost": ("dissipated",),
    "jobs": ("workers", "executor"),
    "max_force": ("peak_force",),
    "modulus": ("youngs_modulus",),
    "n_jobs": ("workers", "executor"),
    "position": ("x",),
    "pressure": ("stress",),
    "quantity": ("field",),
    "radius": ("diameter",),
    "rods": ("bodies",),
    "sound_speed": ("wave_speed",),
    "speed": ("velocity", "wave_speed"),
    "stiffness": ("loading",),
    "t_end": ("until",),
    "t_max": ("until",),
    "tend": ("until",),
    "tmax": ("until",),
    "threads": ("workers", "executor"),
    "time": ("times", "until", "t"),
    "tol": ("rtol",),
    "tolerance": ("rtol",),
    # words for functions and classes
    "animate": ("animation",),
    "ball": ("RigidMass",),
    "bounce": ("stack_drop",),
    "bar": ("Rod",),
    "beam": ("Rod",),
    "collision": ("collide", "System"),
    "convert": ("parse",),
    "diagram": ("spacetime",),
    "family": ("sweep",),
    "film": ("animation",),
    "floor": ("Wall",),
    "force": ("contact",),
    "from_toml": ("read_case",),
    "forces": ("contact",),
    "ground": ("Wall",),
    "mass": ("RigidMass",),
    "model": ("System",),
    "movie": ("animation",),
    "plot": ("overview",),
    "problem": ("System",),
    "run": ("solve", "run"),
    "simulate": ("solve", "run"),
    "solve": ("run",),
    "to_pandas": ("to_dataframe",),
    "xt": ("spacetime",),
}
"""Names of this package, by other names of the same thing."""
EXPLAINED = "_explains_arguments"
"""Attribute of functions that answer wrong arguments."""
ELSEWHERE = {
    "animate": "rodimpact.plot.animation(solution) makes a film",
    "compare": "plot.comparison(measured, predicted) draws it, and the command "
    "`rodimpact compare` fits it",
    "contact_time": "it is opening - start of contacts[k].episodes; duration is the "
    "time with force",
    "peak_force_time": "it is b.times[b.force.argmax()], b = solution.contacts[k]."
    "breakpoints()",
    "export": "rodimpact.explore(system).save(path) writes the page",
    "plot": "functions of rodimpact.plot draw it, such as plot.overview, and "
    "plot.sweep for a family",
    "Picture.save": "rodimpact.plot.save(picture, path) writes it to a file",
    "run": "rodimpact.solve(system) solves it",
    "savefig": "rodimpact.plot.save(picture, path) writes a picture to a file",
    "show": "rodimpact.plot.show(picture) shows a picture in a window",
    "simulate": "rodimpact.solve(system) solves it",
    "solve": "rodimpact.solve(system) solves it",
    "Solution.to_csv": "gauges_to_csv(path, {name: solution.gauge(body, x)}) writes "
    "strains over time, and save(path) the solution",
    "sweep": "rodimpact.sweep(system) solves a family",
}
"""What is said of attributes that an object has nowhere.

With a class before it, a name is one of this class only.
"""
DEFINED_MATERIAL = "give material=Material(name, youngs_modulus, density)"
DERIVED_ARGUMENTS = {
    "density": ("material", DEFINED_MATERIAL),
    "radius": ("diameter", "give diameter, twice the radius"),
    "youngs_modulus": ("material", DEFINED_MATERIAL),
}
"""Unknown arguments, the argument that takes what they mean, and how it does."""
CALLED_INSTEAD = {
    "explore": "; several bodies make one system, System([left, right])",
    "Spring": "; SpringDashpot(stiffness, damping) has a damping, too",
    "sweep": "; a number that varies is an array in the system, such as "
    "Rod([0.1, 0.2], ...)",
}
"""What is said of arguments that these functions and classes do not take."""


def nearest(word: Any, choices: Collection[str], head: str = "") -> str:
    """Hint at the choice that may be meant by a word, else at the choices there are.

    It reads "perhaps ... is meant", or "use one of ..." if no choice is similar to the
    word. Then `MOST_CHOICES` are named at most, those related to the word first. `head`
    is put before each choice that is named.
    """
    meant = similar(word, choices)
    if meant is not None:
        return f"perhaps {shown(head + meant)} is meant"
    all_names = []
    for choice in related_first(word, choices):
        all_names.append(one_line(head + choice))
    return f"use one of {listed(all_names)}"  # which cuts the list


def similar(word: Any, choices: Collection[str]) -> str | None:
    """The choice that may be meant by a word: a synonym, or one that is spelt alike.

    None if there is no such choice. Capitals do not matter, nor does what follows after
    `MOST_SHOWN` characters. A word that is no text is compared as messages show it.
    """
    text = word
    if not isinstance(word, str):
        text = shown(word)
    for synonym in _synonyms(text):
        if synonym in choices:
            return synonym
    choice_of = {}  # choice by its name, which is cut and in small letters
    for choice in choices:
        choice_of[choice.casefold()[:MOST_SHOWN]] = choice
    text_to_match = text[:MOST_SHOWN].casefold()
    alike = difflib.get_close_matches(text_to_match, choice_of, n=1)
    if alike:
        return choice_of[alike[0]]
    return None


def related_first(word: Any, choices: Collection[str]) -> list[str]:
    """All choices, if they are too many for a message the related ones first.

    First come those whose words all stand in the wrong one, as Hertz in HertzContact;
    then those that share a word with it, and those with a word that begins alike. The
    others keep their order.
    """
    if not isinstance(word, str) or len(choices) <= MOST_CHOICES:
        return list(choices)
    return sorted(choices, key=lambda choice: -_kinship(word, choice))


def _kinship(word: str, choice: str) -> int:
    """How close a choice is to a wrong word, from 3 down to 0 for strangers.

    The words of both names are compared, such as hertz and contact of HertzContact: all
    words of the choice stand in the wrong name (3), one of them does (2), or one of
    them begins like one there (1).
    """
    words = _words(word)
    words_of_choice = _words(choice)
    if words_of_choice and words_of_choice <= words:
        return 3
    if words_of_choice & words:
        return 2
    if _beginnings(words_of_choice) & _beginnings(words):
        return 1
    return 0


def _words(name: str) -> set[str]:
    """Words of a name in small letters: hertz and contact of HertzContact."""
    words = re.findall(r"[A-Z]?[a-z]+|[A-Z]+", name[:MOST_SHOWN])
    return {word.lower() for word in words}


def _beginnings(words: set[str]) -> set[str]:
    """The first letters of all words that have as many."""
    return {
        word[:SHORTEST_BEGINNING] for word in words if len(word) >= SHORTEST_BEGINNING
    }


def _synonyms(word: str) -> tuple[str, ...]:
    """Other names of what a word means, with its capitals or without; () if none."""
    return SYNONYMS.get(word, SYNONYMS.get(word.lower(), ()))


def listed(names: list[str]) -> str:
    """Names with commas between them.

    Of more than `MOST_CHOICES` names only the first are listed, with "..." behind them.
    """
    text = ", ".join(names[:MOST_CHOICES])
    if len(names) > MOST_CHOICES:
        text += ", ..."
    return text


# Attributes


def explain_missing(*deeper: str) -> Callable[[C], C]:
    """Class decorator: a missing attribute is answered by the one that may be meant.

    The error is `MissingAttribute`. Public methods answer wrong arguments in the same
    way, see `explain_methods`. The class itself is changed and returned.

    Parameters
    ----------
    *deeper : str
        Attributes of the class whose own attributes may be meant, too: a solution has
        none called ``restitution``, but its ``outcome`` has. Of a tuple, the first
        item is asked.

    Returns
    -------
    function
        The decorator.
    """

    def decorated(kind: C) -> C:
        """The same class, which answers wrong attributes and arguments from now on."""

        def __getattr__(self: Any, name: str) -> Any:  # noqa: N807
            # Python calls this only for attributes that it does not find.
            if hasattr(type(self), name):  # or for a property that has failed
                return object.__getattribute__(self, name)  # raises its own error
            raise MissingAttribute(self, name)

        open_kind: Any = kind  # whose attributes a type checker does not know
        open_kind._deeper = deeper  # for the hint of `MissingAttribute`
        open_kind.__getattr__ = __getattr__
        explain_methods(kind)
        return kind

    return decorated


def explain_methods(kind: type) -> None:
    """Wrap the public methods of a class by `explain_arguments`, each once.

    The class is changed. Class methods are among them. Inherited methods, properties
    and names that begin with an underscore are not.
    """
    for name, method in list(vars(kind).items()):
        is_class_method = isinstance(method, classmethod)
        function = method
        if is_class_method:
            function = method.__func__
        is_explained = hasattr(function, EXPLAINED)
        if name.startswith("_") or is_explained or not inspect.isfunction(function):
            continue
        explained: Any = explain_arguments(function)
        if is_class_method:
            explained = classmethod(explained)
        setattr(kind, name, explained)


class MissingAttribute(AttributeError):
    """The error of an attribute that an object does not have.

    The hint is looked for when the error is shown: `getattr` with a default, and
    `hasattr`, make this error and never show it.
    """

    def __init__(self, owner: Any, name: str) -> None:
        super().__init__(owner, name, name=name)

    def __str__(self) -> str:
        """The message of Python, with the attribute that may be meant.

        There is no such hint for names that begin with an underscore.
        """
        owner, name = self.args
        message = f"{type(owner).__name__!r} object has no attribute {name!r}"
        if name.startswith("_"):  # Python itself asks for such names
            return message
        return f"{message}; {_attribute_hint(owner, name)}"


def _attribute_hint(owner: Any, name: str) -> str:
    """Hint at the attribute of an object, or of one of its parts, that is meant.

    The first of these is taken: the sentence of `ELSEWHERE` on this name, the name
    itself in a part, a synonym, a name that is spelt alike. Synonyms and such names are
    sought in the object before its parts. Else attributes of the object are listed.
    """
    for key in (f"{type(owner).__name__}.{name}", name):
        if key in ELSEWHERE:
            return ELSEWHERE[key]
    own_names = _public_names(owner)
    paths: dict[str, str] = {}  # of attributes of the parts, the uppermost first
    for path, part in _parts(owner):
        for attribute in _public_names(part):
            paths.setdefault(attribute, f"{path}.{attribute}")
    if name in paths:
        return f"perhaps {paths[name]!r} is meant"
    for synonym in _synonyms(name):
        if synonym in own_names:
            return f"perhaps {synonym!r} is meant"
        if synonym in paths:
            return f"perhaps {paths[synonym]!r} is meant"
    if similar(name, own_names) is None:  # else `nearest` below names it
        meant = similar(name, paths)
        if meant is not None:
            return f"perhaps {paths[meant]!r} is meant"
    return nearest(name, own_names)


def _public_names(owner: Any) -> list[str]:
    """Public attributes of an object, without those that every tuple has."""
    names = []
    for name in dir(owner):
        if not name.startswith("_") and not hasattr(tuple, name):
            names.append(name)
    return names


def _parts(owner: Any, level: int = 1) -> Iterator[tuple[str, Any]]:
    """Yield path and part for the parts of an object: first its own ones, then theirs.

    They are the attributes that `explain_missing` was given for its class; of a tuple
    of parts the first one, with the path "name[0]". Attributes that fail and empty
    tuples are left out. Parts go down to `MOST_LEVELS`; `level` is that of the parts of
    `owner`.
    """
    parts = []
    for attribute in getattr(owner, "_deeper", ()):
        path = attribute
        try:
            part = getattr(owner, attribute)
        except Exception:  # a hint must not hide the mistake
            continue
        is_plain_tuple = isinstance(part, tuple) and not hasattr(part, "_fields")
        if is_plain_tuple:
            if not part:
                continue
            path = f"{attribute}[0]"
            part = part[0]
        parts.append((path, part))
    yield from parts
    if level < MOST_LEVELS:
        for path, part in parts:
            for end, below in _parts(part, level + 1):
                yield f"{path}.{end}", below


class TupleOfParts(tuple[T, ...]):
    """A tuple of parts, such as bodies, that answers an attribute which its parts have.

    Examples
    --------
    >>> from rodimpact import RigidMass
    >>> try:
    ...     TupleOfParts([RigidMass(2.0)]).mass
    ... except AttributeError as error:
    ...     print(error)
    'tuple' object has no attribute 'mass'; ask one of its items, such as [0].mass
    """

    __slots__ = ()

    def __getattr__(self, name: str) -> Any:
        """Raise AttributeError that names the first item with this attribute, if any.

        Python calls this only for attributes that a tuple does not have.
        """
        message = f"'tuple' object has no attribute {name!r}"
        for i in range(len(self)):
            # Python itself asks for names with an underscore.
            if not name.startswith("_") and name in dir(self[i]):
                message += f"; ask one of its items, such as [{i}].{name}"
                break
        raise AttributeError(message, name=name)

    def __getitem__(self, index: Any) -> Any:
        """The item, or items; IndexError tells which items there are."""
        try:
            # Methods index bodies often, and `super()` takes twice as long.
            return tuple.__getitem__(self, index)
        except IndexError:
            there = "there are no items"
            if self:
                there = f"the items are [0] to [{len(self) - 1}]"
            raise IndexError(f"there is no [{index}]: {there}") from None


class UndefinedResult(ValueError, AttributeError):
    """The error of a property that this very object does not have.

    It is an AttributeError, too: `hasattr` is then false, and `inspect` goes on.
    """


class NamedItems(dict[str, Any]):
    """A dictionary that answers a missing key with the one that may be meant."""

    def __missing__(self, name: Any) -> Any:
        if not self:
            raise KeyError(f"there is no {shown(name)}: there are no entries")
        raise KeyError(f"there is no {shown(name)}; {nearest(name, self)}")


def missing_name(
    module: str, name: str, names: Collection[str], **modules: Collection[str]
) -> AttributeError:
    """The error of a name that a module does not have, to be raised by the caller.

    Its message hints at the name that may be meant, here or in the modules below. There
    is no such hint for names that begin with an underscore.

    Parameters
    ----------
    module : str
        Name of the module.
    name : str
        The name that was asked for.
    names : collection of str
        Names that the module has.
    **modules : collection of str
        Names in modules below it.
    """
    message = f"module {module!r} has no attribute {name!r}"
    if not name.startswith("_"):  # Python itself asks for names with an underscore
        message = f"{message}; {_name_hint(module, name, names, modules)}"
    return AttributeError(message, name=name)


def _name_hint(
    module: str,
    name: str,
    names: Collection[str],
    modules: dict[str, Collection[str]],
) -> str:
    """Hint at the name of a module, or of the modules below it, that may be meant.

    The first of these is taken: a synonym in the module, the sentence of `ELSEWHERE` on
    this name, the name or a synonym in a module below, a name that is spelt alike. Else
    all names are listed if they are few, or related names here and below. If there are
    none, the hint says how to list the names.
    """
    synonyms = _synonyms(name)
    for synonym in synonyms:
        if synonym in names:
            return f"perhaps {synonym!r} is meant"
    if name in ELSEWHERE:
        return ELSEWHERE[name]
    for below, its_names in modules.items():
        for meant in (name, name.lower(), *synonyms):
            if meant in its_names and meant not in names:
                path = f"{below}.{meant}"
                return f"perhaps {path!r} is meant"
    if similar(name, names) is not None or len(names) <= MOST_CHOICES:
        return nearest(name, names)
    choices = list(names)
    for below, its_names in modules.items():
        for its_name in its_names:
            choices.append(f"{below}.{its_name}")
    for choice in choices:
        if _kinship(name, choice) > 0:  # at least one is related
            return f"use one of {listed(related_first(name, choices))}"
    return f"dir({module}) lists its names"


# Arguments


def explain_arguments(function: Callable[P, R]) -> Callable[P, R]:
    """Decorator that refuses wrong arguments of a call with those that may be meant.

    The error is a TypeError, as Python's own. A TypeError of the function itself is
    raised as it is.
    """

    @wraps(function)
    def explained(*args: P.args, **kwargs: P.kwargs) -> R:
        try:
            return function(*args, **kwargs)
        except TypeError as error:
            signature = inspect.signature(function)
            try:
                signature.bind(*args, **kwargs)
            except TypeError:
                message = _refusal(function, signature, args, kwargs, str(error))
                raise TypeError(message) from None
            raise  # the arguments are right: the error is the function's own

    setattr(explained, EXPLAINED, True)  # so that `explain_methods` skips it
    return explained


def _refusal(
    function: Callable[..., Any],
    signature: inspect.Signature,
    args: tuple[Any, ...],
    keywords: dict[str, Any],
    otherwise: str,
) -> str:
    """What is wrong with the arguments of a call; `otherwise` if nothing is found.

    The first of these is told: a keyword that is unknown, with the one that may be
    meant, too many arguments by position, or missing ones. `self` and `cls` are not
    counted.
    """
    called, instead = _called(function, args)  # the name, and other constructors
    parameters = dict(signature.parameters)
    for owner in ("self", "cls"):
        if owner in parameters:
            del parameters[owner]
            args = args[1:]
    for keyword in keywords:
        if keyword not in parameters:
            hint = nearest(keyword, parameters)
            meant, remedy = DERIVED_ARGUMENTS.get(keyword, ("", ""))
            if meant in parameters:
                hint = remedy
            elif similar(keyword, parameters) is None:
                hint += instead
            return f"{called}() has no argument {keyword!r}; {hint}"
    excess = _excess(parameters, len(args))
    if excess:
        return f"{called}() takes {excess}{CALLED_INSTEAD.get(called, '')}"
    missing = []
    for i, (name, parameter) in enumerate(parameters.items()):
        is_given = i < len(args) or name in keywords
        if parameter.default is parameter.empty and not is_given:
            missing.append(name)
    if missing:
        return f"{called}() needs {listed(missing)}; it takes {listed([*parameters])}"
    return otherwise


def _excess(parameters: dict[str, inspect.Parameter], n_given: int) -> str:
    """Text on which arguments may be given by position, if `n_given` are too many.

    It names the parameters that take them, and those that must be named. "" if as many
    may be given.
    """
    by_position = []  # names of parameters that may be given so
    by_name = []  # those that must be named
    for name, parameter in parameters.items():
        if parameter.kind is parameter.KEYWORD_ONLY:
            by_name.append(f"{name}=")
        else:
            by_position.append(name)
    if n_given <= len(by_position):
        return ""
    taken = "no argument"
    if by_position:
        taken = f"only {listed(by_position)}"
    text = f"{taken} by position, got {n_given} arguments"
    if by_name:
        text += f"; name the others: {listed(by_name)}"
    return text


class _Called(NamedTuple):
    """What a call is called in a message."""

    name: str  # of the class, the method or the function
    instead: str  # text on what takes other arguments; "" if there is none


def _called(function: Callable[..., Any], args: tuple[Any, ...]) -> _Called:
    """What the call of a function with these arguments is called.

    A method is named with the class of its object, a constructor by its class alone,
    any other function by its own name. With a constructor comes the text on other
    constructors of the class. Otherwise the text is that of `CALLED_INSTEAD`, or "".
    """
    qualified = function.__qualname__
    if not args or "." not in qualified or "<locals>" in qualified:
        return _Called(qualified, CALLED_INSTEAD.get(qualified, ""))
    owner = args[0]  # `self`, or the class of a class method
    if not isinstance(owner, type):
        owner = type(owner)
    if function.__name__ == "__init__":
        name = owner.__name__
        return _Called(name, _other_constructors(owner) + CALLED_INSTEAD.get(name, ""))
    return _Called(f"{owner.__name__}.{function.__name__}", "")


def _other_constructors(kind: type) -> str:
    """Text on the class methods that make an object from something else; "" if none.

    Their names begin with ``from_``. The text goes on with a sentence: ", or
    Hertz.from_radii(left_radius, ...)". Inherited methods are left out.
    """
    text = ""
    for name, method in vars(kind).items():
        if name.startswith("from_") and isinstance(method, classmethod):
            _, *parameters = inspect.signature(method.__func__).parameters  # no `cls`
            text += f", or {kind.__name__}.{name}({listed(parameters)})"
    return text
