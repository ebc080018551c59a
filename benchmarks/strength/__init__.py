"""Finite elements of bones in CalculiX, beside which
`tests/cad/test_bone_elements.py` puts the predicted stresses.
"""
