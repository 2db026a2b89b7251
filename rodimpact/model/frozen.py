"""Frozen objects with declared numbers, which are checked when the objects are made.

A class declares each number once, ``stiffness: Numeric = quantity("N/m", "positive")``.
The declaration gives its constructor, checks, repr and `replace`, the keys of case
files, and the label of the number in figures. A number may be an array, which makes a
family. All mistakes of one object are reported together in one `InvalidModel`, each
with the path of its field.
"""

from __future__ import annotations

import hashlib
import inspect
import json
import math
import sys
import typing
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cache, cached_property
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
from ..hints import (
    explain_arguments,
    explain_methods,
    explain_missing,
    listed,
    nearest,
)
from ..units import one_line, shown
from .quantities import Floats, floats, of_unit

Number: TypeAlias = float | Floats
Held = TypeVar("Held")
Given = TypeVar("Given")
Problems: TypeAlias = list[tuple[str, str]]

MOST_TOLD = 20
"""Number of mistakes that the text of an error names, at most."""
MOST_MEMBERS = 10**7
"""Number of members of a family, at most."""
SMALLEST = 1e-150
"""Smallest magnitude of a positive number: its square is not 0."""
LARGEST = 1e150
"""Largest magnitude of a finite number: its square is not infinite."""
TINY = sys.float_info.min
"""Smallest float that has all its digits."""
OUT_OF_SCALE = (
    f"must be 0 or of a magnitude from {SMALLEST:g} to {LARGEST:g} in consistent "
    "units, got {0!r}"
)
"""Message on a number that is too small or too large."""
REQUIRED = inspect.Parameter.empty
"""Default of a parameter that must be given."""
INTERVALS = {
    "positive": "(0, inf)",
    "positive or infinite": "(0, inf]",
    "non-negative": "[0, inf)",
    "any": "(-inf, inf)",
    "sampled": "(-inf, inf)",
}
"""Interval in which a number with this sign must lie."""


