"""Imports go one way: down to the ground."""

import ast
from pathlib import Path

import rodimpact

ROOT = Path(rodimpact.__file__).parent
LAYERS = [
    "version",
    "units",
    "hints",
    "progress",
    "model",
    "rigid",
    "theory",
    "materials",
    "methods",
    "waves",
    "storage",
    "records",
    "results",
    "running",
    "piles",
    "algebra",
    "design",
    "fitting",
    "plot",
    "explorer",
    "cli",
    "__main__",
]
"""Packages and modules at the root, from the ground up."""
METHODS = ("fronts", "pieces", "grid")
"""Packages of the methods; what they share lies beside them."""
LEVEL = {name: level for level, name in enumerate(LAYERS)}


def modules():
    for path in sorted(ROOT.rglob("*.py")):
        parts = path.relative_to(ROOT).with_suffix("").parts
        if parts != ("__init__",):
            yield ".".join(parts).removesuffix(".__init__"), path


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
                # a public name of the package lies in some module
                home = target or rodimpact._HOME.get(alias.name, "").split(".")[1:]
                if any(full if is_module else home):
                    yield ".".join(full if is_module else home)


def test_modules_import_only_what_lies_below_and_not_each_other_in_a_loop():
    imports = {name: set(imports_of(name, path)) for name, path in modules()}
    for name, targets in imports.items():
        here = name.split(".")
        for target in targets:
            there = target.split(".")
            assert LEVEL[there[0]] <= LEVEL[here[0]], f"{name} imports {target}"
            if here[0] == there[0] == "methods" and there[1] in METHODS:
                assert here[1] in (there[1], "registry"), (
                    f"{name} imports {target}, of one method"
                )
    while imports:
        free = {name for name, targets in imports.items() if not targets & set(imports)}
        assert free, f"a loop among {sorted(imports)}"
        imports = {
            name: targets for name, targets in imports.items() if name not in free
        }


def test_kernels_of_fronts_know_numbers_and_each_other():
    """So the page can take them."""
    kernels = {
        f"methods.fronts.{name}"
        for name in (
            "initial_state",
            "event_queue",
            "contact",
            "events",
            "finality",
            "energy",
            "members",
        )
    }
    kernels |= {"methods.tick_rule", "methods.finality_kernel"}
    known = kernels | {
        "methods.fronts.records",
        "methods.states",
        "methods.link",
        "methods.compiling",
        "methods.record_lists",
    }
    for name, path in modules():
        if name in kernels:
            assert set(imports_of(name, path)) <= known, name


def test_modules_are_imported_by_name_only_for_the_public_names_and_commands():
    by_string = {
        n for n, path in modules() if 'import_module(f".' in path.read_text("utf-8")
    }
    assert by_string == {"cli"}


def test_no_module_bears_the_name_of_a_public_function():
    functions = {
        n for n, home in rodimpact._HOME.items() if n.islower() and home != "."
    }
    assert "solve" in functions
    assert not functions & {name for name, _ in modules()}


def test_only_plot_imports_matplotlib_and_one_file_imports_numba():
    for name, path in modules():
        text = path.read_text(encoding="utf-8")
        if "matplotlib" in text and not name.startswith("plot"):
            imported = [
                node.names[0].name
                if isinstance(node, ast.Import)
                else node.module or ""
                for node in ast.walk(ast.parse(text))
                if isinstance(node, ast.Import | ast.ImportFrom)
            ]
            assert not any(m.startswith("matplotlib") for m in imported), name
        if name != "methods.compiling":
            assert "import numba" not in text, name
        assert "from numba" not in text, name
