"""Imports go one way: down to the ground."""

import ast
import functools
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
"""Height of each of them above the ground."""


@functools.cache
def modules():
    """Pairs of the name of a module, below the package, and its path."""
    pairs = []
    for path in sorted(ROOT.rglob("*.py")):
        parts = path.relative_to(ROOT).with_suffix("").parts
        if parts != ("__init__",):
            pairs.append((".".join(parts).removesuffix(".__init__"), path))
    return pairs


def statements_of(node):
    """All statements below a node; expressions are left out, they import nothing."""
    for field in ("body", "orelse", "handlers", "finalbody"):
        for statement in getattr(node, field, []):
            yield statement
            yield from statements_of(statement)


@functools.cache
def imports_of(name, path):
    """Names of the modules of the package that a module imports by relative imports."""
    package = ("rodimpact." + name).split(".")
    if path.name != "__init__.py":
        package = package[:-1]
    names = []
    for node in statements_of(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.level:
            base = package[: len(package) - node.level + 1][1:]
            target = base + (node.module.split(".") if node.module else [])
            for alias in node.names:
                parts = [*target, alias.name]
                inside = ROOT.joinpath(*parts)
                is_module = inside.is_dir() or inside.with_suffix(".py").exists()
                if not is_module and target:  # a name of the module `target`
                    parts = target
                elif not is_module:  # a public name, which lies in some module
                    parts = rodimpact._HOME.get(alias.name, "").split(".")[1:]
                if any(parts):
                    names.append(".".join(parts))
    return names


def test_modules_import_no_higher_layer_and_no_method_but_their_own():
    """Each import within the package leads to the same layer or a lower one; only
    `registry` imports from several methods.
    """
    for name, path in modules():
        package, *inside = name.split(".")
        for target in imports_of(name, path):
            target_package, *inside_target = target.split(".")
            message = f"{name} imports {target}"
            assert LEVEL[target_package] <= LEVEL[package], message
            is_between_methods = package == "methods" and target_package == "methods"
            if is_between_methods and inside_target[0] in METHODS:
                assert inside[0] in (inside_target[0], "registry"), message


def test_no_modules_import_each_other_in_a_loop():
    """Modules whose imports are all taken away are taken away in turn; in the end none
    is left.
    """
    imports = {name: set(imports_of(name, path)) for name, path in modules()}
    while imports:
        # Modules that import none of those that are left are taken away.
        free = [name for name in imports if not imports[name] & set(imports)]
        assert free, f"a loop among {sorted(imports)}"
        for name in free:
            del imports[name]


def test_kernels_of_fronts_import_records_statuses_and_each_other_only():
    """So the page can take them as they are."""
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
    importing_by_name = []
    for name, path in modules():
        if 'import_module(f".' in path.read_text("utf-8"):
            importing_by_name.append(name)
    assert importing_by_name == ["cli"]  # beside the root of the package


def test_no_module_bears_the_name_of_a_public_function():
    """No module of the package is called `solve`, or as another public function."""
    functions = set()
    for name, home in rodimpact._HOME.items():
        if name.islower() and home != ".":
            functions.add(name)
    assert "solve" in functions
    assert not functions & {name for name, _ in modules()}


def imported_libraries(text):
    """Names of the modules that a source imports, without those by relative imports."""
    names = []
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and not node.level:
            names.append(node.module)
    return names


def test_only_plot_imports_matplotlib_and_one_file_imports_numba():
    """Outside `plot`, no module imports matplotlib; only `methods.compiling` has
    "import numba", and none has "from numba".
    """
    for name, path in modules():
        text = path.read_text(encoding="utf-8")
        if "matplotlib" in text and not name.startswith("plot"):
            for library in imported_libraries(text):
                assert not library.startswith("matplotlib"), name
        if name != "methods.compiling":
            assert "import numba" not in text, name
        assert "from numba" not in text, name
