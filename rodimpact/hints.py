"""Hints on names that do not exist: the attribute, argument or function that is meant.

`nearest` compares a wrong word with the names that exist. Errors with such hints come
from these:

- `explain_missing`: a wrong attribute of an object of a decorated class,
- `explain_arguments`: a wrong argument of a decorated function,
- `NamedItems`: a wrong key of a dictionary,
- `TupleOfParts`: an attribute that items of a tuple have, or an index without an item,
- `missing_name`: a wrong name in a module.
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
"""Number of choices that a message names, at most."""
SHORTEST_BEGINNING = 5
"""Number of equal first letters that make two words related."""
MOST_LEVELS = 2
"""Number of levels below an object that are searched for a missing attribute."""
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
"""Attribute that marks functions wrapped by `explain_arguments`."""
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
"""Hints on attributes that neither an object nor its parts have, by name.

A name with a class before it is for objects of this class only.
"""
DEFINED_MATERIAL = "give material=Material(name, youngs_modulus, density)"
DERIVED_ARGUMENTS = {
    "density": ("material", DEFINED_MATERIAL),
    "radius": ("diameter", "give diameter, twice the radius"),
    "youngs_modulus": ("material", DEFINED_MATERIAL),
}
"""Unknown arguments; for each the argument to give instead, and the hint on it.

The hint is used only if the function has that argument.
"""
CALLED_INSTEAD = {
    "explore": "; several bodies make one system, System([left, right])",
    "Spring": "; SpringDashpot(stiffness, damping) has a damping, too",
    "sweep": "; a number that varies is an array in the system, such as "
    "Rod([0.1, 0.2], ...)",
}
"""Ends of messages on excess arguments of these functions and classes."""


def nearest(word: Any, choices: Collection[str], head: str = "") -> str:
    """Hint at the choice that may be meant by a word, else a list of the choices.

    The hint is "perhaps ... is meant", or "use one of ..." if no choice is similar to
    the word. The list names at most `MOST_CHOICES`, those related to the word first.
    `head` is put before each choice that is named.
    """
    meant = similar(word, choices)
    if meant is not None:
        return f"perhaps {shown(head + meant)} is meant"
    all_names = []
    for choice in related_first(word, choices):
        all_names.append(one_line(head + choice))
    return f"use one of {listed(all_names)}"  # `listed` shortens a long list


def similar(word: Any, choices: Collection[str]) -> str | None:
    """The choice that may be meant by a word: a synonym, or one of similar spelling.

    None if there is no such choice. Capitals, and characters beyond the first
    `MOST_SHOWN`, are ignored. A word that is no text is compared as messages show it.
    """
    text = word
    if not isinstance(word, str):
        text = shown(word)
    for synonym in _synonyms(text):
        if synonym in choices:
            return synonym
    choice_of = {}  # each choice by its first characters, in small letters
    for choice in choices:
        choice_of[choice.casefold()[:MOST_SHOWN]] = choice
    text_to_match = text[:MOST_SHOWN].casefold()
    alike = difflib.get_close_matches(text_to_match, choice_of, n=1)
    if alike:
        return choice_of[alike[0]]
    return None


def related_first(word: Any, choices: Collection[str]) -> list[str]:
    """All choices; if there are more than `MOST_CHOICES`, the related ones come first.

    The order is: choices whose words are all in the wrong word, as Hertz in
    HertzContact; choices that share a word with it; choices with a word that begins
    alike; all others. Equally related choices keep their order.
    """
    if not isinstance(word, str) or len(choices) <= MOST_CHOICES:
        return list(choices)
    return sorted(choices, key=lambda choice: -_kinship(word, choice))


def _kinship(word: str, choice: str) -> int:
    """How closely a choice is related to a wrong name, from 3 to 0 (not at all).

    The words of both names are compared, such as hertz and contact in HertzContact. All
    words of the choice are in the wrong name (3), at least one of them is (2), or at
    least one begins like a word of the wrong name (1).
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
    """First `SHORTEST_BEGINNING` letters of each word; shorter words are left out."""
    return {
        word[:SHORTEST_BEGINNING] for word in words if len(word) >= SHORTEST_BEGINNING
    }


def _synonyms(word: str) -> tuple[str, ...]:
    """Synonyms of a word, with its capitals or in small letters; () if none."""
    return SYNONYMS.get(word, SYNONYMS.get(word.lower(), ()))


def listed(names: list[str]) -> str:
    """Names with commas between them.

    If there are more than `MOST_CHOICES`, only that many are listed, followed by "...".
    """
    text = ", ".join(names[:MOST_CHOICES])
    if len(names) > MOST_CHOICES:
        text += ", ..."
    return text


# Attributes


