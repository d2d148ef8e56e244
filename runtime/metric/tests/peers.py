"""Evaluates formulas with other tools, and says where they differ from what is expected.

`python3 peers.py PACKAGES CASES`: a folder of packages, and a file of JSON: a list of cases, each with the formula in the words of each tool (or null),
`times` in seconds, the samples `x` and `y`, and `expected`, a list of a time and a number, at which both are compared.
"""

import bisect
import json
import sys

sys.path.insert(0, sys.argv[1])


def with_rtamt():
    import rtamt

    def spec(kind, text):
        made = kind()
        made.declare_var("x", "float")
        made.declare_var("y", "float")
        made.spec = text
        made.parse()
        return made

    def regular(text, case):
        made = spec(rtamt.StlDiscreteTimeSpecification, text)
        signals = {"time": [int(t) for t in case["times"]], "x": case["x"], "y": case["y"]}
        return [tuple(pair) for pair in made.evaluate(signals)]

    def irregular(text, case):
        made = spec(rtamt.StlDenseTimeSpecification, text)
        signal = lambda name: [name, [list(pair) for pair in zip(case["times"], case[name])]]
        return [tuple(pair) for pair in made.evaluate(signal("x"), signal("y"))]

    return regular, irregular


def with_reelay():
    import reelay

    def regular(text, case):
        monitor = reelay.discrete_timed_monitor(pattern=text, semantics="robustness", condense=False)
        samples = zip(case["times"], case["x"], case["y"])
        return [(t, monitor.update({"x": x, "y": y})["value"]) for t, x, y in samples]

    def irregular(text, case):
        monitor = reelay.dense_timed_monitor(pattern=text, semantics="robustness")
        found = []
        for t, x, y in zip(case["times"], case["x"], case["y"]):
            found += [(piece["time"], piece["value"]) for piece in monitor.update({"time": t, "x": x, "y": y})]
        return found

    return regular, irregular


def with_sentil():
    import numpy
    import sentil

    def regular(text, case):
        signals = {name: numpy.array(case[name]) for name in ("x", "y")}
        trace = sentil.Trace(numpy.array(case["times"]), signals)
        return list(zip(case["times"], (float(v) for v in sentil.Formula.parse(text).robustness_signal(trace))))

    # Between samples it interpolates, or knows nothing: no common semantics.
    return regular, None


def compare(name, evaluate, text, case):
    """The first difference, or None; and how many moments were compared."""
    found = evaluate(text, case)
    starts = [time for time, _ in found]
    compared = 0
    for time, expected in case["expected"]:
        at = bisect.bisect_right(starts, time) - 1
        if at < 0:
            continue  # It says nothing of this moment.
        value = found[at][1]
        expected = float(expected)
        if value != expected:
            return f"{name}: {text} at {time}: {value}, expected {expected}\n  {json.dumps(case)}", compared
        compared += 1
    return None, compared


def main():
    with open(sys.argv[2]) as file:
        cases = json.load(file)
    differing = 0
    for name, load in (("rtamt", with_rtamt), ("reelay", with_reelay), ("sentil", with_sentil)):
        try:
            regular, irregular = load()
        except Exception as error:
            print(f"{name}: skipped, since it cannot be loaded: {error}")
            continue
        formulas, moments, different = 0, 0, 0
        for case in cases:
            evaluate = regular if case["regular"] else irregular
            text = case["formulas"].get(name)
            if text is None or evaluate is None:
                continue
            difference, compared = compare(name, evaluate, text, case)
            formulas += 1
            moments += compared
            if difference:
                different += 1
                print(difference)
                if different > 10:
                    break
        agree = f"{name}: {formulas} formulas agree at {moments} moments"
        print(f"{name} differs" if different else agree)
        differing += different
    sys.exit(1 if differing else 0)


main()
