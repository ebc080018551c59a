Differences from ../../../pcb/bringup.ino:
@@ -11,1 @@
+static const float TAP_V = 0.0170f;
@@ -78,1 @@
+  report("T at rest: ", mean_v, 0.4206f, 0.4710f);
@@ -80,2 @@
+  report("S at rest: ", mean_v, 1.6083f, 1.6926f);
+  report("S quiet, RMS: ", rms_v, 0.0f, 0.0052f);
@@ -86,3 @@
+  report("S with 66.7 Hz, RMS: ", tone_v, 0.3710f, 0.4575f);
+  Serial.println("Measure TP4 and SLIP now, for 20 seconds.");
+  measure(S_PIN, 44, 20);
+  report("S with 136.4 Hz, RMS: ", tone_v, 0.5265f, 0.6132f);
@@ -90,1 @@
+  report("S with 1000.0 Hz, RMS: ", tone_v, 0.1589f, 0.2153f);
