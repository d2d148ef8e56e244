# Fails with an error that cannot be shown.
# expect: error "the program ended (exit code 1)"
import hrdsl
node = hrdsl.Node('robot')
class Bad(Exception):
    def __str__(self):
        raise self
raise Bad
