# Writes nothing but zeros.
# expect: error "rubbish"
import os
import hrdsl
node = hrdsl.Node('robot')
out = node._link._out
os.write(out, bytes(100) + b'\n')
node.now()
