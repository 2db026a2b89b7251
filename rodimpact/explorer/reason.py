"""Why a collision ends as it does: two sentences, from the contact events of its run.

Plain Python, which the page has as JavaScript.
"""

from bisect import bisect_right
from typing import Any

from ..storage.tables import clean
from .texts import capital, written

SMALL = (
    1e-6  # of the peak force, the largest gap or the time since the first touch: none
)
MOST = 0.99  # of an impulse


def reason_of(known: Any, e: str) -> list[str]:
    """What happened, and what it comes to.

    Parameters
    ----------
    known : dict
        What `picture` was given, with the ``bodies`` and ``contacts`` that it shows.
    e : str
        The coefficient of restitution as it is written; "" if there is none.
    """
    outcome = known["outcome"]
    pressed = [
        known["contacts"][i]
        for i in outcome["able"]
        if outcome["contacts"][i].episodes > 0
    ]
    if len(pressed) == 0:
        happened = (
            "No bodies collide: the force stays zero at every contact that can open."
        )
    elif len(outcome["able"]) > 1:
        happened = of_chain(known, pressed)
    else:
        happened = of_contact(known, pressed[0])
    if not outcome["final"]:
        happened = f"{happened} {known['notes'][0]}"
    return [happened, result_of(known, pressed, e)]


# What happened ------------------------------------------------------------------------------------


def value_at(series: Any, t: float) -> float:
    """Value of a curve at a time."""
    times, y = series["t"], series["y"]
    i = max(0, min(len(times) - 2, bisect_right(times, t) - 1))
    wide = times[i + 1] - times[i]
    share = max(0.0, min(1.0, (t - times[i]) / wide)) if wide > 0 else 1.0
    return float(y[i] + (y[i + 1] - y[i]) * share)


def spells_of(contact: Any) -> list[Any]:
    """Spells in which a contact is "open", "touching" or "pressing": state, `from` and `to`, s."""
    force, gap = contact["force"], contact["gap"]
    if gap is None:  # a bond never opens
        gap = {"t": force["t"], "y": [0.0 for _ in force["t"]]}
    weak, narrow = [SMALL * max([abs(y) for y in curve["y"]]) for curve in (force, gap)]
    spells: list[Any] = []
    before = force["t"][0]
    for t in sorted([*force["t"], *gap["t"]]):
        middle, state = (before + t) / 2, "touching"
        if abs(value_at(force, middle)) > weak:
            state = "pressing"
        elif value_at(gap, middle) > narrow:
            state = "open"
        if t > before and len(spells) > 0 and spells[-1]["state"] == state:
            spells[len(spells) - 1]["to"] = t
        elif t > before:
            spells.append({"from": before, "to": t, "state": state})
        before = t
    return spells


def presses_of(contact: Any) -> list[Any]:
    """Spells in which a contact presses."""
    return [spell for spell in spells_of(contact) if spell["state"] == "pressing"]


def beside(known: Any, contact: Any) -> Any:
    """The bodies of a contact."""
    return known["bodies"][contact["index"] : contact["index"] + 2]


def pair_of(known: Any, contact: Any) -> str:
    """Names of the bodies of a contact."""
    left, right = beside(known, contact)
    return f"{left['name']} and {right['name']}"


def of_chain(known: Any, pressed: list[Any]) -> str:
    """The first and the last of several contacts."""
    first, last, begun, ended = pressed[0], pressed[0], -1.0, -1.0
    for contact in pressed:
        for spell in presses_of(contact):
            if begun < 0 or spell["from"] < begun:
                first, begun = contact, spell["from"]
            if spell["to"] > ended:
                last, ended = contact, spell["to"]
    return (
        f"The first contact to press is that of {pair_of(known, first)}, at "
        f"{written(begun, 's', 4)}; the last force, between {pair_of(known, last)}, ends at "
        f"{written(ended, 's', 4)}."
    )


def of_contact(known: Any, contact: Any) -> str:
    """How the force of the only contact that can open begins, falls and ends."""
    spells, presses, pair = (
        spells_of(contact),
        presses_of(contact),
        pair_of(known, contact),
    )
    if len(presses) == 0:
        return "The contact force lasts for too short a time to be shown."
    begun, ended, force = presses[0]["from"], presses[-1]["to"], contact["force"]
    lasted = ended - begun
    if spells[-1]["state"] == "pressing":
        text = f"{capital(pair)} press to the end of the run"
    elif not known["exact"]:
        if len(presses) == 1:  # samples know it less well
            lasted = known["outcome"]["contacts"][contact["index"]].duration
        text = f"The force has fallen to zero {written(lasted, 's', 4)} after the first touch"
        end = "; no single wave ends it" if contact["compliant"] else ""
        most = time_of_most(force) - begun
        early = f"; {100 * MOST:.3g} % of the impulse came in the first {written(most, 's', 4)}"
        text = f"{text}{in_transits(known, contact, lasted)}{end}"
        text = f"{text}{early if most < 0.75 * lasted else ''}"
    elif any(
        spell["state"] == "open" and begun < spell["from"] < ended for spell in spells
    ):
        text = f"{capital(pair)} part and meet again; the last force ends at "
        text = f"{text}{written(ended, 's', 4)}"
    else:
        wall = any(body["kind"] == "wall" for body in beside(known, contact))
        puller = "a wall" if wall else "a contact"
        text = f"{returning(known, contact, lasted)} and the force ends, since {puller} cannot pull"
        edge, y = SMALL * lasted, force["y"]
        falls = [
            k
            for k, t in enumerate(force["t"])
            if begun + edge < t < ended - edge and y[k] < (1 - SMALL) * y[k - 1]
        ]
        if len(falls) > 0:
            k, more = falls[0], "" if len(falls) == 1 else ", and so do later waves"
            text = (
                f"{returning(known, contact, force['t'][k] - begun)} and lowers the force to "
                f"{y[k] / y[k - 1]:.3g} times its value{more}; contact goes on. {text}"
            )
    opened = (
        spells[-1]["from"] if known["exact"] and spells[-1]["state"] == "open" else -1.0
    )
    if opened > ended + SMALL * lasted:
        text = f"{text}; the faces touch without force until they part at {written(opened, 's', 4)}"
    return f"{text}."


