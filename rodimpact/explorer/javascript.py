"""Functions of this package as JavaScript, so that the page computes with the same kernels.

What is translated is what has a method below: numbers, text, lists, tables, named tuples and
records; loops and conditions; calls of functions that are translated too; constants, nested lists
and enums of modules. Values are the same, bit for bit, but for exp, logarithms and powers. All else
is refused with its file and line. Where JavaScript means another thing, page/python.js says what
Python means, or throws. Whole numbers must stay below 2^53. A condition is true, false or a number,
no list; division by 0 gives what arrays give.
"""

from __future__ import annotations

import ast
import bisect
import inspect
import json
import math
import re
import string
import sys
import textwrap
from collections.abc import Iterable, Mapping
from enum import Enum, EnumType
from types import FunctionType, ModuleType
from typing import Any, NoReturn

import numpy as np

MOST = 1 << 53  # doubles hold whole numbers below
OPERATORS: dict[type, str] = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Lt: "<", ast.LtE: "<=",
    ast.Gt: ">", ast.GtE: ">=", ast.Eq: "===", ast.NotEq: "!==", ast.And: " && ", ast.Or: " || ",
}
EXACT: dict[type, str] = {
    ast.FloorDiv: "floordiv", ast.Mod: "mod", ast.BitXor: "xor", ast.LShift: "shl",
    ast.RShift: "shr", ast.Pow: "pow",
}
CALLS = {
    "len": "{}.length", "abs": "Math.abs({})", "int": "py.int({})", "round": "py.round({})",
    "sorted": "py.sorted({})", "list": "Array.from({})", "enumerate": "py.enumerate({})",
    "zip": "py.zip({})", "range": "py.range({})", "bool": "py.bool({})", "float": "Number({})",
    "bisect_left": "py.bisect_left({})", "bisect_right": "py.bisect_right({})",
}
MATH = {
    "inf": "Infinity", "nan": "NaN", "sqrt": "Math.sqrt", "floor": "Math.floor",
    "trunc": "Math.trunc", "log": "Math.log", "log10": "Math.log10", "gcd": "py.gcd",
    "frexp": "py.frexp", "isfinite": "Number.isFinite",
}
NUMPY = {  # of single numbers
    "where": "py.where", "minimum": "py.min", "maximum": "py.max", "floor": "Math.floor",
    "abs": "Math.abs", "exp": "Math.exp", "expm1": "Math.expm1", "arctanh": "Math.atanh",
    "rint": "py.round", "spacing": "py.spacing", "isfinite": "Number.isFinite",
}
KINDS = {"float": "number", "str": "string", "dict": "object", "list": "array",
         "Steps": "object"}
METHODS = {
    "append": "{}.push({})", "extend": "py.extend({},{})", "get": "py.get({},{})",
    "pop": "{}.pop()",
    "items": "Object.entries({})", "upper": "{}.toUpperCase()", "update": "Object.assign({},{})",
}
TAKEN = ("do", "if", "in", "of", "py", "at")  # short names that mean something else


class Untranslatable(ValueError):
    """A function uses what is not translated; the message says what, and where."""


def javascript(
    roots: Iterable[Any], constants: Mapping[str, float] | None = None,
    known: Mapping[Any, str] | None = None,
) -> str:
    """Functions, and all of the package that they call, as JavaScript.

    Parameters
    ----------
    roots : iterable of functions
    constants : mapping of str to number, optional
        Values that stand in for those of modules, by name.
    known : mapping of functions to str, optional
        Functions that the page has under a name of its own.

    Raises
    ------
    Untranslatable
        At the first thing that is not translated.
    """
    program = Program(roots, constants or {}, known or {})
    return "\n".join([*program.tables, *program.texts.values()])


