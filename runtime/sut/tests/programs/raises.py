import hrdsl

node = hrdsl.Node("raises")


def fail():
    raise ValueError("a wheel came off")


fail()
