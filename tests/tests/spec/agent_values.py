"""Values, expressions and lists, as `spec/expressions.md` and `spec/internal-actions.md` define them."""

import functools
import math
import struct
from dataclasses import dataclass
from decimal import Decimal

LEAST, GREATEST = -(2**63), 2**63 - 1


class Fault(Exception):
    """An expression without a value, a term that cannot be matched, a query without an end."""


@dataclass(frozen=True)
class Text:
    """A string; a `str` is a value of an enumeration, or an agent's name. A list is a tuple."""

    text: str


class Open:
    """In the place of a value: any value."""


OPEN = Open()


def value_of(data):
    """A value from its form in JSON."""
    if isinstance(data, dict):
        return Text(data["text"])
    return tuple(map(value_of, data)) if isinstance(data, list) else data


def values_of(data):
    return [value_of(v) for v in data]


def kind(v):
    """`false` before `true`, then numbers, names, strings, lists: the order of kinds."""
    if isinstance(v, bool):
        return 0
    for number, cls in enumerate(((int, float), str, Text, tuple), 1):
        if isinstance(v, cls):
            return number
    raise TypeError(v)


def alike(v, w):
    """v ≈ w."""
    if kind(v) != kind(w):
        return False
    if isinstance(v, tuple):
        return len(v) == len(w) and all(map(alike, v, w))
    if isinstance(v, float) and isinstance(w, float):
        return struct.pack("d", v) == struct.pack("d", w)
    return v == w


def fits(pattern, values):
    """Whether values are those of a pattern, wherever that is not open."""
    return all(p is OPEN or v is OPEN or alike(p, v) for p, v in zip(pattern, values))


def total(x):
    """The bits of a float as a number that grows as floats do, −0 before 0."""
    bits = struct.unpack("q", struct.pack("d", x))[0]
    return bits if bits >= 0 else LEAST - bits - 1


def order(v, w):
    """Less than 0, 0, or more: the order of `.sort`."""
    if kind(v) != kind(w):
        return kind(v) - kind(w)
    if isinstance(v, tuple):
        parts = (order(a, b) for a, b in zip(v, w))
        return next((p for p in parts if p), len(v) - len(w))
    if isinstance(v, Text):
        v, w = v.text, w.text
    elif isinstance(v, float) or isinstance(w, float):
        v, w = total(float(v)), total(float(w))
    return (v > w) - (v < w)


# ── Writing ──


def quoted(text):
    known = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\t": "\\t", "\r": "\\r", "\0": "\\0"}
    return '"' + "".join(known.get(c, c) for c in text) + '"'


def written(v):
    """A value, as the log has it."""
    if v is OPEN:
        return "_"
    if isinstance(v, bool):
        return str(v).lower()
    if isinstance(v, float):
        if math.isnan(v):
            return "NaN"
        if math.isinf(v):
            return "inf" if v > 0 else "-inf"
        digits = format(Decimal(repr(v)), "f")
        return digits.removesuffix(".0")
    if isinstance(v, Text):
        return quoted(v.text)
    if isinstance(v, tuple):
        return "[" + ", ".join(map(written, v)) + "]"
    return str(v)


def plain(v):
    """A value in a text that is printed: a string without its quotes."""
    return v.text if isinstance(v, Text) else written(v)


def applied(name, arguments):
    """`name(a, b)`; without arguments, the name."""
    inside = ", ".join(arguments)
    return f"{name}({inside})" if inside else name


# ── Expressions ──


def whole(n):
    if not LEAST <= n <= GREATEST:
        raise Fault("integer overflow")
    return n


def wrong():
    raise Fault("operand of the wrong type")


def boolean(v):
    return v if isinstance(v, bool) else wrong()


def evaluate(e, names, called=()):
    """names ⊢ e ⇓ the result. `called`: what the variables are called, for faults."""
    ((form, of),) = e.items()
    if form == "const":
        return value_of(of)
    if form == "var":
        if of not in names:
            raise Fault(f"`{called[of] if of < len(called) else of}` has no value")
        return names[of]
    if form == "if":
        return evaluate(of[1] if boolean(evaluate(of[0], names, called)) else of[2], names, called)
    if form == "unary":
        return unary(of[0], evaluate(of[1], names, called))
    if form == "binary":
        op, left, right = of
        a = evaluate(left, names, called)
        if op in ("and", "or"):
            return a if boolean(a) == (op == "or") else evaluate(right, names, called)
        return binary(op, a, evaluate(right, names, called))
    if form == "call":
        return call(of[0], [evaluate(a, names, called) for a in of[1]])
    if form == "list":
        elements = tuple(evaluate(a, names, called) for a in of[0])
        rest = evaluate(of[1], names, called) if of[1] else ()
        return elements + rest if isinstance(rest, tuple) else wrong()
    if form == "element":
        return names[resolved(of, names)]
    if form == "apply":
        return names.apply(of[0], [evaluate(a, names, called) for a in of[1]])
    raise NotImplementedError(form)


