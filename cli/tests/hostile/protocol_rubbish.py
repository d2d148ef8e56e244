# Writes no JSON.
# expect: error "rubbish"
import os
import hrdsl
node = hrdsl.Node('robot')
out = node._link._out
os.write(out, b'Hello, world\n')
node.now()
