"""Tables in and out by the Arrow PyCapsule interface.

The structs are those of Arrow's C data interface (https://arrow.apache.org/docs/format/CDataInterface.html). Columns come in as
lists, so that any frame with ``__arrow_c_stream__`` works and no library for frames is needed.
"""

from __future__ import annotations

import ctypes
import itertools
from collections.abc import Mapping, Sequence
from ctypes import POINTER, byref, c_char_p, c_int, c_int64, c_void_p, cast, pointer
from typing import Any

from ._native import MavericError as Error

Cells = list[Any]
Columns = list[tuple[str, Cells]]
# Name, Arrow's letter for the type, rows, buffers.
Column = tuple[str, str, int, list[bytes]]


class _Schema(ctypes.Structure):
    pass


class _Array(ctypes.Structure):
    pass


class _Stream(ctypes.Structure):
    pass


_ReleaseSchema = ctypes.CFUNCTYPE(None, POINTER(_Schema))
_ReleaseArray = ctypes.CFUNCTYPE(None, POINTER(_Array))
_ReleaseStream = ctypes.CFUNCTYPE(None, POINTER(_Stream))
_GetSchema = ctypes.CFUNCTYPE(c_int, POINTER(_Stream), POINTER(_Schema))
_GetNext = ctypes.CFUNCTYPE(c_int, POINTER(_Stream), POINTER(_Array))
_GetError = ctypes.CFUNCTYPE(c_void_p, POINTER(_Stream))

_Schema._fields_ = [
    ("format", c_char_p),
    ("name", c_char_p),
    ("metadata", c_void_p),
    ("flags", c_int64),
    ("n_children", c_int64),
    ("children", POINTER(POINTER(_Schema))),
    ("dictionary", POINTER(_Schema)),
    ("release", _ReleaseSchema),
    ("private_data", c_void_p),
]
_Array._fields_ = [
    ("length", c_int64),
    ("null_count", c_int64),
    ("offset", c_int64),
    ("n_buffers", c_int64),
    ("n_children", c_int64),
    ("buffers", POINTER(c_void_p)),
    ("children", POINTER(POINTER(_Array))),
    ("dictionary", POINTER(_Array)),
    ("release", _ReleaseArray),
    ("private_data", c_void_p),
]
_Stream._fields_ = [
    ("get_schema", _GetSchema),
    ("get_next", _GetNext),
    ("get_last_error", _GetError),
    ("release", _ReleaseStream),
    ("private_data", c_void_p),
]

_PyCapsule_GetPointer = ctypes.pythonapi.PyCapsule_GetPointer
_PyCapsule_GetPointer.restype = c_void_p
_PyCapsule_GetPointer.argtypes = [ctypes.py_object, c_char_p]
_STREAM = b"arrow_array_stream"

# ---------------------------------------------------------------------------------------------------------------------- in

_NUMBERS: dict[str, tuple[Any, int]] = {
    "c": (ctypes.c_int8, 1),
    "C": (ctypes.c_uint8, 1),
    "s": (ctypes.c_int16, 2),
    "S": (ctypes.c_uint16, 2),
    "i": (ctypes.c_int32, 4),
    "I": (ctypes.c_uint32, 4),
    "l": (ctypes.c_int64, 8),
    "L": (ctypes.c_uint64, 8),
    "f": (ctypes.c_float, 4),
    "g": (ctypes.c_double, 8),
}


def columns_of(data: Any) -> Columns:
    """Names and cells of a frame with ``__arrow_c_stream__``, or of a mapping from names to sequences."""
    if hasattr(data, "__arrow_c_stream__"):
        return _of_stream(data.__arrow_c_stream__())
    if isinstance(data, Mapping):
        return [(str(name), _plain(name, cells)) for name, cells in data.items()]
    raise Error(
        f"{type(data).__name__} is no table: expected a data frame (polars, pandas 2.2 or newer, pyarrow) or a dict of lists"
    )


def _plain(name: Any, cells: Sequence[Any]) -> Cells:
    listed = cells.tolist() if hasattr(cells, "tolist") else list(cells)
    if any(isinstance(cell, bool) for cell in listed):
        return [None if cell is None else str(cell).lower() for cell in listed]
    kinds = {type(cell) for cell in listed if cell is not None}
    if not kinds <= {int, float, str} or (str in kinds and len(kinds) > 1):
        words = ", ".join(sorted(kind.__name__ for kind in kinds))
        raise Error(f"column `{name}` holds {words}, expected numbers or text")
    return listed


