# Nests an unknown member half a million times.
# expect: any
import os
import hrdsl
node = hrdsl.Node('robot')
replies = open(node._link._in, 'rb', buffering=0, closefd=False)
out = node._link._out
text = b'{"request":"now","x":' + b'[' * 400_000 + b']' * 400_000 + b'}\n'
while text:
    text = text[os.write(out, text):]
replies.readline()
node.wait_for('asked')
node.emit('said', n=1)
