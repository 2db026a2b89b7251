"""Values made once: checked when they are made, frozen, compared and stored by what they say.

A class declares each number once, ``stiffness: Numeric = quantity("N/m", "positive")``. From that
come its constructor, checks, repr and `replace`, case files, and what figures call the number. A
number may be an array, which makes a family. All mistakes of one object are reported together in
one `InvalidModel`, each with the path of its field.
"""

from __future__ import annotations

import difflib
import hashlib
import inspect
import json
import math
import sys
import typing
from collections.abc import Callable, Collection, Iterable, Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import pairwise
from typing import (
    TYPE_CHECKING,
    Any,
    ClassVar,
    Generic,
    NamedTuple,
    Self,
    TypeAlias,
    TypeVar,
)

import numpy as np
from numpy.typing import ArrayLike

from .. import units
from ..units import MOST_SHOWN, one_line, shown
from .quantities import Floats, floats, number_of

Number: TypeAlias = float | Floats
Held = TypeVar("Held")
Given = TypeVar("Given")
Problems: TypeAlias = list[tuple[str, str]]

MOST_CHOICES = 12  # named in a message
MOST_TOLD = 20  # mistakes that the text of an error tells
MOST_MEMBERS = 10**7  # of a family
SMALLEST, LARGEST = 1e-150, 1e150  # magnitudes whose squares are neither 0 nor infinite
TINY = sys.float_info.min  # with all its digits
OUT_OF_SCALE = (
    f"must be 0 or of a magnitude from {SMALLEST:g} to {LARGEST:g} in consistent units"
)
OUT_OF_SCALE += ", got {0!r}"
REQUIRED = inspect.Parameter.empty
INTERVALS = {
    "positive": "(0, inf)",
    "positive or infinite": "(0, inf]",
    "non-negative": "[0, inf)",
    "any": "(-inf, inf)",
    "sampled": "(-inf, inf)",
}
"""Where the numbers of a sign lie."""


class InvalidModel(ValueError):
    """The description of a collision, or an argument of a function, has mistakes.

    Attributes
    ----------
    problems : list of (str, str)
        Path of each faulty field (``bodies.0.length``) and what is wrong with it. The text of the
        error tells the first `MOST_TOLD` of them and counts the rest.

    Examples
    --------
    >>> import rodimpact as ri
    >>> try:
    ...     ri.Rod(-1.0, area=0.0, material=ri.materials.steel)
    ... except InvalidModel as error:
    ...     print(error)
    length: must be a finite positive number of metres, got -1.0
    area: must be a finite positive number of square metres, got 0.0
    """

    def __init__(self, problems: Problems) -> None:
        self.problems = problems = list(dict.fromkeys(problems))
        lines = [
            f"{one_line(path)}: {message}" for path, message in problems[:MOST_TOLD]
        ]
        if len(problems) > MOST_TOLD:
            lines.append(f"...: and {len(problems) - MOST_TOLD} mistakes more")
        super().__init__("\n".join(lines))

    def __reduce__(self) -> tuple[type[InvalidModel], tuple[Problems]]:
        return InvalidModel, (self.problems,)


def refusal(path: str, message: str) -> InvalidModel:
    """The error of one mistake."""
    return InvalidModel([(path, message)])


