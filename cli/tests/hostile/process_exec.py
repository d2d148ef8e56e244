# Becomes another program.
# expect: error "the program ended (exit code 0)"
import os
import hrdsl
node = hrdsl.Node('robot')
os.execvp('true', ['true'])
