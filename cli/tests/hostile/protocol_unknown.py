# Asks for what nobody knows, for ever, and listens.
# expect: error "1000 requests were refused"
import os
import hrdsl
node = hrdsl.Node('robot')
out = node._link._out
while True:
    os.write(out, b'{"request":"fly"}\n')
    node._link._in.readline()
