"""The kernel of the grid, below the model: the same bits always, exact balances, no
energy made.
"""

import numpy as np
import pytest
from exhaustive import few_of
from grid_rows import grid_run, matrices, random_row, run_row, thicken
from hypothesis import given
from hypothesis import strategies as st
from mistakes import refused
from networks import STEP, unit_rod
from numpy.random import default_rng
from runs import solution_of

import rodimpact as ri
from rodimpact.methods import kernels, record_lists
from rodimpact.methods.grid import contact_kernel as contacts
from rodimpact.methods.grid import elimination_kernel as elimination
from rodimpact.methods.grid.proof import (
    finality_time,
    group_at_contact,
    present_motion,
)
from rodimpact.methods.grid.records import LINK
from rodimpact.methods.link import Law

SEEDS = st.integers(0, 10**6)


def bits(run):
    """{name: bytes} of all arrays of the state and of the history of a run, except
    where it was stopped and continued.
    """
    arrays = run.grid._asdict()
    arrays |= run.history._asdict()
    del arrays["run"]  # it says where the run was stopped and continued
    return {name: array.tobytes() for name, array in arrays.items()}


def run_and_prove(system, compiling):
    """`bits` of a run of 48 steps, and the time at which its proof says that it is
    over.
    """
    with kernels.forced(compiling):
        run = grid_run(system, room=48)
        run.advance(48)
        state = bits(run)
        proof_time = finality_time(run)
    return state, proof_time


# One source, the same bits
# --------------------------------------------------------------------------------------


@pytest.mark.skipif(not kernels.enabled(), reason="compiling is disabled")
@pytest.mark.parametrize("seeds", few_of([range(10), range(10, 25)], [range(10)]))
def test_compiled_and_plain_runs_and_proofs_are_bit_identical(seeds):
    """Random rows, every second one with driven ends, have the same bits of a run and
    the same time of its proof in plain Python and in machine code.
    """
    for seed in seeds:
        driven = seed % 2 == 1
        system = random_row(seed, driven=driven)
        plain_bits, plain_time = run_and_prove(system, compiling=False)
        compiled_bits, compiled_time = run_and_prove(system, compiling=True)
        assert plain_bits == compiled_bits, seed
        assert plain_time == compiled_time, seed


@pytest.mark.parametrize("driven", [False, True])
def test_a_run_in_pieces_is_the_whole_run(driven):
    """A run that is stopped at random steps and continued leaves the same bits."""
    for seed in range(8):
        system = random_row(seed, driven=driven)
        whole = grid_run(system, room=100)
        whole.advance(100)

        in_pieces = grid_run(system, room=100)
        rng = default_rng(seed)
        lengths = rng.choice(np.arange(1, 100), 5)
        pauses = lengths.cumsum()  # steps at which the run is stopped
        for pause in pauses[pauses < 100]:
            in_pieces.advance(int(pause))
        in_pieces.advance(100)

        assert bits(whole) == bits(in_pieces), seed


# The elimination
# --------------------------------------------------------------------------------------


def tridiagonal(diagonal, coupling, is_held):
    """The matrix of all nodes: -coupling[i] between i - 1 and i; rows of held nodes are
    those of the identity.
    """
    n = len(diagonal)
    matrix = np.diag(diagonal)
    for i in range(1, n):
        matrix[i, i - 1] = -coupling[i]
        matrix[i - 1, i] = -coupling[i]
    identity = np.eye(n)
    matrix[is_held == 1] = identity[is_held == 1]
    return matrix


