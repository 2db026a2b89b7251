"""Case files: a collision written down in TOML, read with every mistake reported at once.

    schema = 1
    gravity = "9.81 m/s^2"   # to the right; 0 if left out

    [[bodies]]
    kind = "rod"
    length = "400 mm"        # a number in SI units, or text with a unit
    area = 1e-4              # or a profile, or the `diameter` of a round rod
    material = "steel"       # of `rodimpact.materials`, or a [materials.NAME] of this file
    velocity = 1.0           # or a profile; so is `strain`

    [[bodies]]
    kind = "mass"            # rigid
    mass = "2 kg"
    velocity = 0.0

    [[bodies]]
    kind = "wall"            # takes `velocity` only

    [[contacts]]             # entry i lies between body i and i + 1; leave all out for touching
    gap = "50 um"
    law = "rigid"            # or another of `rodimpact.model.laws`

    [[contacts]]
    law = "spring"
    stiffness = "3 kN/mm"

    [ends.left]              # of the row; free if left out
    kind = "force"           # or "velocity", "fixed", "absorbing", "free"
    value = "1 kN"           # or a profile in time; for "force" and "velocity" only

    [solve]                  # until, method, max_events, dt, rtol, cells, snapshots: as for
                             # `rodimpact.solve`; all but the last for `rodimpact.sweep` too
    [output]                 # plot, save: names of files to write

A law, "rigid", "bonded", "spring", "spring-dashpot", "hertz", "hunt-crossley" and so on, takes the
numbers of its class, under their names; Hertz contact a stiffness, or left_radius and right_radius.

A [materials.NAME] takes youngs_modulus, density, poisson_ratio and viscosity, or for the latter a
loss_factor and the loss_frequency at which it is that; a stepped rod takes [[bodies.segments]] with
length, area and material each. For lateral inertia rods and segments take a polar_moment, a number
or "circular". Mistakes bear the path of the entry, such as `bodies.0.length`.

A profile is {values = [1.0, 0.0], at = [0.1]}, constant between jumps, or {samples = [...]}, at
equal distances from end to end. In time `at` are times, and samples have a `step` between them.

A radius left out, or "inf", is that of a flat face. The faces of a Hertz contact are of the
material of their rods; those of a mass or a wall do not yield, unless left_material or
right_material names what they are made of.

Any number but samples may be varied: the grid given for its path stands in for the entry, which
may then be absent, and the case becomes a family with one axis a grid.
"""

from __future__ import annotations

import inspect
import json
import math
import os
import re
import reprlib
import tomllib
from collections.abc import Collection, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from .. import materials, units
from ..methods.registry import METHOD_NAMES, Options
from ..model import SIDES, System
from ..model.bodies import CIRCULAR, Body, Material, RigidMass, Rod, Segment, Wall
from ..model.ends import ENDS, FREE, End
from ..model.frozen import Field, Frozen, InvalidModel, Number, Problems, nearest
from ..model.laws import CONTACT_LAWS, ContactLaw, Hertz, Spring
from ..model.profiles import Samples, Steps

SCHEMA = 1
MISSING = math.nan  # default of an entry that must be there, and what stands for it then
MOST_COLLISIONS = 10**9  # in one family
GRID_FORM = "start:stop:count, start:stop:count:log or a list such as 0.1,0.2,0.4"
PROFILES = {  # how a profile is written along a rod, and in time
    "length": "{values = [...], at = [...]} or {samples = [...]}",
    "time": "{values = [...], at = [...]} or {samples = [...], step = ...}",
}
Materials = dict[str, Material]


class Varied(NamedTuple):
    """A number of a case that runs through a grid.

    path : such as ``bodies.0.length``; values : array of shape (n,), in `unit`;
    unit : of SI, "" for a pure number.
    """

    path: str
    values: np.ndarray[Any, np.dtype[np.float64]]
    unit: str


