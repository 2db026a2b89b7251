"""Why a collision ends as it does: two sentences, from the contact events of its run.

Plain Python, which the page has as JavaScript.
"""

from __future__ import annotations

from bisect import bisect_right
from typing import Any

from ..storage.tables import clean
from .texts import capital, name_of, numbers_of, written

SMALL = 1e-6  # of the peak force, the largest gap or the time since the first touch: none
MOST = 0.99  # of an impulse


def reason_of(known: Any, e: str) -> list[str]:
    """What happened, and what it comes to.

    Parameters
    ----------
    known : dict
        As of `picture`.
    e : str
        The coefficient of restitution as it is written; "" if there is none.
    """
    outcome = known["outcome"]
    forces, gaps = series_of_contacts(known)
    pressed = [i for i in outcome["able"] if outcome["contacts"][i]["episodes"] > 0]
    if len(pressed) == 0:
        happened = "No contact that can open presses."
    elif len(outcome["able"]) > 1:
        happened = of_chain(known, pressed, forces, gaps)
    else:
        happened = of_contact(known, pressed[0], forces, gaps)
    if not outcome["final"]:
        happened = f"{happened} {known['notes'][0]}"
    return [happened, result_of(known, pressed, e)]


# What happened ------------------------------------------------------------------------------------


def series_of_contacts(known: Any) -> Any:
    """Force and gap over time of each contact; the gap of one that cannot open is None."""
    forces, gaps = known["plots"][0]["series"], [None for _ in known["contacts"]]
    found = [contact["index"] for contact in known["contacts"] if not contact["bonded"]]
    for i, gap in zip(found, known["plots"][1]["series"], strict=True):
        gaps[i] = gap
    return forces, gaps


def value_at(series: Any, t: float) -> float:
    """Value of a curve at a time."""
    times, y = series["t"], series["y"]
    i = bisect_right(times, t) - 1
    if i < 0:
        return float(y[0])
    if i == len(times) - 1:
        return float(y[i])
    return float(y[i] + (y[i + 1] - y[i]) * (t - times[i]) / (times[i + 1] - times[i]))


def spells_of(force: Any, gap: Any) -> list[Any]:
    """Spells in which a contact is "open", "touching" or "pressing": state, `from` and `to`, s."""
    weak, narrow, before = 0.0, 0.0, force["t"][0]
    for y in force["y"]:
        weak = max(weak, SMALL * abs(y))
    for y in gap["y"] if gap is not None else []:
        narrow = max(narrow, SMALL * abs(y))
    spells: list[Any] = []
    for t in sorted([*force["t"], *(gap["t"] if gap is not None else [])]):
        middle, state = (before + t) / 2, "touching"
        if abs(value_at(force, middle)) > weak:
            state = "pressing"
        elif gap is not None and value_at(gap, middle) > narrow:
            state = "open"
        if t > before and len(spells) > 0 and spells[-1]["state"] == state:
            spells[len(spells) - 1]["to"] = t
        elif t > before:
            spells.append({"from": before, "to": t, "state": state})
        before = t
    return spells


def pair_of(known: Any, i: int) -> str:
    """The bodies of a contact."""
    numbers = numbers_of(known["bodies"])
    left, right = [name_of(known["bodies"][k]["kind"], numbers[k]) for k in (i, i + 1)]
    return f"{left} and {right}"


def of_chain(known: Any, pressed: list[int], forces: Any, gaps: Any) -> str:
    """The first and the last of several contacts."""
    first, last, begun, ended = pressed[0], pressed[0], -1.0, -1.0
    for i in pressed:
        for spell in spells_of(forces[i], gaps[i]):
            if spell["state"] == "pressing" and (begun < 0 or spell["from"] < begun):
                first, begun = i, spell["from"]
            if spell["state"] == "pressing" and spell["to"] > ended:
                last, ended = i, spell["to"]
    return (f"The first contact to press is that of {pair_of(known, first)}, at "
            f"{written(begun, 's', 4)}; the last force, between {pair_of(known, last)}, ends at "
            f"{written(ended, 's', 4)}.")


def of_contact(known: Any, i: int, forces: Any, gaps: Any) -> str:
    """How the force of the only contact that can open begins, falls and ends."""
    spells = spells_of(forces[i], gaps[i])
    presses = [spell for spell in spells if spell["state"] == "pressing"]
    if len(presses) == 0:
        return "The contact presses for too short a time to be shown."
    begun, ended = presses[0]["from"], presses[-1]["to"]
    lasted, wall = ended - begun, any(body["kind"] == "wall" for body in known["bodies"][i : i + 2])
    puller = "a wall" if wall else "a contact"
    if spells[-1]["state"] == "pressing":
        text = f"{capital(pair_of(known, i))} press to the end of the run"
    elif not known["exact"]:
        if len(presses) == 1:  # samples know it less well
            lasted = known["outcome"]["contacts"][i]["duration"]
        text = f"The force has fallen to zero {written(lasted, 's', 4)} after the first touch"
        end = "; no single wave ends it" if known["contacts"][i]["compliant"] else ""
        most = time_of_most(forces[i]) - begun
        early = f"; {100 * MOST:.3g} % of the impulse came in the first {written(most, 's', 4)}"
        text = f"{text}{in_transits(known, i, lasted)}{end}{early if most < 0.75 * lasted else ''}"
    elif any(spell["state"] == "open" and begun < spell["from"] < ended for spell in spells):
        text = f"{capital(pair_of(known, i))} part and meet again; the last force ends at "
        text = f"{text}{written(ended, 's', 4)}"
    else:
        falls = falls_of(forces[i], begun, ended)
        text = f"{returning(known, i, lasted)} and the force ends, since {puller} cannot pull"
        if len(falls) > 0:
            when, share = falls[0]
            more = "" if len(falls) == 1 else ", and so do later waves"
            text = (f"{returning(known, i, when - begun)} and lowers the force to {share:.3g} "
                    f"times its value{more}; contact goes on. {text}")
    opened = spells[-1]["from"] if known["exact"] and spells[-1]["state"] == "open" else -1.0
    if opened > ended + SMALL * lasted:
        text = f"{text}; the faces touch without force until they part at {written(opened, 's', 4)}"
    return f"{text}."


