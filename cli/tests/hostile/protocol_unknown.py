# Asks for what nobody knows, for ever, and listens.
# expect: error "did not make a request"
import os
import hrdsl
node = hrdsl.Node('robot')
out = node._link._out
while True:
    os.write(out, b'{"request":"fly"}\n')
    node._link._in.readline()
