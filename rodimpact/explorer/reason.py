"""Why a collision ends as it does: two sentences, from the contact events of its run.

The first sentence says how the contact force begins, falls and ends, the second one
what impulse and velocities follow. The page has these functions as JavaScript. Their
parameter `facts` is the dictionary of a solved collision that `picture.page_data`
describes.
"""

from bisect import bisect_right
from typing import Any

from ..storage.tables import without_round_off
from .texts import capital, format_quantity

NEGLIGIBLE = 1e-6
"""Fraction of the peak force, the largest gap or a time that counts as zero.

Transit times, impedances and wave speeds that differ by less count as equal.
"""
MAIN_IMPULSE = 0.99
"""Fraction of the impulse after which the rest is the weak tail of a stiff contact."""
EARLY = 0.75
"""Fraction of the force duration before which the main impulse is worth a remark."""


def reason_of(facts: Any, e: str) -> list[str]:
    """Sentence on the contact force, and sentence on the velocities that follow.

    The first says so if no contact that can open has pressed. If the outcome is not
    final, it also has the first note, which says why.

    Parameters
    ----------
    facts : dict
        The parameter `solution` of `page_data`, with the ``bodies`` and ``contacts``
        that it shows.
    e : str
        The coefficient of restitution as it is written; "" if there is none.
    """
    outcome = facts["outcome"]
    pressed = []
    for i in outcome["unilateral"]:
        if outcome["contacts"][i].episodes > 0:
            pressed.append(facts["contacts"][i])
    if len(pressed) == 0:
        events = (
            "No bodies collide: the force stays zero at every contact that can open."
        )
    elif len(outcome["unilateral"]) > 1:
        events = events_of_chain(facts, pressed)
    else:
        events = events_of_contact(facts, pressed[0])
    if not outcome["final"]:
        events = f"{events} {facts['notes'][0]}"
    return [events, result_of(facts, pressed, e)]


# Events -------------------------------------------------------------------------------


def value_at(series: Any, t: float) -> float:
    """Value of a curve at a time, by straight lines between its points.

    At a jump, where two points have one time, it is the value after the jump. Before
    the first point and after the last one, the curve keeps the values there.
    """
    times = series["t"]
    values = series["y"]
    # The last point i that is not later than t, but not the last of all
    i = max(0, min(len(times) - 2, bisect_right(times, t) - 1))
    width = times[i + 1] - times[i]
    fraction = 1.0  # of the way from point i to the next; all of it at a jump
    if width > 0:
        fraction = max(0.0, min(1.0, (t - times[i]) / width))
    return float(values[i] + (values[i + 1] - values[i]) * fraction)


def spells_of(contact: Any) -> list[Any]:
    """Intervals of time in which a contact keeps one state, in order.

    The force and the gap half-way between two neighbouring points of their curves tell
    the state between these points. A contact that does not press is open if its gap is
    not negligible. Neighbouring intervals with the same state are joined.

    Returns
    -------
    list of dict
        With ``state``, "open", "touching" or "pressing"; ``from`` and ``to``, s.
    """
    force = contact["force"]
    gap = contact["gap"]
    if gap is None:  # a bond never opens
        gap = {"t": force["t"], "y": [0.0] * len(force["t"])}
    zero_force = NEGLIGIBLE * peak_of(force["y"])
    zero_gap = NEGLIGIBLE * peak_of(gap["y"])
    spells: list[Any] = []
    before = force["t"][0]
    for t in sorted([*force["t"], *gap["t"]]):
        # The state from `before` to t
        middle = (before + t) / 2
        state = "touching"
        if abs(value_at(force, middle)) > zero_force:
            state = "pressing"
        elif value_at(gap, middle) > zero_gap:
            state = "open"
        is_continued = len(spells) > 0 and spells[-1]["state"] == state
        if t > before and is_continued:
            spells[len(spells) - 1]["to"] = t  # JavaScript cannot assign to [-1]
        elif t > before:
            spells.append({"from": before, "to": t, "state": state})
        before = t
    return spells


def peak_of(values: Any) -> float:
    """Largest absolute value of numbers, of which there must be one."""
    peak: float = max([abs(value) for value in values])
    return peak


