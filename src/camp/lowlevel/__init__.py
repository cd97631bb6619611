"""The Go2's low-level interface: motor commands out, joint and inertial readings in, and a way to end safely."""