def time_of_most(force: Any) -> float:
    """When `MOST` of the impulse of a force has come: a stiff contact has a long weak tail."""
    times, y = force["t"], force["y"]
    sums = [0.0]
    for k in range(1, len(times)):
        sums.append(sums[k - 1] + (y[k] + y[k - 1]) * (times[k] - times[k - 1]) / 2)
    k = bisect_right(sums, MOST * sums[-1])
    return float(times[min(k, len(times) - 1)])


def returning(known: Any, contact: Any, after: float) -> str:
    """Whose wave is back so long after the first touch of a contact."""
    time, found, fewest = written(after, "s", 4), "", 0
    for body in beside(known, contact):
        if len(body["pieces"]) == 1:
            share = after / (2 * body["pieces"][0]["transit_time"])
            trips = round(share)
            if trips == 0 or abs(share - trips) > SMALL:
                continue
            if trips == 1 and fewest == 1:
                return f"Each rod's wave returns after {time}"
            if fewest == 0 or trips < fewest:
                fewest, found = trips, f"{capital(body['name'])}'s wave returns after"
    if fewest == 0:
        return f"After {time} a wave arrives"
    return (
        f"{found} {time}" if fewest == 1 else f"{found} {fewest} round trips, {time},"
    )


def in_transits(known: Any, contact: Any, lasted: float) -> str:
    """A duration in transit times of the rod beside a contact that has the shortest."""
    shortest, found = 0.0, ""
    for body in beside(known, contact):
        time = sum(piece["transit_time"] for piece in body["pieces"])
        if time > 0 and (shortest == 0 or time < shortest):
            shortest, found = (
                time,
                f", {lasted / time:.3g} transit times of {body['name']}",
            )
    return found


# What it comes to ---------------------------------------------------------------------------------


def result_of(known: Any, pressed: list[Any], e: str) -> str:
    """The impulse, the velocities that it leaves, e, and the share of vibration."""
    outcome, bodies, after = (
        known["outcome"],
        known["bodies"],
        known["outcome"]["after"],
    )
    fastest = max([abs(v) for v in [*outcome["before"], *after]])
    said = [
        f"{clean(after[i], fastest):.4g} m/s"
        for i, body in enumerate(bodies)
        if body["kind"] != "wall"
    ]
    vibration = outcome["vibration_after"]
    energy = vibration + sum(
        body["mass"] * after[i] ** 2 / 2 for i, body in enumerate(bodies)
    )
    speeds, word = said[-1], "velocity"
    if len(said) > 1:
        speeds, word = f"{', '.join(said[: len(said) - 1])} and {speeds}", "velocities"
    if len(pressed) == 1 and len(outcome["able"]) == 1:
        impulse = written(outcome["contacts"][pressed[0]["index"]].impulse, "N s", 4)
        text = f"The impulse of {impulse} changes the mean {word} to {speeds}"
        if e != "":
            text = f"{text}, so e = {e}{ratio_named(known)}"
    else:
        when = "after the collision" if outcome["final"] else "at the end of the run"
        text = f"The mean {word} {when}: {speeds}"
    if energy <= 0:
        return f"{text}."
    share = clean(100 * vibration / energy, 100.0)
    return f"{text}; {share:.3g} % of the energy is vibration energy."


def ratio_named(known: Any) -> str:
    """The ratio of lengths or transit times that e is; "" where e is none.

    Two uniform rods of one impedance, in rigid contact and without vibration before.
    """
    bodies = known["bodies"]
    if (
        len(bodies) != 2
        or known["contacts"][0]["compliant"]
        or any(len(body["pieces"]) != 1 or body["approach"] is None for body in bodies)
    ):
        return ""
    left, right = [body["pieces"][0] for body in bodies]
    order, ratio = "₁₂", left["transit_time"] / right["transit_time"]
    if ratio > 1:
        order, ratio = "₂₁", 1 / ratio
    same = abs(left["impedance"] / right["impedance"] - 1) < SMALL
    if not same or abs(known["outcome"]["restitution"] - ratio) > SMALL:
        return ""
    letter = "l" if abs(left["wave_speed"] / right["wave_speed"] - 1) < SMALL else "T"
    return f" = {letter}{order[0]}/{letter}{order[1]}"
