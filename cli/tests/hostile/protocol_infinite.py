# Waits for a number that no float holds.
# expect: error "rubbish"
import os
import hrdsl
node = hrdsl.Node('robot')
out = node._link._out
os.write(out, b'{"request":"sleep","seconds":1e999}\n')
node._link._in.readline()
node.now()
