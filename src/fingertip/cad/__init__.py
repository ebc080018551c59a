"""Computer-aided design of the parts: solids, the two kernels that evaluate them, files, printing and checks."""
