# Nests a request half a million times.
# expect: error "rubbish"
import os
import hrdsl
node = hrdsl.Node('robot')
out = node._link._out
os.write(out, b'[' * 500_000 + b'\n')
node.now()
