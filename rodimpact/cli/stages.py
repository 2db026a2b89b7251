"""The stages of a collision in words: what happens when, and what is where in between.

Everything is read off the solution. Moments are the corners of its regions of constant state: there
a wave front is at an end of a rod, or two fronts cross. Between two moments the pieces of a rod
keep their order, velocity and stress, and only their boundaries, the fronts, move.
"""

from __future__ import annotations

from collections import defaultdict

from ..model import Rod
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
    events: dict[float, list[str]] = defaultdict(list)
    events[episode.start] += [f"the {names[0]} and the {names[1]} meet"]
    for time, sentences in _fronts(solution, names).items():
        if episode.start < time < solution.t_end:
            events[time] += sentences
    events[episode.force_end] += ["the contact force ends"]
    events[episode.opening] += ["the gap opens"]
    times = sorted(t for t in events if t <= episode.opening)
    later = min((t for t in events if t > episode.opening), default=solution.t_end)
    rods = {i: body for i, body in enumerate(solution.system.bodies) if isinstance(body, Rod)}
    width = max(len(names[i]) for i in rods)
    lines = []
    for time, after in zip(times, [*times[1:], later], strict=True):
        lines.append(f"{format_si(time, 's'):>12}  {'; '.join(events[time])}")
        lines += [f"{'':14}    {names[i]:{width}}  {_pieces(solution, i, rod, (time + after) / 2)}"
                  for i, rod in rods.items()]
    return "\n".join(lines)


def _fronts(solution: Solution, names: tuple[str, str]) -> dict[float, list[str]]:
    """When fronts are at the ends of the rods, and when they cross."""
    free: dict[float, list[str]] = defaultdict(list)
    sentences: dict[float, list[str]] = defaultdict(list)
    regions = regions_of(solution)
    bodies = regions.body_of_vertices().tolist()
    corners = dict.fromkeys(zip(regions.t.tolist(), bodies, regions.x.tolist(), strict=True))
    for time, body, x in corners:
        rod = solution.system.bodies[body]
        assert isinstance(rod, Rod)
        if x == (0.0 if body else rod.length):
            message = "the wave is back at the contact"
        elif x in (0.0, rod.length):
            free[time].append(f"of the {names[body]}")
            continue
        else:
            place = format_si(x, "m", 3)
            message = f"two fronts cross in the {names[body]}, {place} from its left end"
        if message not in sentences[time]:
            sentences[time].append(message)
    for time, whose in free.items():
        ends = "ends" if len(whose) > 1 else "end"
        turn = f"the wave turns back at the free {ends} {' and '.join(whose)}"
        sentences[time].insert(0, turn)
    return sentences


def _pieces(solution: Solution, body: int, rod: Rod, time: float) -> str:
    """The pieces of a rod, with the fronts between them."""
    v0 = max(map(abs, solution.outcome.velocities_before))
    material = rod.segments[0].material
    impact = float(material.density) * float(material.wave_speed) * v0
    state = solution.fields.profile(body, int(solution.fields.to_ticks(time)))
    stress = state.strain * float(material.youngs_modulus)
    text = ""
    for i, (v, s) in enumerate(zip(state.velocity, stress, strict=True)):
        if i:  # v + sigma/(rho c) is the same on both sides of a front that runs right
            right = (v - state.velocity[i - 1]) * (s - stress[i - 1]) < 0
            text += "  |>  " if right else "  <|  "
        s = clean(float(s), impact)
        kind = "tension" if s > 0 else "compression"
        text += f"{clean(float(v), v0):.3g} m/s, " + (
            f"{format_si(abs(s), 'Pa', 3)} {kind}" if s else "no stress")
    return text
