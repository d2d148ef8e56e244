# Keeps the protocol open in a child after its own end.
# expect: error "the program ended (exit code 3)"
import os
import posix
import hrdsl
node = hrdsl.Node('robot')
os.set_inheritable(node._link._out, True)
if posix.fork() == 0:
    os.execvp('sleep', ['sleep', '1000'])
os._exit(3)