class InvalidModel(ValueError):
    """The description of a collision, or an argument of a function, has mistakes.

    Attributes
    ----------
    problems : list of (str, str)
        Path of each faulty field (``bodies.0.length``) and what is wrong with it. The
        text of the error names the first `MOST_TOLD` of them and counts the rest.

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
        """Store the problems, without repetitions, and make the text of the error.

        The text names the first `MOST_TOLD` problems, one per line, and counts the
        rest. If `problems` is no list of pairs of texts, another InvalidModel is raised
        whose only problem is the argument `problems` itself.
        """
        if not _are_problems(problems):
            wanted = (
                "must be a list of (path, message), such as [('length', 'is missing')]"
            )
            raise InvalidModel([("problems", f"{wanted}, got {shown(problems)}")])
        self.problems = list(dict.fromkeys(problems))
        lines = []
        for path, message in self.problems[:MOST_TOLD]:
            lines.append(f"{one_line(path)}: {message}")
        n_more = len(self.problems) - MOST_TOLD
        if n_more > 0:
            lines.append(f"...: and {n_more} mistakes more")
        super().__init__("\n".join(lines))

    def __reduce__(self) -> tuple[type[InvalidModel], tuple[Problems]]:
        return InvalidModel, (self.problems,)


def _are_problems(problems: Any) -> bool:
    """Whether an argument is a list or a tuple of pairs of texts."""
    if not isinstance(problems, list | tuple):
        return False
    for pair in problems:
        if not isinstance(pair, tuple | list) or len(pair) != 2:
            return False
        path, message = pair
        if not isinstance(path, str) or not isinstance(message, str):
            return False
    return True


def invalid_argument(path: str, message: str) -> InvalidModel:
    """The InvalidModel, a ValueError, of one mistake, to be raised by the caller."""
    return InvalidModel([(path, message)])


class QuantityField(NamedTuple):
    """Declaration of a number of the model, or of an argument.

    Attributes
    ----------
    unit : str
        SI unit, ``"kg/m^3"``; ``""`` for a pure number.
    sign : str
        ``"positive"``, ``"positive or infinite"``, ``"non-negative"``, ``"any"``, or an
        interval such as ``"[0, 1]"`` or ``"(-1, 0.5]"``; ``"sampled"`` for the values
        of a profile.
    label : str
        Label in figures; "" if it is the name of the number.
    default : object
        Value if the number is left out. With the default None the number may be None;
        with `REQUIRED` it must be given.
    along : str
        ``"length"`` or ``"time"``, if the number may be a profile along a rod or in
        time.
    word : str
        Word that may stand in place of the number.
    scalar : bool
        Whether the number must not be an array.
    many : bool
        Whether it is a list of numbers, each of which may be an array.
    """

    unit: str = ""
    sign: str = "any"
    label: str = ""
    default: Any = REQUIRED
    along: str = ""
    word: str = ""
    scalar: bool = False
    many: bool = False

    @property
    def dimension(self) -> str:
        """Dimension of the number, for `units.parse`."""
        return units.dimension_of(self.unit)

    @property
    def wanted(self) -> str:
        """Message on the allowed sign and unit: "must be a ... number of ...".

        It ends with ``got {0!r}``, to be formatted with the wrong value.
        """
        number = f"number{of_unit(self.unit)}"
        if self.sign == "positive or infinite":
            return f"must be a positive {number} or infinite, got {{0!r}}"
        if self.sign[0] in "[(":
            return f"must lie in {self.sign}, got {{0!r}}"
        if self.sign in ("positive", "non-negative"):
            return f"must be a finite {self.sign} {number}, got {{0!r}}"
        return f"must be a finite {number}, got {{0!r}}"

    def holds(self, value: Any) -> Any:
        """Whether a number, or each of an array, lies in the interval of the sign.

        The result is a truth value, or an array of them. NaN lies in no interval.
        """
        # A sign that is no word is an interval itself, such as "[0, 1]".
        interval = INTERVALS.get(self.sign, self.sign)
        low, high = interval[1:-1].split(",")  # without the brackets
        if interval[0] == "[":
            is_above = value >= float(low)
        else:
            is_above = value > float(low)
        if interval[-1] == "]":
            is_below = value <= float(high)
        else:
            is_below = value < float(high)
        return is_above & is_below

    def checked(self, problems: Problems, path: str, value: Any) -> Any:
        """Return a value as a float or a read-only array in the unit of the field.

        None and a word are returned as they are, if the field allows them. If `many`,
        a list of numbers becomes a tuple. Another word, a wrong sign, an extreme
        magnitude, an empty array, and an array in place of a scalar are mistakes. A
        mistake is added to `problems` with the path; the returned value is then
        meaningless. -0.0 becomes 0.0, so that equal numbers have equal descriptions.
        """
        if value is None and self.default is None:
            return None
        if self.word and isinstance(value, str):
            self._check_word(problems, path, value)
            return value
        if self.many:
            return self._each_checked(problems, path, value)
        sign = self.sign
        if type(value) is float and sign in INTERVALS:
            # Most values are valid floats. For speed they are returned here, without
            # being converted to arrays; other floats are checked below.
            magnitude = value  # negative values do not pass the next test
            if sign in ("any", "sampled"):
                magnitude = abs(value)
            may_be_zero = "positive" not in sign
            if SMALLEST <= magnitude <= LARGEST or (magnitude == 0 and may_be_zero):
                return value + 0.0  # no -0.0
        try:
            numbers: Any = floats(value, self.unit)
            if not numbers.size:
                raise ValueError("must not be an empty array")
        except ValueError as error:
            problems.append((path, str(error)))
            return math.nan
        if not numbers.ndim:  # a single number
            numbers = numbers.item()
        numbers = numbers + 0.0  # no -0.0
        if require(problems, self.holds(numbers), path, self.wanted, numbers):
            is_in_scale = self._is_in_scale(numbers)
            require(problems, is_in_scale, path, OUT_OF_SCALE, numbers)
        if isinstance(numbers, np.ndarray):
            numbers.flags.writeable = False
            if self.scalar:
                add_problem(problems, path, "must be a single number", value)
        return numbers

    def _check_word(self, problems: Problems, path: str, value: str) -> None:
        """Add a problem if a text is not the word that may stand for the number."""
        if value != self.word:
            message = f'must be a number{of_unit(self.unit)} or "{self.word}"'
            add_problem(problems, path, message, value)

    def _is_in_scale(self, numbers: Any) -> Any:
        """Whether each number is 0, infinite, or of an allowed magnitude.

        An allowed magnitude is at most `LARGEST`. It is at least `SMALLEST` if the
        number must be positive, else `TINY`; samples of a profile may be smaller. The
        result is a boolean array, or a truth value for a single number. The sign of the
        number is not checked.
        """
        smallest = TINY
        if "positive" in self.sign:  # "positive", or "positive or infinite"
            smallest = SMALLEST
        elif self.sign == "sampled":
            smallest = 0.0
        magnitude = abs(numbers)
        is_sound = (magnitude >= smallest) & (magnitude <= LARGEST)
        return (magnitude == 0) | is_sound | (magnitude == math.inf)

    def _each_checked(
        self, problems: Problems, path: str, items: Any
    ) -> tuple[Any, ...]:
        """Return a list of numbers as a tuple, each as `checked` returns it.

        The items of an array are its entries along the first axis, and each may be an
        array itself. A mistake of an item has the path of the item. If the value is no
        list, tuple or array of numbers, a problem is added and () returned.
        """
        if not isinstance(items, list | tuple):
            try:
                items = list(floats(items, self.unit))
            except TypeError:  # a single number has no items
                add_problem(problems, path, "must be a list of numbers", items)
                return ()
            except ValueError as error:
                problems.append((path, str(error)))
                return ()
        field = self._replace(many=False)  # the same declaration, of a single number
        numbers = []
        for i, item in enumerate(items):
            numbers.append(field.checked(problems, f"{path}.{i}", item))
        return tuple(numbers)


def quantity(unit: str = "", sign: str = "any", label: str = "", **more: Any) -> Any:
    """Declare a number of a class by the fields of its `QuantityField`."""
    return QuantityField(unit, sign, label, **more)


class TypedAttribute(Generic[Held, Given]):
    """Types of an attribute and of its argument, for type checkers."""

    if TYPE_CHECKING:

        def __get__(self, instance: object, owner: Any) -> Held: ...
        def __set__(self, instance: object, value: Given) -> None: ...


Numeric: TypeAlias = TypedAttribute[Number, ArrayLike]
NumericOrNone: TypeAlias = TypedAttribute[Number | None, ArrayLike | None]


def require_increasing(problems: Problems, path: str, values: Iterable[Number]) -> None:
    """Add a problem for each number that is not larger than the number before it.

    If numbers are arrays, this must hold in every member of the family.
    """
    message = "must lie above {0!r}, got {1!r}"
    numbers = list(values)
    for i in range(1, len(numbers)):
        before = numbers[i - 1]
        value = numbers[i]
        is_above = np.greater(value, before)
        require(problems, is_above, f"{path}.{i}", message, before, value)


def family_shape(numbers: Iterable[tuple[str, Any]]) -> tuple[int, ...]:
    """Broadcast shape of the arrays among pairs (path, number), the shape of a family.

    () if there are no arrays. InvalidModel if the arrays do not broadcast, or make a
    family of more than `MOST_MEMBERS`.
    """
    arrays = []
    for path, value in numbers:
        if isinstance(value, np.ndarray):
            arrays.append((path, value))
    shape = broadcast_shape(arrays)
    n_members = math.prod(shape)
    if n_members > MOST_MEMBERS:
        first_path, _ = arrays[0]
        message = (
            f"makes a family of {n_members} members, more than {MOST_MEMBERS}; take "
            "one part after another"
        )
        raise invalid_argument(first_path, message)
    return shape


def broadcast_shape(arrays: Iterable[tuple[str, Any]]) -> tuple[int, ...]:
    """Shape to which arrays broadcast, each given with its path; () if there is none.

    If they do not broadcast, InvalidModel is raised for the first path. Its message
    names the path and the shape of each array.
    """
    paths = []
    shapes = []
    for path, values in arrays:
        paths.append(path)
        shapes.append(values.shape)
    try:
        return np.broadcast_shapes(*shapes)
    except ValueError:
        texts = []
        for path, shape in zip(paths, shapes, strict=True):
            texts.append(f"{path} has shape {shape}")
        message = f"arrays do not broadcast: {listed(texts)}"
        raise invalid_argument(paths[0], message) from None


def vanishes(value: Number) -> bool:
    """Whether a number is 0 in every member of a family."""
    if isinstance(value, float):
        return value == 0
    return not np.any(value)


def in_range(value: Number) -> Any:
    """Whether a derived positive quantity is from `SMALLEST` to `LARGEST`.

    The result is an array of truth values, or one for a single number.
    """
    return (value >= SMALLEST) & (value <= LARGEST)


def require(
    problems: Problems, condition: Any, path: str, message: str, *values: Number
) -> bool:
    """Return whether a condition, a truth value or an array, holds in every member.

    If not, one problem is added, for the first member for which it does not hold. The
    message is formatted with the values of that member, ``{0!r}`` for the first one, if
    values are given. The index of the member, ``[3,1]``, is appended to the path unless
    the condition is a single truth value.
    """
    if condition is True or np.all(condition):
        return True
    condition = np.asarray(condition)
    # Index of the first member that fails; () if the condition is a truth value
    index = tuple(np.argwhere(~condition)[0].tolist())
    if index:
        path = f"{path}[{','.join(map(str, index))}]"
    if values:
        of_member = []
        for value in values:
            all_members = np.broadcast_to(value, condition.shape)
            of_member.append(float(all_members[index]))
        message = message.format(*of_member)
    problems.append((path, message))
    return False


def add_problem(problems: Problems, path: str, message: str, value: Any) -> None:
    """Add a mistake to `problems`, with the value that was given."""
    problems.append((path, f"{message}, got {shown(value)}"))


def raise_if_problems(problems: Problems) -> None:
    """Raise InvalidModel if there are problems."""
    if problems:
        raise InvalidModel(problems)


@explain_missing()
class Frozen:
    """A frozen object: compared, hashed and stored through its `to_dict`.

    Parameters of the constructor are attributes, except some of those in
    `_alternatives`.
    """

    fields: ClassVar[dict[str, QuantityField]] = {}
    """Declarations of the numbers of the class."""
    kind: str
    law: str
    _tag: ClassVar[dict[str, str]] = {}
    """Entry of tables that names the class, from its header: ``{"kind": "rod"}``."""
    _alternatives: ClassVar[dict[str, tuple[str, ...]]] = {}
    """Parameters that stand for others: ``{"diameter": ("area",)}``."""
    _shared_fields: ClassVar[tuple[str, ...]] = ()
    """Fields that are no numbers of a family: its members share them."""

    def __init_subclass__(cls, **tag: str) -> None:
        """Set the tag of a class, and take its declared numbers as its `fields`.

        A tag, such as kind="rod", names the class in descriptions; its word becomes an
        attribute of the class, too. A declaration is replaced by the default of its
        number, or deleted if that has none. A class without declarations or tag keeps
        those of its base. Constructor and methods are wrapped, so that the error on an
        unknown argument names those that may be meant.
        """
        if tag:
            cls._tag = tag
        for name, word in tag.items():
            setattr(cls, name, word)
        declared = {
            name: attribute
            for name, attribute in vars(cls).items()
            if isinstance(attribute, QuantityField)
        }
        if declared:
            cls.fields = declared
        for name, field in declared.items():
            delattr(cls, name)
            if field.default is not REQUIRED:
                setattr(cls, name, field.default)
        if "__init__" in vars(cls):
            _explain_constructor(cls)
        explain_methods(cls)

    def __setattr__(self, name: str, value: Any = None) -> None:
        kind = type(self).__name__
        raise AttributeError(f"{kind} is frozen; make a new one with another {name}")

    __delattr__ = __setattr__

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Set the attributes that were pickled or copied, and make arrays read-only.

        Parts that are `Frozen` have already done this for their own arrays.
        """
        self.__dict__.update(state)
        for _, item in self._parts():  # with the items of tuples
            if isinstance(item, np.ndarray):
                item.flags.writeable = False

    def _set(self, **fields: Any) -> None:
        """Set attributes of this object, unchecked; it is frozen for everybody else."""
        self.__dict__.update(fields)

    def replace(self, **changes: Any) -> Self:
        """Return a new object with other values for some parameters of its constructor.

        A parameter that is an alternative to others, such as the diameter of a rod to
        its area, replaces them.

        Parameters
        ----------
        **changes
            Values by the names of the parameters; arrays make a family.

        Returns
        -------
        object
            A new object of the same class.

        Raises
        ------
        InvalidModel
            Naming every change that is no parameter, or is not what it should be.

        Examples
        --------
        >>> import rodimpact as ri
        >>> rod = ri.Rod(1.0, area=1e-4, material=ri.materials.steel)
        >>> rod.replace(length=0.5).length
        0.5
        """
        kind: Any = type(self)
        defaults = defaults_of(kind)
        problems: Problems = []
        for name in changes:
            if name not in defaults:
                hint = "it has none"
                if defaults:
                    hint = nearest(name, defaults)
                problems.append((name, f"is no parameter of {kind.__name__}; {hint}"))
        raise_if_problems(problems)
        parameters = self._parameters()
        for name in changes:
            for replaced in self._alternatives.get(name, ()):
                parameters.pop(replaced, None)
        parameters.update(changes)
        return kind(**parameters)  # type: ignore[no-any-return]

    def _parameters(self) -> dict[str, Any]:
        """Parameters of the constructor that make this object, in a new dictionary.

        Attributes with an underscore are no parameters: they store computed values.
        """
        return {name: v for name, v in self.__dict__.items() if name[0] != "_"}

    def to_dict(self) -> dict[str, Any]:
        """Return a JSON-ready description from which an equal object can be made.

        Parameters that are None are left out.

        Returns
        -------
        dict
            Parameters of the constructor by name, and the entry that names the class.

        Examples
        --------
        >>> import rodimpact as ri
        >>> ri.RigidMass(2.0, velocity=1.0).to_dict()
        {'kind': 'mass', 'mass': 2.0, 'velocity': 1.0}
        """
        description = dict(self._tag)
        for name, value in self._parameters().items():
            if value is not None:
                description[name] = json_ready(value)
        return description

    @property
    def digest(self) -> str:
        """SHA-256 of the description: the same for equal objects in any process.

        The digest is a hexadecimal text. The hash covers the description, in which each
        array that varies in a family is replaced by its shape, and the bytes of these
        arrays.
        """
        with_shapes = self._mapped(lambda array: list(array.shape))
        outline = json.dumps(with_shapes.to_dict(), sort_keys=True)
        sha = hashlib.sha256(outline.encode())
        for _, value in self._numbers():
            if isinstance(value, np.ndarray):
                sha.update(value.tobytes())
        return sha.hexdigest()

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Frozen) or type(self) is not type(other):
            return NotImplemented
        return self.to_dict() == other.to_dict()

    def __hash__(self) -> int:
        return hash(self.digest)

    def __repr__(self) -> str:
        """The call that makes the object, as text, in one line.

        Parameters that are None are left out. An array is shown by its shape, a part
        with a name by that name, see `short`.
        """
        parameters = []
        for name, value in self._parameters().items():
            if value is not None:
                parameters.append(f"{name}={short(value)}")
        return f"{type(self).__name__}({', '.join(parameters)})"

    def _parts(self) -> Iterator[tuple[str, Any]]:
        """Yield the path in a case file and the value of every parameter.

        The items of a tuple are yielded one by one: those of ``values`` have the paths
        ``"values.0"``, ``"values.1"``. A part that is `Frozen` is yielded itself, not
        its parameters.
        """
        for name, value in self._parameters().items():
            if isinstance(value, tuple):
                for i, item in enumerate(value):
                    yield f"{name}.{i}", item
            else:
                yield name, value

    @cached_property
    def _varies(self) -> bool:
        """Whether a number of this object, or of one of its parts, is an array.

        Arrays that all members of a family share do not count.
        """
        # This runs for every object that is made: `_parts` would be slower.
        for name, value in self.__dict__.items():
            items = (value,)
            if isinstance(value, tuple):
                items = value
            for item in items:
                if isinstance(item, Frozen):
                    if item._varies:
                        return True
                elif isinstance(item, np.ndarray) and name not in self._shared_fields:
                    return True
        return False

    def _numbers(self, path: str = "") -> Iterator[tuple[str, Number]]:
        """Yield path and value of each number that may vary in a family.

        A value is a float or an array. The numbers are those of this object and of its
        parts; numbers that all members share are left out. `path` is the path of this
        object in the object that it is a part of, "" if it is none.
        """
        for name, item in self._parts():
            item_path = name
            if path:
                item_path = f"{path}.{name}"
            if isinstance(item, Frozen):
                yield from item._numbers(item_path)
            elif name in self._shared_fields:
                continue
            elif isinstance(item, float | np.ndarray):
                yield item_path, item

    def _mapped(self, change: Callable[[Any], Any]) -> Self:
        """A new object with ``change(array)`` in place of every array, unchecked.

        Arrays in tuples and in parts are replaced too. Arrays that all members of a
        family share are kept. The new object has no attributes with an underscore,
        which store computed values.
        """

        def mapped(value: Any) -> Any:
            """A value, or all items of a tuple, with arrays changed."""
            if isinstance(value, np.ndarray):
                return change(value)
            if isinstance(value, Frozen):
                return value._mapped(change)
            if isinstance(value, tuple):
                return tuple(mapped(item) for item in value)
            return value

        attributes = {}
        for name, value in self.__dict__.items():
            if name in self._shared_fields:
                attributes[name] = value
            elif name[0] != "_":  # values with "_" were computed from the old arrays
                attributes[name] = mapped(value)
        twin = object.__new__(type(self))  # without the checks of the constructor
        twin._set(**attributes)
        return twin


