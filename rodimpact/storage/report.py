"""Outcomes, solutions and ring-downs as tables for people and as JSON for programs.

JSON has all digits of a number, and null for a number that does not exist.
"""

import math
from dataclasses import fields
from typing import Any

from ..model import Rod, Soil
from ..model.laws import SmithToe
from ..model.numbering import body_names, contact_names
from ..units import format_si
from .tables import align, joules, versioned_json, without_round_off

MAX_LISTED_EPISODES = 12
"""Largest number of first episodes in a table, and of last episodes below them."""
ENERGY_LABELS = {
    "kinetic": "moving as a whole",
    "vibrational_kinetic": "vibration, kinetic part",
    "strain": "strain energy",
    "inner": "vibration",
    "contact": "in compliant contacts",
    "dissipated": "lost in contacts",
    "damped": "lost in material",
    "soil_work": "taken by soil",
    "drag_work": "lost to drag",
    "numerical": "lost to the grid",
    "radiated": "gone through absorbing ends",
}
"""Labels of the entries of an energy ledger, in tables, figures and the page."""
LOSSES = (
    "dissipated",
    "damped",
    "soil_work",
    "drag_work",
    "numerical",
    "radiated",
)
"""Entries of the energy that leaves the bodies and their contacts."""


def outcome_table(outcome: Any) -> str:
    """Outcome of a collision as tables of text, for people.

    Parameters
    ----------
    outcome : Outcome

    Returns
    -------
    str
        Tables of bodies, contacts, energies, and restitution with balances; then
        sentences on why there is no restitution, and why the run ended.

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
    """Outcome of a collision and course of its run as tables of text, for people.

    Parameters
    ----------
    solution : Solution

    Returns
    -------
    str
        The tables of `outcome_table`; the times at which each contact pressed and
        opened, if any did; for a pile in soil its permanent set and largest stresses;
        end, method and events of the run; and the sentences of `outcome_table`.
    """
    outcome = solution.outcome
    run = [
        ["run to", format_si(solution.t_end, "s")],
        ["method", solution.method],
        ["events", str(solution.events)],
    ]
    # t_final: 0 if nothing collides, inf if a contact presses forever, nan if unknown
    if 0 < solution.t_final < math.inf:
        # The first line of the table
        run.insert(0, ["last contact ended at", format_si(solution.t_final, "s")])
    blocks = _tables(outcome)
    episodes = _episodes_table(solution)
    if episodes:
        blocks.append(episodes)
    if _is_in_soil(solution.system):
        blocks.append(_pile_table(solution))
    blocks += [align(run), _sentences(outcome)]
    return "\n\n".join(blocks)


def _is_in_soil(system: Any) -> bool:
    """Whether soil acts along a rod or below the toe of a pile."""
    for body in system.bodies:
        if isinstance(getattr(body, "shaft", None), Soil):
            return True
    return any(isinstance(law, SmithToe) for law in system.contacts)


def _pile_table(solution: Any) -> str:
    """Table of the permanent set of each toe and the largest stresses in each rod.

    The largest compression and the largest tension are listed with position and time;
    "none" if the rod was never under compression or tension.
    """
    system = solution.system
    rows = []
    pairs = contact_names(system.kinds)  # such as "1-2"
    for contact, pair in zip(solution.contacts, pairs, strict=True):
        if isinstance(contact.law, SmithToe):
            permanent = format_si(contact.permanent_set(), "m")
            # The columns of position and time are empty.
            rows.append([f"permanent set, contact {pair}", permanent, "", ""])
    names = body_names(system.kinds)
    for i, body in enumerate(system.bodies):
        if not isinstance(body, Rod):
            continue
        extreme = solution.extreme_stress(i)
        peaks = {"compression": extreme.compression, "tension": extreme.tension}
        for sign, peak in peaks.items():
            label = f"largest {sign} in {names[i]}"
            if peak.stress == 0:
                rows.append([label, "none", "", ""])
                continue
            stress = format_si(abs(peak.stress), "Pa")
            place = format_si(peak.x, "m")
            time = format_si(peak.t, "s")
            rows.append([label, stress, f"at {place}", f"after {time}"])
    return align(rows)


def ring_down_table(ring_down: Any) -> str:
    """Decay of the vibration as a table of text, for people.

    Parameters
    ----------
    ring_down : RingDown

    Returns
    -------
    str
        Energies, times and the relative error of the momentum; "never" stands for an
        infinite time.
    """
    first = float(ring_down.vibration[0])
    last = float(ring_down.vibration[-1])
    lasted = float(ring_down.times[-1] - ring_down.times[0])
    frequency = format_si(ring_down.frequency, "Hz", digits=4)
    # An energy below the round-off of this scale, J, is shown as 0.
    scale = first + ring_down.rigid
    last_shown = format_si(without_round_off(last, scale), "J", digits=4)
    rows = [
        ["vibration when the collision is over", format_si(first, "J", digits=4)],
        ["vibration at the end", last_shown],
        ["energy of the rigid motion", format_si(ring_down.rigid, "J", digits=4)],
        ["time from then to the end", _duration(lasted)],
        [
            "vibration falls to 1/e in, by its last third",
            _duration(ring_down.decay_time),
        ],
        [
            f"the slowest to decay, {frequency}, falls to 1/e in",
            _duration(ring_down.modal_decay_time),
        ],
        ["momentum changed by, relative", _error_text(ring_down.momentum_change)],
    ]
    return align(rows)


def _duration(seconds: float) -> str:
    """A time in s as text with a unit; "never" for infinity or nan."""
    if seconds < math.inf:
        return format_si(seconds, "s", digits=4)
    return "never"


def solution_json(solution: Any) -> str:
    """Outcome of a collision and course of its run as JSON: SI units, all digits.

    Parameters
    ----------
    solution : Solution

    Returns
    -------
    str
        An object with ``schema_version``, ``system``, ``method``, ``outcome``,
        ``episodes`` of each contact, and the attributes of `Solution` on the run:
        ``final``, ``stopped_by``, ``status``, ``t_end``, ``t_final``, ``t_proved``,
        ``events`` and ``transit_error``. Numbers that do not exist or are infinite are
        null. In the outcome, ``restitution_undefined`` is the reason why there is no
        restitution; it is null if there is one.
    """
    episodes = []
    for contact in solution.contacts:
        episodes.append([episode._asdict() for episode in contact.episodes])
    return versioned_json(
        system=solution.system.to_dict(),
        method=solution.method,
        outcome=_outcome_entries(solution.outcome),
        episodes=episodes,
        final=solution.final,
        stopped_by=solution.stopped_by,
        status=solution.status,
        t_end=solution.t_end,
        t_final=solution.t_final,
        t_proved=solution.t_proved,
        events=solution.events,
        transit_error=solution.transit_error,
    )


def _tables(outcome: Any) -> list[str]:
    """Tables of bodies, contacts, energies and balances, each as text.

    The table of contacts is left out if there are none.
    """
    tables = [_bodies_table(outcome)]
    if outcome.contacts:
        tables.append(_contacts_table(outcome))
    tables.append(_energy_table(outcome))
    tables.append(_balances_table(outcome))
    return tables


def _bodies_table(outcome: Any) -> str:
    """Table of masses, velocities and vibration energies of the bodies.

    Velocities have enough digits for six digits of their differences, but at most 15.
    The mass and the vibration energy of a wall are "-".
    """
    before = outcome.velocities_before
    after = outcome.velocities_after
    velocities = [*before, *after]
    largest = max(map(abs, velocities))
    spread = without_round_off(max(velocities) - min(velocities), scale=largest)
    digits = 6
    if spread > 0:
        # The first digits, in which all velocities agree, are added to the six.
        digits += math.floor(math.log10(largest / spread))
    digits = min(digits, 15)
    then = _then(outcome)
    # An energy below the round-off of this scale, J, is shown as 0.
    vibration_scale = _vibration_scale(outcome)
    head = ["body", "mass", "velocity before"]
    head += [f"velocity {then}", f"vibration energy {then}"]
    rows = [head]
    for i, name in enumerate(body_names(outcome.bodies)):
        mass = "-"
        vibration = "-"
        is_wall = outcome.masses[i] == math.inf
        if not is_wall:
            mass = format_si(outcome.masses[i], "kg")
            vibration = joules(outcome.vibration_after[i], vibration_scale)
        row = [name, mass]
        for velocity in (before[i], after[i]):
            row.append(f"{without_round_off(velocity, scale=largest):.{digits}g} m/s")
        rows.append([*row, vibration])
    return align(rows)


def _contacts_table(outcome: Any) -> str:
    """Table of the totals of the contacts; there must be one or more contacts.

    A joined pair is marked "joined"; all its totals except the impulse are "-".
    """
    rows = [["contact", "impulse", "peak force", "force duration", "episodes"]]
    scale = max(abs(tally.impulse) for tally in outcome.contacts)
    names = contact_names(outcome.bodies)
    for k, tally in enumerate(outcome.contacts):
        impulse = format_si(without_round_off(tally.impulse, scale), "N s")
        if k in outcome.unilateral:
            force = format_si(tally.peak_force, "N")
            duration = format_si(tally.duration, "s")
            rows.append([names[k], impulse, force, duration, str(tally.episodes)])
        else:
            rows.append([f"{names[k]} joined", impulse, "-", "-", "-"])
    return align(rows)


def _energy_table(outcome: Any) -> str:
    """Table of the energies before and after, then of the work done and energy lost.

    Contact energy, works and losses are left out if they are 0. The total is the sum of
    kinetic, vibration and contact energy.
    """
    vibration_label = ENERGY_LABELS["inner"]
    # (energy before, energy after), J, by label
    pairs: dict[str, tuple[float, float]] = {
        ENERGY_LABELS["kinetic"]: (outcome.kinetic_before, outcome.kinetic_after),
        vibration_label: (sum(outcome.vibration_before), sum(outcome.vibration_after)),
    }
    contact_energies = (outcome.contact_energy_before, outcome.contact_energy)
    if any(contact_energies):
        pairs[ENERGY_LABELS["contact"]] = contact_energies
    total_before = sum(before for before, _ in pairs.values())
    total_after = sum(after for _, after in pairs.values())
    pairs["total"] = (total_before, total_after)
    # An energy below the round-off of its scale, J, is shown as 0.
    total_scale = max(total_before, total_after)
    rows = [["energy", "before", _then(outcome)]]
    for name, (before, after) in pairs.items():
        scale = total_scale
        if name == vibration_label:
            scale = _vibration_scale(outcome)
        rows.append([name, joules(before, scale), joules(after, scale)])
    exchanged = {
        "work of moving walls": outcome.wall_work,
        "work of driven ends": outcome.drive_work,
        "work of gravity": outcome.gravity_work,
    }
    for name in LOSSES:
        exchanged[ENERGY_LABELS[name]] = getattr(outcome, name)
    exchanged_scale = max(total_scale, *map(abs, exchanged.values()))
    for name, energy in exchanged.items():
        is_zero = without_round_off(energy, exchanged_scale) == 0
        if not is_zero:
            # The column "before" is empty.
            rows.append([name, "", joules(energy, exchanged_scale)])
    return align(rows)


def _balances_table(outcome: Any) -> str:
    """Table of e, "-" if it is undefined, and the relative errors of both balances."""
    restitution = "-"
    is_defined = outcome.why_no_restitution() == ""
    if is_defined:
        restitution = f"{without_round_off(outcome.restitution, scale=1.0):.9g}"
    rows = [
        ["coefficient of restitution e", restitution],
        ["momentum balance, relative error", _error_text(outcome.momentum_residual)],
        ["energy balance, relative error", _error_text(outcome.energy_residual)],
    ]
    return align(rows)


def _error_text(value: float) -> str:
    """Absolute value of a relative error with two digits, or "below 1e-15"."""
    if abs(value) < 1e-15:
        return "below 1e-15"
    return f"{abs(value):.2g}"


def _episodes_table(solution: Any) -> str:
    """Table of the times of episodes, contact by contact; "" if there are none.

    The first `MAX_LISTED_EPISODES` episodes are listed. A line then gives the number of
    episodes that are left out, and the last episode of each contact with several
    follows: a ball that bounces comes to rest in its last episode.
    """
    names = contact_names(solution.system.kinds)
    rows = []
    # Last episodes of those contacts whose last episode is not among the first rows
    last_rows = []
    for contact in solution.contacts:
        for episode in contact.episodes:
            # The fields of an episode are three times, in the order of the head below.
            times = [format_si(t, "s") for t in episode]
            rows.append([names[contact.index], *times])
        if len(contact.episodes) > 1 and len(rows) > MAX_LISTED_EPISODES:
            last_rows.append(rows[-1])
    if not rows:
        return ""
    head = ["contact", "force from", "force ends", "gap opens"]
    first_rows = rows[:MAX_LISTED_EPISODES]
    last_rows = last_rows[:MAX_LISTED_EPISODES]
    lines = align([head, *first_rows, *last_rows]).splitlines()
    hidden = len(rows) - len(first_rows) - len(last_rows)
    if hidden > 0:
        note = f"... and {hidden} more"
        if last_rows:
            note += "; the last ones of contacts are:"
        lines.insert(1 + MAX_LISTED_EPISODES, note)  # below the head and the first rows
    return "\n".join(lines)


def _sentences(outcome: Any) -> str:
    """Sentences on why there is no restitution, and why the run ended, one per line.

    The first is left out if there is a restitution. The second is left out if the first
    contains it.
    """
    sentences = []
    reason = outcome.why_no_restitution()
    if reason:
        sentences.append(reason[:1].upper() + reason[1:])  # with a capital letter
    if outcome.status not in reason:  # `reason` is "" if there is a restitution
        sentences.append(outcome.status)
    return "\n".join(f"{sentence.removesuffix('.')}." for sentence in sentences)


def _then(outcome: Any) -> str:
    """Head of the second column: "after" the collision, or "at the end" of the run."""
    if outcome.final:
        return "after"
    return "at the end"


def _vibration_scale(outcome: Any) -> Any:
    """Scale of vibration energies, J: an energy below its round-off is shown as 0.

    It is m dv^2/2 plus the vibration energy before the collision. Here m is the mass of
    all bodies except walls, and dv the largest difference of the velocities before.
    """
    velocities = outcome.velocities_before
    spread = max(velocities) - min(velocities)
    mass = sum(mass for mass in outcome.masses if mass < math.inf)  # not of walls
    return mass * spread * spread / 2 + sum(outcome.vibration_before)


def _outcome_entries(outcome: Any) -> dict[str, Any]:
    """Entries of an outcome for JSON, by name; numbers in SI units.

    They are `bodies` and `contacts`, lists of dicts; `restitution`, None if undefined;
    `restitution_undefined`, the reason for that or None; all fields of the type float,
    which are energies and residuals of the row; `final` and `status`. All totals of a
    joined pair (bond or joint) except the impulse are None.
    """
    bodies = []
    for i, kind in enumerate(outcome.bodies):
        body = {
            "kind": kind,
            "mass": outcome.masses[i],
            "velocity_before": outcome.velocities_before[i],
            "velocity_after": outcome.velocities_after[i],
            "vibration_before": outcome.vibration_before[i],
            "vibration_after": outcome.vibration_after[i],
        }
        bodies.append(body)
    contacts = []
    for k, tally in enumerate(outcome.contacts):
        joined = k not in outcome.unilateral
        contact: dict[str, Any] = {"left": k, "right": k + 1, "bonded": joined}
        contact.update(tally._asdict())
        if joined:
            # A joined pair has only an impulse, the first field of the totals.
            for name in tally._fields[1:]:
                contact[name] = None
        contacts.append(contact)
    reason = outcome.why_no_restitution()
    entries: dict[str, Any] = {"bodies": bodies, "contacts": contacts}
    if reason:
        entries["restitution"] = None
        entries["restitution_undefined"] = reason
    else:
        entries["restitution"] = outcome.restitution
        entries["restitution_undefined"] = None
    for field in fields(outcome):
        # `field.type` is a class, not a text, since the module of `Outcome` does not
        # defer the evaluation of annotations.
        if field.type is float:  # energies and residuals of the whole row
            entries[field.name] = getattr(outcome, field.name)
    entries["final"] = outcome.final
    entries["status"] = outcome.status
    return entries
