/* Names that a scenario does not take. */
test(on).
event(1).
'odd name'(2).
count(1). count(1, 2).
ns::fact(3).
room(idle). idle.
plan(event). self_(1).
!do.
+!do : test(On) & event(_X) & 'odd name'(Y) & count(_X, Z) & ns::fact(Y) & room(idle) & idle & plan(event)
   <- wait(On); for_(Y); .print(Z); !agent(_X, Y).
+!agent(_A, B) : _B = B <- use(B); world(_A); .print("a ", b(_A, ü), " \"quoted\" \\ \t end").
