// The owner drinks, and asks for more.
!get(beer).
!check_bored.

@g
+!get(beer) : true
   <- .send(robot, achieve, has(owner, beer)).

+has(owner, beer) : true
   <- !drink(beer).
-has(owner, beer) : true
   <- !get(beer).

// as long as there is beer, sip
+!drink(beer) : has(owner, beer)
   <- sip(beer);
      !drink(beer).
+!drink(beer) : not has(owner, beer).

+!check_bored : true
   <- .random(X); .wait(X * 5000 + 2000);
      .send(robot, askOne, time(_), R);
      .print(R);
      !!check_bored.

+msg(M)[source(Ag)] : .my_name(Me)
   <- .print("Message from ", Ag, " to ", Me, ": ", M);
      -msg(M).
