"""Functions of this package as JavaScript, so that the page computes with the same kernels.

What is translated is what has a method or a template below: numbers, text, lists, tables, named
tuples and records; loops and conditions; calls of functions that are translated too; constants,
nested lists and enums of modules. Values are the same, bit for bit, but for exp, logarithms and
powers. All else is refused with its file and line. Where JavaScript means another thing,
page/python.js says what Python means, or throws. Whole numbers must stay below 2^53. A condition is
true, false or a number, no list; division by 0 gives what arrays give.
"""

from __future__ import annotations

import ast
import builtins
import inspect
import json
import math
import re
import textwrap
from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Mapping
from enum import Enum, EnumType
from functools import reduce
from types import FunctionType, ModuleType
from typing import Any, NoReturn

import numpy as np

MOST = 1 << 53  # doubles hold whole numbers below
TEMPLATES = {
    "Break": "break;\n", "Continue": "continue;\n", "Return": "return {value};\n",
    "If": "if({test}){{\n{body}}}else{{\n{orelse}}}\n", "While": "while({test}){{\n{body}}}\n",
    "IfExp": "({test}?{body}:{orelse})", "List": "[{elts}]", "Tuple": "[{elts}]",
    "Starred": "...{value}",
}
"""Nodes whose parts are only put together."""
OPERATORS: dict[type, str] = {  # a space, as the number behind may have a sign
    ast.Add: "({}+{})", ast.Sub: "({}- {})", ast.Mult: "({}*{})", ast.Div: "({}/{})",
    ast.FloorDiv: "py.floordiv({},{})", ast.Mod: "py.mod({},{})", ast.BitXor: "py.xor({},{})",
    ast.LShift: "py.shl({},{})", ast.RShift: "py.shr({},{})", ast.Pow: "py.pow({},{})",
}
COMPARISONS: dict[Any, str] = {
    ast.Lt: "{}<{}", ast.LtE: "{}<={}", ast.Gt: "{}>{}", ast.GtE: "{}>={}", ast.Eq: "{}==={}",
    ast.NotEq: "{}!=={}", ast.In: "py.has({1},{0})", ast.NotIn: "!py.has({1},{0})",
    (ast.In, ast.Tuple): "{1}.includes({0})", (ast.NotIn, ast.Tuple): "!{1}.includes({0})",
    (ast.Is, ast.Constant): "{}=={}", (ast.IsNot, ast.Constant): "{}!={}",
}
"""By operator; beside a tuple, or None, by that, too."""
CALLS: dict[Any, str] = {
    abs: "Math.abs", int: "py.int", round: "py.round", sorted: "py.sorted", list: "Array.from",
    enumerate: "py.enumerate", zip: "py.zip", range: "py.range", bool: "py.bool", float: "Number",
    bisect_left: "py.bisect_left", bisect_right: "py.bisect_right",
    math.sqrt: "Math.sqrt", math.floor: "Math.floor", math.trunc: "Math.trunc",
    math.log: "Math.log", math.log10: "Math.log10", math.gcd: "py.gcd", math.frexp: "py.frexp",
    math.isfinite: "Number.isFinite",
    # of single numbers
    np.where: "py.where", np.minimum: "py.min", np.maximum: "py.max", np.floor: "Math.floor",
    np.abs: "Math.abs", np.exp: "Math.exp", np.expm1: "Math.expm1", np.arctanh: "Math.atanh",
    np.rint: "py.round", np.spacing: "py.spacing", np.isfinite: "Number.isFinite",
}
KINDS = {"float": "number", "str": "string", "dict": "object", "list": "array",
         "Steps": "object"}
METHODS = {
    "append": "{}.push({})", "extend": "py.extend({},{})", "get": "py.get({},{})",
    "pop": "{}.pop()", "items": "Object.entries({})", "upper": "{}.toUpperCase()",
    "update": "Object.assign({},{})", "join": "{1}.join({0})",
}
ARRAYS = set(dir(np.ndarray)) - {"base", "mean"}
"""What arrays have and nothing in JavaScript, but for the names of fields of records."""


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
        self.constants, self.calls = constants, {**CALLS, **known}
        self.texts: dict[FunctionType, str] = {}
        self.tables: list[str] = []
        self._names: dict[int, str] = {}
        self._waiting: list[FunctionType] = []
        for function in roots:
            self.function(function)
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


