"""A row whose numbers have names, so that a run of it can be read as a formula.

The letters are T for transit times, Z impedances, l lengths, A areas, E Young's moduli,
rho densities, v velocities and g gaps. Each is numbered from left to right: by segment,
material, body or contact. A wave speed that is no fraction has a name of its own, c,
which stands for sqrt(E/rho).

`SymbolWords` matches the symbols that a user gave to paths, `_SymbolSource` gives names
to numbers, and `SymbolicRow` runs the row with values of the names.
"""

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

from ..methods.row import Row
from ..methods.row_builder import build_row
from ..model import Segment, System
from ..model.frozen import InvalidModel, Problems
from ..model.paths import entries_by_path, suggestion
from ..units import shown
from .checks import check_system, decimal_fraction
from .exact_run import ExactRun, RowNumbers, WaveMaterial, read_numbers, run_exactly
from .square_roots import SquareRoots, rational_root
from .traced_fraction import ZERO, Program, TracedFraction

LETTERS = {
    "transit_time": "T",
    "impedance": "Z",
    "length": "l",
    "area": "A",
    "youngs_modulus": "E",
    "density": "rho",
    "velocity": "v",
    "gap": "g",
}


class SymbolWords:
    """The symbols that a user gave, and which of them names the number at a path.

    A number answers to its path, such as ``bodies.0.length``, to that of its material,
    such as ``materials.steel.density``, and to the last word of its path.
    """

    def __init__(self, system: System, symbols: Sequence[str]) -> None:
        """Store the symbols, and the path by its material of each number that has one.

        Such a path is ``materials.steel.density``.
        """
        self.symbols = list(symbols)
        self._material_path_of: dict[str, str] = {}
        for path, entries in entries_by_path(system).items():
            if path.startswith("materials."):
                for full_path in entries:
                    self._material_path_of[full_path] = path

    def words_for(self, path: str) -> list[str]:
        """Words to which the number at a path answers.

        They are its path, its path by the name of its material if that has one, and the
        last word of the path.
        """
        words = [path]
        if path in self._material_path_of:
            words.append(self._material_path_of[path])
        _, _, last_word = path.rpartition(".")
        words.append(last_word)
        return words

    def symbol_of(self, path: str) -> str | None:
        """The symbol that names the number at a path, if one does.

        If several do, it is the first in the order of `words_for`. None if there is
        none.
        """
        for word in self.words_for(path):
            if word in self.symbols:
                return word
        return None


class NamedWaveSpeed(NamedTuple):
    """E and rho of a wave speed that has a name: their names, or their values."""

    youngs_modulus: str | Fraction
    density: str | Fraction

    @property
    def has_symbol(self) -> bool:
        """Whether E or rho has a name."""
        if isinstance(self.youngs_modulus, str):
            return True
        return isinstance(self.density, str)