def resolved(place, names):
    """The variable that the indices of a place choose."""
    slot = place["slot"]
    for index in place.get("indices", ()):
        at = evaluate(index["at"], names)
        if not 0 <= at < index["count"]:
            raise Fault(f"index {at} is none of {index['count']}")
        slot += at * index["stride"]
    return slot


def unary(op, v):
    if op == "not":
        return not boolean(v)
    if kind(v) != 1:
        wrong()
    return -v if isinstance(v, float) else whole(-v)


def binary(op, a, b):
    if kind(a) != kind(b):
        wrong()
    if kind(a) != 1:
        same = {"eq": alike(a, b), "ne": not alike(a, b)}
        return same[op] if op in same else wrong()
    floats = isinstance(a, float) or isinstance(b, float)
    if floats:
        a, b = float(a), float(b)
    if op in ("div", "rem"):
        if b == 0:
            raise Fault("division by zero")
        return divided(op, a, b) if floats else truncated(op, a, b)
    if op in ("add", "sub", "mul"):
        result = {"add": a + b, "sub": a - b, "mul": a * b}[op]
        return result if floats else whole(result)
    return {"eq": a == b, "ne": a != b, "lt": a < b, "le": a <= b, "gt": a > b, "ge": a >= b}[op]


def divided(op, a, b):
    if op == "div":
        return a / b
    return math.fmod(a, b) if math.isfinite(a) else math.nan


def truncated(op, a, b):
    quotient = abs(a) // abs(b) * (1 if (a < 0) == (b < 0) else -1)
    return whole(quotient) if op == "div" else a - b * quotient


def call(name, values):
    if any(kind(v) != 1 for v in values):
        wrong()
    if name == "abs":
        return abs(values[0]) if isinstance(values[0], float) else whole(abs(values[0]))
    if name == "norm":
        return float(abs(values[0])) if len(values) == 1 else math.sqrt(sum(float(v) * float(v) for v in values))
    a, b = values
    return a if (a <= b if name == "min" else a >= b) else b


def reads(e):
    """The variables that an expression reads."""
    if isinstance(e, dict):
        return [e["var"]] if "var" in e else [v for form, of in e.items() if form != "const" for v in reads(of)]
    return [v for part in e for v in reads(part)] if isinstance(e, list) else []


# ── Lists ──


def one_of(v, *classes):
    return v if isinstance(v, classes) else wrong()


def contained(v, values):
    return any(alike(v, w) for w in values)


def distinct(values):
    out = []
    for v in values:
        if not contained(v, out):
            out.append(v)
    return tuple(out)


def in_order(values):
    return tuple(sorted(values, key=functools.cmp_to_key(order)))


def extreme(values, sign):
    best = None
    for v in values:
        if best is None or sign * order(v, best) > 0:
            best = v
    return best


def joined(values):
    if any(isinstance(v, Text) for v in values):
        return Text("".join(map(plain, values)))
    return sum((one_of(v, tuple) for v in values), ())


def sequences(values):
    """Two strings, by characters, or two lists."""
    if all(isinstance(v, Text) for v in values):
        return [list(v.text) for v in values]
    return [one_of(v, tuple) for v in values]


