"""What a case file may hold: every table with its keys, as the `fields` of the model tell it.

A new field of a class, and a new law, body or end, need no line here. Each table comes with the
shortest example of it, which `parse_case` reads.
"""

import inspect
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

from ..methods.registry import METHOD_NAMES, Options
from ..model import GAP, SIDES, System
from ..model.bodies import BODIES, Material, Rod, Segment
from ..model.ends import ENDS
from ..model.frozen import REQUIRED, Field, defaults_of
from ..model.lateral_inertia import THEORIES
from ..model.laws import CONTACT_LAWS, FACE, Hertz
from .case import SCHEMA
from .case_reading import DAMPING
from .case_writing import toml_table

TYPICAL = {
    "m": "400 mm",
    "m^2": "1 cm^2",
    "kg": "2 kg",
    "m/s": "1 m/s",
    "Pa": "200 GPa",
    "kg/m^3": "7.85 g/cm^3",
    "N": "5 kN",
    "N/m": "20 kN/mm",
    "N s/m": "200 N s/m",
    "s/m": "0.3 s/m",
    "N/m^1.5": "10 GN/m^1.5",
    "N/m^p": 10**9,
    "": "-500 microstrain",
    "exponent": 2,
    "compression": ["0.1 mm", "1 mm"],
    "force": ["1 kN", "1.2 kN"],
}
"""An example for each unit, and for what is no strain."""
SIGNS = {
    "any": "any number",
    "positive": "> 0",
    "non-negative": ">= 0",
    "positive or infinite": '> 0, or "inf"',
}
WORD = "name of a material"


class Entry(NamedTuple):
    """One key of a table: its unit, what it takes, and what holds where it is left out."""

    key: str
    unit: str
    takes: str
    default: str


class Section(NamedTuple):
    """One table of a case file, the shortest example of it, and what it describes in Python."""

    title: str
    meaning: str
    entries: list[Entry]
    example: str
    name: str = ""


def sections() -> list[Section]:
    """Every table, in the order of a file.

    Examples
    --------
    >>> mass = next(table for table in sections() if "mass" in table.title)
    >>> print(mass.example)
    [[bodies]]
    kind = "mass"
    mass = "2 kg"
    >>> mass.entries[1]
    Entry(key='velocity', unit='m/s', takes='any number', default='0')
    """
    top = [
        Entry("schema", "", str(SCHEMA), "required"),
        _number("gravity", System.fields["gravity"]),
    ]
    damping = [_number(key, field, "none") for key, field in DAMPING.items()]
    shape = [
        Entry("material", "", WORD, "required"),
        Entry("lateral_inertia", "", _either(THEORIES), "none"),
    ]
    made_of = {**_needed(Segment), "material": "steel"}
    rod = [
        *_numbers(Segment),
        *shape,
        Entry("segments", "", "[[bodies.segments]]", "in place of all above"),
    ]
    contact = [_number("gap", GAP), Entry("law", "", _either(CONTACT_LAWS), "rigid")]
    faces = [
        entry
        for side in SIDES
        for entry in (  # in place of the stiffness of Hertz contact
            _number(f"{side}_radius", FACE, "flat; in place of stiffness"),
            Entry(f"{side}_material", "", WORD, "that of the rod; else rigid"),
        )
    ]
    files = [Entry(key, "", "name of a file", "none") for key in ("plot", "save")]
    gauge = [
        Entry("body", "", "number of a rod, from 0", "required"),
        Entry("fraction", "1", "[0, 1]", "required"),
        Entry("name", "", "name of its column or channel", "none"),
    ]
    return [
        Section(
            "at the top", "What holds for the whole row.", top, f"schema = {SCHEMA}"
        ),
        _section("[materials.NAME]", {}, Material, after=damping),
        *(
            _section(
                "[[bodies]]",
                made_of if body is Rod else {},
                body,
                before=rod if body is Rod else [],
            )
            for body in BODIES.values()
        ),
        _section("[[bodies.segments]]", made_of, Segment, after=shape),
        Section(
            "[[contacts]]",
            "Entry i lies between bodies i and i + 1. Without any, all bodies touch.",
            contact,
            toml_table("[[contacts]]", {"gap": "50 um"}),
        ),
        *(
            _section("[[contacts]]", {}, law, after=faces if law is Hertz else [])
            for law in CONTACT_LAWS.values()
        ),
        *(_section("[ends.right]", {}, end) for end in ENDS.values()),
        Section(
            "[solve]",
            "How to solve it; `rodimpact run --help` says what these mean.",
            _options(),
            toml_table("[solve]", {"until": "2 ms"}),
            Options.__name__,
        ),
        Section(
            "[output]",
            "What `rodimpact run` writes.",
            files,
            toml_table("[output]", {"plot": "case.png"}),
        ),
        Section(
            "[[gauges]]",
            "A strain gauge for `rodimpact explore`, `export`, `compare` and "
            "`run --gauges`: on which rod, and where, over its length from the left end.",
            gauge,
            toml_table("[[gauges]]", {"body": 0, "fraction": 0.5}),
        ),
    ]


def _section(
    header: str,
    described: dict[str, Any],
    kind: Any,
    before: Sequence[Entry] = (),
    after: Sequence[Entry] = (),
) -> Section:
    """The table that describes an object of this class; `described` is what is no number."""
    tag = "".join(f' {name} = "{value}"' for name, value in kind._tag.items())
    title = header.replace("right", "SIDE") + tag
    meaning = (inspect.getdoc(kind) or "").partition("\n")[0]
    return Section(
        title,
        meaning,
        [*before, *_numbers(kind), *after],
        toml_table(header, kind._tag | described | _needed(kind)),
        kind.__name__,
    )


def _numbers(kind: Any) -> list[Entry]:
    return [
        _number(key, field, _place(kind, key)) for key, field in kind.fields.items()
    ]


def _number(key: str, field: Field, place: str = "") -> Entry:
    takes = SIGNS.get(field.sign, field.sign)
    if field.many:
        takes = "a list of increasing positive numbers"
    if field.word:
        takes += f', or "{field.word}"'
    if field.along:
        takes += (
            f", or a profile {'in time' if field.along == 'time' else 'along the rod'}"
        )
    default = field.default
    if not place:
        place = (
            "required"
            if default is REQUIRED
            else "none"
            if default is None
            else f"{default:g}"
        )
    return Entry(key, field.unit or "1", takes, place)


def _place(kind: Any, key: str) -> str:
    """Of a number that stands for another: which; and of that other."""
    for other, replaced in kind._instead.items():
        if key in replaced:
            return f"required, or {other}"
        if key == other and key in kind.fields:
            return f"in place of {replaced[0]}"
    return ""


def _needed(kind: Any) -> dict[str, Any]:
    """Typical values of the numbers that must be given."""
    return {
        key: TYPICAL.get(key, TYPICAL[field.unit])
        for key, field in kind.fields.items()
        if field.default is REQUIRED or _place(kind, key).startswith("required")
    }


def _options() -> list[Entry]:
    entries = []
    for key, default in defaults_of(Options).items():
        takes = _either(METHOD_NAMES) if key == "method" else "whole number"
        entry = Entry(key, "", takes, "none" if default is None else str(default))
        entries.append(
            _number(key, Options.fields[key]) if key in Options.fields else entry
        )
    return entries


def _either(words: Iterable[str]) -> str:
    return " or ".join(f'"{word}"' for word in words)
