# Calls itself for ever.
# expect: error "RecursionError"
import hrdsl
node = hrdsl.Node('robot')
def f():
    f()
f()
