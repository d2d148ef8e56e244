# Waits for no number of seconds.
# expect: error "rubbish"
import os
import hrdsl
node = hrdsl.Node('robot')
out = node._link._out
os.write(out, b'{"request":"sleep","seconds":NaN}\n')
node._link._in.readline()
node.now()
