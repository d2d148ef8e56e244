!count(20000).

// Goals a second. A goal of its own for each number, down to 0.
+!count(N) : N > 0 <- !count(N - 1).
+!count(_) <- .print(done).
