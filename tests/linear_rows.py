"""Rows that are bonded, jointed and driven, and an independent solver for them.

Nothing here uses the package to solve. Transit times are multiples of a unit, so that
waves that leave an end in one interval arrive in another one. In each interval all
signals are polynomials of high degree, given by their values at Gauss-Legendre points.
With the rightgoing part f and the leftgoing part g of the velocity, v = f + g and the
tension is N = Z (g - f). So at the right end of a rod N = Z (v - 2 f), at the left end
N = Z (2 g - v), and a mass between them obeys m v' = N_right - N_left. A joint of
stretch s obeys s' = v_right - v_left and N = k s + c s'.
"""

from typing import NamedTuple

import numpy as np
from numpy.random import default_rng

import rodimpact as ri

UNIT_TIME = 1 / 16
"""Length of an interval, s; transit times are multiples of it."""
POINTS, WEIGHTS_FROM_MINUS_1 = np.polynomial.legendre.leggauss(16)
SHARES = (POINTS + 1) / 2
"""The points as shares of an interval [point]."""
WEIGHTS = WEIGHTS_FROM_MINUS_1 / 2
"""Weights of the values at the points in the mean over an interval [point]."""


def _integration():
    """Matrix from values at the points to integrals from the start of the interval to
    them, over the length of the interval [point, point].
    """
    columns = np.eye(len(SHARES))
    matrix = np.empty((len(SHARES), len(SHARES)))
    for j, values in enumerate(columns):
        degree = len(POINTS) - 1
        series = np.polynomial.legendre.legfit(POINTS, values, degree)
        primitive = np.polynomial.legendre.legint(series, lbnd=-1)
        integrals = np.polynomial.legendre.legval(POINTS, primitive)
        matrix[:, j] = integrals / 2  # the interval from -1 to 1 has the length 2
    return matrix


INTEGRATION = _integration()


class Piece(NamedTuple):
    """A rod (impedance, units of transit time, velocity), or a mass (mass, 0,
    velocity).
    """

    inertia: float
    units: int
    velocity: float


class LinearRow(NamedTuple):
    """Pieces; joints between them, None for a bond or (k, c); drives of the two ends.

    A drive is None (free), ("velocity", function) or ("force", function): to the right
    on the left end, to the left on the right end.
    """

    pieces: list
    joints: list
    drives: list


class Motion(NamedTuple):
    """Mean velocities of the pieces at the end, and impulses through the joints
    (pushes).
    """

    velocities: list
    impulses: list


def random_linear_row(seed):
    """A row of one to four rods and masses whose ends are free, pushed or moved. The
    first piece is a rod, and no two masses are neighbours. In 70 % of the rows all
    velocities, also those of moved ends, are equal at the start; in the others they
    differ.
    """
    rng = default_rng([seed, 45])
    count = int(rng.integers(1, 5))
    jumping = rng.random() < 0.3
    pieces = []
    joints = []
    for i in range(count):
        after_mass = i > 0 and pieces[-1].units == 0
        if jumping or i == 0:
            velocity = float(rng.uniform(-1, 1))
        else:
            velocity = pieces[0].velocity
        joint = None
        if i > 0 and rng.random() < 0.4:
            stiffness = float(rng.uniform(0.5, 20))
            damping = float(rng.choice([0.0, 0.3]))
            joint = (stiffness, damping)
        if i > 0 and rng.random() < 0.3 and not after_mass:
            mass = float(rng.uniform(0.1, 2))
            pieces.append(Piece(mass, 0, velocity))
        else:
            impedance = float(rng.uniform(0.5, 3))
            units = int(rng.integers(6, 20))
            pieces.append(Piece(impedance, units, velocity))
        if i > 0:
            joints.append(joint)
    first_drive = random_drive(rng, pieces[0], jumping)
    last_drive = random_drive(rng, pieces[-1], jumping)
    drives = [first_drive, last_drive]
    return LinearRow(pieces, joints, drives)


def random_drive(rng, piece, jumping):
    """A sine as the drive of an end beside a piece, or None; masses are not driven.

    A velocity begins with that of the piece if it is not to jump, a force with 0.
    """
    kind = rng.choice(["none", "velocity", "force"])
    if piece.units == 0 or kind == "none":
        return None
    rate = float(rng.uniform(1, 4))
    size = float(rng.uniform(-0.7, 0.7))
    start = 0.0
    if kind == "velocity" and not jumping:
        start = piece.velocity
    return str(kind), _sine(start, size, rate)


def _sine(start, size, rate):
    """A drive as a function of time, s."""
    return lambda t: start + size * np.sin(rate * t)


def system_of(row, until):
    """The same row for the package: wave speed 1, so that area and impedance are
    equal. Its drives are given until `until`, s.
    """
    unit = ri.Material("unit", youngs_modulus=1.0, density=1.0)
    bodies = []
    for piece in row.pieces:
        if piece.units == 0:
            mass = ri.RigidMass(piece.inertia, velocity=piece.velocity)
            bodies.append(mass)
            continue
        length = piece.units * UNIT_TIME
        impedance = piece.inertia
        rod = ri.Rod(length, area=impedance, material=unit, velocity=piece.velocity)
        bodies.append(rod)
    contacts = []
    for joint in row.joints:
        contacts.append(ri.Bonded() if joint is None else ri.Joint(*joint))
    ends = []
    for drive in row.drives:
        if drive is None:
            ends.append(ri.Free())
            continue
        kind, function = drive
        end_type = ri.Moved if kind == "velocity" else ri.Pushed
        ends.append(end_type(function, duration=until))
    return ri.System(bodies, contacts=contacts, ends=tuple(ends))


