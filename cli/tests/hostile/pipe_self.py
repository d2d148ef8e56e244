# Writes replies to itself.
# expect: any
import os
import hrdsl
node = hrdsl.Node('robot')
reply = os.open('/proc/self/fd/%d' % node._link._in, os.O_WRONLY)
os.write(reply, b'{"t":5}\n' * 100)
node.wait_for('asked')
node.emit('said', n=1)
