"""Outcomes, solutions and ring-downs as tables for people and as JSON for programs.

JSON gives every digit, and null where there is no such number.
"""

import math
from dataclasses import fields
from typing import Any

from ..model.numbering import body_names, contact_names
from ..units import format_si
from .tables import align, as_json, clean, joules

MOST_EPISODES = 12  # listed in a table
ENERGIES = {
    "kinetic": "moving as a whole",
    "vibrational_kinetic": "vibration",
    "strain": "strain",
    "inner": "vibration and strain",
    "contact": "in compliant contacts",
    "dissipated": "lost in contacts",
    "damped": "lost in material",
    "numerical": "lost to the grid",
    "radiated": "gone through absorbing ends",
}
"""What tables, figures and the page call the entries of an energy ledger."""


def outcome_table(outcome: Any) -> str:
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
    rod 2  0.785 kg            0 m/s         0.4 m/s                 94.2 mJ
    """
    return "\n\n".join([*_tables(outcome), _sentences(outcome)])


def solution_table(solution: Any) -> str:
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
    if 0 < solution.t_final < math.inf:
        run.insert(0, ["last contact ended at", format_si(solution.t_final, "s")])
    blocks = [*_tables(outcome), *_episodes(solution), align(run), _sentences(outcome)]
    return "\n\n".join(blocks)


def ring_down_table(found: Any) -> str:
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
    return align(
        [
            ["vibration when the collision is over", format_si(first, "J", 4)],
            [
                "vibration at the end",
                format_si(clean(last, first + found.rigid), "J", 4),
            ],
            ["energy of the rigid motion", format_si(found.rigid, "J", 4)],
            [
                "time from then to the end",
                spell(float(found.times[-1] - found.times[0])),
            ],
            ["vibration falls to 1/e in, by its last third", spell(found.decay_time)],
            [
                f"the slowest to decay, {format_si(found.frequency, 'Hz', 4)}, falls to 1/e in",
                spell(found.modal_decay_time),
            ],
            ["momentum changed by, relative", _residual(found.momentum_change)],
        ]
    )


def solution_json(solution: Any) -> str:
    """What a collision did and how the run went, for programs: SI units, full precision.

    Parameters
    ----------
    solution : Solution

    Returns
    -------
    str
        With ``schema_version``, the system, the outcome, and for each contact its episodes. Numbers
        that do not exist or are infinite are null; where there is no restitution,
        ``restitution_undefined`` is the reason.
    """
    names = (
        "final",
        "stopped_by",
        "status",
        "t_end",
        "t_final",
        "t_proved",
        "events",
        "transit_error",
    )
    return as_json(
        system=solution.system.to_dict(),
        method=solution.method,
        outcome=_outcome(solution.outcome),
        episodes=[
            [episode._asdict() for episode in contact.episodes]
            for contact in solution.contacts
        ],
        **{name: getattr(solution, name) for name in names},
    )


def _tables(outcome: Any) -> list[str]:
    contacts = [_contacts(outcome)] if outcome.contacts else []
    return [_bodies(outcome), *contacts, _energy(outcome), _balances(outcome)]


def _bodies(o: Any) -> str:
    velocities = [*o.velocities_before, *o.velocities_after]
    largest = max(map(abs, velocities))
    spread = clean(max(velocities) - min(velocities), largest)
    common = math.floor(math.log10(largest / spread)) if spread > 0 else 0
    digits = min(6 + common, 15)  # so that the differences have six

    def velocity(v: float) -> str:
        return f"{clean(v, largest):.{digits}g} m/s"

    then, scale = _then(o), _vibration_scale(o)
    rows = [
        [
            "body",
            "mass",
            "velocity before",
            f"velocity {then}",
            f"vibration energy {then}",
        ]
    ]
    for name, mass, before, after, vibration in zip(
        body_names(o.bodies),
        o.masses,
        o.velocities_before,
        o.velocities_after,
        o.vibration_after,
        strict=True,
    ):
        rest = (
            ["-", "-"]
            if mass == math.inf
            else [format_si(mass, "kg"), joules(vibration, scale)]
        )
        rows.append([name, rest[0], velocity(before), velocity(after), rest[1]])
    return align(rows)


def _contacts(o: Any) -> str:
    rows = [["contact", "impulse", "peak force", "force duration", "episodes"]]
    scale = max(abs(c.impulse) for c in o.contacts)
    for i, (name, c) in enumerate(
        zip(contact_names(o.bodies), o.contacts, strict=True)
    ):
        impulse = format_si(clean(c.impulse, scale), "N s")
        if i in o.unilateral:
            force, time = format_si(c.peak_force, "N"), format_si(c.duration, "s")
            rows.append([name, impulse, force, time, str(c.episodes)])
        else:
            rows.append([f"{name} joined", impulse, "-", "-", "-"])
    return align(rows)


def _energy(o: Any) -> str:
    both: dict[str, tuple[float, ...]] = {
        ENERGIES["kinetic"]: (o.kinetic_before, o.kinetic_after),
        ENERGIES["inner"]: (sum(o.vibration_before), sum(o.vibration_after)),
        ENERGIES["contact"]: (o.contact_energy_before, o.contact_energy),
    }
    both["total"] = tuple(map(sum, zip(*both.values(), strict=True)))
    exchanged = {
        "work of moving walls": o.wall_work,
        "work of driven ends": o.drive_work,
        "work of gravity": o.gravity_work,
        **{
            ENERGIES[name]: getattr(o, name)
            for name in ("dissipated", "damped", "numerical", "radiated")
        },
    }
    scale = max(both["total"])
    scales = {ENERGIES["inner"]: _vibration_scale(o)}
    rows = [["energy", "before", _then(o)]]
    rows += [
        [name, *(joules(value, scales.get(name, scale)) for value in pair)]
        for name, pair in both.items()
        if name != ENERGIES["contact"] or any(pair)
    ]
    scale = max(scale, *map(abs, exchanged.values()))
    rows += [
        [name, "", joules(value, scale)]
        for name, value in exchanged.items()
        if clean(value, scale)
    ]
    return align(rows)


def _balances(o: Any) -> str:
    e = "-" if o.why_no_restitution() else f"{clean(o.restitution, 1.0):.9g}"
    return align(
        [
            ["coefficient of restitution e", e],
            ["momentum balance, relative error", _residual(o.momentum_residual)],
            ["energy balance, relative error", _residual(o.energy_residual)],
        ]
    )


def _residual(value: float) -> str:
    return "below 1e-15" if abs(value) < 1e-15 else f"{abs(value):.2g}"


def _episodes(solution: Any) -> list[str]:
    names = contact_names(solution.system.kinds)
    rows = [
        [names[contact.index], *(format_si(t, "s") for t in episode)]
        for contact in solution.contacts
        for episode in contact.episodes
    ]
    hidden = len(rows) - MOST_EPISODES
    table = align(
        [["contact", "force from", "force ends", "gap opens"], *rows[:MOST_EPISODES]]
    )
    return [table + (f"\n... and {hidden} more" if hidden > 0 else "")] if rows else []


def _sentences(o: Any) -> str:
    reason = o.why_no_restitution()
    said = [reason[:1].upper() + reason[1:]] if reason else []
    if o.status not in reason:
        said.append(o.status)
    return "\n".join(text if text.endswith(".") else f"{text}." for text in said)


def _then(o: Any) -> str:
    return "after" if o.final else "at the end"


def _vibration_scale(o: Any) -> Any:
    """Energy of the motion of the bodies relative to each other."""
    velocities = o.velocities_before
    spread = max(velocities) - min(velocities)
    mass = sum(m for m in o.masses if m < math.inf)
    return mass * spread * spread / 2 + sum(o.vibration_before)


def _outcome(o: Any) -> dict[str, Any]:
    reason = o.why_no_restitution()
    bodies = {
        "kind": o.bodies,
        "mass": o.masses,
        "velocity_before": o.velocities_before,
        "velocity_after": o.velocities_after,
        "vibration_before": o.vibration_before,
        "vibration_after": o.vibration_after,
    }
    contacts = [
        {
            "left": i,
            "right": i + 1,
            "bonded": i not in o.unilateral,
            **{
                name: value if i in o.unilateral or name == "impulse" else None
                for name, value in c._asdict().items()
            },
        }
        for i, c in enumerate(o.contacts)
    ]
    return {
        "bodies": [
            dict(zip(bodies, numbers, strict=True))
            for numbers in zip(*bodies.values(), strict=True)
        ],
        "contacts": contacts,
        "restitution": None if reason else o.restitution,
        "restitution_undefined": reason or None,
        **{of.name: getattr(o, of.name) for of in fields(o) if of.type is float},
        "final": o.final,
        "status": o.status,
    }
