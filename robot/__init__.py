"""A planar continuum arm: dynamics, controllers, disturbances and closed-loop simulation, in SI units."""
