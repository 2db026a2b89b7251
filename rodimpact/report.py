"""Outcomes and solutions as tables for people and as JSON for programs.

A table gives six digits with units, a dash where there is no such number, and 0 where only
round-off is left. JSON gives every digit, and null where there is no such number.
"""

from __future__ import annotations

import html
import json
import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from .model import Bonded, Rod
from .units import format_si

if TYPE_CHECKING:
    from .contacts import Episode
    from .outcome import Outcome
    from .ring_down import RingDown
    from .solution import Solution
    from .sweeping import SweepResult

SCHEMA_VERSION = 1

ROUND_OFF = 2.0**-44
"""A table shows values below this fraction of their scale as 0. A wave is known to 2^-48 of the
velocities for each end it has passed."""

MOST_EPISODES = 12  # listed in a table
MOST_MEMBERS, SOME_MEMBERS = 20, 12  # of a family: listed one by one, picked from a larger one
MOST_BODIES = 8  # whose velocities are listed for each member of a family

Varied = Sequence[tuple[str, Any, str]]
"""For each axis of a family: the path of what varies along it, its values, and their unit."""


def align(rows: Sequence[Sequence[str]], left: Sequence[int] = (0,)) -> str:
    """Set rows of text in columns, two spaces apart.

    Parameters
    ----------
    rows : sequence of rows of str
        All rows have as many cells.
    left : sequence of int
        Columns whose text starts at the left; in the others it ends at the right.

    Returns
    -------
    str
        One line a row, without a final newline.

    Examples
    --------
    >>> print(align([["rod", "length"], ["left", "0.4 m"], ["right", "1 m"]]))
    rod    length
    left    0.4 m
    right     1 m
    """
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return "\n".join(
        "  ".join(
            cell.ljust(width) if i in left else cell.rjust(width)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    )


def clean(value: float, scale: float) -> float:
    """A value for a table: 0 if it is only round-off beside `scale`."""
    return 0.0 if abs(value) <= ROUND_OFF * scale else value


def as_html(text: str) -> str:
    """A table as HTML, for notebooks."""
    return f"<pre>{html.escape(text)}</pre>"


def outcome_table(outcome: Outcome) -> str:
    """What a collision did, for people.

    Parameters
    ----------
    outcome : Outcome

    Returns
    -------
    str
        Bodies, contacts, energy, restitution and balances, and the sentences that go with them.

    Examples
    --------
    >>> import rodimpact as ri
    >>> left = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=1e-4, material=ri.materials.steel)
    >>> print(outcome_table(ri.collide(left, right)).splitlines()[2])
    1     rod  0.785 kg            0 m/s         0.4 m/s                 94.2 mJ
    """
    return "\n\n".join([*_tables(outcome), _sentences(outcome)])


def solution_table(solution: Solution) -> str:
    """What a collision did and how the run went, for people.

    Parameters
    ----------
    solution : Solution

    Returns
    -------
    str
        The tables of `outcome_table`, and when each contact pressed and opened.
    """
    outcome = solution.outcome
    run = [
        ["run to", format_si(solution.t_end, "s")],
        ["method", solution.method],
        ["events", str(solution.events)],
    ]
    blocks = [*_tables(outcome), *_episodes(solution), align(run), _sentences(outcome)]
    return "\n\n".join(blocks)


def ring_down_table(found: RingDown) -> str:
    """How vibration dies out, for people.

    Parameters
    ----------
    found : RingDown

    Returns
    -------
    str
    """
    def spell(seconds: float) -> str:
        return format_si(seconds, "s", 4) if seconds < math.inf else "never"

    first, last = float(found.vibration[0]), float(found.vibration[-1])
    return align([
        ["vibration when the collision is over", format_si(first, "J", 4)],
        ["vibration at the end", format_si(clean(last, first + found.rigid), "J", 4)],
        ["energy of the rigid motion", format_si(found.rigid, "J", 4)],
        ["energy of vibration falls to 1/e in", spell(found.decay_time)],
        [f"that of rod {found.body}'s mode of {format_si(found.frequency, 'Hz', 4)} in",
         spell(found.modal_decay_time)],
        ["read off the last third of", spell(float(found.times[-1] - found.times[0]))],
        ["momentum changed by, relative", _residual(found.momentum_change)],
    ])


def outcome_dict(outcome: Outcome) -> dict[str, Any]:
    """What a collision did, for programs: JSON-ready, SI units, full precision, None for null.

    Parameters
    ----------
    outcome : Outcome

    Returns
    -------
    dict
        With ``schema_version``; numbers that do not exist or are infinite are None, and
        ``restitution_undefined`` is then the reason.
    """
    return {"schema_version": SCHEMA_VERSION, **_outcome(outcome)}


def solution_dict(solution: Solution) -> dict[str, Any]:
    """What a collision did and how the run went, for programs; as `outcome_dict`.

    Parameters
    ----------
    solution : Solution

    Returns
    -------
    dict
        With ``schema_version``, the system, the outcome, and for each contact its episodes.
    """
    return {
        "schema_version": SCHEMA_VERSION,
        "system": solution.system.to_dict(),
        "method": solution.method,
        "outcome": _outcome(solution.outcome),
        "episodes": [
            [{name: _number(t) for name, t in episode._asdict().items()} for episode in c.episodes]
            for c in solution.contacts
        ],
        "final": solution.final,
        "stopped_by": solution.stopped_by,
        "status": solution.status,
        "t_end": solution.t_end,
        "t_final": _number(solution.t_final),
        "events": solution.events,
        "transit_error": solution.transit_error,
    }


def sweep_table(
    result: SweepResult, varied: Varied, more: str = "--csv prints all, --save keeps them"
) -> str:
    """What the collisions of a family did, for people.

    Parameters
    ----------
    result : SweepResult
    varied : sequence of (path, values, unit)
        What varies along each axis.
    more : str
        How to get at all members, where only some are listed.

    Returns
    -------
    str
        The grids, the extremes of e, all collisions or some, and why some have no e.
    """
    rows = [["varied", "values", "from", "to"]]
    rows += [
        [path, str(len(values)), format_si(values.min(), unit), format_si(values.max(), unit)]
        for path, values, unit in varied
    ]
    blocks = [align(rows), _extremes(result, varied), _members(result, varied, more)]
    return "\n\n".join([*blocks, *_missing(result, varied)])


def sweep_json(result: SweepResult, varied: Varied) -> Iterator[str]:
    """What the collisions of a family did, for programs: the lines of a JSON document.

    Parameters
    ----------
    result : SweepResult
    varied : sequence of (path, values, unit)
        What varies along each axis.

    Yields
    ------
    str
        Of an object with ``schema_version``, ``method``, ``shape``, ``varied`` and ``columns``. A
        column is a number that varies or a result: a list with one entry a collision, the last axis
        fastest, in SI units and full precision, with null for what does not exist.
    """
    from .sweeping import STATUS

    yield "{"
    for name, value in {
        "schema_version": SCHEMA_VERSION,
        "method": result.method,
        "shape": result.shape,
        "varied": [
            {"path": path, "unit": unit, "values": values.tolist()} for path, values, unit in varied
        ],
    }.items():
        yield f"{json.dumps(name)}: {json.dumps(value)},"
    yield '"columns": {'
    columns = {**result.parameters, **result.columns, "status": np.array(STATUS)[result.status]}
    for i, (name, column) in enumerate(columns.items(), 1):
        entries = [
            None if isinstance(entry, float) and not math.isfinite(entry) else entry
            for entry in np.broadcast_to(column, result.shape).ravel().tolist()
        ]
        yield f"{json.dumps(name)}: {json.dumps(entries)}" + "," * (i < len(columns))
    yield "}}"


def _tables(outcome: Outcome) -> list[str]:
    contacts = [_contacts(outcome)] if outcome.contacts else []
    return [_bodies(outcome), *contacts, _energy(outcome), _balances(outcome)]


def _bodies(o: Outcome) -> str:
    velocities = [*o.velocities_before, *o.velocities_after]
    largest = max(map(abs, velocities))
    spread = clean(max(velocities) - min(velocities), largest)
    common = math.floor(math.log10(largest / spread)) if spread > 0 else 0
    digits = min(6 + common, 15)  # so that the differences have six

    def velocity(v: float) -> str:
        return f"{clean(v, largest):.{digits}g} m/s"

    then = _then(o)
    rows = [["body", "", "mass", "velocity before", f"velocity {then}", f"vibration energy {then}"]]
    scale = _vibration_scale(o)
    for i, (kind, mass, before, after, vibration) in enumerate(zip(
        o.bodies, o.masses, o.velocities_before, o.velocities_after, o.vibration_after, strict=True
    )):
        rigid = mass == math.inf
        rows.append([
            str(i), kind, "-" if rigid else format_si(mass, "kg"), velocity(before),
            velocity(after), "-" if rigid else _joules(vibration, scale),
        ])
    return align(rows, left=(0, 1))


def _contacts(o: Outcome) -> str:
    rows = [["contact", "impulse", "peak force", "time under force", "episodes"]]
    scale = max(abs(c.impulse) for c in o.contacts)
    for i, c in enumerate(o.contacts):
        name, impulse = f"{i}-{i + 1}", format_si(clean(c.impulse, scale), "N s")
        if i in o.unilateral:
            force, time = format_si(c.peak_force, "N"), format_si(c.duration, "s")
            rows.append([name, impulse, force, time, str(c.episodes)])
        else:
            rows.append([f"{name} bonded", impulse, "-", "-", "-"])
    return align(rows)


def _energy(o: Outcome) -> str:
    vibration = sum(o.vibration_before), sum(o.vibration_after)
    total = o.kinetic_before + vibration[0], o.kinetic_after + vibration[1] + o.contact_energy
    scale, inner = max(total), _vibration_scale(o)

    def row(name: str, before: float, after: float, scale: float) -> list[str]:
        return [name, _joules(before, scale), _joules(after, scale)]

    rows = [
        ["energy", "before", _then(o)],
        row("moving as a whole", o.kinetic_before, o.kinetic_after, scale),
        row("vibration and strain", *vibration, inner),
    ]
    if o.contact_energy:
        rows.append(["in compliant contacts", "", _joules(o.contact_energy, scale)])
    rows.append(row("total", *total, scale))
    scale = max(scale, *(abs(value) for _, value in _exchanges(o)))
    rows += [[name, "", _joules(value, scale)]
             for name, value in _exchanges(o) if clean(value, scale)]
    return align(rows)


def _exchanges(o: Outcome) -> list[tuple[str, float]]:
    """Works and losses between before and after, J."""
    return [
        ("work of moving walls", o.wall_work), ("work of driven ends", o.drive_work),
        ("work of gravity", o.gravity_work), ("lost in contacts", o.dissipated),
        ("lost in material", o.damped), ("lost to the time step", o.numerical),
        ("radiated", o.radiated),
    ]


def _balances(o: Outcome) -> str:
    e = "-" if o.why_no_restitution() else f"{clean(o.restitution, 1.0):.9g}"
    return align([
        ["coefficient of restitution e", e],
        ["momentum balance, relative error", _residual(o.momentum_residual)],
        ["energy balance, relative error", _residual(o.energy_residual)],
    ])


def _residual(value: float) -> str:
    return "below 1e-15" if abs(value) < 1e-15 else f"{abs(value):.2g}"


def _episodes(solution: Solution) -> list[str]:
    found: list[tuple[int, Episode]] = [
        (contact.index, episode) for contact in solution.contacts for episode in contact.episodes
    ]
    if not found:
        return []
    rows = [["contact", "force from", "force ends", "gap opens"]]
    rows += [[f"{i}-{i + 1}", *(format_si(t, "s") for t in e)] for i, e in found[:MOST_EPISODES]]
    hidden = len(found) - MOST_EPISODES
    return [align(rows) + (f"\n... and {hidden} more" if hidden > 0 else "")]


def _sentences(o: Outcome) -> str:
    reason = o.why_no_restitution()
    said = [reason[:1].upper() + reason[1:]] if reason else []
    if o.status not in reason:
        said.append(o.status)
    return "\n".join(text if text.endswith(".") else f"{text}." for text in said)


def _then(o: Outcome) -> str:
    return "after" if o.final else "at the end"


def _vibration_scale(o: Outcome) -> float:
    """Energy of the motion of the bodies relative to each other."""
    velocities = o.velocities_before
    spread = max(velocities) - min(velocities)
    mass = sum(m for m in o.masses if m < math.inf)
    return mass * spread * spread / 2 + sum(o.vibration_before)


def _joules(value: float, scale: float) -> str:
    return format_si(clean(value, scale), "J")


def _number(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _outcome(o: Outcome) -> dict[str, Any]:
    bodies = zip(
        o.bodies, o.masses, o.velocities_before, o.velocities_after,
        o.vibration_before, o.vibration_after, strict=True,
    )
    names = (
        "mass", "velocity_before", "velocity_after", "vibration_before", "vibration_after",
    )
    reason = o.why_no_restitution()
    return {
        "bodies": [
            {"kind": kind, **dict(zip(names, map(_number, numbers), strict=True))}
            for kind, *numbers in bodies
        ],
        "contacts": [
            {
                "left": i, "right": i + 1, "bonded": i not in o.unilateral,
                **{name: _number(value) if i in o.unilateral or name == "impulse" else None
                   for name, value in c._asdict().items()},
            }
            for i, c in enumerate(o.contacts)
        ],
        "restitution": None if reason else _number(o.restitution),
        "restitution_undefined": reason or None,
        "kinetic_before": _number(o.kinetic_before),
        "kinetic_after": _number(o.kinetic_after),
        "contact_energy": _number(o.contact_energy),
        "dissipated": _number(o.dissipated),
        "damped": _number(o.damped),
        "numerical": _number(o.numerical),
        "radiated": _number(o.radiated),
        "wall_work": _number(o.wall_work),
        "drive_work": _number(o.drive_work),
        "gravity_work": _number(o.gravity_work),
        "momentum_residual": _number(o.momentum_residual),
        "energy_residual": _number(o.energy_residual),
        "final": o.final,
        "status": o.status,
    }


def _extremes(result: SweepResult, varied: Varied) -> str:
    shape = " x ".join(map(str, result.shape))
    where = f"in a grid of {shape}" if shape else ""
    rows = [["collisions", str(result.restitution.size), where]]
    for name, extreme in (("smallest", np.fmin), ("largest", np.fmax)):
        e = extreme.reduce(result.restitution, axis=None)
        if not math.isnan(e):
            where = _where(_first(result.restitution == e), varied)
            rows.append([f"{name} coefficient of restitution e", f"{clean(e, 1.0):.9g}", where])
    return align(rows, left=(0, 2))


def _members(result: SweepResult, varied: Varied, more: str) -> str:
    """All collisions of a small family, some of a large one."""
    count = result.restitution.size
    shown = range(count) if count <= MOST_MEMBERS else [
        round(i * (count - 1) / (SOME_MEMBERS - 1)) for i in range(SOME_MEMBERS)
    ]
    laws = result.system.contacts
    pairs = [k for k, law in enumerate(laws) if not isinstance(law, Bonded)]
    bodies = list(range(len(result.system.bodies)))
    if len(bodies) > MOST_BODIES:
        bodies = bodies[: MOST_BODIES // 2] + bodies[-MOST_BODIES // 2 :]
    names = (
        ["e", "impulse", "peak force", "time under force", "episodes"] if len(pairs) == 1
        else [f"velocity {i} after" for i in bodies]
    )
    rows = [[*(path for path, _, _ in varied), *names, "vibration energy"]]
    for flat in shown:
        index = np.unravel_index(flat, result.shape)
        where = [
            format_si(values[i], unit) for i, (_, values, unit) in zip(index, varied, strict=True)
        ]
        if len(pairs) == 1:
            c = result.contacts[pairs[0]]
            cells = [
                _digits(result.restitution[index], 1.0),
                format_si(c.impulse[index], "N s"), format_si(c.peak_force[index], "N"),
                format_si(c.duration[index], "s"),
                "-" if math.isnan(c.impulse[index]) else str(c.episodes[index]),
            ]
        else:
            velocities = [result.velocities_after[i][index] for i in bodies]
            scale = max(map(abs, velocities))
            cells = [_digits(v, scale, " m/s") for v in velocities]
        rows.append([*where, *cells, _joules(result.vibration[index], _scale(result, index))])
    table = align(rows, left=())
    if len(shown) < count:
        table += f"\n... {len(shown)} of {count}; {more}"
    return table


def _scale(result: SweepResult, index: Any) -> float:
    """Energy of the motion of the bodies of a member relative to each other, or more."""
    masses = [body.mass for body in result.system[index].bodies if isinstance(body, Rod)]
    velocities = [v[index] for v in result.velocities_after]
    spread = max(velocities) - min(velocities)
    push = sum(abs(contact.impulse[index]) for contact in result.contacts)
    return float(sum(masses) * spread * spread / 2 + push * push / (2 * min(masses)))


def _digits(value: float, scale: float, unit: str = "") -> str:
    return "-" if math.isnan(value) else f"{clean(value, scale):.6g}{unit}"


def _missing(result: SweepResult, varied: Varied) -> list[str]:
    """How many have no e, and why: a sentence for each kind."""
    missing = np.isnan(result.restitution)
    met = sum(contact.episodes for contact in result.contacts) > 0
    said = []
    for code in np.unique(result.status[missing]):
        for which in (met, ~met):
            kind = missing & (result.status == code) & which
            if kind.any():
                index = _first(kind)
                count = int(np.count_nonzero(kind))
                have = "1 collision has" if count == 1 else f"{count} collisions have"
                reason = result.explain(index).removesuffix(".")
                said.append(f"{have} no e. At {_where(index, varied)}: {reason}.")
    return ["\n".join(said)] if said else []


def _first(which: Any) -> Any:
    return np.unravel_index(np.argmax(which), which.shape)


def _where(index: Any, varied: Varied) -> str:
    return ", ".join(
        f"{path} = {format_si(values[i], unit)}"
        for i, (path, values, unit) in zip(index, varied, strict=True)
    )
