"""Design parameters of the seal and their design velocities."""