def solve_linear_row(row, intervals):
    """`Motion` of a row after so many intervals of `UNIT_TIME`.

    Every interval is one set of linear equations: for the velocities of both faces of
    each piece, and the forces between and outside them, at all points.
    """
    n = len(SHARES)
    count = len(row.pieces)
    speeds = [piece.velocity for piece in row.pieces]
    # Outgoing parts by piece: leaving the left end (rightgoing), leaving the right end.
    leaving = [([], []) for _ in row.pieces]
    stretches = [0.0 for _ in row.joints]
    impulses = [0.0 for _ in row.joints]
    identity = np.eye(n)
    for interval in range(intervals):
        times = (interval + SHARES) * UNIT_TIME
        n_velocities = 2 * count * n
        n_forces = (count + 1) * n
        size = n_velocities + n_forces
        matrix = np.zeros((size, size))
        right = np.zeros(size)
        equation = 0

        def face(piece, side, n=n):
            """Columns of the velocities of a piece's left (0) or right (1) face."""
            start = (2 * piece + side) * n
            return slice(start, start + n)

        def force(link, n=n):
            """Columns of the tensions to the left of piece `link`."""
            start = (2 * count + link) * n
            return slice(start, start + n)

        arriving = []
        for i, piece in enumerate(row.pieces):
            rows = slice(equation, equation + n)
            if piece.units == 0:
                # v - (integral of the difference of the tensions)/m = v at the start
                matrix[rows, face(i, 0)] = identity
                step = UNIT_TIME / piece.inertia * INTEGRATION
                matrix[rows, force(i + 1)] = -step
                matrix[rows, force(i)] = step
                right[rows] = speeds[i]
                equation += n
                rows = slice(equation, equation + n)
                matrix[rows, face(i, 0)] = identity
                matrix[rows, face(i, 1)] = -identity
                equation += n
                arriving.append(None)
                continue
            back = interval - piece.units
            initial = np.full(n, piece.velocity / 2)  # both parts before the start
            f = initial
            g = initial
            if back >= 0:
                from_left, from_right = leaving[i]
                f = from_left[back]
                g = from_right[back]
            arriving.append((f, g))
            # left end: N + Z v = 2 Z g; right end: N - Z v = -2 Z f
            matrix[rows, force(i)] = identity
            matrix[rows, face(i, 0)] = piece.inertia * identity
            right[rows] = 2 * piece.inertia * g
            equation += n
            rows = slice(equation, equation + n)
            matrix[rows, force(i + 1)] = identity
            matrix[rows, face(i, 1)] = -piece.inertia * identity
            right[rows] = -2 * piece.inertia * f
            equation += n
        for j, joint in enumerate(row.joints):
            rows = slice(equation, equation + n)
            if joint is None:
                matrix[rows, face(j, 1)] = identity
                matrix[rows, face(j + 1, 0)] = -identity
            else:
                k, c = joint
                law = k * UNIT_TIME * INTEGRATION + c * identity
                matrix[rows, force(j + 1)] = identity
                matrix[rows, face(j + 1, 0)] = -law
                matrix[rows, face(j, 1)] = law
                right[rows] = k * stretches[j]
            equation += n
        # Link and piece at the left and at the right end of the row
        ends = [(0, 0), (count, count - 1)]
        for side, drive in enumerate(row.drives):
            rows = slice(equation, equation + n)
            link, end_piece = ends[side]
            if drive is None:
                matrix[rows, force(link)] = identity
            elif drive[0] == "force":
                matrix[rows, force(link)] = identity
                right[rows] = -drive[1](times)
            else:
                matrix[rows, face(end_piece, side)] = identity
                right[rows] = drive[1](times)
            equation += n
        solution = np.linalg.solve(matrix, right)
        for i, piece in enumerate(row.pieces):
            if piece.units == 0:
                force_on_right = solution[force(i + 1)]
                gained = force_on_right - solution[force(i)]
                mean_force = float(WEIGHTS @ gained)
                speeds[i] += UNIT_TIME / piece.inertia * mean_force
            else:
                f, g = arriving[i]
                velocity_of_left_face = solution[face(i, 0)]
                velocity_of_right_face = solution[face(i, 1)]
                from_left, from_right = leaving[i]
                from_left.append(velocity_of_left_face - g)
                from_right.append(velocity_of_right_face - f)
        for j in range(len(row.joints)):
            mean_tension = float(WEIGHTS @ solution[force(j + 1)])
            impulses[j] -= UNIT_TIME * mean_tension  # a push is positive
            face_on_left = solution[face(j, 1)]
            face_on_right = solution[face(j + 1, 0)]
            stretching = face_on_right - face_on_left
            stretches[j] += UNIT_TIME * float(WEIGHTS @ stretching)
    velocities = []
    for i, piece in enumerate(row.pieces):
        if piece.units == 0:
            velocities.append(speeds[i])
            continue
        total = 0.0
        for back in range(1, piece.units + 1):
            interval = intervals - back
            for line in leaving[i]:
                mean = piece.velocity / 2
                if interval >= 0:
                    mean = float(WEIGHTS @ line[interval])
                total += mean
        velocities.append(total / piece.units)
    return Motion(velocities, impulses)
