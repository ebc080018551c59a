"""What is ordered: parts, boards, assembly."""
