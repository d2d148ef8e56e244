plays(initiator, c).
+plays(initiator, In) : .my_name(Me) <- .send(In, tell, introduction(participant, Me)).
+cfp(CNPId, _Service)[source(A)] : plays(initiator, A) <- .send(A, tell, refuse(CNPId)).
