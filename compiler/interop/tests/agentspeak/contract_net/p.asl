// gives the price of a task
price(_Service, X) :- .random(R) & X = (10 * R) + 100.

plays(initiator, c).

+plays(initiator, In)
   :  .my_name(Me)
   <- .send(In, tell, introduction(participant, Me)).

@c1 +cfp(CNPId, Task)[source(A)]
   :  plays(initiator, A) & price(Task, Offer)
   <- +proposal(CNPId, Task, Offer); // remember my proposal
      .send(A, tell, propose(CNPId, Offer)).

@r1 +accept_proposal(CNPId)
   :  proposal(CNPId, Task, Offer)
   <- .print("My proposal '", Offer, "' won CNP ", CNPId, " for ", Task, "!");
      do(Task).
@r2 +reject_proposal(CNPId)
   <- .print("I lost CNP ", CNPId, ".");
      -proposal(CNPId, _, _).