class SymbolicRow:
    """A row with named numbers.

    Parameters
    ----------
    system : System
    symbols : sequence of str
        Paths of numbers, such as ``bodies.0.length`` or ``materials.steel.density``, or
        the last words of such paths.

    Attributes
    ----------
    row : Row
    paths : dict of str to str
        Path of the number for which each name stands; the first of several numbers.
    base : dict of str to Fraction
        Values of the names in the system.
    wave_speeds : dict of str to NamedWaveSpeed
        Wave speeds that have names.

    Raises
    ------
    InvalidModel
        If a symbol names nothing, or the system has no exact numbers.
    """

    def __init__(self, system: System, symbols: Sequence[str]) -> None:
        """Check system and symbols, and give names to the numbers of the row.

        InvalidModel is raised for a system or a symbol that is refused.
        """
        check_system(system)
        _check_symbols(symbols)
        self.row = build_row(system)
        self._roots = SquareRoots()
        self._words = SymbolWords(system, symbols)
        source = _SymbolSource(self.row, self._words, self._roots)
        self._numbers = read_numbers(self.row, source)
        source.check_use_of_symbols()
        self.paths = source.paths
        self.base = source.base
        self.wave_speeds = source.wave_speeds

    def symbol_of(self, path: str) -> str | None:
        """The symbol that names the number at a path, if one does."""
        return self._words.symbol_of(path)

    @property
    def free_names(self) -> list[str]:
        """Names of the numbers of a run that can be changed one by one.

        Of E, rho and c = sqrt(E/rho), rho and c are free if both E and rho have names,
        and only c if one of them has. A c that has a name only because it is irrational
        is not free.
        """
        names = []
        for name in self.base:
            if not name.startswith(("E", "rho")):
                names.append(name)
        for speed in self.wave_speeds.values():
            modulus_has_name = isinstance(speed.youngs_modulus, str)
            if modulus_has_name and isinstance(speed.density, str):
                names.append(speed.density)
        for name, speed in self.wave_speeds.items():
            if speed.has_symbol:
                names.append(name)
        return names

    def values(self, changed: Mapping[str, Fraction]) -> dict[str, Fraction]:
        """Values of all names in a run: those in `changed`, else those of the system.

        A wave speed that is not in `changed` is sqrt(E/rho), or 0 if E or rho is not
        positive.
        """
        values = {**self.base, **changed}
        for name, speed in self.wave_speeds.items():
            if name in changed:
                continue
            E = _value_of(speed.youngs_modulus, values)
            rho = _value_of(speed.density, values)
            values[name] = Fraction(0)
            if E > 0 and rho > 0:
                values[name] = self._roots.root(E / rho)
        return values

    def run(self, values: Mapping[str, Fraction], max_events: int) -> ExactRun:
        """Run the row with these values of all names, on traced fractions.

        The run may end at `max_events` before it is final.
        """
        named_numbers = {}
        for name, value in values.items():
            named_numbers[name] = TracedFraction(value, name)
        numbers = []
        for numbers_of_quantity in self._numbers:  # the fields of `RowNumbers`
            program = Program(numbers_of_quantity, TracedFraction)
            numbers.append(program(named_numbers))
        return run_exactly(self.row, RowNumbers(*numbers), max_events)


def _check_symbols(symbols: Any) -> None:
    """Raise InvalidModel unless the symbols are a list or tuple of texts."""
    is_list = isinstance(symbols, list | tuple)
    if not is_list or not all(isinstance(symbol, str) for symbol in symbols):
        message = "must be a list of paths or words, such as ['length'], got "
        raise InvalidModel([("symbols", message + shown(symbols))])


def _value_of(name: str | Fraction, values: Mapping[str, Fraction]) -> Fraction:
    """Value of a number that has a name, or the number itself."""
    if isinstance(name, str):
        return values[name]
    return name