@given(SEEDS, st.integers(2, 12), st.booleans(), st.booleans())
def test_elimination_solves_as_dense_matrices_do(seed, nodes, held_left, held_right):
    """A piece with held or free ends, between other nodes, is solved as by NumPy."""
    rng = default_rng(seed)
    before, after = rng.integers(0, 3, 2)  # nodes on either side of the piece
    n = before + nodes + after
    first = before
    last = before + nodes - 1
    coupling = rng.uniform(0.01, 100, n + 1)
    coupling[: first + 1] = 0.0  # nodes before and after are pieces by themselves
    coupling[last + 1 :] = 0.0
    own = rng.uniform(0.1, 10, n)  # of each node
    diagonal = own + coupling[:-1] + coupling[1:]
    is_held = np.zeros(n, int)
    is_held[first] = held_left
    is_held[last] = held_right

    factors = np.zeros(n), np.zeros(n), np.zeros(n)
    elimination.factor(coupling, diagonal, is_held, *factors)
    right_side = rng.uniform(-1, 1, n)
    solution = right_side.copy()
    elimination.substitute(*factors, solution)

    matrix = tridiagonal(diagonal, coupling, is_held)
    expected = np.linalg.solve(matrix, right_side)
    assert solution == pytest.approx(expected, rel=1e-10, abs=1e-12)
    nodes_after = slice(last + 1, n)  # each of them is alone
    alone = right_side[nodes_after] / diagonal[nodes_after]
    assert solution[nodes_after] == pytest.approx(alone, rel=1e-15)


CHAIN = {
    "law": Law.SPRING,
    "stiffness": 1e4,
    "exponent": 1.0,
    "self_mobility": 1.0,
    "coupling_mobility": 0.49,
    "force_free_closing": 0.1,
    "overlap": 1e-3,
    "chain_end": 11,
}
"""Fields of each of twelve links that are coupled to their neighbours."""


def chain_of_links():
    """Twelve links with the fields of `CHAIN`, as objects."""
    records = np.zeros(12, LINK)
    for name, value in CHAIN.items():
        records[name] = value
    return record_lists.as_objects(records)


FIRST_LINK = 0
LAST_LINK = 11
LARGEST_SPEED = 1.0  # m/s, of the bodies


def forces_of(links):
    """Force of each link, N."""
    return [link.force for link in links]


def test_newton_solves_a_chain_of_stiff_links_in_few_sweeps(monkeypatch):
    """Forces of twelve coupled springs are those of a linear system after 6 sweeps at
    most. Link after link, they would spread by one body a sweep, and settle after
    hundreds.
    """
    links = chain_of_links()
    links[0].coupling_mobility = 0.0  # there is no link before the first
    sweep = contacts.gauss_seidel_sweep
    n_sweeps = 0

    def count_and_sweep(*arguments):
        nonlocal n_sweeps
        n_sweeps += 1
        return sweep(*arguments)

    monkeypatch.setattr(contacts, "gauss_seidel_sweep", count_and_sweep)

    has_converged = contacts.solve_chain(links, FIRST_LINK, LAST_LINK, LARGEST_SPEED)

    assert has_converged
    # The closing without forces, 0.1, less what the forces take, leaves F = k w/2.
    neighbours = np.eye(12, k=1) + np.eye(12, k=-1)
    mobility = np.eye(12) - 0.49 * neighbours
    compliance = 2 / 1e4 * np.eye(12)
    closing = np.full(12, 0.1)
    expected = np.linalg.solve(mobility + compliance, closing)
    assert forces_of(links) == pytest.approx(expected, rel=1e-12)
    assert n_sweeps <= 6


def test_no_newton_step_follows_the_last_sweep_of_a_chain(monkeypatch):
    """With a single sweep the forces stay those that the sweep has left, and the chain
    counts as not solved.
    """
    links = chain_of_links()
    sweep = contacts.gauss_seidel_sweep
    forces_of_sweeps = []  # of all links, after each sweep

    def sweep_and_keep(*arguments):
        changes = sweep(*arguments)
        forces_of_sweeps.append(forces_of(links))
        return changes

    monkeypatch.setattr(contacts, "gauss_seidel_sweep", sweep_and_keep)
    monkeypatch.setattr(contacts, "MAX_SWEEPS", 1)

    has_converged = contacts.solve_chain(links, FIRST_LINK, LAST_LINK, LARGEST_SPEED)

    assert not has_converged
    (forces_of_last_sweep,) = forces_of_sweeps
    assert forces_of(links) == forces_of_last_sweep


