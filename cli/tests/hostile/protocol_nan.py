# Waits for no number of seconds.
# expect: error "rubbish"
import os
import hrdsl
node = hrdsl.Node('robot')
replies = open(node._link._in, 'rb', buffering=0, closefd=False)
out = node._link._out
os.write(out, b'{"request":"sleep","seconds":NaN}\n')
replies.readline()
node.now()
