"""The kernel of the grid, below the model: the same bits always, exact balances, no energy made."""

import numpy as np
import pytest
from grid_rows import grid_run, matrices, random_row, run_row, thicken
from hypothesis import given
from hypothesis import strategies as st
from mistakes import refused
from networks import STEP, unit_rod
from runs import solution_of

import rodimpact as ri
from rodimpact.methods import kernels, record_lists
from rodimpact.methods.grid import contact_kernel as contacts
from rodimpact.methods.grid import elimination_kernel as elimination
from rodimpact.methods.grid.proof import finality_time, present, side_of
from rodimpact.methods.grid.records import LINK, STATE_FIELDS
from rodimpact.methods.link import Law

seeds = st.integers(0, 10**6)


def bits(run, states=True):
    """Every number of the state, and what was entered."""
    grid = run.grid._asdict()
    del grid["run"]
    entered = {
        name: x
        for name, x in run.history._asdict().items()
        if states or name not in STATE_FIELDS
    }
    return {name: x.tobytes() for name, x in (grid | entered).items()}


# One source, the same bits ------------------------------------------------------------------------


@pytest.mark.skipif(not kernels.enabled(), reason="compiling is disabled")
def test_compiled_and_plain_runs_are_bit_identical():
    for seed in range(25):
        system = random_row(seed, driven=seed % 2 == 1)
        runs = []
        waits = []
        for compiling_it in (False, True):
            with kernels.forced(compiling_it):
                runs.append(grid_run(system, 48))
                runs[-1].advance(48)
                waits.append(finality_time(runs[-1]))
        assert bits(runs[0]) == bits(runs[1]), seed
        assert waits[0] == waits[1], seed


@pytest.mark.parametrize("driven", [False, True])
def test_a_run_in_pieces_is_the_whole_run(driven):
    for seed in range(8):
        system = random_row(seed, driven=driven)
        whole = grid_run(system, 100)
        pieces = grid_run(system, 100)
        whole.advance(100)
        for end in (
            *np.random.default_rng(seed).choice(np.arange(1, 100), 5).cumsum(),
            100,
        ):
            if end < 100:
                pieces.advance(int(end))
        pieces.advance(100)
        assert bits(whole) == bits(pieces), seed


# The elimination ----------------------------------------------------------------------------------


@given(seeds, st.integers(2, 12), st.booleans(), st.booleans())
def test_elimination_against_dense_matrices(seed, nodes, held_left, held_right):
    rng = np.random.default_rng(seed)
    before, after = rng.integers(0, 3, 2)
    n = before + nodes + after
    a = before
    b = before + nodes - 1
    bound = rng.uniform(0.01, 100, n + 1)
    bound[: a + 1] = bound[b + 1 :] = 0.0  # what stands beside is a piece by itself
    diagonal = rng.uniform(0.1, 10, n) + bound[:-1] + bound[1:]
    held = np.zeros(n, int)
    held[a], held[b] = held_left, held_right
    matrix = np.diag(diagonal)
    for i in range(a + 1, b + 1):
        matrix[i, i - 1] = matrix[i - 1, i] = -bound[i]
    matrix[held == 1] = np.eye(n)[held == 1]
    multipliers = elimination.factor(bound, diagonal, held)
    right = rng.uniform(-1, 1, n)
    found = right.copy()
    elimination.substitute(*multipliers, found)
    assert found == pytest.approx(np.linalg.solve(matrix, right), rel=1e-10, abs=1e-12)
    assert found[before + nodes :] == pytest.approx(
        right[b + 1 :] / diagonal[b + 1 :], rel=1e-15
    )