@dataclass(frozen=True)
class Case:
    """A collision, or a family of them, and what to do with it.

    Attributes
    ----------
    system : System
        Of shape (), or where numbers are varied of shape (n_0, n_1, ...), one axis a grid.
    solve : dict
        Those of `until` (s), `method`, `max_events`, `dt` (s), `rtol`, `cells` and `snapshots` that
        were given, for ``ri.solve``.
    output : dict of str
        Those of `plot` and `save` that were given: names of files.
    path : str
        Where it was read from; empty if from nowhere.
    varied : tuple of Varied
        What varies along each axis; the system holds the same numbers in its own terms.
    """

    system: System
    solve: dict[str, Any] = field(default_factory=dict)
    output: dict[str, str] = field(default_factory=dict)
    path: str = ""
    varied: tuple[Varied, ...] = field(default=(), compare=False)


# Reading ------------------------------------------------------------------------------------------


def read_case(path: str | os.PathLike[str], vary: Mapping[str, str] | None = None) -> Case:
    """Read a case file.

    Parameters
    ----------
    path : str or path
        Of a TOML file in UTF-8.
    vary : mapping of str to str, optional
        Paths of numbers and the grids to vary them on, as for `parse_case`.

    Returns
    -------
    Case

    Raises
    ------
    InvalidModel
        If the file cannot be read, is no TOML, or describes no collision; with all its mistakes.
    """
    name = os.fspath(path)
    try:
        raw = Path(path).read_bytes()
    except (OSError, ValueError) as error:  # a name with a null byte is a ValueError
        reason = getattr(error, "strerror", None) or error
        raise InvalidModel([(name, f"cannot be read: {reason}")]) from None
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        message = f"is not text in UTF-8 (at line {line}); save it as UTF-8"
        raise InvalidModel([(name, message)]) from None
    return parse_case(text, name, vary)


def parse_case(
    text: str, source: str = "case", vary: Mapping[str, str] | None = None
) -> Case:
    """Read the text of a case file.

    Parameters
    ----------
    text : str
        TOML.
    source : str
        What to call it where the text itself is at fault.
    vary : mapping of str to str, optional
        For each number to vary its path, such as ``bodies.0.length`` or
        ``materials.NAME.density``, and the text of a grid: ``start:stop:count`` for equal steps,
        ``start:stop:count:log`` for equal ratios, both with both ends, or a list ``a,b,c``. Each
        number may have a unit. The k-th of them becomes axis k of the family.

    Returns
    -------
    Case

    Raises
    ------
    InvalidModel
        With all mistakes, each with the path of its entry.

    Examples
    --------
    >>> case = parse_case('''
    ... schema = 1
    ... bodies = [
    ...     {kind = "rod", length = "40 cm", area = "1 cm^2", material = "steel", velocity = 1},
    ...     {kind = "wall"},
    ... ]
    ... ''')
    >>> case.system.bodies[0].length, case.system.gaps
    (0.4, (0.0,))
    >>> family = parse_case(write_case(case), vary={"bodies.0.length": "50 mm:1 m:20"})
    >>> family.system.shape, family.system[19].bodies[0].length
    ((20,), 1.0)
    """
    try:
        data = tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # a number of 5000 digits is a plain ValueError
        raise InvalidModel([(source, f"is not valid TOML: {error}")]) from None
    return case_from(data, source, vary)


def case_from(
    data: dict[str, Any], source: str = "case", vary: Mapping[str, str] | None = None
) -> Case:
    """Make a case of the tables that a case file holds.

    Parameters
    ----------
    data : dict
        As ``tomllib.loads`` makes it of a case file, or a program of its own.
    source, vary
        As for `parse_case`.

    Returns
    -------
    Case

    Raises
    ------
    InvalidModel
        With all mistakes, each with the path of its entry.
    """
    problems: Problems = []
    grids = _Grids(vary)
    top = _Table(problems, "", data, grids)
    _check_schema(top)
    known = _read_materials(top)
    gravity = top.number("gravity", System.fields["gravity"].dimension, 0.0)
    read = [_read_body(table, known) for table in top.tables("bodies")]
    if not read:
        top.note("bodies", "is missing; describe each body in a [[bodies]] table")
    gaps, laws = _read_contacts(top, read, known)
    ends = _read_ends(top.table("ends"))
    bodies = [body or Rod(1.0, area=1.0, material=materials.steel) for body in read]
    system: Any = bodies and top.make(
        System, bodies=bodies, gaps=gaps, contacts=laws, gravity=gravity, ends=ends
    )
    options, output = _read_solve(top.table("solve")), _read_output(top.table("output"))
    top.close()
    _check_grids(top, system)
    if problems:
        raise InvalidModel(problems)
    return Case(system, options, output, source, tuple(grids.taken[path] for path in grids.texts))


