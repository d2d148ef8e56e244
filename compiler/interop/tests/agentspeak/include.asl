{ include("common.asl") }
{ include("$jacamoJar/templates/common-cartago.asl") }
!go.
+!go : limit(N) & near(N, M) <- !common(M).
