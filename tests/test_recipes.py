"""The recipes of docs/contributing.md, carried out in a copy of the package.

Each recipe touches the files and the lists of tests that the table names, and no
others; then the new thing works, and the tests that list all such things pass.
"""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "contributing.md").read_text("utf-8")
FOLDERS = ("rodimpact", "docs", "tests", "validation")
FILES = ("README.md", "pyproject.toml")
LISTS = (
    "tests/test_documentation.py::test_the_manual_lists_every_public_name",
    "tests/test_documentation.py::test_every_name_of_the_manual_has_an_example",
    "tests/fuzz/test_calls.py::test_every_public_name_has_good_arguments",
    "tests/test_layers.py",
)
"""Tests that look at every public name."""

NEW_FILE = ""
"""Text in place of which a whole file is written."""

# Edits of each recipe: by file, pairs of a text and of what takes its place. Files of
# the package are named without its folder.
UNIT = {
    "units.py": [
        (
            '        "km": "1e3",\n',
            '        "km": "1e3",\n        "furlong": "201.168",\n',
        )
    ],
}
CLOSED_FORM = {
    "theory.py": [
        ('    "rod_on_wall",\n', '    "first_force",\n    "rod_on_wall",\n'),
        (
            "@explain_arguments\ndef mass_on_rod(",
            '''@explain_arguments
def first_force(
    impedance_1: ArrayLike, impedance_2: ArrayLike, closing_speed: ArrayLike
) -> Number:
    """Force of two rods that have just met, F = V Z1 Z2/(Z1 + Z2).

    Parameters
    ----------
    impedance_1, impedance_2 : float or array
        Impedances of the rods [kg/s].
    closing_speed : float or array
        Speed at which the rods approach each other [m/s].

    Returns
    -------
    float or array
        The force [N].

    Examples
    --------
    >>> first_force(2.0, 2.0, 3.0)
    3.0
    """
    Z1, Z2, V = _checked(
        impedance_1=impedance_1, impedance_2=impedance_2, closing_speed=closing_speed
    )
    return float_or_array(V * Z1 * Z2 / (Z1 + Z2))


@explain_arguments
def mass_on_rod(''',
        ),
    ],
    "docs/api.md": [
        ("   theory.rod_on_wall\n", "   theory.rod_on_wall\n   theory.first_force\n")
    ],
    "tests/fuzz/good_calls.py": [
        (
            '    "theory.mass_on_rod"',
            '    "theory.first_force": lambda: {\n'
            '        "impedance_1": 1.0, "impedance_2": 1.0, "closing_speed": 1.0\n'
            '    },\n    "theory.mass_on_rod"',
        )
    ],
}
FIGURE = {
    "plot/velocities.py": [
        (
            NEW_FILE,
            '''"""Velocities of the centres of mass over time."""

import numpy as np
from matplotlib.axes import Axes

from ..results.solution import Solution, check_solution
from .panels import Draft, Picture, axes_or_new, finish, format_axes
from .scales import time_scale
from .style import styled


@styled
def velocities(solution: Solution, ax: Axes | None = None) -> Picture:
    """Draw the velocity of each body over time.

    Parameters
    ----------
    solution : Solution
    ax : Axes, optional
        By default a new figure is made.

    Returns
    -------
    Picture

    Examples
    --------
    >>> import rodimpact as ri
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> picture = ri.plot.velocities(ri.solve(ri.System([rod, ri.Wall()])))
    >>> picture.ax.get_ylabel()
    'velocity (m/s)'
    """
    check_solution(solution)
    ax = axes_or_new(ax, 5.6, 3.2)
    time = time_scale(solution.t_end)

    # What is measured.
    times = np.linspace(0.0, solution.t_end, 200)

    # What is drawn.
    curves = []
    for body in range(len(solution.system.bodies)):
        velocity = solution.mean_velocity(body, times)
        curves += ax.plot(times * time.factor, velocity)
    format_axes(ax, xlabel=time.label, ylabel="velocity (m/s)")
    return finish(Draft(Picture(ax=ax, curves=curves), lambda: None))
''',
        )
    ],
    "plot/__init__.py": [
        (
            "from .style import look",
            "from .style import look\nfrom .velocities import velocities",
        ),
        ('    "sweep",\n]', '    "sweep",\n    "velocities",\n]'),
    ],
    "docs/api.md": [("   plot.energy\n", "   plot.energy\n   plot.velocities\n")],
    "tests/fuzz/good_calls.py": [
        (
            '    "plot.energy"',
            '    "plot.velocities": lambda: {"solution": exact_solution()},\n    "plot.energy"',
        )
    ],
    "tests/plot/test_plot_labels.py": [
        (
            '    "energy": plot.energy,',
            '    "velocities": plot.velocities,\n    "energy": plot.energy,',
        )
    ],
}
LAW = {
    "model/laws.py": [
        (
            "class SpringDashpot(_Linear",
            '''class Bumper(_Linear, law="bumper"):
    """A bumper: F = k d.

    Parameters
    ----------
    stiffness : float or array
        k, N/m.

    Examples
    --------
    >>> Bumper(stiffness=1e8)
    Bumper(stiffness=100000000.0)
    """

    acts_as = "spring"
    fills_link = ("stiffness",)
    stiffness: Numeric = quantity("N/m", "positive")


class SpringDashpot(_Linear''',
        ),
        ("    | Tabulated\n", "    | Tabulated\n    | Bumper\n"),
    ],
    "__init__.pyi": [
        (
            "from .model.laws import Cushion",
            "from .model.laws import Bumper as Bumper\nfrom .model.laws import Cushion",
        )
    ],
    "docs/api.md": [("   Cushion\n", "   Cushion\n   Bumper\n")],
    "docs/input.md": [
        (
            '### `[ends.SIDE] kind = "free"`',
            """### `[[contacts]] law = "bumper"`

A bumper: F = k d. See {class}`rodimpact.Bumper`.

| key | unit | takes | default |
|---|---|---|---|
| `stiffness` | N/m | > 0 | required |

```toml
[[contacts]]
law = "bumper"
stiffness = "20 kN/mm"
```

### `[ends.SIDE] kind = "free"`""",
        )
    ],
    "tests/model/test_laws.py": [
        ("    ri.Bonded(),\n", "    ri.Bonded(),\n    ri.Bumper(stiffness=1e6),\n"),
        ("cushion tabulated", "cushion tabulated bumper"),
    ],
    "tests/model/test_quantities.py": [
        ("    ri.Joint(1.0),\n", "    ri.Joint(1.0),\n    ri.Bumper(1.0),\n")
    ],
    "tests/storage/test_round_trip.py": [
        (
            '    "cushion": st',
            '    "bumper": st.builds(ri.Bumper, sizes()),\n    "cushion": st',
        )
    ],
    "tests/fuzz/good_calls.py": [
        (
            '    "Cushion": [',
            '    "Bumper": [lambda: ri.Bumper(1e8)],\n    "Cushion": [',
        ),
        (
            '    "Cushion": lambda',
            '    "Bumper": lambda: {"stiffness": 1e8},\n    "Cushion": lambda',
        ),
        ('"Yielding", "SmithToe",', '"Yielding", "Bumper", "SmithToe",'),
    ],
}
LAW_WITH_A_FORCE = {
    "model/laws.py": [
        (
            'class Yielding(Plastic, law="yielding"):',
            '''class ViscousPower(_Compliant, law="viscous-power"):
    """Contact of viscoelastic bodies: F = max(0, k d^p + c d^q d').

    G. Kuwabara and K. Kono, Restitution coefficient in a collision between two spheres,
    Jpn. J. Appl. Phys. 26 (1987) 1230-1233: p = 3/2 and q = 1/2 for spheres.

    Parameters
    ----------
    stiffness : float or array
        k, N/m^p, a bare number.
    exponent : float or array
        p, at least 1.
    damping : float or array
        c, N s/m^(q+1), a bare number.
    damping_exponent : float or array
        q, positive.

    Raises
    ------
    InvalidModel
        If a number is out of its range.

    Examples
    --------
    >>> spheres = ViscousPower(1e10, exponent=1.5, damping=1e6, damping_exponent=0.5)
    >>> round(float(spheres.stored(1e-4)), 12)        # J: k d^(5/2)/(5/2)
    0.4
    """

    acts_as = "viscous"
    fills_link = ("stiffness", "exponent", "damping", "damping_exponent")
    stiffness: Numeric = quantity("N/m^p", "positive")
    exponent: Numeric = quantity("", "[1, inf)")
    damping: Numeric = quantity("N s/m^(q+1)", "non-negative")
    damping_exponent: Numeric = quantity("", "positive")


class Yielding(Plastic, law="yielding"):''',
        ),
        ("    | PowerLaw\n", "    | PowerLaw\n    | ViscousPower\n"),
    ],
    "methods/link.py": [
        (
            "    OWN = 9  # a function of the user\n",
            "    OWN = 9  # a function of the user\n"
            "    VISCOUS = 10  # a power with a loss c d^q d'\n",
        ),
        (
            "    restitution: float",
            "    damping_exponent: float  # q of a loss c d^q d'\n    restitution: "
            "float",
        ),
        (
            '        "gap": (links',
            '        "damping": links["damping"] * step ** links["damping_exponent"],\n'
            '        "gap": (links',
        ),
    ],
    "methods/contact_laws.py": [
        (
            "    if is_nonlinear(link):  # a power",
            "    if law == Law.VISCOUS:\n"
            "        return viscous_force(link, d, closing)\n"
            "    if is_nonlinear(link):  # a power",
        ),
        (
            "def user_force(",
            '''def viscous_force(link: Any, d: float, closing: float) -> tuple[float, float, float]:
    """F = k d^p + c d^q d', N, with dF/dd and dF/dclosing (Kuwabara and Kono 1987).

    d' = closing - Y F. Solved for F, with g = k d^p, h = c d^q and share = 1/(1 + h Y):
    F = (g + h closing) share,  dF/dd = (dg/dd + dh/dd d') share,  dF/dclosing = h share.
    At d = 0, dh/dd may be infinite: 0 stands for it there, as below.
    """
    k = link.stiffness
    p = link.exponent
    q = link.damping_exponent
    Y = link.mobility
    root = abs(d) ** (p - 1)
    g = k * d * root
    slope = p * k * root  # dg/dd
    if link.damping == 0 or d <= 0:
        return g, slope, 0.0
    h = link.damping * d**q
    share = 1 / (1 + h * Y)
    F = (g + h * closing) * share
    rate = closing - Y * F
    return F, (slope + q * h / d * rate) * share, h * share


def user_force(''',
        ),
        (
            "    elif has_dashpot(link):\n        sign =",
            "    elif link.law == Law.VISCOUS:\n"
            "        x = max(d, 0.0)\n"
            "        excess = link.exponent - link.damping_exponent\n"
            "        if excess >= 0:\n"
            "            sign = (link.stiffness * x**excess / damping + closing) / "
            "scale\n        else:\n"
            "            sign = 1 + damping / link.stiffness * x ** (-excess) * "
            "closing\n    elif has_dashpot(link):\n        sign =",
        ),
        (
            "    if law == Law.POWER:\n        F, dF = mean_power",
            "    if law == Law.VISCOUS:\n"
            "        F, dF = mean_power(k, link.exponent, x0, x1)\n"
            "        # The mean of c x^q dx/dt over a step is its integral over x.\n"
            "        q = link.damping_exponent\n"
            "        first = max(x0, 0.0)\n"
            "        last = max(x1, 0.0)\n"
            "        F += damping * (last ** (q + 1) - first ** (q + 1)) / (q + 1)\n"
            "        dF += damping * last**q\n"
            "    elif law == Law.POWER:\n        F, dF = mean_power",
        ),
    ],
    "__init__.pyi": [
        (
            "from .model.laws import Yielding",
            "from .model.laws import ViscousPower as ViscousPower\n"
            "from .model.laws import Yielding",
        )
    ],
    "docs/api.md": [("   PowerLaw\n", "   PowerLaw\n   ViscousPower\n")],
    "docs/input.md": [
        (
            '### `[[contacts]] law = "yielding"`',
            """### `[[contacts]] law = "viscous-power"`

Contact of viscoelastic bodies: F = max(0, k d^p + c d^q d'). See {class}`rodimpact.ViscousPower`.

| key | unit | takes | default |
|---|---|---|---|
| `stiffness` | N/m^p | > 0 | required |
| `exponent` | 1 | [1, inf) | required |
| `damping` | N s/m^(q+1) | >= 0 | required |
| `damping_exponent` | 1 | > 0 | required |

```toml
[[contacts]]
law = "viscous-power"
stiffness = 10000000000
exponent = 1.5
damping = 1000000
damping_exponent = 0.5
```

### `[[contacts]] law = "yielding"`""",
        )
    ],
    "tests/model/test_laws.py": [
        (
            "    ri.PowerLaw(stiffness=1e9, exponent=2.0),\n",
            "    ri.PowerLaw(stiffness=1e9, exponent=2.0),\n"
            "    ri.ViscousPower(1e9, 1.5, 1e5, 0.5),\n",
        ),
        ('power yielding "', 'power viscous-power yielding "'),
    ],
    "tests/model/test_quantities.py": [
        (
            "    ri.PowerLaw(1.0, 1.5),\n",
            "    ri.PowerLaw(1.0, 1.5),\n    ri.ViscousPower(1.0, 1.5, 1.0, 0.5),\n",
        )
    ],
    "tests/storage/test_round_trip.py": [
        (
            '    "yielding": st.builds(',
            '    "viscous-power": st.builds(\n'
            "        ri.ViscousPower, sizes(), shares(1, 5), sizes(), shares(0.1, 5)\n"
            '    ),\n    "yielding": st.builds(',
        )
    ],
    "tests/fuzz/good_calls.py": [
        (
            '    "PowerLaw": [',
            '    "ViscousPower": [lambda: ri.ViscousPower(1e8, 1.5, 1e4, 0.5)],\n'
            '    "PowerLaw": [',
        ),
        (
            '    "PowerLaw": lambda',
            '    "ViscousPower": lambda: {\n'
            '        "stiffness": 1e8, "exponent": 1.5, "damping": 1e4, "damping_exponent": 0.5\n'
            '    },\n    "PowerLaw": lambda',
        ),
        ('"Yielding", "SmithToe",', '"Yielding", "ViscousPower", "SmithToe",'),
    ],
}
VISCOUS_PROGRAM = """
import numpy as np
from scipy.integrate import solve_ivp

# A mass on a wall, as an integration of the law has it
m, v, k, p = 0.5, 1.0, 1e10, 1.5
for c, q in ((1e6, 0.5), (3e5, 0.5), (1e12, 2.5)):

    def motion(t, state):
        d, rate = state
        force = 0.0
        if d > 0:
            force = max(0.0, k * d**p + c * d**q * rate)
        return [rate, -force / m]

    def overlap(t, state):
        return state[0]

    overlap.terminal = True
    overlap.direction = -1
    begin = [1e-18, v]
    run = solve_ivp(motion, (0, 1.0), begin, events=overlap, rtol=1e-11, atol=1e-18)
    mass = ri.RigidMass(m, velocity=v)
    law = ri.ViscousPower(k, p, c, q)
    outcome = ri.solve(ri.System([mass, ri.Wall()], contacts=[law])).outcome
    assert abs(outcome.velocities_after[0] - run.y[1, -1]) < 1e-8
    lost = m * (v**2 - run.y[1, -1] ** 2) / 2
    assert abs(outcome.dissipated - lost) < 1e-8
    assert abs(outcome.energy_residual) < 1e-9


# Two rods: both methods, a family, a file
def pair(c):
    law = ri.ViscousPower(k, p, c, 0.5)
    left = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    right = ri.Rod(1.0, area=1e-4, material=ri.materials.steel)
    return ri.System([left, right], contacts=[law])


outcome = ri.solve(pair(1e6)).outcome
on_grid = ri.solve(pair(1e6), method="finite-difference", cells=400).outcome
assert abs(outcome.restitution - on_grid.restitution) < 1e-5
assert abs(outcome.dissipated / on_grid.dissipated - 1) < 1e-3
assert abs(on_grid.energy_residual) < 1e-12
family = ri.sweep(pair(np.array([0.0, 1e6])), progress=False)
assert family.restitution[1] == outcome.restitution
assert ri.parse_case(ri.format_case(pair(1e6))).system == pair(1e6)
"""
# The new thing as the page calls it, the edits, a program that uses it, and tests
RECIPES = [
    pytest.param(
        "a unit",
        UNIT,
        "assert ri.units.parse('2 furlong', 'length') == 402.336\n",
        (),
        id="unit",
    ),
    pytest.param(
        "a closed form",
        CLOSED_FORM,
        "assert ri.theory.first_force(1.0, 1.0, [2.0, 4.0]).tolist() == [1.0, 2.0]\n",
        (*LISTS, "tests/test_documentation.py::test_examples_in_docstrings[theory]"),
        id="closed form",
        marks=pytest.mark.exhaustive,
    ),
    pytest.param(
        "a figure",
        FIGURE,
        "rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)\n"
        "picture = ri.plot.velocities(ri.solve(ri.System([rod, ri.Wall()])))\n"
        "ri.plot.save(picture, 'velocities.png')\n",
        (*LISTS, "tests/plot/test_plot_labels.py"),
        id="figure",
        marks=pytest.mark.exhaustive,
    ),
    pytest.param(
        "a contact law with an existing force",
        LAW,
        "rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)\n"
        "results = []\n"
        "for law in (ri.Bumper(1e8), ri.Spring(1e8)):\n"
        "    system = ri.System([rod, ri.Wall()], contacts=[law])\n"
        "    assert ri.parse_case(ri.format_case(system)).system == system\n"
        "    results.append(ri.solve(system).outcome.velocities_after)\n"
        "assert results[0] == results[1]\n",
        (
            *LISTS,
            "tests/test_documentation.py::test_examples_in_docstrings[model]",
            "tests/model/test_laws.py",
            "tests/model/test_quantities.py",
            "tests/storage/test_round_trip.py",
            "tests/storage/test_case_keys.py",
        ),
        id="law",
        marks=pytest.mark.exhaustive,
    ),
    pytest.param(
        "a contact law with a new force",
        LAW_WITH_A_FORCE,
        VISCOUS_PROGRAM,
        (
            *LISTS,
            "tests/test_documentation.py::test_examples_in_docstrings[model]",
            "tests/model/test_laws.py",
            "tests/model/test_quantities.py",
            "tests/storage/test_round_trip.py",
            "tests/storage/test_case_keys.py",
        ),
        id="law with a force",
        marks=pytest.mark.exhaustive,
    ),
]