class _SymbolSource:
    """Source of the numbers of a row that gives names to those that have a symbol.

    Attributes
    ----------
    paths, base, wave_speeds
        Attributes of the `SymbolicRow`.
    """

    def __init__(self, row: Row, words: SymbolWords, roots: SquareRoots) -> None:
        """Store row, words and roots; no number has a name yet."""
        self.paths: dict[str, str] = {}
        self.base: dict[str, Fraction] = {}
        self.wave_speeds: dict[str, NamedWaveSpeed] = {}
        self._row = row
        self._words = words
        self._roots = roots
        self._asked_paths: list[str] = []
        self._named_paths: list[str] = []
        self._material_number: dict[tuple[str, Any, Any], int] = {}

    def number(self, path: str, value: float) -> Any:
        """Number at a path, with a name such as l2 if a symbol names it.

        A number without a symbol is a constant, and so is a gap of 0. The result is
        None for a transit time or an impedance without a symbol, which follows from
        other numbers.
        """
        owner, _, quantity = path.rpartition(".")
        if quantity == "gap" and value == 0:
            return ZERO  # bodies that touch have no gap to be named
        self._asked_paths.append(path)
        is_derived = quantity in ("transit_time", "impedance")
        if not self._words.symbol_of(path):
            if is_derived:
                return None
            return TracedFraction(decimal_fraction(value))
        if quantity in ("velocity", "gap"):  # bodies.0.velocity is v1
            number = int(path.split(".")[1]) + 1
        else:  # segments are counted from 1 in the paths of the row
            number = self._row.paths.index(owner)
        if is_derived:
            exact_value = self._derived(quantity, self._row.segments[number - 1])
        else:
            exact_value = decimal_fraction(value)
        name = f"{LETTERS[quantity]}{number}"
        self._add_name(name, path, exact_value)
        return TracedFraction(self.base[name], name)

    def _derived(self, quantity: str, segment: Any) -> Fraction:
        """Transit time L/c or impedance rho A c of a segment.

        c is the root of E/rho from `SquareRoots`, which may be rounded.
        """
        E = decimal_fraction(segment.material.youngs_modulus)
        rho = decimal_fraction(segment.material.density)
        c = self._roots.root(E / rho)
        if quantity == "transit_time":
            return decimal_fraction(segment.length) / c
        return rho * decimal_fraction(segment.area) * c

    def material(self, path: str, segment: Segment) -> WaveMaterial:
        """Wave speed and density of the segment at a path.

        E and rho have names if symbols name them. Their wave speed c = sqrt(E/rho) has:

        - no name if neither E nor rho has one and c is rational,
        - a name, and the density is that of the segment, if rho has no name,
        - a name, and the density is rho with its name, if E and rho have names,
        - a name, and the density is E/c^2, if only rho has a name: it follows from c.
        """
        material: Any = segment.material
        path = f"{path}.material"
        # The remedy for a wrong symbol suggests paths that were asked for. The density
        # stands for both E and rho there.
        self._asked_paths.append(f"{path}.density")
        number = self._number_of_material(path, material)
        # E and rho are names, or values of numbers without a name.
        E = self._name_or_value(
            f"E{number}", f"{path}.youngs_modulus", material.youngs_modulus
        )
        rho = self._name_or_value(f"rho{number}", f"{path}.density", material.density)
        modulus = decimal_fraction(material.youngs_modulus)
        squared_speed = modulus / decimal_fraction(material.density)
        speed = NamedWaveSpeed(E, rho)
        c = self._roots.root(squared_speed)
        # A wave speed needs a name if it changes with E or rho, or if it is rounded.
        is_rounded = not rational_root(squared_speed)
        if not is_rounded and not speed.has_symbol:
            return WaveMaterial(TracedFraction(c), TracedFraction(rho))
        name = f"c{number}"
        self.wave_speeds[name] = speed
        wave_speed = TracedFraction(c, name)
        if not isinstance(rho, str):  # rho has no name
            return WaveMaterial(wave_speed, TracedFraction(rho))
        if isinstance(E, str):  # both have names
            density = TracedFraction(self.base[rho], rho)
        else:  # E is fixed, so rho follows from c
            density = TracedFraction(E) / (wave_speed * wave_speed)
        return WaveMaterial(wave_speed, density)

    def _number_of_material(self, path: str, material: Any) -> int:
        """Number of a material in the names of its properties.

        Rods of equal materials share it, unless one of them is named by its path. The
        materials are counted from 1, in the order of their first use.
        """
        own_path = ""
        for quantity in ("youngs_modulus", "density"):
            if f"{path}.{quantity}" in self._words.symbols:
                own_path = path
        key = (own_path, material.youngs_modulus, material.density)
        next_number = len(self._material_number) + 1
        return self._material_number.setdefault(key, next_number)

    def _name_or_value(self, name: str, path: str, value: float) -> str | Fraction:
        """The name, if a symbol names the number at a path, else its exact value.

        The name and the value are stored. A number whose name is stored already, as of
        an equal material, also gets it.
        """
        exact_value = decimal_fraction(value)
        if not self._words.symbol_of(path) and name not in self.base:
            return exact_value
        self._add_name(name, path, exact_value)
        return name

    def _add_name(self, name: str, path: str, value: Fraction) -> None:
        """Remember the name of the number at a path, and its value in the system."""
        self._named_paths.append(path)
        self.paths.setdefault(name, path)
        self.base[name] = value

    def check_use_of_symbols(self) -> None:
        """Raise InvalidModel if there is no symbol, or one names no number of the row.

        To be called when all numbers have been asked for.
        """
        if not self._words.symbols:
            raise InvalidModel([("symbols", "must name a number")])
        known_words = self._words_for_all(self._asked_paths)
        used_words = self._words_for_all(self._named_paths)
        problems: Problems = []
        for symbol in self._words.symbols:
            if symbol not in used_words:
                message = (
                    f"{shown(symbol)} names no number of the formula beside the other "
                    f"symbols; {suggestion(symbol, known_words)}"
                )
                problems.append(("symbols", message))
        if problems:
            raise InvalidModel(problems)

    def _words_for_all(self, paths: list[str]) -> dict[str, None]:
        """Words to which the numbers at some paths answer, each once, in order."""
        words: dict[str, None] = {}
        for path in paths:
            words |= dict.fromkeys(self._words.words_for(path))
        return words