class Program:
    """Functions with all that they need: `texts` by function, and `tables`.

    Parameters as of `javascript`.
    """

    def __init__(
        self, roots: Iterable[Any], constants: Mapping[str, float], known: Mapping[Any, str]
    ) -> None:
        self.constants, self.known = constants, known
        self.texts: dict[FunctionType, str] = {}
        self.tables: list[str] = []
        self._names: dict[int, str] = {}
        self._waiting: list[FunctionType] = []
        for function in roots:
            self.function(function)
        self.fields = fields_of(self._waiting)
        while self._waiting:
            one = _Translator(self._waiting.pop(0), self)
            self.texts[one.function] = one.visit(one.tree)

    def function(self, function: FunctionType) -> str:
        """Name of a function, which is translated too."""
        if id(function) not in self._names:
            self._waiting.append(function)
        return self._name(function, function.__name__, function.__module__)

    def table(self, table: Any, name: str, module: str) -> str:
        """Name of a list that a module holds, or of an empty record, which is written too."""
        new, name = id(table) not in self._names, self._name(table, name, module)
        held: Any = table
        if isinstance(table, np.dtype):
            held = {field: np.zeros(table[field].shape).tolist() for field in table.names or ()}
        if new:
            self.tables.append(f"const {name}={json.dumps(held, separators=(',', ':'))};")
        return name

    def _name(self, thing: Any, name: str, module: str) -> str:
        """The name of a thing, behind those of its modules where another thing bears it."""
        parts = module.split(".")
        while id(thing) not in self._names and name in self._names.values():
            name = f"{parts.pop()}_{name}"
        return self._names.setdefault(id(thing), name)


def fields_of(functions: Iterable[Any]) -> set[str]:
    """Fields of all records and classes of the modules of functions, and of what these hold."""
    modules: set[str] = set()
    waiting = [function.__module__ for function in functions]
    while waiting:
        name = waiting.pop()
        if name not in modules:
            modules.add(name)
            waiting += [value.__name__ if isinstance(value, ModuleType) else value.__module__
                        for value in vars(sys.modules[name]).values()
                        if isinstance(value, FunctionType | type | ModuleType) and _is_ours(value)]
    values = [value for name in modules for value in vars(sys.modules[name]).values()]
    return {field for value in values for field in (
        value.names or () if isinstance(value, np.dtype)
        else getattr(value, "__annotations__", ()) if isinstance(value, type) else ())}


def _is_ours(thing: Any) -> bool:
    """Whether a module, or what it holds, is of this package."""
    return bool(getattr(thing, "__module__", thing.__name__).startswith("rodimpact."))


def tree_of(function: FunctionType) -> ast.FunctionDef:
    """The definition of a function, with the lines of its file."""
    lines, first = inspect.getsourcelines(function)
    tree = ast.parse(textwrap.dedent("".join(lines))).body[0]
    assert isinstance(tree, ast.FunctionDef)
    return ast.increment_lineno(tree, first - 1)


