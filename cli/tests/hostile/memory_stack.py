# Calls itself for ever where nobody counts.
# expect: error "signal 11"
import sys
import hrdsl
node = hrdsl.Node('robot')
sys.setrecursionlimit(10 ** 9)
def f(x):
    return sorted([x], key=f)
f(1)
