# Reads where no memory is.
# expect: error "the program ended (signal 11)"
import ctypes
import hrdsl
node = hrdsl.Node('robot')
ctypes.string_at(0)