class _Table:
    """One table of the file: hands out entries by name, notes mistakes with their paths."""

    def __init__(
        self, problems: Problems, path: str, data: dict[str, Any], grids: _Grids
    ) -> None:
        self.problems, self.path, self.data, self.grids = problems, path, data, grids
        self.asked: list[str] = []

    def where(self, key: str) -> str:
        return f"{self.path}.{key}" if self.path else key

    def note(self, key: str, message: str) -> None:
        """Note a mistake, unless this entry has one already: the second would come of the first."""
        path = self.where(key)
        if all(known != path for known, _ in self.problems):
            self.problems.append((path, message))

    def has(self, key: str) -> bool:
        self.asked.append(key)
        return key in self.data

    def gives(self, key: str) -> bool:
        """Whether there is such a number, in the file or varied."""
        varied = self.grids.ask(self.where(key))
        return self.has(key) or varied

    def number(
        self, key: str, dimension: str, default: Any = MISSING, profiles: str = ""
    ) -> Any:
        """A number of the model, an array where it is varied."""
        if self.gives(key):
            return self.variable(key, self.data.get(key), dimension, profiles)
        if default is MISSING:
            self.note(key, f"is missing; give {_unit_hint(dimension)}")
        return default

    def numbers_of(self, kind: type[Frozen]) -> dict[str, Any]:
        """All numbers that an object of this class is made of."""
        taken = inspect.signature(kind).parameters
        return {
            key: self.number(
                key, field.dimension,
                MISSING if taken[key].default is inspect.Parameter.empty else taken[key].default,
            )
            for key, field in kind.fields.items()
        }

    def variable(self, key: str, value: Any, dimension: str, profiles: str = "") -> Number:
        """The grid that varies this number, or else what the file says it is.

        `profiles` says how a profile in its place is written, if there can be one.
        """
        path = self.where(key)
        if self.grids.ask(path):
            try:
                return self.grids.take(path, dimension)
            except ValueError as error:
                self.note(key, str(error))
                return MISSING
        if isinstance(value, list):
            message = f"must be a single number, got {_short(value)}"
            if profiles:
                message += f"; a profile is written {profiles}"
            self.note(key, f"{message}; rodimpact sweep --vary {path}=start:stop:count varies it")
            return MISSING
        return self.quantity(key, value, dimension)

    def quantity(self, key: str, value: Any, dimension: str) -> float:
        """Value of a number or text with unit, nan if it is neither."""
        try:
            return units.parse(value, dimension)
        except ValueError as error:
            self.note(key, str(error))
            return MISSING

    def profile(
        self, key: str, field: Field, default: float = 0.0, over: str = "length",
        stand_in: float = 0.0,
    ) -> Any:
        """A number, `Steps` or `Samples` over a length or a time.

        `stand_in` stands for a profile where mistakes allow none.
        """
        dimension = field.dimension
        if not isinstance(self.data.get(key), dict):
            return self.number(key, dimension, default, PROFILES[over])
        inner, made = self.table(key), None
        if inner.has("samples"):
            step = inner.number("step", "time") if over == "time" else None
            values = inner.samples("samples", dimension)
            made = values and inner.make(Samples, values=values, step=step)
        else:
            lists = {name: inner.numbers(name, of) for name, of in
                     (("values", dimension), ("at", over))}
            made = inner.make(Steps, **lists)
        inner.close()
        return made or stand_in

    def samples(self, key: str, dimension: str) -> list[float]:
        """Numbers of a long list, of whose mistakes the first is noted; empty if there are any."""
        given, found = self.data[key], []
        if not isinstance(given, list) or len(given) < 2:
            self.note(key, f"must be a list of at least two numbers, got {_short(given)}")
            return []
        for i, value in enumerate(given):
            found.append(self.quantity(f"{key}.{i}", value, dimension))
            if math.isnan(found[-1]):
                return []
        return found

    def numbers(self, key: str, dimension: str) -> list[Number] | None:
        if not self.has(key):
            self.note(key, "is missing; give a list of numbers")
            return None
        if not isinstance(self.data[key], list):
            self.note(key, f"must be a list of numbers, got {_short(self.data[key])}")
            return None
        return [self.variable(f"{key}.{i}", v, dimension) for i, v in enumerate(self.data[key])]

    def word(self, key: str, choices: Collection[str], default: str | None = None) -> str | None:
        """One of `choices`, None where it is not."""
        if not self.has(key):
            if default is None:
                self.note(key, f"is missing; use one of {', '.join(choices)}")
            return default
        value = self.data[key]
        if isinstance(value, str) and value in choices:
            return value
        self.note(key, f"unknown {key} {_short(value)}; {nearest(value, choices)}")
        return None

    def table(self, key: str) -> _Table:
        """The table of that name, an empty one if there is none."""
        data = self.data[key] if self.has(key) else {}
        if isinstance(data, dict):
            return self.inner(key, data)
        self.note(key, f"must be a table, got {_short(data)}")
        return _Table([], self.where(key), {}, _Grids())  # what it lacks is no further mistake

    def inner(self, key: str, data: dict[str, Any]) -> _Table:
        return _Table(self.problems, self.where(key), data, self.grids)

    def tables(self, key: str) -> list[_Table]:
        """All tables of that name."""
        data = self.data[key] if self.has(key) else []
        if not isinstance(data, list) or not all(isinstance(item, dict) for item in data):
            brackets = re.sub(r"\.\d+", "", self.where(key))
            self.note(key, f"must be tables that each begin [[{brackets}]], got {_short(data)}")
            data = []
        return [self.inner(f"{key}.{i}", item) for i, item in enumerate(data)]

    def make(self, kind: Any, **fields: Any) -> Any:
        """An object of the model; None, with its mistakes noted here, if they allow none."""
        try:
            return kind(**fields)
        except InvalidModel as error:
            for path, message in error.problems:
                path = re.sub(r"^gaps\.(\d+)", r"contacts.\1.gap", path)
                self.note(re.sub(r"\bvalues\[(\d+)\]$", r"samples.\1", path), message)
            return None

    def close(self) -> None:
        """Note every entry that nobody asked for."""
        for key in self.data:
            if key not in self.asked:
                self.note(key, f"unknown key; {nearest(key, dict.fromkeys(self.asked))}")


