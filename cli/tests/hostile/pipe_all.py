# Writes rubbish to each of its first twenty descriptors.
# expect: error "rubbish"
import os
import hrdsl
node = hrdsl.Node('robot')
for fd in range(3, 21):
    try:
        os.write(fd, b'rubbish\n')
    except OSError:
        pass
node.now()
