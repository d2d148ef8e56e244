// Internal actions as values, and parentheses in bodies.
b(1). b(2). names([x,y,z]).
many :- .count(b(_)) > 1.
!s.
+!s <- .print(.length([1,2,3])); X = .count(b(_)); .print(X); Y = .length("abc") + 1; .print(Y); if (.count(b(_)) > 1 & not .count(b(_)) > 2) { .print(many) };
   ?many; .findall(math.length(L), names(L), All); .print(All); while (.count(b(_)) < 4) { +b(.count(b(_)) + 1) }; .print(.count(b(_))); !t(.length([1])).
+!t(N) : .length([a,b]) > N <- .print(N).
!p.
+!p <- (.print(a); .print(b)); (b(X) & X > 1); ?(b(Y) & (Y < 2 | Y > 7)); .print(X, Y); (X + 1) > 2; (+q(1); -q(1)).