class _Grids:
    """The numbers to vary: hands out the array of each when it is asked for by its path."""

    def __init__(self, vary: Mapping[str, str] | None = None) -> None:
        self.texts = dict(vary or {})
        self.known: dict[str, None] = {}  # all numbers that can be varied
        self.taken: dict[str, Varied] = {}
        self.counts: list[int] = []
        for text in self.texts.values():
            with suppress(ValueError):  # it is said when the grid is taken
                self.counts.append(_Grid(text).count)

    @property
    def too_many(self) -> bool:
        return math.prod(self.counts) > MOST_COLLISIONS

    def ask(self, path: str) -> bool:
        """Whether this number is varied."""
        self.known[path] = None
        return path in self.texts

    def take(self, path: str, dimension: str) -> Number:
        """Array along the axis of this grid; ValueError for a text that is none."""
        values = _Grid(self.texts[path]).values(dimension, only_ends=self.too_many)
        self.taken[path] = Varied(path, values, units.si_unit(dimension))
        return values.reshape([-1 if other == path else 1 for other in self.texts])


class _Grid:
    """Values for one number, read from their text; ValueError for a text that is none."""

    def __init__(self, text: Any) -> None:
        if not isinstance(text, str):
            raise ValueError(f"must be the text of a grid, {GRID_FORM}, got {_short(text)}")
        self.text = text
        first, *rest = (part.strip() for part in text.split(":"))
        self.is_list, self.is_log = not rest, rest[2:] == ["log"]
        if self.is_list:
            self.numbers = first.split(",")
            self.count = len(self.numbers)
            return
        if len(rest) != 2 and not self.is_log:
            raise ValueError(f"must be {GRID_FORM}, got {text!r}")
        stop, count = rest[:2]
        if not re.fullmatch("0*[1-9][0-9]{0,9}", count):
            raise ValueError(
                f"needs a whole number of values from 1 to {MOST_COLLISIONS}, as in {GRID_FORM}; "
                f"got {count!r} in {text!r}"
            )
        self.numbers, self.count = [first, stop], int(count)

    def values(self, dimension: str, only_ends: bool) -> np.ndarray[Any, np.dtype[np.float64]]:
        """All values, shape (n,), in SI units; or only the ends, where all are too many."""
        numbers = [units.parse(text, dimension) for text in self.numbers]
        if self.is_list:
            return np.array(numbers)
        start, stop = numbers
        if self.is_log and min(numbers) <= 0:
            raise ValueError(f"needs ends above 0 for equal ratios, got {self.text!r}")
        if self.count == 1 and start != stop:
            raise ValueError(f"one value cannot be at both ends; raise the count in {self.text!r}")
        count = min(self.count, 2) if only_ends else self.count
        with np.errstate(all="ignore"):
            values = (np.geomspace if self.is_log else np.linspace)(start, stop, count)
        if not np.isfinite(values).all():
            raise ValueError(f"the ends of {self.text!r} are too far apart")
        return values