def files_named_by(what):
    """Files that the table of the page names for a new thing of this kind.

    Those of the package are named without its folder; lists have the folder tests/.
    """
    row = re.search(rf"^\| {re.escape(what)} \| (\d+) \| (.*) \| (.*)\|$", PAGE, re.M)
    count, names, names_of_lists = row.groups()
    files = re.findall(r"`([^`]+)`", names)
    assert len(files) == int(count)
    lists = re.findall(r"`([^`]+)`", names_of_lists)
    return {*files, *(f"tests/{name}" for name in lists)}


def place_of(name):
    """Path of a file of a recipe; those of the package are named without its folder."""
    if name.startswith(("docs/", "tests/")):
        return name
    return f"rodimpact/{name}"


@pytest.fixture
def copy(tmp_path):
    """A copy of the package with its manual and tests, without compiled code."""
    ignored = shutil.ignore_patterns("__pycache__")
    for folder in FOLDERS:
        shutil.copytree(ROOT / folder, tmp_path / folder, ignore=ignored)
    for file in FILES:
        shutil.copy(ROOT / file, tmp_path)
    return tmp_path


def run_in(folder, *arguments):
    """Run Python on the package in a folder; the result must be a success."""
    done = subprocess.run(
        [sys.executable, *arguments],
        cwd=folder,
        env={"PYTHONPATH": str(folder), "PATH": "", "HOME": str(folder)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]


def carry_out(edits, copy):
    """Make the edits of a recipe in a copy of the package."""
    for name, replacements in edits.items():
        path = copy / place_of(name)
        for before, after in replacements:
            if before == NEW_FILE:
                path.write_text(after, "utf-8")
                continue
            text = path.read_text("utf-8")
            assert before in text, name
            path.write_text(text.replace(before, after, 1), "utf-8")


@pytest.mark.parametrize(("what", "edits", "program", "tests"), RECIPES)
def test_a_recipe_touches_the_files_that_the_page_names_and_gives_a_thing_that_works(
    what, edits, program, tests, copy
):
    """The edits of a recipe are in the files that its page names; in a copy with these
    edits, its program and its tests, if it has any, run without an error.
    """
    assert set(edits) == files_named_by(what)

    carry_out(edits, copy)

    run_in(copy, "-c", f"import rodimpact as ri\n{program}")
    if tests:
        run_in(copy, "-m", "pytest", "-n0", "-q", "-p", "no:cacheprovider", *tests)
