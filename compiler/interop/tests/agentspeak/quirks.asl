// Every quirk that is reported.
battery(80).
colour(red). colour(green).
speed(1). speed(2.5).
mood("fine").
mixed(1).
mixed(one).
~safe(kitchen).
pos(point(1, 2)).
open_fact(_).

!start.
!test.

+!start : batery(B) & B > 20 <- .print("misspelt").
+!start : colour(C) & D == red <- .print("D has no value ", C).
+!start <- X > 3; .print("never here").
+!start <- .print("never selected").

+!test
   <- +colour(blue);
      -+colour(red);
      ++alarm;
      +<seen(1);
      +>seen(2);
      -told(1);
      .wait("+go");
      .wait({+go});
      .wait({+go}, 1000);
      .nonsense(1, X);
      my.action(2);
      T =.. [point, [1, 2], []];
      !unplanned(1);
      !ask(Y);
      +mixed(two);
      +note(Z);
      move(point(3, 4));
      .send(nobody, tell, hello);
      .send(quirks, tellHow, "+!a <- true.");
      .at("now +3 s", {+!test});
      ?pos(P);
      +pos(P);
      ?pos(point(A, B));
      !go_to(P);
      K = 7 / 2;
      +ratio(K);
      .fail_goal(start).

+!go_to(point(X, Y)) : pos(point(X, _)) & ~safe(kitchen) & not ~safe(hall) <- move(point(X, Y)).
+!never(X) <- .print(X).
+alarm <- .print("alarm").
^!start[state(finished)] <- .print("state").
+X[source(percept)] <- .print("anything").
+seen(N)[sure(90), source(percept), hot] : N > 0 <- .print(N).
@dup[breakpoint] -!test[error(ina_failed)] <- .print("failed").
{ begin bdg(test) }
+!unused.
{ end }
{ register_function("my.f", 1, "p") }

+!tidy : cupboard(open) <- -cupbord(open); -drawrs.
