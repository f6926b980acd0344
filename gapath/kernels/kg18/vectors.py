"""Vectors as LLVM's intermediate language computes them, written as formulas.

A function of `gapath.kernels.kg18.lanes` or `gapath.kernels.kg18.field_lanes` gives its code as
operations on `Vector`; `Code` reads its arguments, which are numbers and arrays.
Arrays have to be contiguous: their strides are not read.
"""

from typing import Any

from llvmlite import ir

I32, I64, F64 = ir.IntType(32), ir.IntType(64), ir.DoubleType()


class Vector:
    """A vector as LLVM computes it, with the operators that formulas need."""

    def __init__(self, builder: Any, value: Any) -> None:
        self.builder, self.value, self.kind = builder, value, value.type

    def _binary(self, real: str, whole: str, other: "Vector | float") -> "Vector":
        name = real if self.kind.element == F64 else whole
        return Vector(self.builder, getattr(self.builder, name)(self.value, self._like(other)))

    def _like(self, other: "Vector | float") -> Any:
        if isinstance(other, Vector):
            return other.value
        return ir.Constant(self.kind, [other] * self.kind.count)

    def __add__(self, other: "Vector | float") -> "Vector":
        return self._binary("fadd", "add", other)

    def __sub__(self, other: "Vector | float") -> "Vector":
        return self._binary("fsub", "sub", other)

    def __mul__(self, other: "Vector | float") -> "Vector":
        return self._binary("fmul", "mul", other)

    def __rshift__(self, bits: int) -> "Vector":
        return self._binary("", "ashr", bits)

    def __or__(self, other: "Vector") -> "Vector":
        return self._binary("", "or_", other)

    def __and__(self, other: float) -> "Vector":
        return self._binary("", "and_", other)

    def __lt__(self, other: "Vector | float") -> "Vector":
        return Vector(self.builder, self.builder.icmp_signed("<", self.value, self._like(other)))

    def outside(self, side: "Vector") -> "Vector":
        """Tell whether it is negative or at least as large as a side."""
        return Vector(self.builder, self.builder.icmp_unsigned(">=", self.value, side.value))

    def choose(self, one: "Vector", other: "Vector | float") -> "Vector":
        """Give one where this is true, the other where it is false."""
        value = self.builder.select(self.value, one.value, one._like(other))
        return Vector(self.builder, value)

    def negative(self) -> "Vector":
        """Change the sign of whole numbers."""
        return Vector(self.builder, self.builder.sub(self._like(0), self.value))

    def size(self) -> "Vector":
        """Give the absolute value of whole numbers."""
        return (self < 0).choose(self.negative(), self)

    def real(self) -> "Vector":
        """Turn whole numbers into real ones."""
        kind = ir.VectorType(F64, self.kind.count)
        return Vector(self.builder, self.builder.sitofp(self.value, kind))

    def whole(self) -> "Vector":
        """Cut off what follows the point; of numbers beyond 32 bits nothing is left that counts."""
        kind = ir.VectorType(I32, self.kind.count)
        return Vector(self.builder, self.builder.fptosi(self.value, kind))

    def short(self) -> "Vector":
        """Keep the lower 32 of 64 bits."""
        kind = ir.VectorType(I32, self.kind.count)
        return Vector(self.builder, self.builder.trunc(self.value, kind))

    def divide(self, number: float) -> "Vector":
        """Divide a number by it."""
        return Vector(self.builder, self.builder.fdiv(self._like(number), self.value))


class Code:
    """The code of one function: its arguments as numbers, vectors and memory."""

    def __init__(self, context: Any, builder: Any, signature: Any, args: Any) -> None:
        self.context, self.builder = context, builder
        self.kinds, self.args = signature.args, args
        for kind in self.kinds:
            if getattr(kind, "layout", "C") != "C":
                raise TypeError(f"{kind}: not contiguous")

    def all_lanes(self, number: Any, lanes: int, kind: Any = I32) -> Vector:
        """Copy a number, or the argument so numbered, into all lanes."""
        number = self.args[number] if isinstance(number, int) else number
        if kind == I32 and number.type == I64:
            number = self.builder.trunc(number, I32)
        nothing = ir.Constant(ir.VectorType(kind, lanes), ir.Undefined)
        first = self.builder.insert_element(nothing, number, I32(0))
        everywhere = ir.Constant(ir.VectorType(I32, lanes), [0] * lanes)
        return Vector(self.builder, self.builder.shuffle_vector(first, nothing, everywhere))

    def array(self, argument: int) -> Any:
        """Give an argument that is an array, with its data and its shape."""
        return self.context.make_array(self.kinds[argument])(
            self.context, self.builder, self.args[argument]
        )

    def pointer(self, argument: int, place: Any, kind: Any) -> Any:
        """Point to what an array holds from a place on."""
        data = self.builder.gep(self.array(argument).data, [place])
        return self.builder.bitcast(data, ir.PointerType(kind))

    def load(self, argument: int, place: Any, lanes: int, kind: Any = I32) -> Vector:
        """Read a vector from an array, from a place on."""
        pointer = self.pointer(argument, place, ir.VectorType(kind, lanes))
        return Vector(self.builder, self.builder.load(pointer, align=4 if kind == I32 else 8))

    def store(self, value: Vector, argument: int, place: Any) -> None:
        """Write a vector to an array, from a place on."""
        pointer = self.pointer(argument, place, value.kind)
        self.builder.store(value.value, pointer, align=4 if value.kind.element == I32 else 8)

    def place(self, argument: int, row: Any, column: Any) -> Any:
        """Give the place of an element of a matrix."""
        width = self.builder.extract_value(self.array(argument).shape, 1)
        return self.builder.add(self.builder.mul(row, width), column)

    def done(self) -> Any:
        """Give what a function returns that returns nothing."""
        return self.context.get_dummy_value()