def _check_grids(top: _Table, system: System | None) -> None:
    """Note too many collisions, grids of unknown numbers, and grids that change nothing."""
    grids = top.grids
    if grids.too_many:
        made = " x ".join(map(str, grids.counts))
        message = f"the grids make {made} collisions, more than {MOST_COLLISIONS}"
        remedy = "take fewer values, or sweep one part after another"
        top.note(next(iter(grids.texts)), f"{message}; {remedy}")
    # in a table that could not be read, nobody knows the numbers
    unread = tuple(re.sub(r"\.(kind|law)$", "", path) + "." for path, _ in top.problems)
    for path in grids.texts:
        name = path.removeprefix("materials.").rpartition(".")[0]
        if path in grids.known or path.startswith(unread):
            continue
        if name in materials.TABLE and f"materials.{name}.density" not in grids.known:
            message = f"is a number of the library; to vary it, describe [materials.{name}] in "
            top.note(path, message + "the file")
        else:
            top.note(path, f"is no number that can vary; {_nearest_path(path, grids.known)}")
    if system is None or top.problems:  # where mistakes are, something else stands in
        return
    rods = [body for body in system.bodies if isinstance(body, Rod)]
    used = [f"materials.{s.material.name}." for rod in rods for s in rod.segments]
    faces = [entry.get(f"{side}_material") for entry in top.data.get("contacts", ())
             for side in SIDES]
    used += [f"materials.{face}.{elastic}" for face in faces
             for elastic in ("youngs_modulus", "poisson_ratio")]
    for path in grids.taken:
        if path.startswith("materials.") and not path.startswith(tuple(used)):
            top.note(path, "changes nothing: no rod is made of this material")


def _check_schema(top: _Table) -> None:
    schema = top.data["schema"] if top.has("schema") else None
    if schema is None:
        top.note("schema", f"is missing; begin the file with schema = {SCHEMA}")
    elif type(schema) is int and schema > SCHEMA:  # its other entries may mean other things
        message = f"is {schema}; this rodimpact reads {SCHEMA}, get a newer one"
        raise InvalidModel([("schema", message)])
    elif type(schema) is not int or schema != SCHEMA:
        top.note("schema", f"must be {SCHEMA}, got {_short(schema)}")


