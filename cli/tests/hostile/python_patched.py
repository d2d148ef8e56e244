# Replaces what the harness's own modules rely on.
# expect: error "the program ended (exit code 1)"
import json, os
import hrdsl
node = hrdsl.Node('robot')
os.write = os.getpid = os._exit = None
node.now()
