# Floods standard error.
# expect: error "bytes of output"
import os
import hrdsl
node = hrdsl.Node('robot')
while True:
    os.write(2, b'y' * 1000)