class _Translator(ast.NodeVisitor):
    """Translates one function of a program."""

    def __init__(self, function: FunctionType, program: Program) -> None:
        self.function, self.program = function, program
        self.tree = tree_of(function)
        self.inside = [n.arg for n in self.tree.args.args]
        self.local = {n.id for n in ast.walk(self.tree)
                      if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
        taken = {n.attr for n in ast.walk(self.tree) if isinstance(n, ast.Attribute)}
        taken |= {*TAKEN, *function.__globals__}
        short = (f"{a}{b}" for b in ("", *"abcdefghi") for a in string.ascii_letters)
        self.names = dict(zip(
            [*self.inside, *sorted(self.local - set(self.inside))],
            (name for name in short if name not in taken), strict=False))
        self.count = 0

    def refuse(self, node: Any, what: str) -> NoReturn:
        """Say what is not translated, and where it stands."""
        where = f"{inspect.getsourcefile(self.function)}:{node.lineno}"
        raise Untranslatable(f"{where}: {what} is not translated to JavaScript")

    def generic_visit(self, node: ast.AST) -> NoReturn:
        """Refuse what has no method here."""
        self.refuse(node, type(node).__name__)

    def visit(self, node: ast.AST) -> str:
        """Text of a node."""
        return str(super().visit(node))

    # Statements -----------------------------------------------------------------------------------

    def visit_FunctionDef(self, node: ast.FunctionDef) -> str:
        a = node.args
        if node is not self.tree or a.vararg or a.kwarg or a.kwonlyargs or node.decorator_list:
            self.refuse(node, "such a function")
        first = len(a.args) - len(a.defaults)
        names = [self.name(n.arg) for n in a.args]
        names[first:] = [f"{n}={self.visit(d)}" for n, d in zip(names[first:], a.defaults,
                                                              strict=True)]
        body = self.block(node.body)
        own = [self.name(n) for n in sorted(self.local - set(self.inside))]
        own += [f"_{i + 1}" for i in range(self.count)]
        begin = f"let {','.join(own)};\n" if own else ""
        head = f"function {self.program.function(self.function)}({','.join(names)})"
        return f"{head}{{\n{begin}{body}}}"

    def block(self, body: list[ast.stmt]) -> str:
        """Statements, each on a line."""
        return "".join(self.visit(statement) for statement in body)

    def visit_Expr(self, node: ast.Expr) -> str:
        idle = isinstance(node.value, ast.Constant | ast.Name)
        return "" if idle else f"{self.visit(node.value)};\n"

    def visit_Return(self, node: ast.Return) -> str:
        return f"return {self.visit(node.value)};\n" if node.value else "return;\n"

    def visit_Break(self, _: ast.Break) -> str:
        return "break;\n"

    def visit_Continue(self, _: ast.Continue) -> str:
        return "continue;\n"

    def visit_If(self, node: ast.If) -> str:
        other = f"else{{\n{self.block(node.orelse)}}}\n" if node.orelse else ""
        return f"if({self.test(node.test)}){{\n{self.block(node.body)}}}\n{other}"

    def visit_While(self, node: ast.While) -> str:
        if node.orelse:
            self.refuse(node, "else of a loop")
        return f"while({self.test(node.test)}){{\n{self.block(node.body)}}}\n"

    def visit_For(self, node: ast.For) -> str:
        if node.orelse:
            self.refuse(node, "else of a loop")
        body = self.block(node.body)
        match node:
            case ast.For(ast.Name(name), ast.Call(ast.Name("range"), given, [])):
                start, stop, step = self.span(node, given)
                end, turn = self.temporary(), ">" if step < 0 else "<"
                v, own = self.name(name), self.keeps(node)
                i = v if own else self.temporary()
                body = body if own else f"{v}={i};\n{body}"
                head = f"{i}={start},{end}={stop};{i}{turn}{end};{i}+={step}"
            case ast.For(ast.Tuple([place, item]), ast.Call(ast.Name("enumerate"), [items], [])):
                i, every = self.temporary(), self.temporary()
                head = f"{i}=0,{every}={self.visit(items)};{i}<{every}.length;{i}+=1"
                body = f"{self.target(place)}={i};{self.target(item)}={every}[{i}];\n{body}"
            case _:
                head = f"{self.target(node.target)} of {self.visit(node.iter)}"
        return f"for({head}){{\n{body}}}\n"

    def span(self, node: ast.For, given: list[ast.expr]) -> tuple[str, str, int]:
        """Start, stop and step of a range."""
        start, *rest = [self.visit(x) for x in given]
        step = rest[1].strip("()") if len(rest) > 1 else "1"
        if not re.fullmatch(r"-?[1-9]\d*", step):
            self.refuse(node, "such a step")
        return (start, rest[0], int(step)) if rest else ("0", start, 1)

    def keeps(self, loop: ast.For) -> bool:
        """Whether only such loops change and read their variable, so that its end is not seen."""
        name = ast.unparse(loop.target)
        loops = [n for n in ast.walk(self.tree)
                 if isinstance(n, ast.For) and ast.unparse(n.target) == name]
        inside = {n for one in loops for statement in one.body for n in ast.walk(statement)}
        uses = [n for n in ast.walk(self.tree) if isinstance(n, ast.Name) and n.id == name]
        return all((n in inside) == isinstance(n.ctx, ast.Load) for n in uses)

    def visit_Assign(self, node: ast.Assign) -> str:
        (first, *others), value = node.targets, node.value
        if isinstance(first, ast.Tuple) and isinstance(value, ast.Tuple) and not others:
            if self.apart(first, value):
                return "".join(f"{self.target(x)}={self.visit(y)};"
                               for x, y in zip(first.elts, value.elts, strict=True)) + "\n"
            names = [self.temporary() for _ in value.elts]
            sent = [f"{name}={self.visit(x)};" for name, x in zip(names, value.elts, strict=True)]
            sent += [f"{self.target(x)}={name};" for x, name in zip(first.elts, names, strict=True)]
            return "".join(sent) + "\n"
        if others:
            name = self.temporary()
            text = "".join(f"{self.target(x)}={name};" for x in node.targets)
            return f"{name}={self.visit(value)};{text}\n"
        return f"{self.target(first)}={self.visit(value)};\n"

    def apart(self, targets: ast.Tuple, values: ast.Tuple) -> bool:
        """Whether values can be assigned one by one: what they read is no target before them."""
        names = {n.id for n in ast.walk(targets) if isinstance(n, ast.Name)}
        inner = [n for x in values.elts[1:] for n in ast.walk(x)]
        other = ast.Call if all(isinstance(x, ast.Name) for x in targets.elts) else (
            ast.Call, ast.Subscript, ast.Attribute)
        return not any(isinstance(n, other) for n in inner) and not (
            names & {n.id for n in inner if isinstance(n, ast.Name)})

    def visit_AnnAssign(self, node: ast.AnnAssign) -> str:
        assert node.value is not None
        return f"{self.target(node.target)}={self.visit(node.value)};\n"

    def visit_AugAssign(self, node: ast.AugAssign) -> str:
        if isinstance(node.value, ast.List | ast.ListComp):
            self.refuse(node, "adding lists")
        if type(node.op) in OPERATORS:
            sign = OPERATORS[type(node.op)]
            return f"{self.target(node.target)}{sign}={self.visit(node.value)};\n"
        if not isinstance(node.target, ast.Name):
            self.refuse(node, "such a change in place")
        value = self.binary(node, self.visit(node.target), node.op, node.value)
        return f"{self.target(node.target)}={value};\n"

    def target(self, node: ast.expr) -> str:
        """What is assigned to."""
        if isinstance(node, ast.Tuple):
            return f"[{','.join(map(self.target, node.elts))}]"
        if isinstance(node, ast.Subscript):
            return f"{self.visit(node.value)}[{self.index(node.slice)}]"
        if isinstance(node, ast.Name):
            return self.name(node.id)
        if isinstance(node, ast.Attribute):
            return self.visit(node)
        return self.refuse(node, f"assigning to {type(node).__name__}")

    # Expressions ----------------------------------------------------------------------------------

    def visit_Constant(self, node: ast.Constant) -> str:
        return self.literal(node, node.value)

    def literal(self, node: ast.AST, value: Any) -> str:
        """A number, a text, a truth value or None."""
        if isinstance(value, bool | str) or value is None:
            return json.dumps(value)
        if isinstance(value, float):
            return repr(value) if math.isfinite(value) else self.refuse(node, f"{value}")
        if isinstance(value, int) and abs(value) < MOST:
            return repr(int(value))
        return self.refuse(node, f"the constant {value!r}")

    def visit_Name(self, node: ast.Name) -> str:
        return self.names.get(node.id) or self.held(node, node.id)

    def held(self, node: ast.Name | ast.Attribute, name: str) -> str:
        """A constant or a table that a module holds under this name."""
        value = self.known(node)
        if isinstance(value, list | dict | np.dtype):
            return self.program.table(value, name, self.function.__module__)
        if isinstance(value, int | float | str):
            return self.literal(node, value)
        return self.refuse(node, f"the name {name}")

    def known(self, node: ast.expr) -> Any:
        """What a name of a module, or an attribute of a module or an enum, stands for, or None."""
        match node:
            case ast.Name(name) if name not in self.names:
                return self.program.constants.get(name, self.function.__globals__.get(name))
            case ast.Attribute(value, name):
                owner = self.known(value)
                if isinstance(owner, ModuleType) and _is_ours(owner):
                    return self.program.constants.get(name, getattr(owner, name))
                return getattr(owner, name) if isinstance(owner, Enum | EnumType) else None
        return None

    def name(self, name: str) -> str:
        """The short name of a local variable."""
        return self.names[name]

    def temporary(self) -> str:
        """A name that nothing has."""
        self.count += 1
        return f"_{self.count}"

    def visit_Attribute(self, node: ast.Attribute) -> str:
        for module, names in (("math", MATH), ("np", NUMPY)):
            if ast.unparse(node.value) == module and node.attr in names:
                return names[node.attr]
        if self.known(node) is not None:
            return self.held(node, node.attr)
        if node.attr not in self.program.fields:
            self.refuse(node, f"the attribute {node.attr}")
        return f"{self.visit(node.value)}.{node.attr}"

    def visit_Subscript(self, node: ast.Subscript) -> str:
        where, value = node.slice, self.visit(node.value)
        if isinstance(where, ast.Slice):
            if where.step:
                self.refuse(node, "a step of a slice")
            ends = [self.visit(x) if x else None for x in (where.lower or ast.Constant(0),
                                                           where.upper)]
            return f"{value}.slice({','.join(filter(None, ends))})"
        if isinstance(where, ast.UnaryOp) and isinstance(where.operand, ast.Constant):
            return f"{value}.at({self.visit(where)})"
        return f"{value}[{self.index(where)}]"

    def index(self, node: ast.expr) -> str:
        """Where in a list or table; not counted from its end."""
        if isinstance(node, ast.UnaryOp | ast.Slice | ast.Tuple):
            self.refuse(node, "such an index")
        return self.visit(node)

    def visit_BinOp(self, node: ast.BinOp) -> str:
        return self.binary(node, self.visit(node.left), node.op, node.right)

    def binary(self, node: Any, left: str, op: ast.operator, right: ast.expr) -> str:
        """Two numbers with an operator between them."""
        lists = ast.List | ast.ListComp
        if isinstance(op, ast.Mult) and isinstance(node.left, ast.List):
            if len(node.left.elts) != 1:
                self.refuse(node, "repeating such a list")
            return f"py.repeat({self.visit(node.left.elts[0])},{self.visit(right)})"
        if isinstance(right, lists) or isinstance(getattr(node, "left", None), lists):
            self.refuse(node, "adding lists")
        other = self.visit(right)
        if isinstance(op, ast.Pow) and left in ("2", "2.0", "10.0"):
            return f"py.pow{left.removesuffix('.0')}({other})"
        if type(op) in EXACT:
            return f"py.{EXACT[type(op)]}({left},{other})"
        if type(op) not in OPERATORS:
            self.refuse(node, type(op).__name__)
        space = " " if other[0] == "-" else ""
        return f"({left}{OPERATORS[type(op)]}{space}{other})"

    def visit_UnaryOp(self, node: ast.UnaryOp) -> str:
        if isinstance(node.op, ast.Not):
            return f"!{self.test(node.operand)}"
        if isinstance(node.op, ast.USub):
            return f"(-{self.visit(node.operand)})"
        return self.refuse(node, type(node.op).__name__)

    def visit_BoolOp(self, node: ast.BoolOp) -> str:
        return self.truth(node, "bool")

    def test(self, node: ast.expr) -> str:
        """A condition."""
        return self.truth(node, "truth")

    def truth(self, node: ast.expr, kind: str) -> str:
        """What decides: "bool" is true or false, "truth" a number too."""
        if isinstance(node, ast.BoolOp):
            return f"({OPERATORS[type(node.op)].join(self.truth(x, kind) for x in node.values)})"
        sure = isinstance(node, ast.Compare) or (
            isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not)) or (
            isinstance(node, ast.Constant) and isinstance(node.value, bool))
        return self.visit(node) if sure else f"py.{kind}({self.visit(node)})"

    def visit_Compare(self, node: ast.Compare) -> str:
        sides = [node.left, *node.comparators]
        if any(isinstance(x, ast.Call) for side in sides[1:-1] for x in ast.walk(side)):
            self.refuse(node, "a call between two comparisons")
        parts = [self.comparison(node, *pair) for pair in zip(sides, node.ops, sides[1:],
                                                              strict=False)]
        return f"({' && '.join(parts)})"

    def comparison(self, node: Any, left: ast.expr, op: ast.cmpop, right: ast.expr) -> str:
        """Two things compared."""
        if isinstance(op, ast.Is | ast.IsNot) and isinstance(right, ast.Constant):
            sign = "!=" if isinstance(op, ast.IsNot) else "=="
            exact = "" if right.value is None else "="
            return f"{self.visit(left)}{sign}{exact}{self.visit(right)}"
        if isinstance(op, ast.In | ast.NotIn):
            no = "!" if isinstance(op, ast.NotIn) else ""
            if isinstance(right, ast.Tuple):
                return f"{no}{self.visit(right)}.includes({self.visit(left)})"
            return f"{no}py.has({self.visit(right)},{self.visit(left)})"
        if type(op) not in OPERATORS:
            self.refuse(node, type(op).__name__)
        return f"{self.visit(left)}{OPERATORS[type(op)]}{self.visit(right)}"

    def visit_IfExp(self, node: ast.IfExp) -> str:
        return f"({self.test(node.test)}?{self.visit(node.body)}:{self.visit(node.orelse)})"

    def visit_Tuple(self, node: ast.Tuple | ast.List) -> str:
        return f"[{','.join(map(self.visit, node.elts))}]"

    def visit_List(self, node: ast.List) -> str:
        return self.visit_Tuple(node)

    def visit_Starred(self, node: ast.Starred) -> str:
        return f"...{self.visit(node.value)}"

    def visit_Dict(self, node: ast.Dict) -> str:
        entries = [f"...{self.visit(value)}" if key is None
                   else f"[{self.visit(key)}]:{self.visit(value)}"
                   for key, value in zip(node.keys, node.values, strict=True)]
        return f"({{{','.join(entries)}}})"

    def visit_ListComp(self, node: ast.ListComp | ast.GeneratorExp) -> str:
        text = self.visit(node.elt)
        for i, loop in enumerate(reversed(node.generators)):
            item = self.target(loop.target)
            kept = "".join(f".filter(({item})=>{self.test(x)})" for x in loop.ifs)
            every = "flatMap" if i else "map"
            text = f"Array.from({self.visit(loop.iter)}){kept}.{every}(({item})=>({text}))"
        return text

    def visit_JoinedStr(self, node: ast.JoinedStr) -> str:
        return f"({'+'.join(map(self.visit, node.values)) or json.dumps('')})"

    def visit_FormattedValue(self, node: ast.FormattedValue) -> str:
        value, spec = self.visit(node.value), node.format_spec
        if node.conversion != -1:
            self.refuse(node, "such a format")
        if spec is None:
            return f"py.text({value})"
        match spec:
            case ast.JoinedStr([ast.Constant(str(text))]) if re.fullmatch(r"\.\d+g", text):
                return f"py.general({value},{text[1:-1]})"
            case ast.JoinedStr([ast.Constant("."), ast.FormattedValue(digits), ast.Constant("g")]):
                return f"py.general({value},{self.visit(digits)})"
        return self.refuse(node, "such a format")

    def visit_Call(self, node: ast.Call) -> str:
        function = node.func
        if isinstance(function, ast.Name) and function.id == "isinstance":
            return self.kind(node, *node.args)
        called = self.known(function)
        if isinstance(function, ast.Attribute) and called is None:
            return self.method(node, function, [self.visit(x) for x in node.args])
        name = ast.unparse(function)
        if name in ("any", "all") and isinstance(node.args[0], ast.GeneratorExp):
            every = "some" if name == "any" else "every"
            return f"{self.visit_ListComp(node.args[0])}.{every}(py.bool)"
        given = [self.visit(x) for x in node.args]
        if (fields := getattr(called, "_fields", ())) and not node.keywords:
            if len(given) != len(fields):
                return f"py.named({json.dumps(fields)},[{','.join(given)}])"
            return f"({{{','.join(map(':'.join, zip(fields, given, strict=True)))}}})"
        if node.keywords and [ast.unparse(k) for k in node.keywords] != ["strict=True"]:
            self.refuse(node, "an argument by name")
        if isinstance(called, FunctionType) and called in self.program.known:
            return f"{self.program.known[called]}({','.join(given)})"
        if isinstance(called, FunctionType) and _is_ours(called):
            return f"{self.program.function(called)}({','.join(given)})"
        if called is None and name in ("min", "max") and len(given) > 1:
            text = given[0]
            for other in given[1:]:
                text = f"py.{name}({text},{other})"
            return text
        if name in CALLS and given and called in (None, getattr(bisect, name, None)):
            return CALLS[name].format(",".join(given))
        return self.refuse(node, f"calling {name}")

    def kind(self, node: ast.Call, value: ast.expr, kind: ast.expr) -> str:
        """Whether a value is of a kind."""
        if not isinstance(kind, ast.Name) or kind.id not in KINDS:
            self.refuse(node, "such a kind")
        return f'(py.kind({self.visit(value)})==="{KINDS[kind.id]}")'

    def method(self, node: ast.Call, function: ast.Attribute, given: list[str]) -> str:
        """A call of a function of a module, or of a list, a table or a text."""
        if ast.unparse(function.value) in ("math", "np"):
            return f"{self.visit(function)}({','.join(given)})"
        if node.keywords or (function.attr not in METHODS and function.attr != "join"):
            self.refuse(node, f"the method {function.attr}")
        value = self.visit(function.value)
        if function.attr == "join":
            return f"{given[0]}.join({value})"
        return METHODS[function.attr].format(value, ",".join(given))