def apply(function, values):
    """The value of a function of lists and strings; None if it has none."""
    first = values[0]
    if isinstance(function, dict):
        return of_numbers(function["real"], values)
    if function == "concat":
        return joined(values)
    if function == "to_text":
        return Text(plain(first))
    if function == "length":
        return len(first.text if isinstance(first, Text) else one_of(first, tuple))
    if function == "empty":
        return not (first.text if isinstance(first, Text) else one_of(first, tuple))
    if function == "reverse":
        return Text(first.text[::-1]) if isinstance(first, Text) else one_of(first, tuple)[::-1]
    if function == "nth":
        place, of = one_of(first, int), one_of(values[1], tuple)
        return of[place] if 0 <= place < len(of) else None
    if function in ("prefix", "suffix", "sublist"):
        a, b = sequences(values)
        starting = {"prefix": [0], "suffix": [max(0, len(b) - len(a))], "sublist": range(len(b) - len(a) + 1)}
        return len(a) <= len(b) and any(
            all(map(alike, a, b[n:])) for n in starting[function]
        )
    if function == "occurrences":
        a, b = sequences(values)
        return tuple(
            n for n in range(len(b)) if len(b) - n >= len(a) and all(map(alike, a, b[n:]))
        )
    if function == "slice":
        _, start, end = values
        all_of = first.text if isinstance(first, Text) else one_of(first, tuple)
        if not 0 <= one_of(start, int) <= one_of(end, int) <= len(all_of):
            return None
        return Text(all_of[start:end]) if isinstance(first, Text) else all_of[start:end]
    if function == "delete":
        return tuple(v for v in one_of(values[1], tuple) if not alike(v, first))
    if function in ("sort", "min", "max"):
        one_of(first, tuple)
        return in_order(first) if function == "sort" else extreme(first, 1 if function == "max" else -1)
    a, b = one_of(first, tuple), one_of(values[1], tuple)
    if function == "union":
        return distinct(a + b)
    return tuple(v for v in a if contained(v, b) == (function == "intersection"))


# ── Numbers ──


def of_numbers(function, values):
    """A function of numbers, or of a list of numbers; None if it has no value."""
    numbers = one_of(values[0], tuple) if function in ("sum", "mean", "median", "std_dev") else values
    if any(kind(v) != 1 for v in numbers):
        wrong()
    if function == "sum":
        total = 0
        for n in numbers:
            total = total + n
        return whole(total) if all(isinstance(n, int) for n in numbers) else float(total)
    if function in ("mean", "median", "std_dev"):
        return statistic(function, [float(n) for n in numbers])
    if function in ("floor", "ceil", "round"):
        return rounded(function, numbers[0])
    return real(function, [float(n) for n in numbers])


def statistic(function, numbers):
    count, total = len(numbers), 0.0
    for n in numbers:
        total += n
    if count < (2 if function == "std_dev" else 1):
        return None
    if function == "mean":
        return total / count
    if function == "std_dev":
        squares = 0.0
        for n in numbers:
            squares += (n - total / count) * (n - total / count)
        return math.sqrt(squares / (count - 1))
    numbers, middle = sorted(numbers), count // 2
    return numbers[middle] if count % 2 else (numbers[middle - 1] + numbers[middle]) / 2


def rounded(function, x):
    if isinstance(x, int):
        return x
    if not math.isfinite(x):
        raise Fault("integer overflow")
    below = math.floor(x)
    above = below + 1
    return whole({"floor": below, "ceil": math.ceil(x), "round": above if x - below >= 0.5 else below}[function])


def real(function, numbers):
    try:
        if function == "power":
            return float(math.pow(*numbers))
        return float(getattr(math, function)(*numbers))
    except OverflowError:
        return math.inf
    except ValueError:
        # Without a bound at zero; there is none elsewhere.
        if numbers[0] != 0:
            return math.nan
        return {"log": -math.inf, "power": math.inf}.get(function, math.nan)


# ── Types ──


def typed(params, values):
    """The values as a declaration has them, or None if they are not of its types."""
    if len(params) != len(values):
        return None
    out = [of_type(p["ty"], v) for p, v in zip(params, values)]
    return None if any(v is None for v in out) else out


def of_type(ty, v):
    """The value as one of the type; None if it is not."""
    if v is OPEN:
        return v
    if ty == "bool" or ty == "text":
        return v if isinstance(v, bool if ty == "bool" else Text) else None
    ((form, of),) = ty.items()
    if form == "int":
        return v if kind(v) == 1 and isinstance(v, int) and of["lo"] <= v <= of["hi"] else None
    if form == "float":
        return float(v) if kind(v) == 1 else None
    if form == "enum":
        return v if isinstance(v, str) and v in of["values"] else None
    if not isinstance(v, tuple):
        return None
    elements = [of_type(of, e) for e in v]
    return None if any(e is None for e in elements) else tuple(elements)
