"""Compliant contacts and rigid masses on the page: characteristics as JavaScript."""

import json
import shutil
import subprocess
import tomllib
from itertools import pairwise

import numpy as np
import pytest

import rodimpact as ri
from rodimpact.explorer.design import LIBRARY
from rodimpact.explorer.javascript import javascript
from rodimpact.explorer.page_files import read
from rodimpact.explorer.smooth import smooth_known
from rodimpact.explorer.solver import CONSTANTS, KNOWN
from rodimpact.explorer.tables import RULES, lacking, mistakes, row_of

NODE = shutil.which("node")
needs_node = pytest.mark.skipif(NODE is None, reason="node is not installed")
STEEL, ALUMINIUM = ri.materials.steel, ri.materials.aluminium


def run(script, data):
    """What a script in Node makes of JSON data: `answer(data)`."""
    text = f"{script}\nconst data = JSON.parse(require('fs').readFileSync(0, 'utf8'));\n"
    text += "process.stdout.write(JSON.stringify(answer(data)));"
    done = subprocess.run([NODE, "-e", text], input=json.dumps(data), capture_output=True,
                          text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def random_law(rng):
    k = 10.0 ** rng.uniform(6, 10)
    return [
        ri.Spring(k), ri.SpringDashpot(k, damping=10.0 ** rng.uniform(0, 4)), ri.Hertz(100 * k),
        ri.HuntCrossley(100 * k, damping=rng.uniform(0.01, 0.5)),
        ri.PowerLaw(k, exponent=rng.uniform(1.0, 2.0)),
    ][rng.integers(5)]


def random_row(seed):
    """Two to four rods, masses and walls, with compliant contacts or masses."""
    rng = np.random.default_rng(seed)
    bodies = []
    for i in range(rng.integers(2, 5)):
        speed = float(rng.uniform(-1, 1)) if i else 1.0
        if i and rng.random() < 0.25:
            bodies.append(ri.RigidMass(10.0 ** rng.uniform(-2, 0), velocity=speed))
        else:
            segments = [ri.Segment(rng.uniform(0.1, 1.0), 1e-4 * rng.uniform(0.5, 2.0),
                                   STEEL if rng.random() < 0.7 else ALUMINIUM)
                        for _ in range(1 + (rng.random() < 0.15))]
            bodies.append(ri.Rod(segments=segments, velocity=speed))
    if rng.random() < 0.2:
        bodies.append(ri.Wall())
    contacts = []
    for pair in pairwise(bodies):
        rods = any(isinstance(body, ri.Rod) for body in pair)
        contacts.append(ri.Rigid() if rods and rng.random() < 0.2 else random_law(rng))
    gaps = [float(rng.uniform(0, 1e-4)) if rng.random() < 0.3 else 0.0 for _ in contacts]
    until = float(rng.uniform(5e-4, 2e-3)) if rng.random() < 0.3 else None
    return ri.Case(ri.System(bodies, gaps, contacts), {} if until is None else {"until": until})


def tables_of(case):
    return {"solve": {}, **tomllib.loads(ri.write_case(case))}


def shown_by_the_page(cases):
    """What the page knows of cases, without pictures."""
    functions = (row_of, lacking, mistakes, smooth_known)
    text = javascript(functions, CONSTANTS, KNOWN)
    script = f"""{read("python.js")}\n{read("numbers.js")}\n{text}
    const answer = ({{ cases, library, rules }}) => cases.map((tables) => {{
      if (lacking(tables)[0] || mistakes(tables, [], library, rules).length) return null;
      return smooth_known(row_of(tables, library), tables.contacts, []);
    }});"""
    return run(script, {"cases": cases, "library": LIBRARY, "rules": RULES})