def presses_of(contact: Any) -> list[Any]:
    """Those of the `spells_of` a contact in which it presses, in order."""
    presses = []
    for spell in spells_of(contact):
        if spell["state"] == "pressing":
            presses.append(spell)
    return presses


def bodies_of(facts: Any, contact: Any) -> Any:
    """Left and right body of a contact."""
    i = contact["index"]
    return facts["bodies"][i : i + 2]


def pair_of(facts: Any, contact: Any) -> str:
    """Names of the bodies of a contact: "rod 1 and rod 2"."""
    left, right = bodies_of(facts, contact)
    return f"{left['name']} and {right['name']}"


def events_of_chain(facts: Any, pressed: list[Any]) -> str:
    """Sentence on the first and the last force of the contacts that pressed.

    It names the contact that presses first, and the one whose force ends last, with
    both times.
    """
    first = pressed[0]
    last = pressed[0]
    start = -1.0  # negative until a force is found
    end = -1.0
    for contact in pressed:
        for spell in presses_of(contact):
            if start < 0 or spell["from"] < start:
                first = contact
                start = spell["from"]
            if spell["to"] > end:
                last = contact
                end = spell["to"]
    return (
        f"The first contact to press is that of {pair_of(facts, first)}, at "
        f"{format_quantity(start, 's', 4)}; the last force, between "
        f"{pair_of(facts, last)}, ends at {format_quantity(end, 's', 4)}."
    )


def events_of_contact(facts: Any, contact: Any) -> str:
    """Sentence on how the force of the only contact that can open ends, and why.

    There are five cases: the curve of the force shows no press, since it is too short;
    it presses to the end of the run; a smooth solution, see `end_of_smooth_force`; the
    bodies part and meet again; else a wave ends the force, see `end_by_wave`. In an
    exact run the sentence adds when the bodies part, if that is after the last force.
    """
    spells = spells_of(contact)
    presses = presses_of(contact)
    if len(presses) == 0:
        return "The contact force lasts for too short a time to be shown."
    start = presses[0]["from"]
    end = presses[-1]["to"]
    last = spells[-1]
    pair = capital(pair_of(facts, contact))
    reopens = False
    for spell in spells:
        if spell["state"] == "open" and start < spell["from"] < end:
            reopens = True
    if last["state"] == "pressing":
        text = f"{pair} press to the end of the run"
    elif not facts["exact"]:
        text = end_of_smooth_force(facts, contact, presses)
    elif reopens:
        text = f"{pair} part and meet again; the last force ends at "
        text = f"{text}{format_quantity(end, 's', 4)}"
    else:
        text = end_by_wave(facts, contact, start, end)
    if facts["exact"] and last["state"] == "open":
        is_later = last["from"] > end + NEGLIGIBLE * (end - start)
        if is_later:
            parting = format_quantity(last["from"], "s", 4)
            text = f"{text}; the faces touch without force until they part at {parting}"
    return f"{text}."


def end_of_smooth_force(facts: Any, contact: Any, presses: list[Any]) -> str:
    """Words on the duration of the force of a smooth solution, without a full stop.

    The duration is also given in transit times of the rod at the contact, see
    `in_transits`. The words say when `MAIN_IMPULSE` of the impulse had come if the rest
    is a weak tail, and that no single wave ends the force if the contact is compliant.
    (A rigid contact has a smooth solution if a body is a rigid mass, or if the case
    names characteristics.)
    """
    start = presses[0]["from"]
    duration = presses[-1]["to"] - start
    # The duration of the outcome is more exact than that of the curve, but it leaves
    # out the time between two presses.
    if len(presses) == 1:
        duration = facts["outcome"]["contacts"][contact["index"]].duration
    time = format_quantity(duration, "s", 4)
    text = f"The force has fallen to zero {time} after the first touch"
    text = f"{text}{in_transits(facts, contact, duration)}"
    if contact["compliant"]:
        text = f"{text}; no single wave ends it"
    main_duration = main_impulse_time(contact["force"]) - start
    if main_duration < EARLY * duration:
        text = (
            f"{text}; {100 * MAIN_IMPULSE:.3g} % of the impulse came in the first "
            f"{format_quantity(main_duration, 's', 4)}"
        )
    return text


