"""Small faults, put one at a time into a copy of robot code that is only in memory: do its tests notice?

`mutants` walks the syntax tree of a source and returns every mutant: one operator at one place. `code` compiles a source with one
of them; the user's file is never written. Mutants that compile to the bytecode of the original are *equivalent*, those that
compile to that of an earlier mutant are *duplicates*; neither is worth a run.

`mutmut` copies sources to a folder of mutants, and `cosmic-ray` changes the file itself, each to run unit tests; neither knows of times,
readings or messages. So the operators are here.
"""

from hrdsl.mutation.mutant import Edit, Mutant, applied
from hrdsl.mutation.found import UnknownOperator, code, mutants, operators

__all__ = ["Edit", "Mutant", "UnknownOperator", "applied", "code", "mutants", "operators"]
