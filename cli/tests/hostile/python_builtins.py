# Removes the functions that all code uses.
# expect: error "the program ended (exit code 1)"
import builtins
import hrdsl
node = hrdsl.Node('robot')
builtins.__dict__.clear()
node.now()