def end_by_wave(facts: Any, contact: Any, start: float, end: float) -> str:
    """Words on the returning wave that ends a force, without a full stop.

    If the force falls before, a sentence on the first wave that lowers it comes first.
    `start` and `end` are those of the force, s.
    """
    puller = "a contact"
    if any(body["kind"] == "wall" for body in bodies_of(facts, contact)):
        puller = "a wall"
    wave = returning_wave(facts, contact, end - start)
    text = f"{wave} and the force ends, since {puller} cannot pull"
    times = contact["force"]["t"]
    values = contact["force"]["y"]
    margin = NEGLIGIBLE * (end - start)
    falls = []  # indices of the points of the curve just after the force has fallen
    for k, t in enumerate(times):
        is_inside = start + margin < t < end - margin
        # The first point is never inside, so that k - 1 is not negative.
        if is_inside and values[k] < (1 - NEGLIGIBLE) * values[k - 1]:
            falls.append(k)
    if len(falls) == 0:
        return text
    k = falls[0]
    wave = returning_wave(facts, contact, times[k] - start)
    ratio = values[k] / values[k - 1]
    more_falls = ""
    if len(falls) > 1:
        more_falls = ", and so do later waves"
    return (
        f"{wave} and lowers the force to {ratio:.3g} times its value{more_falls}; "
        f"contact goes on. {text}"
    )


def main_impulse_time(force: Any) -> float:
    """Time at which `MAIN_IMPULSE` of the impulse of a force has come, s.

    It is the time of the first point of the curve up to which the impulse is more than
    this part, or of the last point. Impulses are computed by the trapezoidal rule.
    """
    times = force["t"]
    values = force["y"]
    impulses = [0.0]  # up to each point of the curve, N s
    for k in range(1, len(times)):
        step = (values[k] + values[k - 1]) * (times[k] - times[k - 1]) / 2
        impulses.append(impulses[k - 1] + step)
    k = bisect_right(impulses, MAIN_IMPULSE * impulses[-1])
    return float(times[min(k, len(times) - 1)])


def returning_wave(facts: Any, contact: Any, after: float) -> str:
    """Subject and verb on the wave that arrives `after` seconds after the first touch.

    A wave of a body beside the contact arrives after a whole number of `round_trips`.
    If waves of both bodies arrive just then, the one with fewer round trips is named:
    "Rod 1's wave returns after 80 µs". If both have made one, the text is "Each rod's
    wave returns ..."; if no wave of these bodies arrives just then, it is "After 80 µs
    a wave arrives". After several round trips their number is added, between commas.
    There is no full stop.
    """
    time = format_quantity(after, "s", 4)
    name = ""
    fewest_trips = 0
    for body in bodies_of(facts, contact):
        trips = round_trips(body, after)
        if trips == 0:  # no wave of this body arrives just then
            continue
        if trips == 1 and fewest_trips == 1:
            return f"Each rod's wave returns after {time}"
        is_first = fewest_trips == 0
        if is_first or trips < fewest_trips:
            fewest_trips = trips
            name = capital(body["name"])
    if fewest_trips == 0:
        return f"After {time} a wave arrives"
    if fewest_trips == 1:
        return f"{name}'s wave returns after {time}"
    return f"{name}'s wave returns after {fewest_trips} round trips, {time},"


def round_trips(body: Any, time: float) -> int:
    """Whole number of round trips of a wave in a uniform rod in a time, s.

    It is 0 if the number is not whole, and for stepped rods, masses and walls.
    """
    if len(body["segments"]) != 1:
        return 0
    ratio = time / (2 * body["segments"][0]["transit_time"])
    trips: int = round(ratio)
    if abs(ratio - trips) > NEGLIGIBLE:
        return 0
    return trips


def in_transits(facts: Any, contact: Any, duration: float) -> str:
    """A duration, s, in transit times of a rod: ", 2 transit times of rod 1".

    The rod is the one beside the contact with the shorter transit time. The text is ""
    if no rod is beside it.
    """
    shortest = 0.0
    text = ""
    for body in bodies_of(facts, contact):
        time = 0.0
        for segment in body["segments"]:
            time += segment["transit_time"]
        if time > 0 and (shortest == 0 or time < shortest):
            shortest = time
            text = f", {duration / time:.3g} transit times of {body['name']}"
    return text