def tree_of(function: FunctionType) -> ast.FunctionDef:
    """The definition of a function, with the lines of its file."""
    lines, first = inspect.getsourcelines(function)
    tree = ast.parse(textwrap.dedent("".join(lines))).body[0]
    assert isinstance(tree, ast.FunctionDef)
    return ast.increment_lineno(tree, first - 1)


class _Translator(ast.NodeVisitor):
    """Translates one function of a program."""

    def __init__(self, function: FunctionType, program: Program) -> None:
        self.function, self.program, self.tree = function, program, tree_of(function)
        self.arguments = [n.arg for n in self.tree.args.args]
        self.local = {n.id for n in ast.walk(self.tree)
                      if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}

    def refuse(self, node: Any, what: str) -> NoReturn:
        """Say what is not translated, and where it stands."""
        where = f"{inspect.getsourcefile(self.function)}:{node.lineno}"
        raise Untranslatable(f"{where}: {what} is not translated to JavaScript")

    def visit(self, node: ast.AST) -> str:
        """Text of a node."""
        return str(super().visit(node))

    def generic_visit(self, node: ast.AST) -> str:
        """Fill in the template of a kind of node; refuse what has none."""
        kind = type(node).__name__
        if kind not in TEMPLATES:
            self.refuse(node, kind)
        if isinstance(node, ast.While) and node.orelse:
            self.refuse(node, "else of a loop")
        return TEMPLATES[kind].format(**{
            name: self.part(name, value) for name, value in ast.iter_fields(node)})

    def part(self, name: str, value: Any) -> str:
        """Text of what a node has under a name: statements, expressions or one of them."""
        if isinstance(value, list):
            return ("," if name in ("elts", "args") else "").join(map(self.visit, value))
        if name == "test":
            return self.truth(value, "truth")
        return self.visit(value) if isinstance(value, ast.expr) else ""

    # Statements -----------------------------------------------------------------------------------

    def visit_FunctionDef(self, node: ast.FunctionDef) -> str:
        a = node.args
        if node is not self.tree or a.vararg or a.kwarg or a.kwonlyargs or node.decorator_list:
            self.refuse(node, "such a function")
        names = [f"{name}_" for name in self.arguments]
        for k, default in enumerate(reversed(a.defaults), 1):
            names[-k] += f"={self.visit(default)}"
        own = [f"{name}_" for name in sorted(self.local - {*self.arguments})]
        begin = f"let {','.join(own)};\n" if own else ""
        head = f"function {self.program.function(self.function)}({','.join(names)})"
        return f"{head}{{\n{begin}{self.part('body', node.body)}}}"

    def visit_Expr(self, node: ast.Expr) -> str:
        idle = isinstance(node.value, ast.Constant | ast.Name)
        return "" if idle else f"{self.visit(node.value)};\n"

    def visit_For(self, node: ast.For) -> str:
        if node.orelse:
            self.refuse(node, "else of a loop")
        target, body = self.target(node.target), self.part("body", node.body)
        match node.iter:
            case ast.Call(ast.Name("range"), [*bounds, last], []):
                step = self.visit(last).strip("()") if len(bounds) > 1 else "1"
                if not re.fullmatch(r"-?[1-9]\d*", step):
                    self.refuse(node, "such a step")
                stop = self.visit(bounds[1] if len(bounds) > 1 else last)
                start, sign = self.visit(bounds[0]) if bounds else "0", "<>"[step[0] == "-"]
                # a variable of its own: the loop's keeps its last value
                head = f"let _{target}={start},_end={stop};_{target}{sign}_end;_{target}+={step}"
                body = f"{target}=_{target};\n{body}"
            case ast.Call(ast.Name("enumerate"), [items], []):
                head = f"let _i=0,_all={self.visit(items)};_i<_all.length;_i+=1"
                body = f"{target}=[_i,_all[_i]];\n{body}"
            case _:
                head = f"{target} of {self.visit(node.iter)}"
        return f"for({head}){{\n{body}}}\n"

    def visit_Assign(self, node: ast.Assign) -> str:
        match node.targets, node.value:
            case [ast.Tuple(targets)], ast.Tuple(values):  # quicker than by a list
                held = ",".join(f"_{i}={self.visit(value)}" for i, value in enumerate(values))
                sent = "".join(f"{self.target(x)}=_{i};" for i, x in enumerate(targets))
                return f"{{const {held};{sent}}}\n"
        return f"{'='.join(map(self.target, node.targets))}={self.visit(node.value)};\n"

    def visit_AnnAssign(self, node: ast.AnnAssign) -> str:
        assert node.value is not None
        return f"{self.target(node.target)}={self.visit(node.value)};\n"

    def visit_AugAssign(self, node: ast.AugAssign) -> str:
        if any(isinstance(n, ast.Call) for n in ast.walk(node.target)):
            self.refuse(node, "such a change in place")
        value = self.binary(node, node.target, node.op, node.value)
        return f"{self.target(node.target)}={value};\n"

    def target(self, node: ast.expr) -> str:
        """What is assigned to."""
        if isinstance(node, ast.Tuple):
            return f"[{','.join(map(self.target, node.elts))}]"
        if isinstance(node, ast.Subscript) and isinstance(node.slice, ast.UnaryOp | ast.Slice):
            self.refuse(node, "such an index")
        return self.visit(node)

    # Expressions ----------------------------------------------------------------------------------

    def visit_Constant(self, node: ast.Constant) -> str:
        return self.literal(node, node.value)

    def literal(self, node: ast.AST, value: Any) -> str:
        """A number, a text, a truth value or None."""
        if isinstance(value, int) and abs(value) >= MOST:
            self.refuse(node, f"the constant {value!r}")
        return json.dumps(value)  # which has Infinity and NaN, as JavaScript

    def visit_Name(self, node: ast.Name) -> str:
        if node.id in self.local or node.id in self.arguments:
            return f"{node.id}_"
        return self.held(node, node.id, self.known(node))

    def held(self, node: ast.AST, name: str, value: Any) -> str:
        """A constant or a table that a module holds under this name."""
        if isinstance(value, list | dict | np.dtype):
            return self.program.table(value, name, self.function.__module__)
        if isinstance(value, int | float | str):
            return self.literal(node, value)
        return self.refuse(node, f"the name {name}")

    def known(self, node: ast.expr) -> Any:
        """What a name of a module, or an attribute of a module or an enum, stands for, or None."""
        constants, owner = self.program.constants, None
        match node:
            case ast.Name(name) if name not in self.local and name not in self.arguments:
                held = self.function.__globals__
                return constants.get(name, held.get(name, getattr(builtins, name, None)))
            case ast.Attribute(value, name):
                owner = self.known(value)
        if not isinstance(owner, ModuleType | Enum | EnumType):
            return None
        return constants.get(name, getattr(owner, name))

    def visit_Attribute(self, node: ast.Attribute) -> str:
        value = self.known(node)
        if value is not None:
            return self.held(node, node.attr, value)
        if node.attr in ARRAYS:
            self.refuse(node, f"the attribute {node.attr}")
        return f"{self.visit(node.value)}.{node.attr}"

    def visit_Subscript(self, node: ast.Subscript) -> str:
        value = self.visit(node.value)
        match node.slice:
            case ast.Slice(lower, upper, None):
                ends = [self.visit(x) for x in (lower or ast.Constant(0), upper) if x]
                return f"{value}.slice({','.join(ends)})"
            case ast.UnaryOp(ast.USub(), ast.Constant()) as last:
                return f"{value}.at({self.visit(last)})"
            case ast.UnaryOp() | ast.Slice() | ast.Tuple():
                self.refuse(node, "such an index")
        return f"{value}[{self.visit(node.slice)}]"

    def visit_BinOp(self, node: ast.BinOp) -> str:
        return self.binary(node, node.left, node.op, node.right)

    def binary(self, node: Any, left: ast.expr, op: ast.operator, right: ast.expr) -> str:
        """Two numbers with an operator between them."""
        match left, op:
            case ast.List([item]), ast.Mult():
                return f"py.repeat({self.visit(item)},{self.visit(right)})"
        if isinstance(left, ast.List | ast.ListComp) or isinstance(right, ast.List | ast.ListComp):
            self.refuse(node, "adding lists")
        if type(op) not in OPERATORS:
            self.refuse(node, type(op).__name__)
        return OPERATORS[type(op)].format(self.visit(left), self.visit(right))

    def visit_UnaryOp(self, node: ast.UnaryOp) -> str:
        if isinstance(node.op, ast.Not):
            return f"!{self.truth(node.operand, 'truth')}"
        if isinstance(node.op, ast.USub):
            return f"(-{self.visit(node.operand)})"
        return self.refuse(node, type(node.op).__name__)

    def visit_BoolOp(self, node: ast.BoolOp) -> str:
        return self.truth(node, "bool")

    def truth(self, node: ast.expr, kind: str) -> str:
        """What decides: "bool" is true or false, "truth" a number too."""
        match node:
            case ast.BoolOp(op, values):
                sign = " && " if isinstance(op, ast.And) else " || "
                return f"({sign.join(self.truth(x, kind) for x in values)})"
            case ast.Compare() | ast.UnaryOp(ast.Not()) | ast.Constant(True | False):
                return self.visit(node)
        return f"py.{kind}({self.visit(node)})"

    def visit_Compare(self, node: ast.Compare) -> str:
        sides = [node.left, *node.comparators]
        if any(isinstance(x, ast.Call) for side in sides[1:-1] for x in ast.walk(side)):
            self.refuse(node, "a call between two comparisons")
        parts = []
        for left, op, right in zip(sides, node.ops, sides[1:], strict=False):
            key: Any = type(op)
            if isinstance(right, ast.Tuple) or getattr(right, "value", 0) is None:
                key = key, type(right)
            if key not in COMPARISONS:
                self.refuse(node, type(op).__name__)
            parts.append(COMPARISONS[key].format(self.visit(left), self.visit(right)))
        return f"({' && '.join(parts)})"

    def visit_Dict(self, node: ast.Dict) -> str:
        entries = [f"...{self.visit(value)}" if key is None
                   else f"[{self.visit(key)}]:{self.visit(value)}"
                   for key, value in zip(node.keys, node.values, strict=True)]
        return f"({{{','.join(entries)}}})"

    def visit_ListComp(self, node: ast.ListComp | ast.GeneratorExp) -> str:
        text = self.visit(node.elt)
        for i, loop in enumerate(reversed(node.generators)):
            item = self.target(loop.target)
            kept = "".join(f".filter(({item})=>{self.truth(x, 'truth')})" for x in loop.ifs)
            every = "flatMap" if i else "map"
            text = f"Array.from({self.visit(loop.iter)}){kept}.{every}(({item})=>({text}))"
        return text

    def visit_JoinedStr(self, node: ast.JoinedStr) -> str:
        return f"({'+'.join(map(self.visit, node.values)) or json.dumps('')})"

    def visit_FormattedValue(self, node: ast.FormattedValue) -> str:
        value, spec = self.visit(node.value), ast.unparse(node.format_spec or ast.Constant(""))
        if spec == "''" and node.conversion == -1:
            return f"py.text({value})"
        digits = re.fullmatch(r"f'\.(\d+|\{\w+\})g'", spec)
        if digits is None or node.conversion != -1:
            self.refuse(node, "such a format")
        return f"py.general({value},{digits[1].replace('{', '').replace('}', '_')})"

    def visit_Call(self, node: ast.Call) -> str:
        called, name = self.known(node.func), ast.unparse(node.func)
        match called, node.args:
            case builtins.isinstance, [value, ast.Name(kind)] if kind in KINDS:
                return f'(py.kind({self.visit(value)})==="{KINDS[kind]}")'
            case (builtins.any | builtins.all), [ast.GeneratorExp() as every]:
                some = "some" if called is any else "every"
                return f"{self.visit_ListComp(every)}.{some}(py.bool)"
        given = [self.visit(x) for x in node.args]
        if node.keywords and [ast.unparse(k) for k in node.keywords] != ["strict=True"]:
            self.refuse(node, "an argument by name")
        if called is None and isinstance(node.func, ast.Attribute):
            if node.func.attr not in METHODS:
                self.refuse(node, f"the method {node.func.attr}")
            return METHODS[node.func.attr].format(self.visit(node.func.value), ",".join(given))
        if called in (min, max) and len(given) > 1:
            return reduce(lambda text, other: f"py.{name}({text},{other})", given)
        fields = getattr(called, "_fields", ())
        if fields and len(fields) == len(given):
            return f"({{{','.join(map(':'.join, zip(fields, given, strict=True)))}}})"
        if called is len:
            return f"{given[0]}.length"
        if called in self.program.calls:
            return f"{self.program.calls[called]}({','.join(given)})"
        if isinstance(called, FunctionType) and called.__module__.startswith("rodimpact."):
            return f"{self.program.function(called)}({','.join(given)})"
        return self.refuse(node, f"calling {name}")
