# Kills its own group.
# expect: error "the program ended (signal 9)"
import os, signal
import hrdsl
node = hrdsl.Node('robot')
os.killpg(0, signal.SIGKILL)
