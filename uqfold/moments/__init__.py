"""Moments of a response by quadrature, and the distributions fitted to them."""
