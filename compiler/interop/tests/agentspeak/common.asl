limit(3).
near(X, Y) :- Y = X + 1.
+!common(X) <- .print("common ", X).