def explain_missing(*deeper: str) -> Callable[[C], C]:
    """Class decorator: errors of missing attributes name the one that may be meant.

    The error is `MissingAttribute`. The public methods are wrapped by
    `explain_methods`, so that errors of wrong arguments have hints too. The class
    itself is changed and returned.

    Parameters
    ----------
    *deeper : str
        Attributes of the class whose own attributes may be meant, too: a solution has
        none called ``restitution``, but its ``outcome`` has. If such an attribute is a
        tuple, the attributes of its first item are searched.

    Returns
    -------
    function
        The decorator.
    """

    def decorated(kind: C) -> C:
        """The same class, whose errors of attributes and arguments have hints now."""

        def __getattr__(self: Any, name: str) -> Any:  # noqa: N807
            # Python calls this for attributes that it does not find, and for properties
            # that raised an AttributeError. These raise their own error again.
            if hasattr(type(self), name):
                return object.__getattribute__(self, name)
            raise MissingAttribute(self, name)

        open_kind: Any = kind  # Any: a type checker does not know these attributes
        open_kind._deeper = deeper  # for the hint of `MissingAttribute`
        open_kind.__getattr__ = __getattr__
        explain_methods(kind)
        return kind

    return decorated


def explain_methods(kind: type) -> None:
    """Wrap the public methods of a class by `explain_arguments`, each once.

    The class is changed. Class methods are wrapped, too. Inherited methods, properties
    and names that begin with an underscore are left as they are.
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

    The hint is computed only when the error is shown, since `hasattr`, and `getattr`
    with a default, make this error and never show it.
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

    The first match is taken, in this order: the sentence of `ELSEWHERE` on this name;
    the name itself in a part; a synonym; a name of similar spelling. The latter two are
    searched in the object before its parts. If nothing matches, attributes of the
    object are listed.
    """
    for key in (f"{type(owner).__name__}.{name}", name):
        if key in ELSEWHERE:
            return ELSEWHERE[key]
    own_names = _public_names(owner)
    # Path to each attribute of the parts, by its name. If several parts have it, the
    # path is that of the first, uppermost part.
    paths: dict[str, str] = {}
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
    if similar(name, own_names) is None:  # a similar one is named by `nearest` below
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
    """Yield path and part for the parts of an object, and then for their parts.

    The parts are the attributes that `explain_missing` was given for the class of the
    object. If such an attribute is a tuple, the part is its first item, with the path
    "name[0]". Attributes that fail and empty tuples are left out. The search ends at
    `MOST_LEVELS`; `level` is the level of the parts of `owner`.
    """
    parts = []
    for attribute in getattr(owner, "_deeper", ()):
        path = attribute
        try:
            part = getattr(owner, attribute)
        except Exception:  # an error here must not replace the error to be explained
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
    """A tuple of parts, such as bodies, with hints on attributes that its parts have.

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
        """The item, or items of a slice; IndexError tells which items there are."""
        try:
            # Methods index bodies often, and `super()` takes twice as long.
            return tuple.__getitem__(self, index)
        except IndexError:
            there = "there are no items"
            if self:
                there = f"the items are [0] to [{len(self) - 1}]"
            raise IndexError(f"there is no [{index}]: {there}") from None


class UndefinedResult(ValueError, AttributeError):
    """The error of a property that is not defined for this object.

    It is an AttributeError, too, so that `hasattr` is False, and `inspect` does not
    fail.
    """


class NamedItems(dict[str, Any]):
    """A dictionary whose error of a missing key names the key that may be meant."""

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

    The first match is taken, in this order: a synonym in the module; the sentence of
    `ELSEWHERE` on this name; the name or a synonym in a module below; a name of similar
    spelling. If nothing matches, all names are listed if they are few, or else related
    names of the module and of those below. If no name is related, the hint says how to
    list the names.
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
        if _kinship(name, choice) > 0:  # the first related one: list them all
            return f"use one of {listed(related_first(name, choices))}"
    return f"dir({module}) lists its names"


# Arguments


def explain_arguments(function: Callable[P, R]) -> Callable[P, R]:
    """Decorator: the error of wrong arguments names the arguments that may be meant.

    The error is a TypeError, like Python's own. A TypeError that is raised inside the
    function, with right arguments, is raised as it is.
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
    """Message on wrong arguments of a call; `otherwise` if no mistake is found.

    The first mistake is reported, in this order: an unknown keyword, with the one that
    may be meant; too many arguments by position; missing arguments. `self` and `cls`
    are not counted.
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
            # Argument to give in place of this keyword, and the hint on it
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
    """Text of a message if `n_given` arguments by position are too many, else "".

    It names the parameters that may be given by position, and those that must be named.
    """
    by_position = []  # names of parameters
    by_name = []  # names of parameters with "=" behind them
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
    """Name of a called function in a message, and a text on alternatives to it."""

    name: str  # name of the class, the method or the function
    instead: str  # text on functions that take other arguments; "" if there are none


def _called(function: Callable[..., Any], args: tuple[Any, ...]) -> _Called:
    """Name of a function called with these arguments, and a text on alternatives.

    A method has the name of its class before its own, a constructor the name of its
    class alone. The text for a constructor names other constructors of the class, and
    has the text of `CALLED_INSTEAD`; for a method it is "", and for any other function
    it is that of `CALLED_INSTEAD`, or "".
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

    Their names begin with ``from_``. The text is the end of a sentence: ", or
    Hertz.from_radii(left_radius, ...)". Inherited methods are left out.
    """
    text = ""
    for name, method in vars(kind).items():
        if name.startswith("from_") and isinstance(method, classmethod):
            _, *parameters = inspect.signature(method.__func__).parameters  # no `cls`
            text += f", or {kind.__name__}.{name}({listed(parameters)})"
    return text