# A step against dense matrices
# --------------------------------------------------------------------------------------


def dense_run(mesh, step, v, force, radial, steps, push):
    """Leapfrog of one piece with matrices, from the state at the start.

    Parameters
    ----------
    v, force, radial : array
        Velocity of the nodes, m/s [n]; force and radial strain of the cells [n - 1].
    steps : int
    push : (float, float)
        Forces that push the ends to the right and to the left, N.

    Returns
    -------
    v, force, radial
        The state after the steps.
    """
    n = len(v)
    M, damping, K = matrices(mesh)
    k = mesh.stiffness[1:n]  # of cells; the array has one more on either side
    b = mesh.cells.coupling[1:n]
    J = mesh.cells.radial_inertia[1:n]
    # The unknowns are displacements of n nodes, then radial strains of n - 1 cells.
    free = np.append(mesh.is_prescribed == 0, J > 0)
    outer = np.zeros(2 * n - 1)
    outer[0] = push[0]
    outer[n - 1] = -push[1]
    mean_matrix = M / step + damping / 2
    left_side = mean_matrix[np.ix_(free, free)]
    stretch = (force - b * radial) / k
    displacement = np.append(0.0, np.cumsum(stretch))  # of the nodes
    x = np.append(displacement, radial)
    radial_rate = np.zeros(n - 1)
    rate = np.append(v, radial_rate)
    for _ in range(steps):
        x += step * rate / 2  # in the middle of the step
        right_side = outer - K @ x - damping @ rate
        change = np.linalg.solve(left_side, right_side[free])
        rate[free] += change
        x += step * rate / 2
    strain = x[n:]
    cell_force = k * np.diff(x[:n]) + b * strain
    return rate[:n], cell_force, strain


def unit_density(E):
    """A material with a density of 1 kg/m^3."""
    return ri.Material("m", youngs_modulus=E, density=1.0)


def random_stepped_rod(seed):
    """A rod of three segments, some damped, tapered or with lateral inertia; with seed
    0 a uniform one.
    """
    rng = default_rng(seed)
    soft = unit_density(1.0)
    stiff = unit_density(2.0)
    first = ri.Segment(0.5, area=1.0, material=soft)
    second = ri.Segment(0.4, area=3.0, material=stiff)
    third = ri.Segment(0.6, area=0.7, material=soft)
    segments = []
    for segment in (first, second, third):
        segments.append(thicken(rng, segment))
    if seed == 0:
        segments = [first]
    velocity = ri.Samples([1.0, -1.0, 0.5])
    strain = ri.Samples([0.1, 0.0, -0.2])
    return ri.Rod(segments=segments, velocity=velocity, strain=strain)


ENDS = {  # the ends, and the forces that push them to the right and to the left, N
    "free": ((ri.Free(), ri.Free()), (0.0, 0.0)),
    "fixed": ((ri.Fixed(), ri.Free()), (0.0, 0.0)),
    "pushed": ((ri.Pushed(0.3), ri.Pushed(-0.2)), (0.3, -0.2)),
}


