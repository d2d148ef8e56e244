# Is interrupted.
# expect: error "the program ended (exit code 1)"
import hrdsl
node = hrdsl.Node('robot')
raise KeyboardInterrupt
