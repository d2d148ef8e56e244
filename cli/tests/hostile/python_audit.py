# Refuses everything from now on.
# expect: error "the program ended (exit code 1)"
import sys
import hrdsl
node = hrdsl.Node('robot')
def refuse(*_):
    raise RuntimeError('no')
sys.addaudithook(refuse)
open('x')