@pytest.mark.parametrize("kind", ENDS)
@pytest.mark.parametrize("seed", few_of(range(8), range(3)))
def test_40_steps_are_those_of_a_leapfrog_with_dense_matrices(seed, kind):
    """Velocities, forces and radial strains at the end are those of `dense_run`."""
    ends, push = ENDS[kind]
    bodies = [random_stepped_rod(seed)]
    laws = []
    if kind == "pushed" and seed % 2 == 1:
        mass = ri.RigidMass(0.8, velocity=0.4)
        bodies.append(mass)
        laws.append(ri.Bonded())
    system = ri.System(bodies, contacts=laws, ends=ends)
    run = grid_run(system, room=40)

    run.advance(40)

    n = len(run.mesh.mass)
    velocity = run.history.velocity  # [state, node]
    force = run.history.force[:, 1:n]  # [state, cell]
    radial = np.zeros_like(force)
    if run.mesh.has_radial_strain:
        radial = run.step * run.history.radial[:, 1:n]
    start = (velocity[0], force[0], radial[0])
    v, F, q = dense_run(run.mesh, run.step, *start, steps=40, push=push)
    assert velocity[-1] == pytest.approx(v, abs=1e-12)
    assert force[-1] == pytest.approx(F, abs=1e-12)
    assert radial[-1] == pytest.approx(q, abs=1e-12)


# Energies
# --------------------------------------------------------------------------------------


def moving_mass(mesh):
    """Mass that moves with each node, kg; half cells on a driven end move with it."""
    mass = mesh.mass * (mesh.is_prescribed == 0)
    for node in np.flatnonzero(mesh.is_prescribed):
        masses_of_cells = mesh.cell_mass[node] + mesh.cell_mass[node + 1]
        mass[node] = masses_of_cells / 2
    return mass


def energy_of_bodies(run):
    """Kinetic and strain energy, J [state]: what leapfrog keeps.

    Of nodes that move half of a step h before a kick and half after it, that is
    v^2 m/2 + F^2/(2 k) - (h/2)^2 k w^2/2, k the stiffness of a cell and w the
    difference of its velocities.
    """
    mesh = run.mesh
    states = run.history
    h = run.step
    time = h * states.when[:, None]
    fall = run.row.system.gravity * time
    v = states.velocity + run.row.frame + fall  # [state, node]
    inside = mesh.stiffness[1:-1] > 0  # cells of bodies, not those between pieces
    k = mesh.stiffness[1:-1][inside]
    lateral = mesh.lateral_inertia[1:-1][inside]
    rate = np.diff(v, axis=1)[:, inside]  # [state, cell]
    force = states.force[:, 1:-1][:, inside]
    of_nodes = v * v @ moving_mass(mesh) / 2
    of_cells = rate**2 @ (lateral - k * h * h / 4) / 2
    kinetic = of_nodes + of_cells
    elastic = force**2 @ (1 / k) / 2
    total = kinetic + elastic
    if mesh.has_radial_strain:
        total += energy_of_radial_strain(run, inside, k, rate)
    return total


def energy_of_radial_strain(run, inside, k, rate):
    """Energy of swelling and of shear between the cells, J [state].

    `inside`, `k` and `rate` are those of `energy_of_bodies`.
    """
    mesh = run.mesh
    h = run.step
    J = mesh.cells.radial_inertia[1:-1][inside]
    b = mesh.cells.coupling[1:-1][inside]
    G = mesh.cells.radial_stiffness[1:-1][inside]
    q = h * run.history.radial[:, 1:-1]  # radial strain, and its rate [state, cell]
    p = run.history.radial_rate[:, 1:-1]
    shear = mesh.shear_stiffness[1:-1]
    shear_strain = np.diff(q, axis=1)
    change_in_half_step = np.diff(h * p / 2, axis=1)
    total = shear_strain**2 @ shear / 2
    total -= change_in_half_step**2 @ shear / 2
    q = q[:, inside]
    p = p[:, inside]
    total += q * q @ (G - b * b / k) / 2
    total += p * p @ (J - h * h / 4 * G) / 2
    coupled = (rate * p) @ b
    return total - h * h / 4 * coupled


def energy_of_contacts(run):
    """Energy stored in all compliant contacts and joints, J, at the kept states
    [state].
    """
    total = np.zeros(run.steps + 1)
    for i, law in enumerate(run.row.system.contacts):
        if isinstance(law, ri.Rigid | ri.Bonded):
            continue
        _, gap = run.contact(i)
        overlap = -gap
        if not isinstance(law, ri.Joint):  # only a joint can also be stretched
            overlap = np.maximum(overlap, 0.0)
        total += law.stored(overlap)
    steps_of_states = run.history.when  # steps at which states are kept
    return total[steps_of_states]