class Field(NamedTuple):
    """What a number of the model is, or an argument.

    Attributes
    ----------
    unit : str
        Of the SI: ``"kg/m^3"``; ``""`` for a pure number.
    sign : str
        ``"positive"``, ``"positive or infinite"``, ``"non-negative"``, ``"any"``, or an interval
        such as ``"[0, 1]"`` or ``"(-1, 0.5]"``; ``"sampled"`` for one of many.
    label : str
        What figures call it, where that is not its name.
    default : object
        What holds where it is left out; None: it may be None. `REQUIRED`: it must be given.
    along : str
        ``"length"`` of a rod or ``"time"``, if it may be a profile over that.
    word : str
        That may stand in its place.
    single : bool
        Whether it must not be an array.
    many : bool
        Whether it is a list of numbers, each of which may be an array.
    """

    unit: str = ""
    sign: str = "any"
    label: str = ""
    default: Any = REQUIRED
    along: str = ""
    word: str = ""
    single: bool = False
    many: bool = False

    @property
    def dimension(self) -> str:
        """What kind of quantity it is, for `units.parse`."""
        return units.dimension_of(self.unit)

    @property
    def wanted(self) -> str:
        """What it must be; it may show a value as ``{0!r}``."""
        if self.sign == "positive or infinite":
            return f"must be a positive number{number_of(self.unit)} or infinite, got {{0!r}}"
        if self.sign[0] in "[(":
            return f"must lie in {self.sign}, got {{0!r}}"
        kind = (
            f"finite {self.sign}"
            if self.sign in ("positive", "non-negative")
            else "finite"
        )
        return f"must be a {kind} number{number_of(self.unit)}, got {{0!r}}"

    def holds(self, value: Any) -> Any:
        """Where numbers are of its sign; those that are none are of no sign."""
        interval = INTERVALS.get(self.sign, self.sign)
        low, high = map(float, interval[1:-1].split(","))
        above = value >= low if interval[0] == "[" else value > low
        return above & (value <= high if interval[-1] == "]" else value < high)

    def checked(self, problems: Problems, path: str, value: Any) -> Any:
        """Return `value` as a float or a read-only array; note a mistake in `problems`.

        -0.0 becomes 0.0, so that equal numbers are described alike.
        """
        if value is None and self.default is None:
            return None
        if self.word and isinstance(value, str):
            if value != self.word:
                message = f'must be a number{number_of(self.unit)} or "{self.word}"'
                note(problems, path, message, value)
            return value
        if self.many:
            return self._each_checked(problems, path, value)
        sign = self.sign
        if type(value) is float and sign in INTERVALS:  # most are: no array, for speed
            size = abs(value) if sign in ("any", "sampled") else value
            if SMALLEST <= size <= LARGEST or (size == 0 and "positive" not in sign):
                return value + 0.0
        try:
            array: Any = floats(value, self.unit)
            if not array.size:
                raise ValueError("must not be an empty array")
        except ValueError as error:
            problems.append((path, str(error)))
            return math.nan
        array = (array if array.ndim else array.item()) + 0.0
        if require(problems, self.holds(array), path, self.wanted, array):
            # what may be 0 may be small, too; but a number that stands alone has all its digits
            least = (
                SMALLEST if "positive" in sign else 0.0 if sign == "sampled" else TINY
            )
            size = abs(array)
            good = (
                (size == 0) | (size >= least) & (size <= LARGEST) | (size == math.inf)
            )
            require(problems, good, path, OUT_OF_SCALE, array)
        if isinstance(array, np.ndarray):
            array.flags.writeable = False
            if self.single:
                note(problems, path, "must be a single number", value)
        return array

    def _each_checked(
        self, problems: Problems, path: str, items: Any
    ) -> tuple[Any, ...]:
        """Return a list of numbers as a tuple, each as `checked` returns it."""
        if not isinstance(items, list | tuple):
            try:
                items = list(floats(items, self.unit))
            except (TypeError, ValueError) as error:  # a single number, or what is none
                single = isinstance(error, TypeError)
                wrong = (
                    f"must be a list of numbers, got {shown(items)}"
                    if single
                    else str(error)
                )
                problems.append((path, wrong))
                return ()
        each = self._replace(many=False)
        return tuple(
            each.checked(problems, f"{path}.{i}", v) for i, v in enumerate(items)
        )


def quantity(unit: str = "", sign: str = "any", label: str = "", **more: Any) -> Any:
    """Declare a number of a class by its `Field`."""
    return Field(unit, sign, label, **more)


class Taken(Generic[Held, Given]):
    """To type checkers: what an object holds, and what its constructor takes for it."""

    if TYPE_CHECKING:

        def __get__(self, instance: object, owner: Any) -> Held: ...
        def __set__(self, instance: object, value: Given) -> None: ...


Numeric: TypeAlias = Taken[Number, ArrayLike]
NumericOrNone: TypeAlias = Taken[Number | None, ArrayLike | None]


def increasing(problems: Problems, path: str, values: Iterable[Number]) -> None:
    """Note numbers that do not lie above the one before them."""
    for i, (low, high) in enumerate(pairwise(values), 1):
        message = "must lie above {0!r}, got {1!r}"
        require(problems, np.greater(high, low), f"{path}.{i}", message, low, high)


def family_shape(numbers: Iterable[tuple[str, Any]]) -> tuple[int, ...]:
    """Shape of the family that arrays among numbers make, each number with its path.

    InvalidModel if they do not broadcast, or make more than `MOST_MEMBERS`.
    """
    arrays = [(path, v) for path, v in numbers if isinstance(v, np.ndarray)]
    shape = broadcast_shape(arrays)
    if math.prod(shape) > MOST_MEMBERS:
        message = (
            f"makes a family of {math.prod(shape)} members, more than {MOST_MEMBERS}"
        )
        raise InvalidModel([(arrays[0][0], f"{message}; take one part after another")])
    return shape


def broadcast_shape(arrays: Iterable[tuple[str, Any]]) -> tuple[int, ...]:
    """Shape to which arrays broadcast; InvalidModel with path and shape of each if they do not."""
    shapes = [(path, v.shape) for path, v in arrays]
    try:
        return np.broadcast_shapes(*(shape for _, shape in shapes))
    except ValueError:
        named = [f"{path} has shape {shape}" for path, shape in shapes]
        message = f"arrays do not broadcast: {listed(named)}"
        raise InvalidModel([(shapes[0][0], message)]) from None


