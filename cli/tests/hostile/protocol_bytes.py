# Writes bytes that are no text.
# expect: error "rubbish"
import os
import hrdsl
node = hrdsl.Node('robot')
out = node._link._out
os.write(out, b'\xff\xfe\x00\x80\n')
node.now()
