"""How machine code sees a NamedTuple of arrays: a pointer to where each begins, and its length.

To numba an array is seven numbers, and a NamedTuple of arrays is all of theirs, handed over one by
one at each call. Kernels read and write single entries, ask for lengths and go through columns;
for that a pointer will do, which makes them a third cheaper to compile.
"""

from __future__ import annotations

import functools
import operator
from typing import Any

from llvmlite import ir
from numba.core import cgutils, errors, types
from numba.core.imputils import RefType, iternext_impl
from numba.core.typing.templates import (
    AbstractTemplate,
    AttributeTemplate,
    infer_global,
    signature,
)
from numba.extending import (
    NativeValue,
    infer_getattr,
    lower_builtin,
    lower_getattr_generic,
    models,
    register_model,
    typeof_impl,
    unbox,
)

START, SIZE = ir.IntType(8).as_pointer(), ir.IntType(64)
PLACE = ir.LiteralStructType([START, SIZE])  # of a column


class Column(types.IterableType):
    """A one-dimensional array, entry after entry."""

    def __init__(self, entry: Any) -> None:
        self.entry = entry
        super().__init__(f"Column({entry})")

    @property
    def iterator_type(self) -> Any:
        """What goes through it."""
        return Walk(self)


class Columns(types.IterableType):
    """A NamedTuple of columns."""

    def __init__(self, made: type, entries: tuple[Any, ...]) -> None:
        self.fields: tuple[str, ...] = made._fields  # type: ignore[attr-defined]
        self.entries = entries
        super().__init__(f"{made.__module__}.{made.__name__}({', '.join(map(str, entries))})")

    @property
    def entry(self) -> Any:
        """Type of its columns, where they have one."""
        if len(set(self.entries)) > 1:
            raise errors.TypingError(f"columns of {self} differ in type")
        return Column(self.entries[0])

    @property
    def iterator_type(self) -> Any:
        """What goes through it."""
        return Walk(self)


class Walk(types.SimpleIteratorType):
    """Goes through a column, or through columns of one type."""

    def __init__(self, whole: Any) -> None:
        self.whole = whole
        super().__init__(f"Walk({whole})", whole.entry)


@register_model(Column)
class _ColumnModel(models.StructModel):
    def __init__(self, manager: Any, typ: Any) -> None:
        members = [("start", types.CPointer(typ.entry)), ("size", types.intp)]
        super().__init__(manager, typ, members)


@register_model(Columns)
class _ColumnsModel(models.PrimitiveModel):
    def __init__(self, manager: Any, typ: Any) -> None:
        super().__init__(manager, typ, PLACE.as_pointer())


@register_model(Walk)
class _WalkModel(models.StructModel):
    def __init__(self, manager: Any, typ: Any) -> None:
        members = [("whole", typ.whole), ("next", types.CPointer(types.intp))]
        super().__init__(manager, typ, members)


@functools.cache
def see(made: type) -> None:
    """Let numba see NamedTuples of this class so, where they hold nothing but plain arrays."""
    usual = typeof_impl.dispatch(tuple)

    @typeof_impl.register(made)
    def typeof(value: Any, context: Any) -> Any:
        found = usual(value, context)
        arrays = found.types if isinstance(found, types.BaseNamedTuple) else ()
        plain = arrays and all(map(_is_plain, arrays))
        return Columns(made, tuple(x.dtype for x in arrays)) if plain else found


def _is_plain(typ: Any) -> bool:
    """Whether an array has one axis, without gaps, and can be written to."""
    return bool(isinstance(typ, types.Array) and typ.ndim == 1 and typ.layout == "C"
                and typ.aligned and typ.mutable)


@unbox(Columns)
def take(typ: Any, value: Any, c: Any) -> Any:
    """Note where the arrays of a NamedTuple begin, and their lengths."""
    builder, count = c.builder, len(typ.fields)
    places = cgutils.alloca_once(builder, PLACE, count)
    failed = cgutils.alloca_once_value(builder, cgutils.false_bit)
    of_item = ir.FunctionType(c.pyapi.pyobj, [c.pyapi.pyobj, SIZE])
    take_item = cgutils.get_or_insert_function(builder.module, of_item, "PyTuple_GetItem")
    array = c.context.make_array(types.Array(types.intp, 1, "C"))(c.context, builder)
    with cgutils.for_range(builder, SIZE(count)) as loop:
        item = c.builder.call(take_item, [value, loop.index])
        wrong = c.pyapi.numba_array_adaptor(item, builder.bitcast(array._getpointer(), START))
        with builder.if_then(cgutils.is_not_null(builder, wrong), likely=False):
            builder.store(cgutils.true_bit, failed)
        start, size = _place(builder, places, loop.index)
        builder.store(builder.bitcast(array.data, START), start)
        builder.store(array.nitems, size)
    return NativeValue(places, is_error=builder.load(failed))


