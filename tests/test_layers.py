"""Imports go one way: down to the ground."""

import ast
from pathlib import Path

import pytest

import rodimpact

ROOT = Path(rodimpact.__file__).parent
LAYERS = [
    {"units", "quantities", "writing"},
    {"frozen", "arguments", "methods", "methods.kernels", "methods.layout_kernel",
     "methods.front_kernel", "methods.grid_kernel", "methods.link_kernel",
     "methods.characteristics_kernel", "methods.finite_difference_kernel"},
    {"profiles", "rigid"},
    {"bodies", "ends"},
    {"laws"},
    {"model"},
    {"materials", "theory", "methods.clockwork", "methods.abilities", "methods.plan"},
    {"methods.refinement", "methods.delays"},
    {"methods.assembly", "methods.mesh"},
    {"methods.step_machine", "methods.grid_machine"},
    {"methods.characteristics", "methods.finite_difference"},
    {"methods.fronts", "methods.families", "signals"},
    {"fields"},
    {"wave_fields", "grid_fields"},
    {"contacts", "groups", "options"},
    {"outcome"},
    {"front_totals"},
    {"ledger", "gauges"},
    {"records", "ring_down"},
    {"solution"},
    {"stepped"},
    {"status"},
    {"solving", "regions", "placing", "closed_forms", "files"},
    {"checkpoint"},
    {"sweeping"},
    {"report"},
    {"casefile", "verify", "plot"},
    {"explore"},
    {"cli"},
    {"__main__"},
]
ALLOWED = {
    # printing and saving, imported when asked for
    ("outcome", "report"), ("solution", "report"), ("ring_down", "report"), ("solution", "files"),
    ("files", "sweeping"),
    # pictures in notebooks
    ("solution", "plot"), ("sweeping", "plot"),
}
LEVEL = {name: level for level, names in enumerate(LAYERS) for name in names}


def modules():
    for path in sorted(ROOT.rglob("*.py")):
        parts = path.relative_to(ROOT).with_suffix("").parts
        if parts != ("__init__",):
            yield ".".join(parts).removesuffix(".__init__"), path


def place(name):
    while name not in LEVEL:
        if "." not in name:
            raise AssertionError(f"module {name} has no layer; give it one")
        name = name.rpartition(".")[0]
    return name


def imports_of(name, path):
    package = ("rodimpact." + name).split(".")
    if path.name != "__init__.py":
        package = package[:-1]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.level:
            base = package[: len(package) - node.level + 1][1:]
            target = base + (node.module.split(".") if node.module else [])
            for alias in node.names:
                full = [*target, alias.name]
                inside = ROOT.joinpath(*full)
                is_module = inside.is_dir() or inside.with_suffix(".py").exists()
                yield ".".join(full if is_module else target)


@pytest.mark.parametrize(("name", "path"), [pytest.param(*m, id=m[0]) for m in modules()])
def test_a_module_imports_only_what_lies_below(name, path):
    here = place(name)
    for target in imports_of(name, path):
        if not target:
            continue  # the package itself, for its version
        there = place(target)
        fine = LEVEL[there] < LEVEL[here] or there == here or (here, there) in ALLOWED
        same_kernel_floor = LEVEL[there] == LEVEL[here] and here.startswith("methods")
        assert fine or same_kernel_floor, f"{name} imports {target}"


def test_no_module_bears_the_name_of_a_public_function():
    functions = {n for n in rodimpact.__all__ if n.islower()} - set(rodimpact._MODULES)
    assert not functions & {name for name, _ in modules()}


def test_only_plot_imports_matplotlib_and_only_the_door_imports_numba():
    for name, path in modules():
        text = path.read_text(encoding="utf-8")
        if "matplotlib" in text and not name.startswith("plot"):
            imported = [
                node.names[0].name if isinstance(node, ast.Import) else node.module or ""
                for node in ast.walk(ast.parse(text))
                if isinstance(node, ast.Import | ast.ImportFrom)
            ]
            assert not any(m.startswith("matplotlib") for m in imported), name
        if name != "methods.kernels":
            assert "import numba" not in text, name