def vanishes(value: Number) -> bool:
    """Whether a number is 0 in every member of a family."""
    return value == 0 if isinstance(value, float) else not np.any(value)


def in_range(value: Number) -> Any:
    """Where a derived quantity is neither too small nor too large to compute with."""
    return (value >= SMALLEST) & (value <= LARGEST)


def require(
    problems: Problems, good: Any, path: str, message: str, *values: Number
) -> bool:
    """Whether something holds for every member of a family; note the first for which it does not.

    The message may show the values there, as ``{0!r}``; the path ends with the index, ``[3,1]``.
    """
    if good is True or np.all(good):
        return True
    good = np.asarray(good)
    index = tuple(int(i) for i in np.argwhere(~good)[0])
    at = f"[{','.join(map(str, index))}]" if index else ""
    there = [float(np.broadcast_to(v, good.shape)[index]) for v in values]
    problems.append((f"{path}{at}", message.format(*there) if values else message))
    return False


def note(problems: Problems, path: str, message: str, given: Any) -> None:
    """Note a mistake, and the value that was given."""
    problems.append((path, f"{message}, got {shown(given)}"))


def raise_noted(problems: Problems) -> None:
    """Raise InvalidModel if there are problems."""
    if problems:
        raise InvalidModel(problems)


class Frozen:
    """A value made once: compared, hashed and stored through its `to_dict`.

    Parameters of the constructor are attributes, but for those in `_instead`.
    """

    fields: ClassVar[dict[str, Field]] = {}
    """The numbers of which it is made."""
    kind: str
    law: str
    _tag: ClassVar[dict[str, str]] = {}
    """What says in tables which class it is, from its header: ``{"kind": "rod"}``."""
    _instead: ClassVar[dict[str, tuple[str, ...]]] = {}
    """Parameters that stand for others: ``{"diameter": ("area",)}``."""
    _whole: ClassVar[tuple[str, ...]] = ()
    """Fields that are no numbers of a family: its members share them."""

    def __init_subclass__(cls, **tag: str) -> None:
        cls._tag = tag or cls._tag
        for name, word in tag.items():
            setattr(cls, name, word)
        if declared := {
            name: v for name, v in vars(cls).items() if isinstance(v, Field)
        }:
            cls.fields = declared
        for name, field in declared.items():
            delattr(cls, name)
            if field.default is not REQUIRED:
                setattr(cls, name, field.default)

    def __setattr__(self, name: str, value: Any = None) -> None:
        raise AttributeError(
            f"{type(self).__name__} is frozen; make a new one with another {name}"
        )

    __delattr__ = __setattr__

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Become what was pickled or copied; arrays are read-only again."""
        self.__dict__.update(state)
        for _, item in self._parts():
            if isinstance(item, np.ndarray):
                item.flags.writeable = False

    def _set(self, **fields: Any) -> None:
        self.__dict__.update(fields)

    def replace(self, **changes: Any) -> Self:
        """Return the same object with other values for some parameters of its constructor.

        Parameters
        ----------
        **changes
            By name, as the constructor takes them; arrays make a family.

        Raises
        ------
        InvalidModel
            Naming every change that is no parameter, or is not what it should be.
        """
        kind: Any = type(self)
        known = defaults_of(kind)
        wrong = f"is no parameter of {kind.__name__}"
        raise_noted(
            [
                (name, f"{wrong}; {nearest(name, known) if known else 'it has none'}")
                for name in changes
                if name not in known
            ]
        )
        gone = {other for name in changes for other in self._instead.get(name, ())}
        kept = {name: v for name, v in self._parameters().items() if name not in gone}
        return kind(**{**kept, **changes})  # type: ignore[no-any-return]

    def _parameters(self) -> dict[str, Any]:
        """What the constructor would be given to make this object."""
        return {name: v for name, v in self.__dict__.items() if name[0] != "_"}

    def to_dict(self) -> dict[str, Any]:
        """Return a JSON-ready description from which an equal object can be made."""
        given = {
            name: plain(v) for name, v in self._parameters().items() if v is not None
        }
        return self._tag | given

    @property
    def digest(self) -> str:
        """SHA-256 of the description: the same for equal objects in any process."""
        arrays = [v for _, v in self._numbers() if isinstance(v, np.ndarray)]
        outline = self._mapped(lambda array: list(array.shape)).to_dict()
        sha = hashlib.sha256(json.dumps(outline, sort_keys=True).encode())
        for array in arrays:
            sha.update(array.tobytes())
        return sha.hexdigest()

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Frozen) or type(self) is not type(other):
            return NotImplemented
        return self.to_dict() == other.to_dict()

    def __hash__(self) -> int:
        return hash(self.digest)

    def __repr__(self) -> str:
        given = self._parameters().items()
        fields = ", ".join(f"{name}={short(v)}" for name, v in given if v is not None)
        return f"{type(self).__name__}({fields})"

    def _parts(self) -> Iterator[tuple[str, Any]]:
        """What it holds, each with its place in a case file: ``"values.0"``."""
        for name, value in self._parameters().items():
            if isinstance(value, tuple):
                yield from ((f"{name}.{i}", item) for i, item in enumerate(value))
            else:
                yield name, value

    @cached_property
    def _varies(self) -> bool:
        """Whether a number of this object, or of what it holds, is an array."""
        for (
            name,
            value,
        ) in self.__dict__.items():  # of every object made: no generator, for speed
            for item in value if isinstance(value, tuple) else (value,):
                array = isinstance(item, np.ndarray) and name not in self._whole
                if item._varies if isinstance(item, Frozen) else array:
                    return True
        return False

    def _numbers(self, path: str = "") -> Iterator[tuple[str, Number]]:
        """Every number of this object and of what it holds, with its path in a case file."""
        for place, item in self._parts():
            where = f"{path}.{place}" if path else place
            if isinstance(item, Frozen):
                yield from item._numbers(where)
            elif isinstance(item, float | np.ndarray) and place not in self._whole:
                yield where, item

    def _mapped(self, change: Callable[[Any], Any]) -> Self:
        """The same object with every array of numbers replaced by what `change` makes of it."""

        def mapped(value: Any) -> Any:
            if isinstance(value, np.ndarray):
                return change(value)
            if isinstance(value, Frozen):
                return value._mapped(change)
            return (
                tuple(mapped(v) for v in value) if isinstance(value, tuple) else value
            )

        twin = object.__new__(type(self))
        twin._set(
            **{
                name: value if name in self._whole else mapped(value)
                for name, value in self.__dict__.items()
                if name[0] != "_"
            }
        )
        return twin


@typing.dataclass_transform(eq_default=False, field_specifiers=(quantity,))
class Declared(Frozen):
    """A value whose constructor takes what its class declares: a dataclass that is checked."""

    def __init_subclass__(cls, **tag: str) -> None:
        super().__init_subclass__(**tag)
        dataclass(repr=False, eq=False, frozen=True)(cls)
        del cls.__setattr__, cls.__delattr__  # those of `Frozen` say what to do instead

    def __post_init__(self) -> None:
        """Check everything that was given; InvalidModel with all mistakes in it."""
        problems: Problems = []
        held, varies = self.__dict__, False
        for name, field in self.fields.items():
            if not field.along:
                value = held[name] = field.checked(problems, name, held[name])
                varies = varies or isinstance(value, np.ndarray | tuple)
        if varies and not problems:
            family_shape(self._numbers())
        try:
            self._check(problems)
        except InvalidModel as error:
            problems += error.problems
        raise_noted(problems)

    def _check(self, problems: Problems) -> None:
        """Note, or raise, what is wrong besides single numbers."""


@cache
def defaults_of(kind: Any) -> dict[str, Any]:
    """Parameters of the constructor of a class with their defaults, or `REQUIRED`."""
    return {
        name: taken.default
        for name, taken in inspect.signature(kind).parameters.items()
    }


def short(value: Any) -> str:
    """A value in few words, for a repr."""
    if isinstance(value, np.ndarray):
        return f"array{value.shape}"
    return getattr(value, "name", None) or repr(value)


def nearest(word: Any, choices: Collection[str], head: str = "") -> str:
    """Which of the choices may be meant; `head` is put before them when they are named."""
    known = {choice.casefold()[:MOST_SHOWN]: head + choice for choice in choices}
    text = word if isinstance(word, str) else shown(word)
    near = difflib.get_close_matches(text[:MOST_SHOWN].casefold(), known, n=1)
    if near:
        return f"perhaps {shown(known[near[0]])} is meant"
    return f"use one of {listed(list(map(one_line, known.values())))}"


def listed(names: list[str]) -> str:
    """Names in a row, of which the first `MOST_CHOICES` stand for many."""
    return ", ".join(names[:MOST_CHOICES]) + (
        ", ..." if len(names) > MOST_CHOICES else ""
    )


def plain(value: Any) -> Any:
    """A number, array, tuple or `Frozen` in JSON's terms."""
    if isinstance(value, Frozen):
        return value.to_dict()
    if isinstance(value, np.ndarray):
        return value.tolist()
    return [plain(v) for v in value] if isinstance(value, tuple) else value
