"""Validation: cases that check a claim against something outside, and what they need."""
