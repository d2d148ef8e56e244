# Becomes another program, which sleeps.
# expect: error "it slept for 1 s of wall time"
import os
import hrdsl
node = hrdsl.Node('robot')
os.execvp('sleep', ['sleep', '1000'])
