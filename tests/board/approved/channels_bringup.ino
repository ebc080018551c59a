Differences from ../../../pcb/bringup.ino:
@@ -2,1 @@
+// It reads T and S of one finger as well, and tells what is within its limits.
@@ -8,1 @@
+static const int T_PIN = A0, S_PIN = A1;  // change them for each further finger
@@ -78,1 @@
+  report("T at rest: ", mean_v, 0.4110f, 0.4811f);
@@ -80,2 @@
+  report("S at rest: ", mean_v, 1.6037f, 1.7003f);
+  report("S quiet, RMS: ", rms_v, 0.0f, 0.0060f);
@@ -84,1 @@
+  report("S with 40.0 Hz, RMS: ", tone_v, 0.0906f, 0.1322f);
@@ -86,1 @@
+  report("S with 66.7 Hz, RMS: ", tone_v, 0.3298f, 0.4069f);
@@ -88,1 @@
+  report("S with 136.4 Hz, RMS: ", tone_v, 0.4680f, 0.5452f);
@@ -90,1 @@
+  report("S with 1000.0 Hz, RMS: ", tone_v, 0.1405f, 0.1905f);
@@ -92,1 @@
+  report("T with 1000.0 Hz, RMS: ", tone_v, 0.0007f, 0.0022f);
