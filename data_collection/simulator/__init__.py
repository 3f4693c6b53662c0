"""The iCub at its table in PyBullet: robot, scene, physics, and what is recorded."""