def test_newton_solves_a_chain_of_stiff_links_in_few_sweeps(monkeypatch):
    """Link after link, forces would spread by one body a sweep, and settle after hundreds."""
    links = np.zeros(12, LINK)
    for name, value in {
        "law": Law.SPRING,
        "stiffness": 1e4,
        "exponent": 1.0,
        "self_mobility": 1.0,
        "coupling_mobility": 0.49,
        "force_free_closing": 0.1,
        "overlap": 1e-3,
        "chain_end": 11,
    }.items():
        links[name] = value
    links["coupling_mobility"][0] = 0.0
    link = record_lists.as_objects(links)
    sweeps = []
    relax = contacts.gauss_seidel_sweep
    monkeypatch.setattr(
        contacts, "gauss_seidel_sweep", lambda *given: sweeps.append(1) or relax(*given)
    )
    assert contacts.solve_chain(link, 0, 11, 1.0)
    mobility = np.eye(12) - 0.49 * (np.eye(12, k=1) + np.eye(12, k=-1))
    force = np.linalg.solve(mobility + 2e-4 * np.eye(12), np.full(12, 0.1))  # F = k w/2
    assert [at.force for at in link] == pytest.approx(force, rel=1e-12)
    assert len(sweeps) <= 6


# A step against dense matrices --------------------------------------------------------------------


def dense_run(mesh, step, v, force, radial, steps, push):
    """Leapfrog of one piece with matrices: velocity, force and radial strain after the steps."""
    n, (M, damping, K) = len(v), matrices(mesh)
    k, b, J = (
        x[1:n] for x in (mesh.stiffness, mesh.cells.coupling, mesh.cells.swelling)
    )
    free = np.append(mesh.held == 0, J > 0)
    x = np.concatenate(([0.0], np.cumsum((force - b * radial) / k), radial))
    rate = np.append(v, np.zeros(n - 1))
    outer = np.zeros(2 * n - 1)
    outer[0], outer[n - 1] = push[0], -push[1]
    left = (M / step + damping / 2)[np.ix_(free, free)]
    for _ in range(steps):
        x += step * rate / 2  # in the middle of the step
        rate[free] += np.linalg.solve(left, (outer - K @ x - damping @ rate)[free])
        x += step * rate / 2
    return rate[:n], k * np.diff(x[:n]) + b * x[n:], x[n:]


@pytest.mark.parametrize("ends", ["free", "fixed", "pushed"])
@pytest.mark.parametrize("seed", range(8))
def test_steps_against_dense_matrices(seed, ends):
    rng = np.random.default_rng(seed)
    segments = [
        thicken(rng, ri.Segment(L, A, ri.Material("m", youngs_modulus=E, density=1.0)))
        for L, A, E in ((0.5, 1.0, 1.0), (0.4, 3.0, 2.0), (0.6, 0.7, 1.0))
    ]
    if seed == 0:
        segments = [
            ri.Segment(0.5, 1.0, ri.Material("m", youngs_modulus=1.0, density=1.0))
        ]
    rod = ri.Rod(
        segments=segments,
        velocity=ri.Samples([1.0, -1.0, 0.5]),
        strain=ri.Samples([0.1, 0.0, -0.2]),
    )
    kinds = {
        "free": (ri.Free(), ri.Free()),
        "fixed": (ri.Fixed(), ri.Free()),
        "pushed": (ri.Pushed(0.3), ri.Pushed(-0.2)),
    }
    row = [rod]
    push = (0.3, -0.2) if ends == "pushed" else (0.0, 0.0)
    if ends == "pushed" and seed % 2:
        row = [rod, ri.RigidMass(0.8, velocity=0.4)]
    system = ri.System(row, contacts=[ri.Bonded()] * (len(row) - 1), ends=kinds[ends])
    run = grid_run(system, 40)
    run.advance(40)
    n = len(run.mesh.mass)
    velocity = run.history.velocity
    force = run.history.force
    radial = np.zeros_like(force)
    if run.mesh.has_radial_strain:
        radial = run.step * run.history.radial
    v, F, q = dense_run(
        run.mesh, run.step, velocity[0], force[0, 1:n], radial[0, 1:n], 40, push
    )
    assert velocity[-1] == pytest.approx(v, abs=1e-12)
    assert force[-1, 1:n] == pytest.approx(F, abs=1e-12)
    assert radial[-1, 1:n] == pytest.approx(q, abs=1e-12)


