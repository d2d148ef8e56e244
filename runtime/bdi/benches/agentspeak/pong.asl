// The other side of `ping.asl`, which has the number.
+!ball(N) : N > 0 <- .send(ping, achieve, ball(N - 1)).
+!ball(_) <- .print(done).