def time_of_most(force: Any) -> float:
    """When `MOST` of the impulse of a force has come: a stiff contact has a long weak tail."""
    times, y = force["t"], force["y"]
    sums = [0.0]
    for k in range(1, len(times)):
        sums.append(sums[k - 1] + (y[k] + y[k - 1]) * (times[k] - times[k - 1]) / 2)
    k = bisect_right(sums, MOST * sums[len(sums) - 1])
    return float(times[min(k, len(times) - 1)])


def falls_of(force: Any, begun: float, ended: float) -> list[Any]:
    """When a force falls while it presses on, and to which share of its value before."""
    found, y = [], force["y"]
    for k, t in enumerate(force["t"]):
        inside = begun + SMALL * (ended - begun) < t < ended - SMALL * (ended - begun)
        if inside and y[k] < (1 - SMALL) * y[k - 1]:
            found.append((t, y[k] / y[k - 1]))
    return found


def returning(known: Any, i: int, after: float) -> str:
    """Whose wave is back so long after the first touch of a contact."""
    numbers, whose = numbers_of(known["bodies"]), []
    for k in (i, i + 1):
        body = known["bodies"][k]
        if len(body["pieces"]) == 1:
            trips = after / (2 * body["pieces"][0]["transit_time"])
            if round(trips) > 0 and abs(trips - round(trips)) < SMALL:
                whose.append((round(trips), f"{capital(name_of(body['kind'], numbers[k]))}'s wave"))
    time = written(after, "s", 4)
    if len(whose) == 2 and whose[0][0] == 1 and whose[1][0] == 1:
        return f"Each rod's wave returns after {time}"
    if len(whose) == 0:
        return f"After {time} a wave arrives"
    trips, wave = whose[0]
    if len(whose) == 2 and whose[1][0] < trips:
        trips, wave = whose[1]
    return f"{wave} returns after {time}" if trips == 1 else (
        f"{wave} returns after {trips} round trips, {time},")


def in_transits(known: Any, i: int, lasted: float) -> str:
    """A duration in transit times of the rod beside a contact that has the shortest."""
    numbers, shortest, found = numbers_of(known["bodies"]), 0.0, ""
    for k in (i, i + 1):
        time = 0.0
        for piece in known["bodies"][k]["pieces"]:
            time += piece["transit_time"]
        if time > 0 and (shortest == 0 or time < shortest):
            name = name_of(known["bodies"][k]["kind"], numbers[k])
            shortest, found = time, f", {lasted / time:.3g} transit times of {name}"
    return found


# What it comes to ---------------------------------------------------------------------------------


def result_of(known: Any, pressed: list[int], e: str) -> str:
    """The impulse, the velocities that it leaves, e, and the share of vibration."""
    outcome, said, kinetic, fastest = known["outcome"], [], 0.0, 0.0
    for v in [*outcome["before"], *outcome["after"]]:
        fastest = max(fastest, abs(v))
    for i, body in enumerate(known["bodies"]):
        mass, v = body["mass"] if body["kind"] == "mass" else 0.0, outcome["after"][i]
        for piece in body["pieces"]:
            mass += piece["mass"]
        kinetic += mass * v * v / 2
        if body["kind"] != "wall":
            said.append(f"{clean(v, fastest):.4g} m/s")
    last, energy = said[-1], kinetic + outcome["vibration_after"]
    speeds = last if len(said) == 1 else f"{', '.join(said[:len(said) - 1])} and {last}"
    word = "velocity" if len(said) == 1 else "velocities"
    if len(pressed) == 1 and len(outcome["able"]) == 1:
        impulse = written(outcome["contacts"][pressed[0]]["impulse"], "N s", 4)
        text = f"The impulse of {impulse} changes the mean {word} to {speeds}"
        if e != "":
            text = f"{text}, so e = {e}{ratio_named(known)}"
    else:
        when = "after the collision" if outcome["final"] else "at the end of the run"
        text = f"The mean {word} {when}: {speeds}"
    if energy <= 0:
        return f"{text}."
    share = clean(100 * outcome["vibration_after"] / energy, 100.0)
    return f"{text}; {share:.3g} % of the energy is vibration."


def ratio_named(known: Any) -> str:
    """The ratio of lengths or transit times that e is; "" where e is none.

    Two uniform rods of one impedance, in rigid contact and without vibration before.
    """
    bodies, times, speeds, impedances = known["bodies"], [], [], []
    for body in bodies:
        if len(bodies) == 2 and len(body["pieces"]) == 1 and body["approach"] is not None:
            piece = body["pieces"][0]
            times.append(piece["transit_time"])
            speeds.append(piece["wave_speed"])
            impedances.append(piece["density"] * piece["wave_speed"] * piece["areas"][0])
    if len(times) != 2 or known["contacts"][0]["compliant"]:
        return ""
    short, long = ("₁", "₂") if times[0] <= times[1] else ("₂", "₁")
    ratio = min(times[0], times[1]) / max(times[0], times[1])
    same = abs(impedances[0] / impedances[1] - 1) < SMALL
    if not same or abs(known["outcome"]["restitution"] - ratio) > SMALL:
        return ""
    letter = "l" if abs(speeds[0] / speeds[1] - 1) < SMALL else "T"
    return f" = {letter}{short}/{letter}{long}"
