# Sleeps before it has greeted.
# expect: error "it never spoke to the harness"
import ctypes
ctypes.CDLL(None).sleep(1000)
