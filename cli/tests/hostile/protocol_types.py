# Sends members of wrong types, and goes on.
# expect: pass
import os
import hrdsl
node = hrdsl.Node('robot')
replies = open(node._link._in, 'rb', buffering=0, closefd=False)
out = node._link._out
for line in ['{"request":"sleep","seconds":"long"}', '{"request":"sleep","seconds":-1}', '{"request":"emit","event":[1]}', '{"request":"wait_for","events":{}}', '{"request":"hello","version":-1,"name":""}', '{"request":"hello","version":2,"name":"x"}', '{"request":"act","on":"","do":"","args":[]}', '{"request":"emit","event":"said","args":{"n":1e308}}', '{"request":"emit","event":"said","args":{"n":18446744073709551616}}']:
    os.write(out, line.encode() + b'\n')
    assert b'error' in replies.readline(), line
node.wait_for('asked')
node.emit('said', n=1)
