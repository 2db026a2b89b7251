"""A program whose types are those that users see: it runs, and ``mypy --strict`` reads
it.
"""

import inspect
from collections.abc import Callable
from typing import Any, assert_type

import numpy as np
import pytest
from numpy.typing import NDArray

import rodimpact as ri


def longest_pulse(
    lengths: NDArray[np.float64], area: float, law: ri.Hertz | ri.Rigid
) -> float:
    """Longest force duration, s, of strikers of these lengths, m, on a bar of 2 m."""
    steel = ri.materials.steel
    striker = ri.Rod(lengths, area=area, material=steel, velocity=10.0)
    bar = ri.Rod(2.0, area=area, material=steel)
    family = ri.sweep(ri.System([striker, bar], contacts=[law]))
    assert_type(family, ri.SweepResult)
    return float(np.nanmax(family.contacts[0].duration))


def progress_to(totals: list[int | None]) -> Callable[[int, int | None], object]:
    """A function for `progress` that appends every total to a list."""
    return lambda done, total: totals.append(total)


def test_a_typed_program_of_a_family_runs() -> None:
    steel = assert_type(ri.materials.steel, ri.Material)
    longest = longest_pulse(np.array([0.1, 0.2]), area=1e-4, law=ri.Rigid())
    round_trip = 2 * 0.2 / float(steel.wave_speed)  # of the longer striker
    assert abs(longest / round_trip - 1) < 1e-12


def test_a_typed_program_of_a_solution_runs() -> None:
    """A program with types, which mypy checks, solves a row and reads velocities, a
    gauge and its signal; a few of their values are compared.
    """
    steel = ri.materials.steel
    halves = ri.Steps([1.0, 0.5], at=[0.2])  # m/s
    rod = ri.Rod(0.4, area=1e-4, material=steel, velocity=halves)
    row = ri.System([rod, ri.Wall()])
    totals: list[int | None] = []

    solution = ri.solve(
        row, 1e-4, "finite-difference", cells=8, progress=progress_to(totals)
    )
    velocity: NDArray[np.floating[Any]] = solution.velocity(0, [0.1, 0.3], 0.0)
    gauge = assert_type(solution.gauge(0, 0.2), ri.Gauge)
    signal = assert_type(gauge.signal(1e-5, name="middle"), ri.Signal)

    assert_type(solution, ri.Solution)
    assert_type(solution.outcome, ri.Outcome)
    for contact in solution.contacts:
        for episode in contact.episodes:
            assert_type(episode, ri.Episode)
    assert velocity.tolist() == [1.0, 0.5]
    assert solution.mean_velocity(0, 0.0) == 0.75  # of both halves
    assert (signal * 2.0 - 1.0).name == "middle"
    assert_type(ri.units.parse("400 mm", "length"), float)


def test_constructors_take_more_types_than_their_attributes_have() -> None:
    """A list and an integer are accepted by constructors; mypy checks the types of the
    attributes, and three values are compared.
    """
    pads = ri.SpringDashpot([1e8, 2e8], damping=100)
    assert_type(pads.stiffness, float | NDArray[np.float64])
    rubber = ri.Material("rubber", youngs_modulus=5e6, density=1100)
    assert_type(rubber.poisson_ratio, float | NDArray[np.float64] | None)
    assert_type(rubber.name, str)
    gain: float = ri.Bridge("half", gauge_factor=2.0, excitation=8).gain
    assert np.shape(pads.stiffness) == (2,)
    assert rubber.poisson_ratio is None
    assert gain == 1.0


def test_a_constructor_shows_defaults_and_which_arguments_take_a_position() -> None:
    """The signature of `RigidMass` has a mass without default, by position or keyword,
    and a velocity, 0 by default, by keyword only.
    """
    mass, velocity = inspect.signature(ri.RigidMass).parameters.values()
    assert mass.default is inspect.Parameter.empty
    assert mass.kind is inspect.Parameter.POSITIONAL_OR_KEYWORD
    assert velocity.default == 0.0
    assert velocity.kind is inspect.Parameter.KEYWORD_ONLY
    with pytest.raises(TypeError, match=r"RigidMass\(\) takes only mass by position"):
        ri.RigidMass(1.0, 2.0)  # type: ignore[call-arg]