def _of_stream(capsule: object) -> Columns:
    stream = _Stream.from_address(_PyCapsule_GetPointer(capsule, _STREAM))
    schema = _Schema()
    _checked(stream, stream.get_schema(byref(stream), byref(schema)))
    try:
        if schema.format != b"+s":
            raise Error(f"an Arrow stream of `{schema.format.decode()}`, expected a table")
        fields = [schema.children[i].contents for i in range(schema.n_children)]
        columns: Columns = [(field.name.decode(), []) for field in fields]
        while True:
            batch = _Array()
            _checked(stream, stream.get_next(byref(stream), byref(batch)))
            if not batch.release:
                return columns
            try:
                for i, ((name, cells), field) in enumerate(zip(columns, fields)):
                    column = batch.children[i].contents
                    cells.extend(_cells(name, field, column, batch.offset, batch.length))
            finally:
                batch.release(byref(batch))
    finally:
        schema.release(byref(schema))


def _checked(stream: _Stream, code: int) -> None:
    if code:
        said = stream.get_last_error(byref(stream))
        words = ctypes.string_at(said).decode() if said else f"error {code}"
        raise Error(f"the data frame could not be read: {words}")


def _cells(name: str, field: _Schema, array: _Array, offset: int, length: int) -> Cells:
    start = array.offset + offset
    there = array.buffers[0] if array.n_buffers and array.null_count else None
    values = _values(name, field, array, start, length)
    if there:
        bits = ctypes.string_at(there, (start + length + 7) // 8)
        values = [v if bits[i >> 3] >> (i & 7) & 1 else None for i, v in enumerate(values, start)]
    return values


def _values(name: str, field: _Schema, array: _Array, start: int, length: int) -> Cells:
    kind = field.format.decode()
    if field.dictionary:
        words = array.dictionary.contents
        known = _cells(name, field.dictionary.contents, words, 0, words.length)
        ctype, _ = _NUMBERS[kind]
        indices = (ctype * (start + length)).from_address(array.buffers[1])[start:] if length else []
        return [known[i] if 0 <= i < len(known) else None for i in indices]
    if kind in _NUMBERS:
        ctype, _ = _NUMBERS[kind]
        values: Cells = list((ctype * (start + length)).from_address(array.buffers[1])[start:]) if length else []
        return [float(v) for v in values] if kind == "L" else values
    if kind == "b":
        bits = ctypes.string_at(array.buffers[1], (start + length + 7) // 8) if length else b""
        return ["true" if bits[i >> 3] >> (i & 7) & 1 else "false" for i in range(start, start + length)]
    if kind in ("u", "U"):
        ends = (ctypes.c_int32 if kind == "u" else ctypes.c_int64) * (start + length + 1)
        if not length:
            return []
        at = ends.from_address(array.buffers[1])[start:]
        text = ctypes.string_at(array.buffers[2], at[-1]) if at[-1] else b""
        return [text[a:b].decode() for a, b in zip(at, at[1:])]
    if kind == "vu":
        return [_view(array, i) for i in range(start, start + length)]
    if kind == "n":
        return [None] * length
    raise Error(f"column `{name}` is of Arrow's type `{kind}`, expected numbers or text")


def _view(array: _Array, row: int) -> str:
    view = ctypes.string_at(array.buffers[1] + 16 * row, 16)
    size = int.from_bytes(view[:4], "little")
    if size <= 12:
        return view[4 : 4 + size].decode()
    buffer, offset = int.from_bytes(view[8:12], "little"), int.from_bytes(view[12:], "little")
    return ctypes.string_at(array.buffers[2 + buffer] + offset, size).decode()


# --------------------------------------------------------------------------------------------------------------------- out

# What Arrow's consumers still hold, by the number in `private_data`.
_HELD: dict[int, object] = {}
_NUMBER = itertools.count(1)


def _hold(thing: object) -> int:
    number = next(_NUMBER)
    _HELD[number] = thing
    return number


def _let_go(struct: Any) -> None:
    for i in range(getattr(struct.contents, "n_children", 0)):
        child = struct.contents.children[i]
        if child.contents.release:
            child.contents.release(child)
    _HELD.pop(struct.contents.private_data or 0, None)
    struct.contents.release = type(struct.contents.release)()


def _schema_of(stream: Any, out: Any) -> int:
    held: Any = _HELD[stream.contents.private_data]
    table = held[0]
    children = [_Schema() for _ in table._columns]
    for child, (name, kind, _, buffers) in zip(children, table._columns):
        words = (kind.encode(), name.encode())
        child.format, child.name = words
        child.flags = 2 if buffers[0] else 0
        child.release = _release_schema
        child.private_data = _hold((child, words))
    pointers = (POINTER(_Schema) * len(children))(*map(pointer, children))
    root = out.contents
    ctypes.memset(out, 0, ctypes.sizeof(_Schema))
    root.format, root.name = b"+s", b""
    root.n_children = len(children)
    root.children = cast(pointers, POINTER(POINTER(_Schema)))
    root.release = _release_schema
    root.private_data = _hold((pointers, children))
    return 0


def _next_of(stream: Any, out: Any) -> int:
    held: Any = _HELD[stream.contents.private_data]
    table, done = held
    ctypes.memset(out, 0, ctypes.sizeof(_Array))
    if done:
        return 0
    held[1] = True
    children = [_Array() for _ in table._columns]
    for child, (_, _, rows, buffers) in zip(children, table._columns):
        addresses = [cast(c_char_p(b), c_void_p).value if b else None for b in buffers]
        if buffers[1:] and not buffers[-1]:
            addresses[-1] = cast(c_char_p(b"\0"), c_void_p).value
        listed = (c_void_p * len(buffers))(*addresses)
        child.length, child.n_buffers = rows, len(buffers)
        child.null_count = -1 if buffers[0] else 0
        child.buffers = cast(listed, POINTER(c_void_p))
        child.release = _release_array
        child.private_data = _hold((child, listed, buffers))
    pointers = (POINTER(_Array) * len(children))(*map(pointer, children))
    none = (c_void_p * 1)(None)
    root = out.contents
    root.length, root.n_buffers, root.n_children = len(table), 1, len(children)
    root.buffers = cast(none, POINTER(c_void_p))
    root.children = cast(pointers, POINTER(POINTER(_Array)))
    root.release = _release_array
    root.private_data = _hold((pointers, none, children))
    return 0


# These live as long as the process: whoever holds a struct calls them.
_release_schema = _ReleaseSchema(_let_go)
_release_array = _ReleaseArray(_let_go)
_release_stream = _ReleaseStream(_let_go)
_get_schema = _GetSchema(_schema_of)
_get_next = _GetNext(_next_of)
_get_error = _GetError(lambda _: None)

_Destructor = ctypes.CFUNCTYPE(None, c_void_p)
_PyCapsule_New = ctypes.pythonapi.PyCapsule_New
_PyCapsule_New.restype = ctypes.py_object
_PyCapsule_New.argtypes = [c_void_p, c_char_p, _Destructor]
_raw_pointer = ctypes.PYFUNCTYPE(c_void_p, c_void_p, c_char_p)(("PyCapsule_GetPointer", ctypes.pythonapi))


def _forget(capsule: int) -> None:
    address = _raw_pointer(capsule, _STREAM)
    stream = _Stream.from_address(address)
    if stream.release:
        stream.release(byref(stream))
    _HELD.pop(-address, None)


_destroy = _Destructor(_forget)


class Table:
    """Columns that polars, pandas and pyarrow take as they are: ``polars.DataFrame(t)``, ``pyarrow.table(t)``."""

    def __init__(self, columns: list[Column]) -> None:
        self._columns = columns

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        stream = _Stream()
        stream.get_schema, stream.get_next = _get_schema, _get_next
        stream.get_last_error, stream.release = _get_error, _release_stream
        stream.private_data = _hold([self, False])
        address = ctypes.addressof(stream)
        # The struct lives as long as the capsule, whoever has taken what it held.
        _HELD[-address] = stream
        return _PyCapsule_New(address, _STREAM, _destroy)

    @property
    def columns(self) -> list[str]:
        """Names of the columns, in order."""
        return [name for name, *_ in self._columns]

    def to_dict(self) -> dict[str, list[Any]]:
        """A list a column; a missing cell is None, a flag True or False."""
        rows = dict(columns_of(self))
        for name, kind, *_ in self._columns:
            if kind == "b":
                rows[name] = [None if word is None else word == "true" for word in rows[name]]
        return rows

    def __len__(self) -> int:
        return self._columns[0][2] if self._columns else 0

    def __repr__(self) -> str:
        return f"<maveric.Table: {len(self)} rows of {', '.join(self.columns)}>"
