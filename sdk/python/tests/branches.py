"""Code whose branches are hard to tell: `with` that is left early, comprehensions, statements of several lines."""
import contextlib


def f(n):
    with contextlib.suppress(ValueError):
        with contextlib.suppress(KeyError), contextlib.suppress(IndexError):
            if n > 2:
                return 1
        n = n + (
            1 +
            2
        )
    for i in range(n):
        with contextlib.suppress(KeyError):
            if i == 1:
                continue
            if i > 2:
                break
            with open(__file__) as g:
                if g.read(1):
                    pass
    else:
        n = 3
    try:
        with contextlib.suppress(KeyError):
            raise ValueError(n)
    except ValueError:
        n = 1
    finally:
        n = 2
    while True:
        with contextlib.suppress(KeyError):
            break
    return [
        x for x in range(n)
        if x
    ]


f(1)
f(3)