# Passivity ----------------------------------------------------------------------------------------


def energy_of_bodies(run):
    """[state] kinetic and strain energy, J: what leapfrog keeps."""
    mesh = run.mesh
    states = run.history
    h = run.step
    v = (
        states.velocity
        + run.row.frame
        + run.row.system.gravity * h * states.when[:, None]
    )
    change = np.diff(v, axis=1)
    inside = mesh.stiffness[1:-1] > 0
    k = mesh.stiffness[1:-1][inside]
    lateral = mesh.lateral[1:-1][inside]
    change, force = change[:, inside], states.force[:, 1:-1][:, inside]
    free = mesh.mass * (mesh.held == 0)
    for node in np.flatnonzero(mesh.held):  # half cells on a driven end move with it
        free[node] = (mesh.cell_mass[node] + mesh.cell_mass[node + 1]) / 2
    kinetic = v * v @ free / 2 + change**2 @ (lateral - k * h * h / 4) / 2
    total = kinetic + force**2 @ (1 / k) / 2
    if mesh.has_radial_strain:
        J, b, G = (x[1:-1][inside] for x in mesh.cells[4:7])
        q = h * states.radial[:, 1:-1]
        p = states.radial_rate[:, 1:-1]
        for moved, share in ((q, 1.0), (h * p / 2, -1.0)):
            total += share * np.diff(moved, axis=1) ** 2 @ mesh.shear[1:-1] / 2
        q, p = q[:, inside], p[:, inside]
        total += q * q @ (G - b * b / k) / 2 + p * p @ (J - h * h / 4 * G) / 2
        total -= h * h / 4 * (change * p) @ b
    return total


def energy_of_contacts(run):
    """[state] energy stored in compliant contacts, J."""
    total = np.zeros(run.steps + 1)
    for i, law in enumerate(run.row.system.contacts):
        if not isinstance(law, ri.Rigid | ri.Bonded):
            _, gap = run.contact(i)
            total += law.stored(
                -gap if isinstance(law, ri.Joint) else np.maximum(-gap, 0.0)
            )
    return total[run.history.when]


@given(seeds, st.booleans())
def test_energies_at_every_state_are_those_that_leapfrog_keeps(seed, driven):
    run = run_row(random_row(seed, driven=driven, bodies=4), 1.5)
    ledger = solution_of(run, 1.5).energy(run.history.when * run.step)
    scale = ledger.total.max() + np.abs(ledger.drive_work).max()
    close = {"rtol": 0, "atol": 1e-11 * scale}
    np.testing.assert_allclose(
        ledger.kinetic + ledger.vibration, energy_of_bodies(run), **close
    )
    np.testing.assert_allclose(ledger.contact, energy_of_contacts(run), **close)


@pytest.mark.parametrize(
    "pair",
    [
        (unit_rod(velocity=0.5), unit_rod(velocity=-0.5)),
        (ri.RigidMass(1.0, velocity=0.5), ri.RigidMass(1.0, velocity=-0.5)),
    ],
    ids=["rods", "masses"],
)
def test_what_stops_no_more_than_the_tolerance_is_no_force(pair):
    """A contact without rebound takes half of the closing velocity, 1, as it shuts at the kick."""
    laws = [
        ri.Rigid() if isinstance(pair[0], ri.Rod) else ri.Rigid(restitution=0.0),
        ri.Rigid(),
    ]
    system = ri.System([*pair, unit_rod()], [STEP / 2, 10.0], laws)
    for slack, pressed in ((1.0, 0), (1.0 - 2**-50, 1)):
        run = grid_run(system, 1)
        own = float(run.grid.links["self_mobility"][0])
        run.grid.run["velocity_tolerance"] = 0.5 / own * own * slack
        run.advance(1)
        assert (run.history.signals["force"][0, 0] > 0) == pressed


