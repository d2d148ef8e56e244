"""Samples a second of processor time that SENTIL takes for the formulas of `formulas.rs`, on signals made alike.

`pip install sentil==0.3.1 numpy`, then `python3 runtime/metric/benches/sentil.py [SAMPLES]`. A row is robustness at each sample, of the whole trace at once; as they
come in, through Python's objects, it takes longer.
"""

import sys
import time

import numpy
import sentil

ROUNDS = 5

FORMULAS = [
    "a < 0.9",
    "(a < 0.9) -> F[0,10](b < 0.9)",
    *(f.format(to) for to in (10, 1000) for f in ("O[0,{}](a < 0.9)", "H[2,{}](a < 0.9)", "(a < 0.9) S[2,{}] (b < 0.9)", "(a < 0.9) U[2,{}] (b < 0.9)")),
]


def main():
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 200_000
    dice = numpy.random.default_rng(7)
    signals = {name: dice.uniform(-1, 1, count) for name in "ab"}
    regular = numpy.arange(count, dtype=float)
    irregular = numpy.cumsum(dice.integers(1, 201, count) / 100)
    for kind, times in (("regular", regular), ("irregular", irregular)):
        trace = sentil.Trace(times, signals)
        for text in FORMULAS:
            formula = sentil.Formula.parse(text)
            best = float("inf")
            for _ in range(ROUNDS):
                before = time.process_time()
                formula.robustness_signal(trace)
                best = min(best, time.process_time() - before)
            print(f"{f'{text}, {kind}':<46} {count / best / 1e6:>8.1f} million samples a second")


main()
