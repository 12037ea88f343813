"""Response surfaces: from runs (u, y) in standard-normal space to a cheap function of u."""
