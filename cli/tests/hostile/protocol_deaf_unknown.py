# Asks for what nobody knows, for ever, and reads no reply.
# expect: error "did not read its replies"
import os
import hrdsl
node = hrdsl.Node('robot')
out = node._link._out
while True:
    os.write(out, b'{"request":"fly"}\n' * 1000)
