"""Calls of C functions by address from inside a kernel.

A ctypes function among a kernel's globals keeps numba from caching it: its address holds for one
process only. Here the address is an argument like any other, so the kernel is cached.
"""

import ctypes
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from neol.base.kernel import PLAIN

_plain: dict[int, Callable[..., Any]] = {}
"""Python functions that plain kernels call in place of C functions, by their made-up addresses."""


def address(function: Any) -> int:
    """Return the address of a ctypes function."""
    value = ctypes.cast(function, ctypes.c_void_p).value
    assert value is not None
    return value


def plain_address(function: Callable[..., Any]) -> int:
    """Return a number by which plain kernels can call a Python function."""
    _plain[id(function)] = function
    return id(function)


def _call_plain(function: int, *arguments: Any) -> Any:
    return _plain[function](*arguments)


def _c_call(returns: types.Type, function: types.Type, arguments: tuple[types.Type, ...]) -> Any:
    """Return numba's signature and code of a call; an array is passed as a pointer to its data."""
    if not isinstance(function, types.Integer):
        return None
    signature = returns(function, types.StarArgTuple(arguments))  # type: ignore[no-untyped-call]

    def generate(context: Any, builder: Any, _signature: Any, values: Any) -> Any:
        pointer, packed = values
        passed = [
            context.make_array(kind)(context, builder, value).data
            if isinstance(kind, types.Array)
            else value
            for kind, value in zip(arguments, cgutils.unpack_tuple(builder, packed), strict=True)  # type: ignore[no-untyped-call]
        ]
        result = ir.VoidType() if returns == types.void else context.get_value_type(returns)
        prototype = ir.FunctionType(result, [value.type for value in passed])
        called = builder.call(builder.inttoptr(pointer, prototype.as_pointer()), passed)
        return context.get_dummy_value() if returns == types.void else called

    return signature, generate


@intrinsic
def call_void(_typing_context: Any, function: Any, *arguments: Any) -> Any:
    """Call a C function that returns nothing: call_void(function, *arguments).

    `function` is its address. Arrays are passed as pointers, a handle as the int64 of its
    address; integers and floats have the C type of their own width, so `int` is np.int32.
    """
    return _c_call(types.void, function, arguments)


@intrinsic
def call_int(_typing_context: Any, function: Any, *arguments: Any) -> Any:
    """Call a C function that returns an int: call_int(function, *arguments) (see `call_void`)."""
    return _c_call(types.int32, function, arguments)


if PLAIN:
    call_void = call_int = _call_plain  # type: ignore[assignment]
