"""The kernels of the mixing sampler on (z, F), π, φ and θ integrated out: each leaves the posterior invariant."""
