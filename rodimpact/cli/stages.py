"""The stages of a collision in words: what happens when, and what is where in between.

Everything is read off the solution. Moments are the corners of its regions of constant state: there
a wave front is at an end of a rod, or two fronts cross. Between two moments the pieces of a rod
keep their order, velocity and stress, and only their boundaries, the fronts, move.
"""

from typing import Any

from ..results.regions import regions_of
from ..results.solution import Solution
from ..storage.tables import clean
from ..units import format_si

LEGEND = "<| is a wave front that runs to the left, |> one that runs to the right."


def tell(solution: Solution, names: tuple[str, str]) -> str:
    """The stages of the collision of two bodies as lines, until the fronts after the parting.

    Each stage is a moment, what happens then, and for each rod its pieces halfway to the next
    moment, from left to right with the fronts between them.

    Parameters
    ----------
    solution : Solution
        Of uniform rods or walls that meet once.
    names : (str, str)
        What to call the bodies.
    """
    episode = solution.contacts[0].episodes[0]
    told = [(episode.start, f"the {names[0]} and the {names[1]} meet")]
    told += [
        event
        for event in _fronts(solution, names)
        if episode.start < event[0] < solution.t_end
    ]
    told += [
        (episode.force_end, "the contact force ends"),
        (episode.opening, "the gap opens"),
    ]
    events: dict[float, list[str]] = {}
    for time, sentence in dict.fromkeys(told):
        events.setdefault(time, []).append(sentence)
    times = sorted(t for t in events if t <= episode.opening)
    later = min((t for t in events if t > episode.opening), default=solution.t_end)
    rods = {
        i: names[i]
        for i, body in enumerate(solution.system.bodies)
        if body.kind == "rod"
    }
    width = max(map(len, rods.values()))
    lines = []
    for time, after in zip(times, [*times[1:], later], strict=True):
        lines.append(f"{format_si(time, 's'):>12}  " + f"\n{'':14}".join(events[time]))
        lines += [
            f"{'':18}{name:{width}}  {_pieces(solution, i, (time + after) / 2)}"
            for i, name in rods.items()
        ]
    return "\n".join(lines)


def _fronts(solution: Solution, names: tuple[str, str]) -> list[tuple[float, str]]:
    """When fronts are at the ends of the rods, and when they cross."""
    regions = regions_of(solution)
    told = []
    for time, i, x in zip(
        regions.t.tolist(),
        regions.body_of_vertices().tolist(),
        regions.x.tolist(),
        strict=True,
    ):
        rod: Any = solution.system.bodies[i]
        place = f"{format_si(x, 'm', 3)} from its left end"
        sentence = f"two fronts cross in the {names[i]}, {place}"
        if x in (0.0, rod.length):
            sentence = f"the wave turns back at the free end of the {names[i]}"
        if x == (0.0 if i else rod.length):
            sentence = "the wave is back at the contact"
        told.append((time, sentence))
    return told


def _pieces(solution: Solution, body: int, time: float) -> str:
    """The pieces of a rod, with the fronts between them."""
    v0 = max(map(abs, solution.outcome.velocities_before))
    rod: Any = solution.system.bodies[body]
    material = rod.segments[0].material
    impact = float(material.density) * float(material.wave_speed) * v0
    state = solution.fields.profile(body, int(solution.fields.to_ticks(time)))
    text = ""
    before: Any = None
    for v, s in zip(
        state.velocity, state.strain * float(material.youngs_modulus), strict=True
    ):
        if (
            before
        ):  # v + sigma/(rho c) is the same on both sides of a front that runs right
            right = (v - before[0]) * (s - before[1]) < 0
            text += "  |>  " if right else "  <|  "
        before = v, s
        s = clean(float(s), impact)
        stress = f"{format_si(abs(s), 'Pa', 3)} {'tension' if s > 0 else 'compression'}"
        text += f"{clean(float(v), v0):.3g} m/s, {stress if s else 'no stress'}"
    return text
