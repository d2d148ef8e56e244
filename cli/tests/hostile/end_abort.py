# Aborts.
# expect: error "the program ended (signal 6)"
import os
import hrdsl
node = hrdsl.Node('robot')
os.abort()