@pytest.mark.parametrize("share", [0.4, 0.9, 1.5])
def test_a_gap_closes_at_its_time_but_not_before_the_first_kick(share):
    """The kicks are in the middle of steps; from then on the force of equal bars is Z v/2."""
    run = grid_run(
        ri.System([unit_rod(velocity=1.0), unit_rod(1.3)], [share * STEP]), 20
    )
    run.advance(20)
    pressed = run.history.signals["force"].sum() / 0.5  # steps
    assert pressed == pytest.approx(20 - max(share, 0.5), abs=0.01)
    assert run.history.signals["gap"].min() == 0


@pytest.mark.parametrize("law", [ri.Rigid(), ri.Rigid(restitution=0.5)])
def test_a_mass_squeezed_between_walls_stops_the_run(law):
    """A rod whose end is nailed down from within is the second wall."""
    laws = [ri.Rigid(restitution=0.5), law if law.restitution is None else ri.Rigid()]
    system = ri.System([ri.Wall(0.5), ri.RigidMass(1.0), unit_rod()], [0.1, 0.1], laws)
    run = grid_run(system, 50)
    node = int(run.grid.links["left_node"][0]) + 1
    run.grid.links["self_mobility"][1] -= run.grid.velocity_by_first[node + 1] / 2
    run.grid.velocity_by_first[node + 1] = 0.0
    assert refused(r"two walls squeeze .* at 0\.\d+ s; give", run.advance, 50) == [
        "contacts"
    ]


# The proof ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(12))
def test_an_end_is_where_the_proof_says_and_stays_within_its_bound(seed):
    """Far from all else: its centre of mass, or its wall, and the sum of strains beyond."""
    rng = np.random.default_rng(seed)
    pieces = [
        ri.Segment(L, A, ri.Material("m", youngs_modulus=1.0, density=1.0))
        for L, A in ((0.5, 1.0), (0.7, 3.0), (0.3, 0.4))
    ]
    if seed % 3 == 0:
        pieces = [thicken(rng, piece) for piece in pieces]
    rod = ri.Rod(
        segments=pieces,
        velocity=ri.Samples(rng.uniform(-1, 1, 5).tolist()),
        strain=ri.Samples([0.0, *rng.uniform(-0.3, 0.3, 3), 0.0]),
    )
    end = (ri.Free(), ri.Fixed(), ri.Absorbing())[seed % 2 + (seed > 9)]
    other = ri.RigidMass(2.0, velocity=float(rod.velocity.values[0]))
    row = [rod, unit_rod()]
    laws = [ri.Rigid()]
    gaps = [90.0]
    if seed % 2 == 0 and seed < 10:
        row, laws, gaps = [other, *row], [ri.Bonded(), *laws], [0.0, *gaps]
    system = ri.System(row, gaps, laws, ends=(end, ri.Free()))
    for mirrored in (False, True):
        turned = system.mirrored() if mirrored else system
        run = grid_run(turned, 400)
        left, right = next(iter(run.mesh.touching.values()))
        node, right_end, x = (right, False, 0.0) if mirrored else (left, True, 1.5)
        solution = solution_of(run_row(turned, 400 * STEP))
        body = (
            turned.bodies.index(rod) if not mirrored else len(row) - 1 - row.index(rod)
        )
        run.advance(0)
        V, d, bound = side_of(run, node, right_end, present(run))
        for end_ in (1, 7, 50, 51, 400):
            run.advance(end_)
            now, then, limit = side_of(run, node, right_end, present(run))
            t = end_ * STEP
            moved = float(
                solution.displacement(body, x, t) - solution.displacement(body, x, 0.0)
            )
            expected = (V + run.row.frame) * t + then - d
            assert moved == pytest.approx(expected, abs=1e-9 * STEP)
            assert now == pytest.approx(V, abs=1e-12)
            assert abs(then) <= bound * (1 + 1e-12)
            assert limit <= bound * (1 + 1e-12)
