# Computes for ever before it says anything.
# expect: error "within 1 s of processor time"
while True:
    pass
