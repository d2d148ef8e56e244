/* The person can say that the leg may be let go. true */
E<> Human.Told

/* Both legs can be given. true */
E<> given == N

/* Both legs can be kept. true */
E<> kept == N

/* A person in a hurry gets bored. true */
E<> Human.Bored

/* A patient one never does: the robot is there after 11 ticks. false */
E<> Human.Bored and Human.patience == PATIENT

/* What is decided was asked for. true */
A[] given + kept <= asked

/* The robot lets go although the gaze was not seen. false */
E<> Robot.Releasing && !seen[GAZE]

/* When the robot lets go, the person is ready in all respects. true */
A[] Robot.Releasing imply forall (i : sensor_t) ok[i]

/* Nothing ever stands still. true */
A[] not deadlock

/* An order is always worked off. true */
Robot.Ordered --> Robot.Returning

/* Who waits is offered the leg, or gets bored. true */
Human.Waiting --> (Human.Offered or Human.Bored)

/* The person goes home in the end. false: nobody must */
A<> Human.Home

/* The person may never ask. true */
E[] not Robot.Ordered

/* How long an offer stands at most. 6 */
sup{Watch.Open}: Watch.w

/* How many legs are asked for at most. 2 */
sup: asked

/* The earliest decision after an offer. 2 */
inf{Robot.Deciding}: Watch.w

/* How likely it is that the person speaks: this is not carried over */
Pr[<=100](<> Human.Told)
