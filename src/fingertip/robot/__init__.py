"""Models of a fingertip for simulators of robots: masses, frames, collision pieces and contact, as MJCF and URDF."""