@given(SEEDS, st.booleans())
def test_energies_at_every_state_are_those_that_leapfrog_keeps(seed, driven):
    """Energies of the solution of a random row are those of `energy_of_bodies` and
    `energy_of_contacts`.
    """
    system = random_row(seed, driven=driven, bodies=4)
    run = run_row(system, until=1.5)
    times = run.history.when * run.step

    solution = solution_of(run, until=1.5)
    energy = solution.energy(times)

    largest_work = np.abs(energy.drive_work).max()
    scale = energy.total.max() + largest_work
    round_off = 1e-11 * scale
    in_bodies = energy.kinetic + energy.vibration
    expected = energy_of_bodies(run)
    assert in_bodies == pytest.approx(expected, rel=0, abs=round_off)
    in_contacts = energy_of_contacts(run)
    assert energy.contact == pytest.approx(in_contacts, rel=0, abs=round_off)


# Contacts
# --------------------------------------------------------------------------------------

RODS = (unit_rod(velocity=0.5), unit_rod(velocity=-0.5))
MASSES = (ri.RigidMass(1.0, velocity=0.5), ri.RigidMass(1.0, velocity=-0.5))


@pytest.mark.parametrize(
    ("pair", "law"),
    [(RODS, ri.Rigid()), (MASSES, ri.Rigid(restitution=0.0))],
    ids=["rods", "masses"],
)
@pytest.mark.parametrize(("factor", "is_pressed"), [(1.0, False), (1.0 - 2**-50, True)])
def test_what_stops_no_more_than_the_tolerance_is_no_force(
    pair, law, factor, is_pressed
):
    """A contact presses only if it takes away more velocity than the tolerance, which
    is `factor` times what it would take.

    A contact without rebound takes half of the closing velocity, 1, as it shuts at the
    kick.
    """
    far_rod = unit_rod()
    bodies = [*pair, far_rod]
    laws = [law, ri.Rigid()]
    system = ri.System(bodies, gaps=[STEP / 2, 10.0], contacts=laws)
    run = grid_run(system, room=1)
    mobilities = run.grid.links["self_mobility"]
    mobility = float(mobilities[0])
    taken_away = 0.5 / mobility * mobility  # as the kernel rounds it
    run.grid.run["velocity_tolerance"] = taken_away * factor

    run.advance(1)

    force = run.history.signals["force"][0, 0]
    assert (force > 0) == is_pressed


@pytest.mark.parametrize("share", [0.4, 0.9, 1.5])
def test_a_gap_closes_at_its_time_but_not_before_the_first_kick(share):
    """The first kick is in the middle of the first step; the gap would close after a
    `share` of this step. From then on the force of equal bars is Z v/2.
    """
    bars = [unit_rod(velocity=1.0), unit_rod(1.3)]
    gap = share * STEP
    system = ri.System(bars, gaps=[gap])
    run = grid_run(system, room=20)

    run.advance(20)

    signals = run.history.signals
    force = 0.5  # Z v/2, N
    pressed_steps = signals["force"].sum() / force
    open_steps = max(share, 0.5)
    assert pressed_steps == pytest.approx(20 - open_steps, abs=0.01)
    assert signals["gap"].min() == 0


