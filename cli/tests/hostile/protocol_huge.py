# Writes a line of four megabytes.
# expect: error "a line longer than"
import os
import hrdsl
node = hrdsl.Node('robot')
out = node._link._out
line = b'x' * (1 << 16)
for _ in range(64):
    os.write(out, line)
node.now()
