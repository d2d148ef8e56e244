# Asks for what nobody knows, for ever, and listens.
# expect: error "1000 requests were refused"
import os
import hrdsl
node = hrdsl.Node('robot')
replies = open(node._link._in, 'rb', buffering=0, closefd=False)
out = node._link._out
while True:
    os.write(out, b'{"request":"fly"}\n')
    replies.readline()