def _read_materials(top: _Table) -> Materials:
    """Materials by name; steel stands in for those with mistakes."""
    known, group = dict(materials.TABLE), top.table("materials")
    for name in group.data:
        table = group.table(name)
        made = table.make(
            Material, name=name, **table.numbers_of(Material)
        ) or materials.steel
        if table.gives("loss_factor") or table.gives("loss_frequency"):
            if table.gives("viscosity"):
                message = "give either viscosity or loss_factor and loss_frequency, not both"
                table.note("viscosity", message)
            made = table.make(
                _damped,
                material=made,
                loss_factor=table.number("loss_factor", "dimensionless"),
                loss_frequency=table.number("loss_frequency", "frequency"),
            )
        table.close()
        known[name] = made or materials.steel
    return known


def _damped(material: Material, loss_factor: Number, loss_frequency: Number) -> Material:
    """The material with the viscosity of that loss factor."""
    try:
        return material.damped(loss_factor, loss_frequency)
    except InvalidModel as error:
        raise InvalidModel([
            (re.sub("^frequency", "loss_frequency", path), message)
            for path, message in error.problems
        ]) from None


def _read_body(table: _Table, known: Materials) -> Body | None:
    """The body, None if of unknown kind; where mistakes allow none, any of its kind stands in."""
    kind = table.word("kind", ("rod", "mass", "wall"))
    if kind is None:
        return None
    body: Body | None = None
    if kind == "wall":
        body = table.make(Wall, **table.numbers_of(Wall)) or Wall()
    elif kind == "mass":
        body = table.make(RigidMass, **table.numbers_of(RigidMass)) or RigidMass(1.0)
    else:
        shape = _read_segments(table, known) if table.has("segments") else _shape(table, known)
        state = {key: table.profile(key, field) for key, field in Rod.fields.items()}
        if None not in shape.get("segments", ()):
            body = table.make(Rod, **shape, **state)
    table.close()
    return body or Rod(1.0, area=1.0, material=materials.steel)


def _read_segments(table: _Table, known: Materials) -> dict[str, Any]:
    uniform = ("length", "area", "diameter", "material", "polar_moment")
    if [key for key in uniform if table.has(key)]:
        message = "give either segments or length, area, material and polar_moment, not both"
        table.note("segments", message)
    pieces = []
    for piece in table.tables("segments"):
        pieces.append(piece.make(Segment, **_shape(piece, known)))
        piece.close()
    return {"segments": pieces}


def _shape(table: _Table, known: Materials) -> dict[str, Any]:
    return {
        "length": table.number("length", Segment.fields["length"].dimension),
        **_section(table),
        "material": _material(table, known),
        "polar_moment": _polar_moment(table),
    }


def _section(table: _Table) -> dict[str, Any]:
    """What says how wide the rod is: the area of its cross-section, the diameter, or both."""
    given = {}
    if table.gives("diameter"):
        given["diameter"] = table.number("diameter", Segment.fields["diameter"].dimension)
    if isinstance(table.data.get("area"), dict) or table.gives("area"):
        given["area"] = table.profile("area", Segment.fields["area"], stand_in=1.0)
    if not given:
        table.note("area", "is missing; give it, or the diameter of a round rod")
    return given


def _polar_moment(table: _Table) -> Any:
    """Polar second moment of the cross-section, m^4, or a word for one; None without one."""
    value = table.data.get("polar_moment")
    varied = table.grids.ask(table.where("polar_moment"))
    if not varied and isinstance(value, str) and value[:1].isalpha():
        return table.word("polar_moment", (CIRCULAR,))
    return table.number("polar_moment", Segment.fields["polar_moment"].dimension, None)


def _material(table: _Table, known: Materials, key: str = "material") -> Material:
    """The material that the table names; steel stands in for an unknown one."""
    if not table.has(key):
        table.note(key, "is missing; name one of rodimpact.materials or of this file")
        return materials.steel
    name = table.data[key]
    if isinstance(name, str) and name in known:
        return known[name]
    table.note(key, f"unknown material {_short(name)}; {nearest(name, known)}")
    return materials.steel