def test_a_mass_squeezed_between_walls_stops_the_run():
    """A mass between a moving wall and a rod, whose first node is fixed by editing the
    mesh, is squeezed: the run is refused at the path contacts.
    """
    laws = [ri.Rigid(restitution=0.5), ri.Rigid()]
    bodies = [ri.Wall(0.5), ri.RigidMass(1.0), unit_rod()]
    system = ri.System(bodies, gaps=[0.1, 0.1], contacts=laws)
    run = grid_run(system, room=50)
    # No force changes the velocity of the rod's first node, behind that of the mass.
    left_nodes = run.grid.links["left_node"]
    mobilities = run.grid.links["self_mobility"]
    rod_node = int(left_nodes[0]) + 2
    mobilities[1] -= run.grid.velocity_by_first[rod_node] / 2
    run.grid.velocity_by_first[rod_node] = 0.0
    paths = refused(r"two walls squeeze .* at 0\.\d+ s; give", run.advance, 50)
    assert paths == ["contacts"]


# The proof
# --------------------------------------------------------------------------------------


def random_far_end(seed):
    """A row whose first touching end is far from all else, and the rod of this end.

    The other end of the rod is free, fixed or absorbs, or a mass is bonded to it.
    """
    rng = default_rng(seed)
    soft = unit_density(1.0)
    segments = [
        ri.Segment(0.5, area=1.0, material=soft),
        ri.Segment(0.7, area=3.0, material=soft),
        ri.Segment(0.3, area=0.4, material=soft),
    ]
    if seed % 3 == 0:
        segments = [thicken(rng, segment) for segment in segments]
    velocities = rng.uniform(-1, 1, 5)
    strains = rng.uniform(-0.3, 0.3, 3)
    velocity = ri.Samples(velocities.tolist())
    strain = ri.Samples([0.0, *strains, 0.0])
    rod = ri.Rod(segments=segments, velocity=velocity, strain=strain)
    kinds_of_end = (ri.Free(), ri.Fixed(), ri.Absorbing())
    kind = seed % 2 + (seed > 9)
    end = kinds_of_end[kind]
    bodies = [rod, unit_rod()]
    gaps = [90.0]
    laws = [ri.Rigid()]
    if seed % 2 == 0 and seed < 10:
        velocity_of_end = float(rod.velocity.values[0])
        mass = ri.RigidMass(2.0, velocity=velocity_of_end)
        bodies.insert(0, mass)
        gaps.insert(0, 0.0)
        laws.insert(0, ri.Bonded())
    ends = (end, ri.Free())
    system = ri.System(bodies, gaps=gaps, contacts=laws, ends=ends)
    return system, rod


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("seed", few_of(range(12), range(3)))
def test_an_end_is_where_the_proof_says_and_stays_within_its_bound(seed, mirrored):
    """The end of a rod, 90 m from the next body, is at five times where the proof puts
    it: it moves with the centre of mass of its group, or with the end that holds it,
    and deviates by the sum of the strains between, within the bound.
    """
    system, rod = random_far_end(seed)
    body = system.bodies.index(rod)
    right_end = not mirrored
    x = 1.5  # length of the rod
    if mirrored:
        system = system.mirrored()
        body = len(system.bodies) - 1 - body  # counted from the other side
        x = 0.0
    reference_run = run_row(system, until=400 * STEP)
    solution = solution_of(reference_run)
    at_start = solution.displacement(body, x, 0.0)
    run = grid_run(system, room=400)
    link_nodes = run.mesh.link_nodes.values()
    left_node, right_node = next(iter(link_nodes))
    node = left_node if right_end else right_node

    run.advance(0)
    V, deviation, bound = group_at_contact(run, node, right_end, present_motion(run))

    largest = bound * (1 + 1e-12)
    for steps in (1, 7, 50, 51, 400):
        run.advance(steps)
        velocity, later_deviation, later_bound = group_at_contact(
            run, node, right_end, present_motion(run)
        )
        t = steps * STEP
        displacement = solution.displacement(body, x, t)
        moved = float(displacement - at_start)  # m
        mean_motion = (V + run.row.frame) * t
        expected = mean_motion + later_deviation - deviation
        assert moved == pytest.approx(expected, abs=1e-9 * STEP)
        assert velocity == pytest.approx(V, abs=1e-12)
        assert abs(later_deviation) <= largest
        assert later_bound <= largest