# Result -------------------------------------------------------------------------------


def result_of(facts: Any, pressed: list[Any], e: str) -> str:
    """Sentence on the impulse, the velocities, e, and the vibration energy.

    It has the impulse and e only if there is one contact that can open, and it pressed.
    Otherwise it begins with the mean velocities, and says whether they are those at the
    end of the run or after the collision. It leaves the vibration energy out if there
    is no energy at all.
    """
    outcome = facts["outcome"]
    velocities = velocities_of(facts)
    text = velocities[-1]  # the velocities in words: "a", or "a, b and c"
    noun = "velocity"
    verb = "is"
    if len(velocities) > 1:
        all_but_last = ", ".join(velocities[: len(velocities) - 1])
        text = f"{all_but_last} and {text}"
        noun = "velocities"
        verb = "are"
    n_can_open = len(outcome["unilateral"])
    if len(pressed) == 1 and n_can_open == 1:
        tally = outcome["contacts"][pressed[0]["index"]]  # a ContactTally
        impulse = format_quantity(tally.impulse, "N s", 4)
        text = f"The impulse of {impulse} changes the mean {noun} to {text}"
        if e != "":
            text = f"{text}, so e = {e}{ratio_named(facts)}"
    elif not outcome["final"]:
        text = f"The mean {noun} at the end of the run {verb} {text}"
    elif len(pressed) == 0:
        text = f"The mean {noun} {verb} {text}"
    else:
        text = f"The mean {noun} after the collision {verb} {text}"
    vibration = outcome["vibration_after"]
    energy = vibration + kinetic_energy(facts)
    if energy <= 0:
        return f"{text}."
    percentage = without_round_off(100 * vibration / energy, 100.0)  # 0 for round-off
    return f"{text}; {percentage:.3g} % of the energy is vibration energy."


def velocities_of(facts: Any) -> list[str]:
    """Velocities of rods and masses after the collision, as texts with four digits.

    Round-off is written as 0.
    """
    after = facts["outcome"]["after"]
    fastest = peak_of([*facts["outcome"]["before"], *after])
    texts = []
    for i, body in enumerate(facts["bodies"]):
        if body["kind"] != "wall":
            texts.append(f"{without_round_off(after[i], fastest):.4g} m/s")
    return texts


def kinetic_energy(facts: Any) -> float:
    """Energy of the centre-of-mass motions after the collision, J.

    It is sum(m V^2/2) over all bodies; a wall counts with the mass 0.
    """
    after = facts["outcome"]["after"]
    energy = 0.0
    for i, body in enumerate(facts["bodies"]):
        energy += body["mass"] * after[i] ** 2 / 2
    return energy


def ratio_named(facts: Any) -> str:
    """The ratio of lengths or transit times that e equals, such as " = l₁/l₂", or "".

    e equals the shorter transit time over the longer one for two uniform rods of one
    impedance, in rigid contact and without vibration before. The letter is T, or l for
    lengths if the wave speeds are equal too. "" is returned for any other row, and if e
    does not have this value. If the row has two bodies, their contact must be one that
    can open.
    """
    bodies = facts["bodies"]
    if len(bodies) != 2 or facts["contacts"][0]["compliant"]:
        return ""
    for body in bodies:
        # a body that is strained or has several velocities has no approach velocity
        if len(body["segments"]) != 1 or body["approach"] is None:
            return ""
    left = bodies[0]["segments"][0]
    right = bodies[1]["segments"][0]
    index_of_short = "₁"
    index_of_long = "₂"
    ratio = left["transit_time"] / right["transit_time"]
    if ratio > 1:
        index_of_short = "₂"
        index_of_long = "₁"
        ratio = 1 / ratio
    if not is_same(left["impedance"], right["impedance"]):
        return ""
    if abs(facts["outcome"]["restitution"] - ratio) > NEGLIGIBLE:
        return ""
    letter = "T"
    if is_same(left["wave_speed"], right["wave_speed"]):  # then l1/l2 = T1/T2
        letter = "l"
    return f" = {letter}{index_of_short}/{letter}{index_of_long}"


def is_same(a: float, b: float) -> bool:
    """Whether two positive numbers are equal to within `NEGLIGIBLE`."""
    return abs(a / b - 1) < NEGLIGIBLE