def _read_contacts(
    top: _Table, bodies: list[Body | None], known: Materials
) -> tuple[list[Number], list[ContactLaw]]:
    """Gaps and laws of all pairs."""
    tables, pairs = top.tables("contacts"), len(bodies) - 1
    if "contacts" in top.data and 0 <= pairs != len(tables):
        message = f"needs one entry for each neighbouring pair, {pairs} in all, got {len(tables)}"
        top.note("contacts", message + "; leave all out if all bodies touch")
    tables += [top.inner(f"contacts.{i}", {}) for i in range(len(tables), pairs)]
    gaps, laws = [], []
    for i, table in enumerate(tables):
        gaps.append(table.number("gap", System.fields["gaps"].dimension, 0.0))
        laws.append(_read_law(table, (*bodies[i : i + 2], None, None)[:2], known))
    return gaps[:pairs], laws[:pairs]


def _read_law(
    table: _Table, pair: tuple[Body | None, ...], known: Materials
) -> ContactLaw:
    """The law; a spring, which goes between any bodies, where mistakes allow none."""
    name = table.word("law", CONTACT_LAWS, "rigid")
    law: ContactLaw | None = None
    if name is None:  # who knows which keys are right
        return Spring(1.0)
    if name == Hertz.law and (faces := _read_faces(table, pair, known)):
        law = table.make(Hertz.from_radii, **faces)
    else:
        numbers = table.numbers_of(CONTACT_LAWS[name])
        law = table.make(CONTACT_LAWS[name], **numbers)
        if numbers.get("restitution") is not None and None in pair:  # is it right here?
            law = None
    table.close()
    return law or Spring(1.0)


def _read_faces(
    table: _Table, pair: tuple[Body | None, ...], known: Materials
) -> dict[str, Any]:
    """Radii and materials of a Hertz contact, for `Hertz.from_radii`; empty if it has none."""
    rounded = [side for side in SIDES if table.gives(f"{side}_radius")]
    if table.gives("stiffness") or not rounded:
        needless = [f"{side}_radius" for side in rounded]
        needless += [key for side in SIDES if table.has(key := f"{side}_material")]
        for key in needless:
            table.note(key, "belongs to radii; give either stiffness or radii, not both")
        if not table.gives("stiffness"):
            table.note("stiffness", "is missing; give it, or left_radius and right_radius")
        return {}
    faces: dict[str, Any] = {}
    for side, body, end in zip(SIDES, pair, (-1, 0), strict=True):
        faces[f"{side}_radius"] = _radius(table, f"{side}_radius")
        key = f"{side}_material"
        if table.has(key):
            faces[key] = _material(table, known, key)
        elif isinstance(body, Rod):
            faces[key] = body.segments[end].material
        else:
            faces[key] = None if body else materials.steel
    return faces


def _radius(table: _Table, key: str) -> Any:
    """Radius of a face, m; that of a flat one is infinite."""
    varied = table.grids.ask(table.where(key))
    if not varied and table.has(key) and table.data[key] in ("inf", math.inf):
        return math.inf
    return table.number(key, "length", math.inf)


def _read_ends(table: _Table) -> list[End]:
    """What happens at the two ends of the row."""
    ends = [_read_end(table.table(side)) if table.has(side) else FREE for side in SIDES]
    table.close()
    return ends


def _read_end(table: _Table) -> End:
    """The end; a free one where mistakes allow none."""
    kind = table.word("kind", ENDS)
    if kind is None:
        return FREE
    driven = {
        key: table.profile(key, field, MISSING, "time") for key, field in ENDS[kind].fields.items()
    }
    end: End | None = table.make(ENDS[kind], **driven)
    table.close()
    return end or FREE


def _read_solve(table: _Table) -> dict[str, Any]:
    options: dict[str, Any] = {}
    for key, dimension in (("until", "time"), ("dt", "time"), ("rtol", "dimensionless")):
        if table.has(key):
            options[key] = table.quantity(key, table.data[key], dimension)
    if table.has("method"):
        options["method"] = table.word("method", METHOD_NAMES)
    for key in ("max_events", "cells", "snapshots"):
        if table.has(key):
            options[key] = table.data[key]
    table.make(Options, **options)
    table.close()
    return options


