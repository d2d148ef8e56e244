/* A counter, with everything that a body can have. */
counter(0).
step(2).
limit(9).
names(["one", "two", "three"]).
even(N) :- N mod 2 == 0.
done(N) :- limit(L) & N >= L.
between_limits(N) :- limit(L) & (N < L & N > 0 | N == -1).

!count.
!report.

@count[atomic, priority(3)]
+!count : counter(N) & not done(N) & step(S)
   <- -+counter(N + S);
      if (even(N) & N > 2) {
         .print("even ", N)
      } elif (N == 3) {
         .print("three")
      } else {
         .print("other: ", N, " of ", count(N, [1, 2]))
      };
      .wait(500);
      .wait(2000);
      !count.
+!count.

+!report : names(All)
   <- .length(All, Len);
      for (.member(Name, All)) { .print(Name) }
      for (.range(I, 1, 3)) { say(I, "times") };
      while (counter(N) & N < 4) { .wait(100) }
      { .print("left") |&| .print("right") };
      .print("a") ||| { .wait(10); .print("b") };
      .nth(0, All, First);
      .concat(All, ["four"], More);
      .reverse(More, Back);
      [Head | Tail] = Back;
      Half = Len / 2;
      Whole = Len div 2;
      Square = Len ** 2;
      Abs = math.abs(Whole - Square);
      .max([Whole, Square, Abs], Best);
      +result(Half, Best, Head);
      .findall(R, result(_, R, _), Rs);
      !!show(Rs, Tail);
      .drop_desire(count);
      .suspend(report);
      .fail.

-!report[error(E)] <- .print("no report"); .drop_all_intentions.

+!show([], _).
+!show([H | T], Rest) : Rest \== [] <- .print(H); !show(T, Rest).
+!show(L, []) : not .intend(report) | L == [] <- .resume(report); .succeed_goal(report).
