"""Lists about the packages that fingertip needs: hashes of their wheels, and their licences."""