def _explain_constructor(kind: Any) -> None:
    """Make the constructor of a class name the arguments that wrong ones may mean.

    The class is changed, unless its constructor is wrapped already.
    """
    if not hasattr(kind.__init__, "__wrapped__"):
        kind.__init__ = explain_arguments(kind.__init__)


@typing.dataclass_transform(eq_default=False, field_specifiers=(quantity,))
class FrozenDataclass(Frozen):
    """A frozen object whose class declares its parameters: a checked dataclass."""

    def __init_subclass__(cls, **tag: str) -> None:
        """Make the class a frozen dataclass with the repr and the equality of `Frozen`.

        A tag, such as kind="rod", names the class in descriptions, see `Frozen`. The
        constructor is wrapped, so that the error on an unknown argument names those
        that may be meant.
        """
        super().__init_subclass__(**tag)
        dataclass(repr=False, eq=False, frozen=True)(cls)
        # `dataclass` has just made these two methods. Without them Python finds those
        # of `Frozen`, whose errors say what to do instead of setting an attribute.
        del cls.__setattr__, cls.__delattr__
        _explain_constructor(cls)

    def __post_init__(self) -> None:
        """Check all arguments; InvalidModel names all mistakes.

        `QuantityField.checked` checks and converts each declared number, except
        profiles, which the class checks itself. Arrays must broadcast. Then the
        `_check` of the class is called with the problems found so far, also if there
        are some.
        """
        problems: Problems = []
        attributes = self.__dict__
        may_vary = False
        for name, field in self.fields.items():
            if field.along:  # the class checks profiles itself
                continue
            value = field.checked(problems, name, attributes[name])
            attributes[name] = value
            if isinstance(value, np.ndarray | tuple):
                may_vary = True
        if may_vary and not problems:
            family_shape(self._numbers())  # raises if arrays make no family
        try:
            self._check(problems)
        except InvalidModel as error:
            problems += error.problems
        raise_if_problems(problems)

    def _check(self, problems: Problems) -> None:
        """Add problems to the list, or raise them; here, do nothing.

        A class may override this to check its numbers together. They have been checked
        one by one before, and `problems` has their mistakes.
        """


@cache
def defaults_of(kind: Any) -> dict[str, Any]:
    """Parameters of the constructor of a class with their defaults, or `REQUIRED`."""
    parameters = inspect.signature(kind).parameters
    return {name: parameter.default for name, parameter in parameters.items()}


def short(value: Any) -> str:
    """A value as short text for a repr.

    An array is shown by its shape, an object with a name by that name without quotes,
    and any other value by its own repr.
    """
    if isinstance(value, np.ndarray):
        return f"array{value.shape}"
    name = getattr(value, "name", None)
    if name:
        return one_line(name)
    return repr(value)


def json_ready(value: Any) -> Any:
    """A value as numbers, lists and dictionaries for JSON.

    A `Frozen` becomes its description, an array or a tuple a list. Numbers, texts and
    other values are returned unchanged.
    """
    if isinstance(value, Frozen):
        return value.to_dict()
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, tuple):
        return [json_ready(item) for item in value]
    return value