def _read_output(table: _Table) -> dict[str, str]:
    names = {key: table.data[key] for key in ("plot", "save") if table.has(key)}
    for key, name in names.items():
        if not isinstance(name, str) or not name:
            table.note(key, f"must be the name of a file, got {_short(name)}")
    table.close()
    return names


def _unit_hint(dimension: str) -> str:
    if dimension == "dimensionless":
        return "a number"
    if dimension not in units.UNITS:
        return f"a number of {dimension}"
    article = "an" if dimension[0] in "aeiou" else "a"
    known = ", ".join(units.UNITS[dimension])
    return f"{article} {dimension}, in SI units or as text with one of {known}"


def _nearest_path(path: str, choices: Collection[str]) -> str:
    """As `nearest`, of the choices in the innermost table of the path that has any."""
    head = ""
    for dot in re.finditer(r"\.", path):
        if any(choice.startswith(path[: dot.end()]) for choice in choices):
            head = path[: dot.end()]
    inside = [choice.removeprefix(head) for choice in choices if choice.startswith(head)]
    return nearest(path.removeprefix(head), inside, head)


def _short(value: Any) -> str:
    return reprlib.repr(value)


# Writing ------------------------------------------------------------------------------------------


def write_case(case: Case | System) -> str:
    """Write a case, or just a system, as the text of a case file.

    Every material is spelt out, so that the file means the same whatever the table says later.

    Parameters
    ----------
    case : Case or System

    Returns
    -------
    str
        TOML, from which `parse_case` makes an equal system.

    Raises
    ------
    InvalidModel
        For a family, and where two different materials bear one name.

    Examples
    --------
    >>> from rodimpact.model import Rod, System, Wall
    >>> system = System([Rod(0.4, area=1e-4, material=materials.steel, velocity=1.0), Wall()])
    >>> parse_case(write_case(system)).system == system
    True
    """
    if isinstance(case, System):
        case = Case(case)
    system = case.system
    if system.shape != ():
        message = f"a family of shape {system.shape} is no single case; write system[index]"
        raise InvalidModel([("system", message)])
    found: Materials = {}
    for i, body in enumerate(system.bodies):
        for material in (s.material for s in body.segments) if isinstance(body, Rod) else ():
            if found.setdefault(material.name, material) != material:
                message = f"another material is called {material.name!r} too; rename one"
                raise InvalidModel([(f"bodies.{i}.material", message)])
    described = system.to_dict()
    lines = [f"schema = {SCHEMA}"]
    lines += [f"{key} = {_toml(described[key])}" for key in ("gravity",) if key in described]
    for name, material in found.items():
        key = name if re.fullmatch("[A-Za-z0-9_-]+", name) else _toml(name)
        lines += _lines(f"[materials.{key}]", material.to_dict(), without=("name",))
    for body_table in described["bodies"]:
        lines += _lines("[[bodies]]", body_table, without=("segments",))
        for segment in body_table.get("segments", ()):
            lines += _lines("[[bodies.segments]]", segment)
    for contact in described["contacts"]:
        lines += _lines("[[contacts]]", contact)
    for side, end in described.get("ends", {}).items():
        lines += _lines(f"[ends.{side}]", end)
    for name, options in (("solve", case.solve), ("output", case.output)):
        lines += _lines(f"[{name}]", options) if options else []
    return "\n".join(lines) + "\n"


def _lines(header: str, table: dict[str, Any], without: tuple[str, ...] = ()) -> list[str]:
    kept = {k: v for k, v in table.items() if v is not None and k not in without}
    if "material" in kept:
        kept["material"] = kept["material"]["name"]
    return ["", header, *(f"{key} = {_toml(value)}" for key, value in kept.items())]


def _toml(value: Any) -> str:
    if isinstance(value, str):  # a string of JSON is one of TOML, but for DEL
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {_toml(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_toml, value)) + "]"
    return repr(value)
