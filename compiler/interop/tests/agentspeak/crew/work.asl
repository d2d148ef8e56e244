!work.
+!work <- dig(1).