def _place(builder: Any, places: Any, i: Any) -> tuple[Any, Any]:
    """Pointers to where column i begins, and to its length."""
    return tuple(cgutils.gep_inbounds(builder, places, i, j) for j in range(2))


def _column(context: Any, builder: Any, entry: Any, places: Any, i: Any) -> Any:
    """Column i of columns."""
    column = _proxy(context, builder, Column(entry))
    start, size = map(builder.load, _place(builder, places, i))
    for loaded in (start, size):  # columns stay where they are
        loaded.set_metadata("invariant.load", builder.module.add_metadata([]))
    column.start = builder.bitcast(start, context.get_data_type(entry).as_pointer())
    column.size = size
    return column._getvalue()


@infer_getattr
class _Fields(AttributeTemplate):
    key = Columns

    def generic_resolve(self, typ: Any, name: str) -> Any:
        return Column(typ.entries[typ.fields.index(name)]) if name in typ.fields else None


@lower_getattr_generic(Columns)
def _field(context: Any, builder: Any, typ: Any, places: Any, name: str) -> Any:
    i = typ.fields.index(name)
    return _column(context, builder, typ.entries[i], places, SIZE(i))


@infer_global(operator.getitem)
class _Reading(AbstractTemplate):
    def generic(self, given: Any, _: Any) -> Any:
        if isinstance(given[0], Column) and isinstance(given[1], types.Integer):
            return signature(given[0].entry, given[0], types.intp)
        return None


@infer_global(operator.setitem)
class _Writing(AbstractTemplate):
    def generic(self, given: Any, _: Any) -> Any:
        if isinstance(given[0], Column) and isinstance(given[1], types.Integer):
            return signature(types.none, given[0], types.intp, given[0].entry)
        return None


@infer_global(len)
class _Length(AbstractTemplate):
    def generic(self, given: Any, _: Any) -> Any:
        return signature(types.intp, given[0]) if isinstance(given[0], Column) else None


@lower_builtin(operator.getitem, Column, types.intp)
def _read(context: Any, builder: Any, sig: Any, given: Any) -> Any:
    where = _where(context, builder, sig.args[0], *given)
    return context.unpack_value(builder, sig.args[0].entry, where)


@lower_builtin(operator.setitem, Column, types.intp, types.Any)
def _write(context: Any, builder: Any, sig: Any, given: Any) -> Any:
    *which, value = given
    where = _where(context, builder, sig.args[0], *which)
    context.pack_value(builder, sig.args[0].entry, value, where)
    return context.get_dummy_value()


@lower_builtin(len, Column)
def _length(context: Any, builder: Any, sig: Any, given: Any) -> Any:
    return _proxy(context, builder, sig.args[0], given[0]).size


def _where(context: Any, builder: Any, typ: Any, value: Any, i: Any) -> Any:
    """Pointer to entry i, from the end if negative."""
    column = _proxy(context, builder, typ, value)
    negative = builder.icmp_signed("<", i, SIZE(0))
    i = builder.select(negative, builder.add(i, column.size), i)
    return builder.gep(column.start, [i])


def _proxy(context: Any, builder: Any, typ: Any, value: Any = None) -> Any:
    return cgutils.create_struct_proxy(typ)(context, builder, value=value)


@lower_builtin("getiter", Column)
@lower_builtin("getiter", Columns)
def _begin(context: Any, builder: Any, sig: Any, given: Any) -> Any:
    walk = _proxy(context, builder, sig.return_type)
    walk.whole, walk.next = given[0], cgutils.alloca_once_value(builder, SIZE(0))
    return walk._getvalue()


@lower_builtin("iternext", Walk)
@iternext_impl(RefType.UNTRACKED)
def _go_on(context: Any, builder: Any, sig: Any, given: Any, result: Any) -> None:
    walk = _proxy(context, builder, sig.args[0], given[0])
    whole, i = sig.args[0].whole, builder.load(walk.next)
    columns = isinstance(whole, Columns)
    size = SIZE(len(whole.entries)) if columns else (
        _proxy(context, builder, whole, walk.whole).size)
    more = builder.icmp_signed("<", i, size)
    result.set_valid(more)
    with builder.if_then(more):
        if columns:
            found = _column(context, builder, whole.entry.entry, walk.whole, i)
        else:
            where = _where(context, builder, whole, walk.whole, i)
            found = context.unpack_value(builder, whole.entry, where)
        result.yield_(found)
        builder.store(builder.add(i, SIZE(1)), walk.next)
