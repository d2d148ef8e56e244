# Ends in the middle of a line.
# expect: error "the program ended (exit code 0)"
import os
import hrdsl
node = hrdsl.Node('robot')
out = node._link._out
os.write(out, b'{"request":"no')
os._exit(0)
