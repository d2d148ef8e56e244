# Waits for a number that no float holds.
# expect: error "rubbish"
import os
import hrdsl
node = hrdsl.Node('robot')
replies = open(node._link._in, 'rb', buffering=0, closefd=False)
out = node._link._out
os.write(out, b'{"request":"sleep","seconds":1e999}\n')
replies.readline()
node.now()
