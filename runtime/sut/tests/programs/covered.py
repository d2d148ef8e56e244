"""Known statements and branches; the test counts the lines."""
import threading
import hrdsl


def sign(number):
    if number > 0:
        return 1
    elif number < 0:
        return -1
    return 0


def unused():  # pragma: no cover
    return None


def worker(results):
    with open(__file__) as file:
        for line in file:
            results.append(
                len(line)
            )
            break


results = []
thread = threading.Thread(target=worker, args=(results,))
thread.start()
thread.join()
assert results
sign(1)
if hrdsl.Node("covered").seed > 100:
    sign(-1)
    raise RuntimeError("asked for")
