"""A cap on events: a sweep and `solve` end every member alike, at every cap."""

from itertools import pairwise

import numpy as np
import pytest
from exhaustive import few_of
from systems import random_system

import rodimpact as ri

STEEL = ri.materials.steel
MAX_EVENTS = 400
"""Largest number of events of a member, and so the largest cap that is tried."""
SHORT_ROW = 5
"""Seed of a row with few events."""


def with_masses(seed):
    """A random row of two or three rods, some of them stepped, and masses, sometimes
    with a wall behind them, with gaps and contacts of several laws; not solved.
    """
    rng = np.random.default_rng(seed)
    soft_laws = [ri.Hertz(3e9), ri.Spring(2e7), ri.SpringDashpot(1e7, 200.0)]
    n_bodies = rng.integers(2, 4)
    bodies = []
    for velocity in (1.0, 0.0, -0.3)[:n_bodies]:
        if rng.random() < 0.4 and bodies:
            mass = float(rng.uniform(0.1, 1))
            bodies.append(ri.RigidMass(mass, velocity=velocity))
            continue
        n_segments = rng.integers(1, 3)
        lengths = rng.uniform(0.1, 0.5, n_segments).tolist()
        areas = rng.uniform(1e-4, 3e-4, n_segments).tolist()
        segments = []
        for length, area in zip(lengths, areas, strict=True):
            segments.append(ri.Segment(length, area, STEEL))
        bodies.append(ri.Rod(segments=segments, velocity=velocity))
    if rng.random() < 0.3:
        bodies.append(ri.Wall())
    contacts = []
    for left, right in pairwise(bodies):
        laws = soft_laws
        if isinstance(left, ri.Rod) or isinstance(right, ri.Rod):
            laws = [*soft_laws, ri.Rigid()]  # waves decide a rigid contact
        contacts.append(laws[rng.integers(len(laws))])
    gaps = [float(rng.choice([0.0, 1e-5, 1e-4])) for _ in contacts]
    return ri.System(bodies, gaps, contacts)


def family_of(system):
    """The system as a family of three, in which the first rod with a single velocity
    gets three.
    """
    bodies = list(system.bodies)
    for i, body in enumerate(bodies):
        if isinstance(body, ri.Rod) and isinstance(body.velocity, float):
            faster = body.velocity + np.linspace(0.0, 0.4, 3)
            bodies[i] = body.replace(velocity=faster)
            break
    return system.replace(bodies=bodies)


def assert_members_end_as_alone(family, cap, **options):
    """Compare status, finality and incompleteness of each member with a run of its own.

    A cap that ended a run is named in its status.
    """
    result = ri.sweep(family, max_events=cap, **options)
    for index in np.ndindex(family.shape):
        try:
            alone = ri.solve(family[index], max_events=cap, **options)
        except ri.InvalidModel:
            assert result.status[index] == "refused"
            continue
        was_cut = alone.stopped_by in ("max_events", "clock")
        assert result.status[index] == alone.stopped_by
        assert result.final[index] == alone.final
        assert result.incomplete[index] == was_cut
        if alone.stopped_by == "max_events":
            assert "cap of" in alone.status


def caps_of(family, **options):
    """All caps up to one more than the events of the member with the most, a range."""
    most = 0
    for index in np.ndindex(family.shape):
        try:
            run = ri.solve(family[index], max_events=MAX_EVENTS, **options)
        except ri.InvalidModel:
            continue
        most = max(most, run.events)
    return range(1, most + 2)


@pytest.mark.parametrize("seed", few_of(range(8), range(1)))
@pytest.mark.parametrize("until", few_of([None, 1e-3], [1e-3]))
@pytest.mark.parametrize("method", ["fronts", "characteristics"])
def test_members_of_a_capped_sweep_end_as_alone(method, until, seed):
    """All caps of one short row by fronts are tried, and some of other rows.

    Among these are always those at which the longest run just ends.
    """
    system = random_system(seed, bodies=3, unit=0.1, vibrating=False)
    if method == "characteristics":
        system = with_masses(seed)
    family = family_of(system)
    options = {"method": method, "until": until}
    caps = caps_of(family, **options)
    is_short = method == "fronts" and seed == SHORT_ROW
    if not is_short:
        largest = len(caps)  # one more than the events of the longest run
        n_spread = 4 if seed < 2 else 8
        spread_caps = np.geomspace(1, largest, n_spread).astype(int)
        caps = {*spread_caps.tolist(), max(largest - 2, 1), largest - 1}

    for cap in caps:
        assert_members_end_as_alone(family, cap, **options)


@pytest.mark.exhaustive
@pytest.mark.parametrize("seed", few_of(range(8), range(1)))
@pytest.mark.parametrize("until", few_of([None, 1e-3], [1e-3]))
def test_members_of_a_capped_sweep_on_a_grid_end_as_alone(until, seed):
    """A random family is swept on a grid with several caps on events, at and beside
    whole steps: each member ends as it does alone.
    """
    family = family_of(with_masses(seed))
    options = {"method": "finite-difference", "until": until, "cells": 12}
    links = len(family.bodies) + 1  # both ends of the row are links, too
    most = ri.solve(family[(0,)], max_events=10**6, **options).events
    # A grid counts its steps times its links, so that few caps differ.
    steps = np.unique(np.geomspace(1, most // links + 1, 3).astype(int))
    caps_of_whole_steps = (links * steps).tolist()
    caps_beside_them = [1, links - 1, most - 1, most, most + 1]
    for cap in sorted({*caps_of_whole_steps, *caps_beside_them}):
        assert_members_end_as_alone(family, cap, **options)
